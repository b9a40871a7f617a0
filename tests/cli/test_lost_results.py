"""What somebody else wrote is not replaced, and what nobody can read does not end as if it had been read."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from fuzz_commands import Run, here
from report_records import typical

from fogproof.checks.json_values import jsonable
from fogproof.errors import InvalidInputError
from fogproof.reports import REPORT, prepare_folder, write_report

ROOT = Path(__file__).resolve().parents[2]
SUN = str(ROOT / "scenes" / "images" / "sun.toml")
LECTURE = str(ROOT / "studies" / "lecture.toml")
WRITERS = [
    (["verify", "fog/analog/haze", "--report"], "index.html"),
    (["verify", "fog/analog/haze", "--report"], "junit.xml"),
    (["study", LECTURE, "-o"], "index.html"),
    (["study", LECTURE, "-o"], "results.json"),
    (["render", SUN, "--with", "true {scene} {out}", "-o"], "results.json"),
    (["relations", SUN, "--with", "true {scene} {out}", "-o"], "index.html"),
    (["compare", "none.npy", SUN, "--report"], "results.json"),
    (["gallery", "fog", "-o"], "gallery.html"),
    (["stability", "free_path/*", "-o"], "stability.csv"),
    (["bench", "airlight*", "-o"], "bench.json"),
    (["bench", "airlight*", "-o"], "bench.md"),
    (["bench", "airlight*", "-o"], "bench.jsonl"),
    (["zoo", "errata", "-o"], "zoo.md"),
]
CLOSED = pytest.mark.skipif(os.name != "posix", reason="needs a shell that closes stdout")


def record():
    return jsonable(typical(2))


def ends(*words):
    return here(Run([str(word) for word in words]))


@pytest.mark.parametrize(("words", "name"), WRITERS, ids=lambda part: part if isinstance(part, str) else part[0])
def test_no_command_replaces_what_it_did_not_write(tmp_path, words, name):
    (tmp_path / name).write_text('{"mine": 1}')
    end = ends(*words, tmp_path)
    assert end.code == 2
    assert str(tmp_path / name) in end.err.decode()
    assert [path.read_text() for path in tmp_path.iterdir()] == ['{"mine": 1}']


def test_a_report_is_not_written_over_somebody_elses(tmp_path):
    for name in ("new", "old"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "results.json").write_text(json.dumps(record()))
    page = tmp_path / "new" / "comparison.html"
    page.write_text("mine")
    words = ("report", tmp_path / "new", "--against", tmp_path / "old")
    assert ends(*words).code == 2
    assert page.read_text() == "mine"
    assert ends(*words, "--force").code == 0
    assert ends(*words).code == 0


def test_a_report_of_ours_is_replaced_and_each_file_is_looked_at(tmp_path):
    write_report(record(), tmp_path)
    prepare_folder(tmp_path)
    for name in REPORT[:2]:
        ours = (tmp_path / name).read_bytes()
        for theirs in (
            b"fogproof",
            b"<title>My notes on fogproof</title>",
            b'["fogproof"]',
            b"[" * 100_000,
            b"\xff",
        ):
            (tmp_path / name).write_bytes(theirs)
            with pytest.raises(InvalidInputError, match=rf"{name} was not written by fogproof.*--force"):
                prepare_folder(tmp_path, force=False)
            prepare_folder(tmp_path, force=True)
        (tmp_path / name).write_bytes(ours)
        prepare_folder(tmp_path)
    for name in REPORT[:2]:
        (tmp_path / name).unlink()
        (tmp_path / name).symlink_to("nowhere")
        with pytest.raises(InvalidInputError, match=rf"{name} was not written by fogproof"):
            prepare_folder(tmp_path)
        (tmp_path / name).unlink()
    with pytest.raises(InvalidInputError, match=r"results\.csv was not written by fogproof"):
        prepare_folder(tmp_path)  # nothing is left that says whose it is


@CLOSED
@pytest.mark.parametrize("words", ["oracle -", "--help"])
def test_a_closed_stdout_is_one_that_nobody_reads(words):
    request = json.dumps({"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": 0.5}).encode()
    command = f"{shlex.quote(sys.executable)} -m fogproof {words} >&-"
    out = subprocess.run(command, shell=True, input=request, stderr=subprocess.PIPE)
    assert (out.returncode, out.stderr) == (141, b"")


@CLOSED
def test_nothing_to_print_needs_no_stdout(tmp_path):
    file = tmp_path / "sun.json"
    command = (
        f"{shlex.quote(sys.executable)} -m fogproof export {shlex.quote(SUN)} --to json -o {shlex.quote(str(file))} >&-"
    )
    assert subprocess.run(command, shell=True, stderr=subprocess.PIPE).returncode == 0
    assert file.exists()


@CLOSED
@pytest.mark.parametrize("closed", ["2>&-", "2>&- <&-"])
def test_a_closed_stderr_costs_nothing(tmp_path, closed):
    samples, spec = tmp_path / "samples.csv", tmp_path / "spec.toml"
    samples.write_text("".join(f"{(i + 0.5) / 1000 - 1}\n" for i in range(2000)))
    spec.write_text('domain = { kind = "interval", a = -1, b = 1 }\nphase = { kind = "isotropic" }\n')
    words = shlex.join([sys.executable, "-m", "fogproof", "check", str(samples), "--spec", str(spec), "--json"])
    found = [subprocess.run(f"{words} {end}", shell=True, capture_output=True) for end in ("", closed)]
    assert found[1].returncode == found[0].returncode != 70
    assert json.loads(found[1].stdout)["outcome"] == json.loads(found[0].stdout)["outcome"]


@CLOSED
@pytest.mark.parametrize("words", ["golden --requests {file} --format csv", "oracle --schema"])
def test_output_that_is_cut_short_is_told_without_buffers_too(tmp_path, words):
    """Unbuffered, Python takes what a limited file still had room for as the whole."""
    requests = tmp_path / "requests.jsonl"
    mu = ", ".join(str(i / 4000) for i in range(4000))
    requests.write_text(f'{{"quantity": "phase_pdf", "phase": {{"kind": "rayleigh"}}, "mu": [{mu}]}}\n')
    words = words.format(file=shlex.quote(str(requests)))
    command = f"ulimit -f 8; {shlex.quote(sys.executable)} -m fogproof {words} > {tmp_path}/out"
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    out = subprocess.run(["bash", "-c", command], stderr=subprocess.PIPE, env=environment)
    assert out.returncode == 2, out.stderr
    assert b"File too large" in out.stderr


@CLOSED
def test_help_that_nobody_reads_is_no_rejection():
    reading, writing = os.pipe()
    os.close(reading)
    out = subprocess.run([sys.executable, "-m", "fogproof", "--help"], stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    assert (out.returncode, out.stderr) == (141, b"")


@pytest.mark.parametrize("words", [("oracle", "-"), ("golden", "--requests", "-")])
def test_a_closed_stdin_is_a_sentence(monkeypatch, words):
    import fogproof.cli.terminal

    monkeypatch.setattr(fogproof.cli.terminal, "sys", type("closed", (), {"stdin": None}))
    end = ends(*words)
    assert (end.code, b"stdin is closed" in end.err) == (2, True)


@pytest.mark.parametrize(("stdin", "stdout"), [("ab", "wb"), ("rb", "rb")], ids=["stdin", "stdout"])
def test_a_stream_that_is_open_the_other_way_is_a_sentence(tmp_path, stdin, stdout):
    for name in ("in", "out"):
        (tmp_path / name).write_text("{}\n")
    with (tmp_path / "in").open(stdin) as given, (tmp_path / "out").open(stdout) as taken:
        words = [sys.executable, "-m", "fogproof", "oracle", "-"]
        done = subprocess.run(words, stdin=given, stdout=taken, stderr=subprocess.PIPE)
    assert (done.returncode, b"turn the arrows round" in done.stderr) == (2, True), done.stderr


def test_an_outcome_that_there_is_not_is_named(tmp_path):
    told = record()
    told["cases"][0]["verdict"]["outcome"] = "splendid"
    (tmp_path / "results.json").write_text(json.dumps(told))
    end = ends("report", tmp_path)
    assert end.code == 2
    assert b"cases.0.verdict.outcome must be " in end.err
    assert b"splendid" in end.err
    assert not (tmp_path / "index.html").exists()


@pytest.mark.parametrize("words", [["report", "run"], ["report", "good", "--against", "run"]])
def test_a_record_changed_by_hand_is_named(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    for name in ("good", "run"):
        Path(name).mkdir()
        Path(name, "results.json").write_text(json.dumps(record()))
    text = Path("run/results.json").read_text()
    Path("run/results.json").write_text('{"schema": "mine", ' + text[1:])
    end = ends(*words)
    assert (end.code, b"run/results.json" in end.err, b"'schema' stands twice" in end.err) == (2, True, True)


def test_an_exit_code_that_is_not_that_of_the_cases_is_named(tmp_path):
    told = record()
    assert told["exit_code"] == 1
    for code, told["exit_code"] in ((0, 1), (2, 0), (2, 3)):
        (tmp_path / "results.json").write_text(json.dumps(told))
        assert ends("report", tmp_path).code == code
    told |= {"state": "interrupted", "exit_code": 130}
    (tmp_path / "results.json").write_text(json.dumps(told))
    end = ends("report", tmp_path)
    assert (end.code, b"the run was interrupted, and had rejected" in end.err) == (1, True)


def test_a_finished_record_that_has_lost_cases_is_named(tmp_path):
    told = record()
    told["asked"] = [case["name"] for case in told["cases"]]
    (tmp_path / "results.json").write_text(json.dumps(told))
    assert ends("report", tmp_path).code == 0
    rejected = [case for case in told["cases"] if case["status"] == "rejected"]
    (tmp_path / "results.json").write_text(json.dumps(told | {"cases": rejected}))
    end = ends("report", tmp_path)
    assert (end.code, b"which was asked for" in end.err) == (2, True)
    (tmp_path / "results.json").write_text(json.dumps(told | {"cases": [], "asked": [], "exit_code": 0}))
    end = ends("report", tmp_path)
    assert (end.code, b"cases must not be empty" in end.err) == (2, True)


def test_a_record_of_which_no_page_can_be_made_is_named(tmp_path, monkeypatch):
    import fogproof.reports

    def falls(*_, **__):
        return {}["done"]

    (tmp_path / "results.json").write_text(json.dumps(record()))
    monkeypatch.setattr(fogproof.reports, "write_report", falls)
    end = ends("report", tmp_path)
    assert (end.code, b"results.json, as if changed by hand: KeyError: 'done'" in end.err) == (2, True)
