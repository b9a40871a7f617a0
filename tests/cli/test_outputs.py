"""What is written is there whole or not at all; what was read is not written over; who does not read loses nothing."""

import errno
import io
import json
import os
import shlex
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from fuzz_commands import Run, here

from fogproof.bench.record import SCHEMA, history
from fogproof.errors import InvalidInputError
from fogproof.images.formats import format_of
from fogproof.journal import add_line, whole_lines
from fogproof.oracle import Limits, serve
from fogproof.reports.files import write_output
from fogproof.whole_files import write_file
from fogproof.zoo.running import ZooLog

ROOT = Path(__file__).resolve().parents[2]
SUN = (ROOT / "scenes" / "images" / "sun.toml").read_text().replace("width = 48, height = 36", "width = 2, height = 2")
QUESTION = '{"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": 0.5}'
POSIX = pytest.mark.skipif(os.name != "posix", reason="needs a shell, signals and links")
FOGPROOF = f"{shlex.quote(sys.executable)} -m fogproof"


@POSIX
def test_the_oracle_does_not_answer_its_answers(tmp_path):
    (tmp_path / "f").write_text(f"{QUESTION}\n")
    shell = {"shell": True, "cwd": tmp_path, "capture_output": True, "text": True}
    ran = subprocess.run(f"ulimit -f 1000; {FOGPROOF} oracle - < f >> f", **shell)  # it would end when the file is full
    assert (ran.returncode, "stdout is the file that stdin reads" in ran.stderr) == (2, True), ran.stderr
    assert (tmp_path / "f").read_text() == f"{QUESTION}\n"
    assert subprocess.run(f"{FOGPROOF} oracle - < f >> other", **shell).returncode == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (SUN, ["export", "in.toml", "--to", "json", "-o"]),
        (SUN, ["oracle", "in.toml", "-o"]),
        (QUESTION, ["golden", "--requests", "in.toml", "-o"]),
    ],
    ids=lambda part: part[0] if isinstance(part, list) else "",
)
def test_what_is_read_is_not_written_over(tmp_path, monkeypatch, text, words):
    monkeypatch.chdir(tmp_path)
    Path("in.toml").write_text(text)
    os.link("in.toml", "same.npy")
    end = here(Run([*words, "same.npy"]))
    assert (end.code, b"same.npy is the file that is read" in end.err) == (2, True)
    assert Path("in.toml").read_text() == text
    assert here(Run([*words, "other.npy"])).code == 0


@POSIX
@pytest.mark.parametrize("name", ["-", "/dev/stdin"])
def test_what_stdin_reads_is_not_written_over(tmp_path, name):
    (tmp_path / "in.json").write_text(QUESTION)
    os.link(tmp_path / "in.json", tmp_path / "same.json")
    for output, code in (("same.json", 2), ("/dev/null", 0), ("other.json", 0)):
        command = f"{FOGPROOF} golden --requests {name} -o {output} < in.json"
        done = subprocess.run(["sh", "-c", command], cwd=tmp_path, capture_output=True, text=True)
        assert (done.returncode, "same.json is the file that is read" in done.stderr) == (code, code == 2), done.stderr
        assert (tmp_path / "in.json").read_text() == QUESTION


