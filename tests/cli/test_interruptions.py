"""A run that is stopped says so everywhere, keeps what it has, and leaves no process behind."""

import json
import os
import signal
import subprocess
import sys
import time
from xml.etree import ElementTree

import pytest
from study_fixtures import LIT, SMALL, kinds, toml

COMMAND = [sys.executable, "-c", "from fogproof.cli import main; main()"]
LONG = {**SMALL, "samples": [1000, 10_000_000], "scenes": [{**LIT, "estimators": kinds("airlight")}], "batch": 10_000}


def hearing():
    """Hear signals even where this test was started by nohup or in the background."""
    for name in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(name, signal.SIG_DFL)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_stopped_run_of_the_catalogue_is_unfinished_everywhere(tmp_path, number):
    process = subprocess.Popen(
        [*COMMAND, "verify", "fog", "directions", "--workers", "1", "--report", str(tmp_path / "run")],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=hearing, bufsize=1,
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()
    process.stdout.readline()  # the first case is there
    process.send_signal(number)
    _, said = process.communicate(timeout=600)
    assert process.returncode == 128 + number, said
    record = json.loads((tmp_path / "run" / "results.json").read_text())
    ran, asked = len(record["cases"]), len(record["asked"])
    assert 0 < ran < asked
    assert (record["state"], record["exit_code"]) == ("interrupted", 128 + number)
    assert record["title"] == f"Unfinished: {ran} of {asked}"
    assert f"<title>Unfinished: {ran} of {asked}" in (tmp_path / "run" / "index.html").read_text()
    suite = ElementTree.parse(tmp_path / "run" / "junit.xml").getroot()[0]
    assert f"Unfinished: {ran} of {asked}" in suite.attrib["name"]
    assert int(suite.attrib["skipped"]) >= asked - ran
    assert int(suite.attrib["tests"]) == asked


def test_what_nohup_ignores_is_ignored():
    ask = "from fogproof.cli.signals import stoppable; import os, signal\nwith stoppable():\n os.kill(os.getpid(), 1)\nprint('on')"
    out = subprocess.run(
        [sys.executable, "-c", ask], capture_output=True, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),
    )  # fmt: skip
    assert out.stdout.strip() == "on"


def test_a_stopped_study_writes_what_it_has(tmp_path):
    file, run = tmp_path / "study.toml", tmp_path / "run"
    file.write_text(toml(LONG))
    process = subprocess.Popen(
        [*COMMAND, "study", str(file), "-o", str(run)], stderr=subprocess.PIPE, text=True, preexec_fn=hearing
    )
    wait_for_batches(process, run)
    process.send_signal(signal.SIGTERM)
    _, said = process.communicate(timeout=600)
    assert process.returncode == 143, said
    record = json.loads((run / "results.json").read_text())
    assert record["state"] == "interrupted"
    assert 0 < record["batches"]["done"] < record["batches"]["planned"]


def wait_for_batches(process, run):
    log = run / "study.sqlite-wal"
    while process.poll() is None and not (log.exists() and log.stat().st_size > 100_000):
        time.sleep(0.02)


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="needs Linux")
def test_no_worker_outlives_a_killed_study(tmp_path):
    """All processes hold the pipe open: it closes when the last of them has ended."""
    file, run = tmp_path / "study.toml", tmp_path / "run"
    file.write_text(toml(LONG))
    process = subprocess.Popen(
        [*COMMAND, "study", str(file), "-o", str(run), "--executor", "processes"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    wait_for_batches(process, run)
    process.kill()
    started = time.monotonic()
    assert process.stdout is not None
    process.stdout.read()
    assert time.monotonic() - started < 30
    process.stdout.close()
    process.wait()


def test_uncaught_faults_are_a_sentence_and_70(monkeypatch, tmp_path):
    ask = "import fogproof.cli.list_command as c; c.select = lambda cases: 1 / 0\nfrom fogproof.cli import main; main()"
    out = subprocess.run([sys.executable, "-c", ask, "list"], capture_output=True, text=True)
    assert out.returncode == 70
    assert out.stderr.startswith("fogproof: a fault of fogproof's own, please report it")
    assert "ZeroDivisionError" in out.stderr
    assert "Traceback" not in out.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk_behind_stdout_is_a_sentence():
    with open("/dev/full", "w") as full:
        out = subprocess.run([*COMMAND, "list"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert out.returncode == 2
    assert out.stderr.strip() == "fogproof: cannot write to stdout: No space left on device"


def test_a_foreign_page_is_not_replaced(tmp_path):
    (tmp_path / "index.html").write_text("mine")
    run = [*COMMAND, "verify", "fog/analog/haze", "--report", str(tmp_path)]
    out = subprocess.run(run, capture_output=True, text=True)
    assert out.returncode == 2
    assert "was not written by fogproof" in out.stderr
    assert "--force" in out.stderr
    assert (tmp_path / "index.html").read_text() == "mine"
    assert subprocess.run([*run, "--force"], capture_output=True).returncode == 0
    assert subprocess.run(run, capture_output=True).returncode == 0


def test_comparisons_end_with_what_is_gone(tmp_path):
    for name, cases in (("old", ("fog/analog/haze", "free-path/thin")), ("new", ("fog/analog/haze",))):
        subprocess.run([*COMMAND, "verify", *cases, "--report", str(tmp_path / name)], check=True, capture_output=True)
    compare = [*COMMAND, "report", str(tmp_path / "new"), "--against", str(tmp_path / "old")]
    assert subprocess.run(compare, capture_output=True).returncode == 3
    assert "1 case is gone" in (tmp_path / "new" / "comparison.html").read_text()
    record = json.loads((tmp_path / "old" / "results.json").read_text())
    (tmp_path / "old" / "results.json").write_text(json.dumps({**record, "kind": "tests"}))
    out = subprocess.run(compare, capture_output=True, text=True)
    assert out.returncode == 2
    assert "cannot be compared" in out.stderr
