"""The command line: documented exit codes, JSON on stdout, people on stderr, and never a traceback."""

import json
import subprocess
import sys

import pytest

from fogproof.verify import select

SCENE = """
scattering = "single"
background = 0.5
medium = { sigma_a = 0.1, sigma_s = 0.2, phase = { kind = "rayleigh" } }
ray = { origin = [0, 0, 0], direction = [0, 0, 1], length = 4 }
light = { position = [0, 1, 2], intensity = 3 }
"""


def fogproof(*arguments, stdin=""):
    return subprocess.run(
        [sys.executable, "-c", "from fogproof.cli import main; main()", *map(str, arguments)],
        input=stdin, capture_output=True, text=True, timeout=120,
    )  # fmt: skip


def test_verify_writes_a_report_and_exits_0(tmp_path):
    out = fogproof("verify", "fog", "free-path/thin", "--report", tmp_path / "report", "--seed", 3)
    assert out.returncode == 0, out.stderr
    assert len(out.stdout.splitlines()) == 1 + len(select(["fog", "free-path/thin"]))
    assert "seed 3" in out.stderr
    for name in ("index.html", "results.json", "junit.xml"):
        assert (tmp_path / "report" / name).stat().st_size > 0
    assert list((tmp_path / "report" / "figures").glob("*.png"))
    record = json.loads((tmp_path / "report" / "results.json").read_text())
    assert record["schema"] == "fogproof/results/1"
    page = (tmp_path / "report" / "index.html").read_text()
    again = fogproof("report", tmp_path / "report")
    assert again.returncode == 0, again.stderr
    assert (tmp_path / "report" / "index.html").read_text() == page
    both = fogproof("report", tmp_path / "report", "--against", tmp_path / "report")
    assert both.returncode == 0, both.stderr
    assert both.stdout.strip() == str(tmp_path / "report" / "comparison.html")
    assert "Every case came out as before" in (tmp_path / "report" / "comparison.html").read_text()
    record["cases"][0] |= {"status": "error", "verdict": None}
    (tmp_path / "report" / "results.json").write_text(json.dumps({**record, "exit_code": 1}))
    (tmp_path / "old").mkdir()
    older = {"cases": record["cases"][1:], "asked": [case["name"] for case in record["cases"][1:]]}
    (tmp_path / "old" / "results.json").write_text(json.dumps({**record, **older}))
    assert fogproof("report", tmp_path / "report", "--against", tmp_path / "old").returncode == 1


def test_progress_is_silent_where_stderr_is_not_a_terminal():
    out = fogproof("verify", "fog/analog/haze", "--json")
    (case,) = json.loads(out.stdout)["cases"]
    assert (case["status"], case["twin_result"]) == ("passed", None)
    assert len(out.stderr.splitlines()) == 1


def test_broken_twins_run_where_they_are_asked_for():
    (case,) = json.loads(fogproof("verify", "fog/analog/haze", "--json", "--twins").stdout)["cases"]
    assert case["twin_result"]["outcome"] == "rejected"


def test_list_names_every_case():
    out = fogproof("list", "--json", "directions")
    assert out.returncode == 0
    assert all(json.loads(line)["twin"] for line in out.stdout.splitlines())