@pytest.mark.parametrize(
    "words", [["golden", "phase_pdf"], ["export", "in.toml", "--to", "json"]], ids=lambda words: words[0]
)
def test_a_dash_is_stdout_and_a_name_of_a_folder_no_file(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    Path("in.toml").write_text(SUN)
    assert here(Run([*words, "-o", "-"])).out == here(Run(words)).out != b""
    end = here(Run([*words, "-o", "new/"]))
    assert (end.code, b"new/ is the name of a folder; add that of a file" in end.err) == (2, True)
    assert os.listdir() == ["in.toml"]


def test_an_image_does_not_go_to_stdout(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("in.toml").write_text(SUN)
    end = here(Run(["oracle", "in.toml", "-o", "-"]))
    assert (end.code, b"an image does not go to stdout" in end.err) == (2, True)
    assert os.listdir() == ["in.toml"]


def test_any_name_that_a_system_of_files_takes_can_be_written(tmp_path):
    for length in (4, 100, 201, 255):
        path = write_file(tmp_path / ("n" * length), "told")
        assert path.read_text() == "told"
    assert len(os.listdir(tmp_path)) == 4
    with pytest.raises(InvalidInputError, match=f"{'n' * 4}/x: .*{'n' * 4} is a file, no folder"):
        write_file(tmp_path / "nnnn" / "x", "")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(InvalidInputError, match="link is a link that leads nowhere"):
        write_file(tmp_path / "link" / "x", "")


@POSIX
def test_a_named_output_may_be_a_link_or_a_pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    got = []
    reader = threading.Thread(target=lambda: got.append((tmp_path / "pipe").read_bytes()))
    reader.start()
    write_output(tmp_path / "pipe", "told")
    reader.join()
    assert (got, (tmp_path / "pipe").is_fifo()) == ([b"told"], True)
    (tmp_path / "link").symlink_to("file")
    write_output(tmp_path / "link", "told")
    assert ((tmp_path / "file").read_text(), (tmp_path / "link").is_symlink()) == ("told", True)


@POSIX
@pytest.mark.parametrize("name", ["a.npy", "a.pfm", "a.exr", "a.json"])
def test_a_full_disk_leaves_what_was_there(tmp_path, monkeypatch, name):
    import resource

    if name == "a.exr":
        pytest.importorskip("OpenEXR", reason="python -m pip install 'fogproof[images]'")
    path = tmp_path / name
    path.write_bytes(b"before")
    pixels = {"Y": np.random.default_rng(1).random((64, 64))}
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # it would be cut short, and kept
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (512, before[1]))
    try:
        if name == "a.json":
            assert here(Run(["golden", "phase_pdf", "-o", str(path)])).code == 2
        else:
            with pytest.raises(InvalidInputError, match="cannot write"):
                format_of(path).write(path, pixels)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == {name: b"before"}


@POSIX
@pytest.mark.parametrize(("redirection", "code"), [(">&-", 141), ("> /dev/full", 2), ("2> /dev/full", 0)])
def test_a_report_is_whole_whoever_reads_the_rows(tmp_path, redirection, code):
    words = f"verify fog/analog/haze fog/analog/glowing --report {shlex.quote(str(tmp_path))} {redirection}"
    done = subprocess.run(f"{FOGPROOF} {words}", shell=True, capture_output=True, text=True)
    assert done.returncode == code
    assert "Traceback" not in done.stderr
    assert ("cannot write to stdout: No space left on device" in done.stderr) == (redirection == "> /dev/full")
    record = json.loads((tmp_path / "results.json").read_text())
    assert (record["state"], len(record["cases"])) == ("finished", len(record["asked"]))
    assert (tmp_path / "index.html").exists()


class Endless(io.RawIOBase):
    """Zeros without end; the bytes that were taken are counted."""

    def __init__(self, text=b"\0"):
        self.taken, self.text = 0, text

    def readable(self):
        return True

    def readinto(self, buffer):
        if self.taken > 1 << 22:
            raise OSError(errno.EIO, "nobody should have read so much")
        self.taken += len(buffer)
        buffer[:] = (self.text * len(buffer))[: len(buffer)]
        return len(buffer)


def test_a_line_without_end_is_answered_when_it_is_too_long():
    out, stdin = io.BytesIO(), Endless()
    with pytest.raises(OSError, match="nobody"):
        serve(stdin.read, out, limits=Limits(bytes=1000))
    (answer,) = out.getvalue().splitlines()
    assert json.loads(answer)["error"]["code"] == "too-large"
    text = io.BytesIO(b"x" * 600_000 + b"\n" + QUESTION.encode() + b"\n" + b"y" * 600_000)
    out = io.BytesIO()
    assert not serve(text.read, out, limits=Limits(bytes=1000))
    first, second, third = map(json.loads, out.getvalue().splitlines())
    assert (first["error"]["code"], third["error"]["code"]) == ("too-large", "too-large")
    assert second["value"] > 0


def test_golden_waits_for_nothing_after_a_bad_line(monkeypatch):
    import fogproof.cli.golden_command as module

    monkeypatch.setattr(module, "requests_on_stdin", lambda: io.BufferedReader(Endless(b"y\n")))
    end = here(Run(["golden", "--requests", "-"]))
    assert (end.code, b"-, line 1: request is not valid JSON" in end.err) == (2, True)


def test_a_line_that_was_cut_short_is_the_only_one_lost(tmp_path):
    path = tmp_path / "lines.jsonl"
    long = {"text": "a" * 200_000}
    add_line(path, {"first": 1})
    add_line(path, long)
    path.write_bytes(path.read_bytes() + b'{"cut": "' + b"b" * 100_000)
    assert [json.loads(line) for line in whole_lines(path.read_text())] == [{"first": 1}, long]
    add_line(path, {"last": 2})
    assert [json.loads(line) for line in path.read_text().splitlines()] == [{"first": 1}, long, {"last": 2}]
    for before, after in (('{"cut', []), ('{"a": 1}', ['{"a": 1}']), ("my notes", ["my notes"])):
        path.write_text(before)
        assert whole_lines(before) == after
        add_line(path, {})
        assert path.read_text().splitlines() == [*after, "{}"]


def test_runs_go_on_after_a_line_that_was_cut_short(tmp_path):
    log = ZooLog(tmp_path / "zoo.jsonl", {"samples": 1000})
    log.path.write_text('{"sam')
    assert log.read() == ([], 0)
    log.path.write_text(log.path.read_text() + '{"name": "a", "ti')
    assert log.read() == ([], 0)
    told = json.dumps({"schema": SCHEMA, "started": "", "ways": []})
    (tmp_path / "bench.jsonl").write_text(f"{told}\n{told[:20]}")
    records, damaged = history(tmp_path)
    assert (len(records), damaged) == (1, 0)


@POSIX
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_while_fogproof_is_loaded_is_a_word_and_a_code(tmp_path, name):
    (tmp_path / "fogproof").mkdir()
    (tmp_path / "fogproof" / "__init__.py").write_text("import time\nprint('loading', flush=True)\ntime.sleep(60)\n")
    search = os.pathsep.join([str(tmp_path), str(ROOT / "src")])
    command = [sys.executable, "-c", "from fogproof_command import main; main()"]
    pipe = subprocess.PIPE
    number = getattr(signal, name)

    def hearing():  # even where this test was started by nohup or in the background
        signal.signal(number, signal.default_int_handler if name == "SIGINT" else signal.SIG_DFL)

    environment = {**os.environ, "PYTHONPATH": search}
    child = subprocess.Popen(command, stdout=pipe, stderr=pipe, env=environment, preexec_fn=hearing)
    assert child.stdout.readline() == b"loading\n"
    child.send_signal(number)
    _, said = child.communicate(timeout=30)
    assert (child.returncode, said) == (128 + number, b"fogproof: stopped\n")


def test_no_more_threads_is_a_sentence(monkeypatch):
    def refused(*_):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refused)
    end = here(Run(["verify", "fog/analog/haze"]))
    assert (end.code, b"the system allows no more threads" in end.err) == (2, True)
