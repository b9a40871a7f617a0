"""The documented exit codes are all there are, and each is what a command ends with; fuzzed commands end with no other."""

import io
import json
import os
import re
import signal
import sys
import threading
from pathlib import Path

import pytest
from fuzz_commands import Run, fault_of, fuzz, here
from report_records import typical

import fogproof.cli.commands
import fogproof.cli.list_command
from fogproof.checks.json_values import jsonable
from fogproof.cli.signals import _ASKING, Stopped
from fogproof.cli.terminal import BAD_INPUT, UNREAD

ROOT = Path(__file__).resolve().parents[2]
WRONG = """
import numpy as np
from fogproof.catalogue import EstimatorCase
class Wrong:
    def draw(self, rng, n):
        return rng.random(n)
def cases():
    return [EstimatorCase(name="wrong", make=Wrong, reference=0.6, samples=10_000)]
"""


def documented():
    text = (ROOT / "docs" / "command-line.md").read_text()
    return {int(n) for row in re.findall(r"^\| ([\d, ]+) \|", text, re.M) for n in row.split(",")}


def ends(*words, stdin=b""):
    return here(Run([str(word) for word in words], stdin=stdin))


def compared(folder, change):
    record = jsonable(typical(2))
    for name, made in (("old", record), ("new", change(record))):
        (folder / name).mkdir()
        (folder / name / "results.json").write_text(json.dumps(made))
    return ends("report", folder / "new", "--against", folder / "old").code


def test_as_expected(tmp_path):
    assert ends("list", "fog").code == 0
    assert compared(tmp_path, lambda record: record) == 0


def test_rejected(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(WRONG)
    assert ends("verify", file).code == 1


def test_bad_input():
    assert ends("list", "nothing").code == 2
    assert ends("plan").code == 2
    assert ends("oracle", "-", stdin=b"?").code == 2


def test_usage_cannot_move_the_terminal():
    end = ends("plan", "a", "\u202eb\x07\x9b31m")
    assert end.code == 2
    assert end.err.startswith(b"Usage: ")
    assert "\ufffdb\u2407\ufffd31m" in end.err.decode()


def test_something_is_gone(tmp_path):
    assert compared(tmp_path, lambda record: {**record, "cases": record["cases"][:-1]}) == 3


STOPS = [(Stopped(number), 128 + number) for number in (getattr(signal, name) for name in _ASKING)]


@pytest.mark.parametrize(
    ("stop", "code"), [*STOPS, (KeyboardInterrupt(), 130), (BrokenPipeError(), 141), (ValueError(), 70)]
)
def test_whatever_is_raised_has_its_code(monkeypatch, stop, code):
    def raises(cases):
        raise stop

    monkeypatch.setattr(fogproof.cli.list_command, "select", raises)
    end = ends("list")
    assert end.code == code
    assert code in documented()
    assert code == 141 or end.err.lstrip().startswith(b"fogproof: ")


def test_the_page_knows_every_code():
    own = {BAD_INPUT, fogproof.cli.commands.FAULT, UNREAD, *(128 + getattr(signal, name) for name in _ASKING)}
    assert documented() == own | {0, 1, 3}


def test_no_other_code_is_written_down():
    """Literal codes in the sources of the commands: those of outcomes, and bad input."""
    found = set[str]()
    for file in (ROOT / "src" / "fogproof" / "cli").glob("*.py"):
        found |= set(re.findall(r"(?:return|else|exit\(|code =) ?(\d+)", file.read_text()))
    assert found <= {"0", "1", "2", "3", "128"}


def test_a_fault_is_seen():
    run = Run(["plan", "x"])
    end = here(run)
    assert fault_of(run, end) == ""
    assert "exit code" in fault_of(run, end._replace(code=70))
    assert "sentence" in fault_of(run, end._replace(err=b""))
    assert "terminal" in fault_of(run, end._replace(err=b"\x1b[31m"))
    assert "own" in fault_of(run, end._replace(out=b'{"error": {"code": "internal"}}'))


def test_fuzzed_commands_end_well(tmp_path):
    stdin = sys.stdin
    counts, faults = fuzz(150, 1, tmp_path, jsonable(typical(2)))
    assert not faults
    assert sys.stdin is stdin
    assert {kind for kind, _ in (name.split() for name in counts)} >= {
        "plan",
        "requests",
        "cases",
        "check",
        "export",
        "words",
    }
    assert isinstance(sys.stdout, io.TextIOBase)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_requests_come_from_files_and_pipes_but_no_device(tmp_path):
    request = json.dumps({"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": 0.5}).encode()
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for words in (["oracle"], ["golden", "--requests"]):
        writer = threading.Thread(target=pipe.write_bytes, args=(request,))
        writer.start()
        assert ends(*words, pipe).code == 0
        writer.join()
        end = ends(*words, "/dev/zero")
        assert (end.code, b"it is a device" in end.err) == (2, True)
        assert b"Is a directory" in ends(*words, tmp_path).err