def test_plan_says_what_a_scene_needs(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    assert "single_scattering" in fogproof("plan", path).stdout
    answer = json.loads(fogproof("plan", path, "--json").stdout)
    kept = {term["name"]: term["kept"] for term in answer["terms"]}
    assert kept == {"attenuation": True, "background": True, "emission": False, "in-scattering": True, "colour": False}


REQUEST = {
    "quantity": "transmittance",
    "medium": {"sigma_a": 0.5, "sigma_s": 0.5},
    "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 2},
}


def test_oracle_answers_a_file_and_lines(tmp_path):
    path = tmp_path / "request.json"
    path.write_text(json.dumps(REQUEST, indent=2))
    out = fogproof("oracle", path)
    assert out.returncode == 0, out.stderr
    answer = json.loads(out.stdout)
    assert abs(answer["value"] - 0.1353352832366127) <= answer["error"]
    assert answer["unit"] == "1"
    lines = "\n".join(
        [json.dumps({**REQUEST, "id": 7}), "{", json.dumps({"quantity": "luck"}), "", json.dumps(REQUEST)]
    )
    out = fogproof("oracle", "-", stdin=lines)
    assert out.returncode == 2
    answers = [json.loads(line) for line in out.stdout.splitlines()]
    assert [("value" in a, "error" in a) for a in answers] == [(True, True), (False, True), (False, True), (True, True)]
    assert answers[0]["id"] == 7
    assert answers[1]["error"]["code"] == "invalid-input"
    assert "known are" in answers[2]["error"]["message"]


def test_oracle_keeps_to_the_limits_it_is_given():
    two, three = ({"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": mu} for mu in ([0, 1], [-1, 0, 1]))
    lines = "\n".join(map(json.dumps, [two, three, {**two, "id": "long" * 100}]))
    out = fogproof("oracle", "-", "--max-values", 2, "--max-bytes", 200, stdin=lines)
    assert out.returncode == 2, out.stderr
    assert ["error" in json.loads(line) and "value" not in json.loads(line) for line in out.stdout.splitlines()] == [
        False,
        True,
        True,
    ]


def test_oracle_gives_the_answers_that_physics_has():
    airlight = {"quantity": "airlight_integral", "sigma_t": 0.5, "h": 0, "a": -1, "b": 1}
    empty = {**REQUEST, "medium": {"sigma_a": 0, "sigma_s": 0}, "ray": {**REQUEST["ray"], "length": "inf"}}
    out = fogproof("oracle", "-", stdin="\n".join(map(json.dumps, [airlight, empty])))
    assert out.returncode == 0
    assert [json.loads(line)["value"] for line in out.stdout.splitlines()] == ["inf", 1.0]


BAD_REQUESTS = [
    ({"medium": {"sigma_a": -1, "sigma_s": 0}}, "sigma_a must be finite and >= 0", "medium.sigma_a"),
    ({"medium": {"sigma_a": 0}}, "medium.sigma_s is missing", "medium.sigma_s"),
    ({"ray": {**REQUEST["ray"], "length": -1}}, "length must be >= 0", "ray.length"),
    ({"ray": {**REQUEST["ray"], "direction": [0, 0, 3]}}, "direction must have unit length", "ray.direction"),
    ({"luck": 1}, "luck is not a known key", "luck"),
    ({"quantity": "phase_pdf"}, "medium is not a known key, and phase, mu are missing (and 1 more)", "medium"),
]


@pytest.mark.parametrize(("change", "message", "path"), BAD_REQUESTS)
def test_bad_requests_are_answered_with_code_message_and_path(change, message, path):
    from fogproof.oracle import answer_text

    error = answer_text(json.dumps({**REQUEST, **change}))["error"]
    assert message in error["message"]
    assert error["path"] == path


BAD_CALLS = [
    (["verify", "luck"], "no case is called 'luck'"),
    (["verify", "--alpha", "2"], "'--alpha': must be a number in [1e-90, 1), got 2"),
    (["verify", "--seed", "-1"], "Invalid value for '--seed'"),
    (["verify", "fog/analog/haze", "--report", "/proc/nowhere"], "cannot write /proc/nowhere"),
    (["plan", "nowhere.toml"], "cannot read the scene file nowhere.toml"),
    (["oracle", "nowhere.json"], "cannot read the request file nowhere.json"),
    (["report", "nowhere"], "cannot read nowhere"),
    (["gallery", "luck", "-o", "/tmp"], "no picture is called 'luck'; known are phase-polar"),
    (["gallery", "phase-polar", "-o", "/proc/nowhere"], "cannot write /proc/nowhere"),
    (["gallery"], "Missing option '-o'"),
    (["dance"], "No such command"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_CALLS)
def test_bad_calls_end_in_one_sentence_and_exit_2(arguments, message):
    out = fogproof(*arguments)
    assert out.returncode == 2
    assert message in out.stderr
    assert "Traceback" not in out.stderr
    assert not out.stdout


def test_malformed_json_ends_in_exit_2(tmp_path):
    path = tmp_path / "broken.json"
    path.write_text('{"quantity": ')
    out = fogproof("oracle", path)
    assert out.returncode == 2
    assert "not valid JSON" in json.loads(out.stdout)["error"]["message"]
    assert "Traceback" not in out.stderr
