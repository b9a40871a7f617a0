"""`fogproof check`: exit codes, and where its words go."""

import contextlib
import json
import os
import shlex
import subprocess
import sys

import pytest
from click.testing import CliRunner

from fogproof.cli import main
from fogproof.cli.check_command import command

ZEROS = """
import sys
print('{"fogproof": 1, "type": "text", "columns": ["value"]}', flush=True)
for line in sys.stdin:
    n = int(line.split('"n": ')[1].split(",")[0])
    print('{"n": %d}\\n' % n + "0\\n" * n, end="", flush=True)
"""


def run(tmp_path, spec, *options, source=ZEROS):
    (tmp_path / "spec.toml").write_text(spec)
    (tmp_path / "zeros.py").write_text(source)
    words = ["--exec", f"{sys.executable} -S {tmp_path / 'zeros.py'}", "--spec", str(tmp_path / "spec.toml")]
    return CliRunner().invoke(command, [*words, *options], standalone_mode=False)


@pytest.mark.parametrize(
    ("spec", "code"),
    [("reference = 0\nvariance = 0", 0), ("reference = 1\nbounds = [0, 2]", 1), ("reference = 1e-9", 3)],
)
def test_exit_codes(tmp_path, spec, code):
    result = run(tmp_path, spec, "--samples", "2000")
    assert result.return_value == code, result.output


def test_json_is_alone_on_stdout(tmp_path):
    result = run(tmp_path, "reference = 1\nbounds = [0, 2]", "--json", "--samples", "1000", "--seed", "3")
    told = json.loads(result.stdout)
    assert told["outcome"] == "rejected"
    assert told["reproduce"].startswith("fogproof check --exec")
    assert "--seed=3" in told["reproduce"]


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("", "says nothing of what is to be judged"),
        ("reference = 0.5\ndomain = 'sphere'", "reference is for estimators"),
        ("domain = 'sphre'", "'sphre'; known are sphere"),
        ("domain = { kind = 'interval', a = 1, b = 0 }", "must be greater than a"),
        (
            "domain = { kind = 'interval', low = 1 }",
            "low is not a known key; a is missing; b is missing; its keys are kind, a, b",
        ),
        ("domain = { kind = 'discrete' }", "domain discrete: n is missing; its keys are kind, n"),
        ("domain = { kind = 'sphere', radius = 1 }", "radius is not a known key; it has no key but kind"),
        ("domain = { kind = 'product' }", "parts is missing; its keys are kind, parts"),
        ("domain = 'line'\ndimensons = 1", "did you mean dimensions?"),
        ("phase = { kind = 'rayleigh', g = 0 }", "phase.g is not a known key"),
        ("medium = { sigmaa = 1, sigma_s = 0 }", "medium.sigmaa is not a known key, and medium.sigma_a is missing"),
        ("scene = 'absent.toml'", "cannot read the scene file"),
        ("domain = 'line'\ndimension = 1", "dimension is not a known key"),
        ("domain = 'line'\ndimensions = 0", "dimensions must be >= 1"),
        ("reference = '$g'", "$g is no parameter"),
        ("reference = 0\nscene = 5", "scene"),
        ("phase = { kind = 'hg' }", "kind 'hg'"),
        ("phase = { kind = 'rayleigh' }\nmedium = { sigma_a = 1, sigma_s = 0 }", "one density is enough"),
        ("medium = { sigma_a = 1, sigma_s = 0 }", "medium and ray belong together"),
        ("reference = 1\nfamily = { g = [] }", "family.g must be a list"),
        ("reference = 1\nfamily = { g = { from = 1, to = 0 } }", "greater than from"),
        ("reference = 1 =", "is not valid TOML"),
        ("domain = 'line'\nevents = { medium = 1 }", "events.medium must be a whole number"),
        ("quantity = { quantity = 'nothing' }", "'nothing' is not known"),
        ("domain = 'line'", "is an estimator by its columns"),
        ("domain = 'line'\nalbedo = nan", "albedo must be finite, got nan"),
        ("domain = 'line'\nalbedo = [0.5, -inf]", "albedo must be finite, got -inf"),
        ("domain = 'line'\nuniform_bits = -1", "uniform_bits must be a whole number >= 8"),
        ("reference = 1\nsamples = -1", "samples must be a whole number >= 1, got -1"),
    ],
)
def test_bad_specs_are_told_in_a_sentence(tmp_path, spec, words):
    result = run(tmp_path, spec)
    assert words in (str(result.exception) if result.exception else result.output)


def test_what_cannot_be_started_is_bad_input(tmp_path, capfd):
    (tmp_path / "spec.toml").write_text("reference = 1")
    for wrong, said in (
        ("./nowhere --g 1", "cannot start './nowhere'"),
        ("'unclosed", "--exec is no command line: No closing quotation"),
        ("", "--exec is empty; give a program and its arguments"),
    ):
        with pytest.raises(SystemExit) as end:
            main(["check", "--spec", str(tmp_path / "spec.toml"), "--exec", wrong])
        assert end.value.code == 2
        assert said in capfd.readouterr().err


def test_a_spec_of_an_editor_that_marks_its_utf8(tmp_path):
    assert run(tmp_path, "\ufeffreference = 0\nvariance = 0", "--samples", "2000").return_value == 0


def test_a_scene_may_stand_in_a_file_of_its_own(tmp_path):
    scene = 'scattering = "none"\nbackground = 1.0\n[medium]\nsigma_a = 0.0\nsigma_s = 0.0\n[ray]\n'
    (tmp_path / "scene.toml").write_text(f"{scene}origin = [0, 0, 0]\ndirection = [0, 0, 1]\nlength = 1.0\n")
    result = run(tmp_path, "scene = 'scene.toml'\nbounds = [0, 1]", "--samples", "2000")
    assert "the reference is 1" in result.output, result.output


def test_a_file_has_no_family(tmp_path):
    (tmp_path / "spec.toml").write_text("reference = 0\ncolumns = ['value']\nfamily = { g = [0, 1] }")
    (tmp_path / "x.csv").write_text("0\n" * 500)
    result = CliRunner().invoke(
        command, [str(tmp_path / "x.csv"), "--spec", str(tmp_path / "spec.toml")], standalone_mode=False
    )
    assert "samples of one member" in str(result.exception or result.output)


def test_a_terminal_is_told_what_is_being_done(tmp_path):
    (tmp_path / "spec.toml").write_text("reference = 0\nvariance = 0")
    (tmp_path / "zeros.py").write_text(ZEROS)
    program = shlex.join([sys.executable, "-S", str(tmp_path / "zeros.py")])
    words = ["check", "--exec", program, "--spec", str(tmp_path / "spec.toml"), "--samples", "2000"]
    ours, theirs = os.openpty()
    done = subprocess.run(
        [sys.executable, "-m", "fogproof", *words], stdout=subprocess.PIPE, stderr=theirs, check=False
    )
    os.close(theirs)
    with contextlib.suppress(OSError):  # the other end is closed
        shown = b""
        while more := os.read(ours, 4096):
            shown += more
    os.close(ours)
    assert done.returncode == 0
    assert b"realisation 2000 of 2000 at most" in shown
    assert shown.endswith(b"\r\x1b[K"), "the line is cleared"
    assert b"\x1b" not in done.stdout
