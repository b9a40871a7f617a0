"""No program of somebody else's outlives the command that started it, however that ends."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fogproof.children import carrying, run
from fogproof.renderers.running import RenderFailure, render_one
from fogproof.renderers.table import renderer_of

pytestmark = pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="needs /proc")

STUBBORN = """
import os, signal, sys, time
for each in (1, 2, 15):
    signal.signal(each, signal.SIG_IGN)
file = os.open(sys.argv[1], os.O_CREAT | os.O_WRONLY | os.O_APPEND)
if os.fork() == 0:
    os.setsid()
    os.close(1)
    os.close(2)
os.write(file, b"%d\\n" % os.getpid())
time.sleep(120)
"""


@pytest.fixture
def stubborn(tmp_path):
    """A program that hears no signal, reads nothing, and has a child in a session of its own; and where it writes both pids."""
    (tmp_path / "stubborn.py").write_text(STUBBORN)
    pids = tmp_path / "pids"
    yield [sys.executable, str(tmp_path / "stubborn.py"), str(pids)], pids
    for pid in numbers(pids):
        if alive(pid):
            os.kill(pid, signal.SIGKILL)


def numbers(file):
    return [int(line) for line in file.read_text().splitlines()] if file.exists() else []


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def wait(what, seconds=60):
    deadline = time.monotonic() + seconds
    while not what() and time.monotonic() < deadline:
        time.sleep(0.02)
    return what()


def gone(file):
    return wait(lambda: not any(map(alive, numbers(file))), 20)


def test_what_a_killed_process_started_is_ended(stubborn):
    words, pids = stubborn
    ours = subprocess.Popen([sys.executable, "-c", f"from fogproof.children import run; run({words!r})"])
    assert wait(lambda: len(numbers(pids)) == 2)
    assert all(map(alive, numbers(pids)))
    ours.kill()
    ours.wait()
    assert gone(pids)


def test_who_is_killed_leaves_no_words():
    """Semaphores that he had are removed, and nobody is told."""
    code = "import os; from fogproof import servers; lock = servers.context(['os']).Lock(); os.kill(os.getpid(), 9)"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=60)  # read until all have ended
    assert (ended.returncode, ended.stdout, ended.stderr) == (-signal.SIGKILL, b"", b"")


def test_what_a_killed_process_started_in_another_is_ended(stubborn):
    words, pids = stubborn
    inner = [sys.executable, "-c", f"from fogproof.children import run; run({words!r})"]
    outer = subprocess.Popen([sys.executable, "-c", f"from fogproof.children import run; run({inner!r})"])
    assert wait(lambda: len(numbers(pids)) == 2)
    outer.kill()
    outer.wait()
    assert gone(pids)


def test_two_interruptions_at_once_leave_no_program(stubborn):
    words, pids = stubborn
    code = f"""
import sys, time
from fogproof.children import run
from fogproof.cli import signals
signals.PATIENCE = 60
with signals.stoppable():
    with signals.interruptible() as stop:
        run({words!r})
    time.sleep(0.5)
    sys.exit(stop.code)
"""

    def hearing():
        signal.signal(signal.SIGINT, signal.default_int_handler)

    ours = subprocess.Popen([sys.executable, "-c", code], preexec_fn=hearing)
    assert wait(lambda: len(numbers(pids)) == 2)
    ours.send_signal(signal.SIGINT)
    time.sleep(0.05)
    if ours.poll() is None:
        ours.send_signal(signal.SIGINT)
    assert ours.wait(60) == 130
    assert gone(pids)


def test_a_renderer_that_takes_too_long_is_ended_with_its_children(stubborn, tmp_path):
    words, pids = stubborn
    renderer = renderer_of(" ".join(words) + " {scene} {out}")
    found = render_one(renderer, tmp_path / "scene.json", tmp_path / "out.exr", {}, 4.0)
    assert isinstance(found, RenderFailure)
    assert "longer than 4 s" in found.reason
    assert len(numbers(pids)) == 2
    assert gone(pids)


def test_words_and_what_was_said_come_back():
    done = run([sys.executable, "-c", "import os, sys; print(os.environ['FOGPROOF_CHILD']); sys.exit('bad')"])
    assert (done.returncode, done.stderr) == (1, "bad\n")
    assert carrying(done.stdout.split()[-1:]) == []
