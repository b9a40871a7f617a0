"""Other people's programs: started with a word in their environment, and ended with all that they started.

A program gets a session of its own. `Child.kill` ends its process group and, on Linux, every process that carries the word, those
that left the group included. Whatever ends this process, SIGKILL included, ends the programs as well: a watcher, a small process
that outlives us, reads a pipe of ours and kills what is left when the pipe closes. This file is the watcher's program too, so it
imports the standard library alone.
"""

from __future__ import annotations

import atexit
import contextlib
import errno
import os
import secrets
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

WORDS = "FOGPROOF_CHILD"  # the words of all who started a program, from the outermost to the program's own
_LOOKS = 8  # looks for processes that were started while others were killed
_LAST = 5.0  # seconds for the watcher to end after us, and for what a program wrote to be read after it
_KEPT = 1 << 16  # bytes of the end of stderr


@dataclass(frozen=True)
class Child:
    """A running program, and the word that it and its children carry."""

    popen: subprocess.Popen[Any]
    word: str

    def kill(self) -> None:
        """Kill it and all that it started; what it wrote can still be read."""
        if os.name == "posix":
            end_all({self.popen.pid}, [self.word])
        self.popen.kill()
        self.popen.wait()
        if os.name == "posix":
            end_all((), [self.word])
        _tell(f"ended {self.popen.pid}")


def start(command: Sequence[str], environment: Mapping[str, str] | None = None, **pipes: Any) -> Child:
    """Start a program; OSError or ValueError where there is none. `pipes` are those of `subprocess.Popen`.

    Where this process ignores SIGCHLD nothing is started: without exit codes Python takes every end for a good one.
    """
    if os.name == "posix" and signal.getsignal(signal.SIGCHLD) is signal.SIG_IGN:
        fix = "signal.signal(signal.SIGCHLD, signal.SIG_DFL) hears it"
        raise ChildProcessError(errno.ECHILD, f"this process ignores SIGCHLD, and would not hear how it ends; {fix}")
    word = secrets.token_hex(16)
    told = {**(os.environ if environment is None else environment)}
    told[WORDS] = f"{words_of(told)} {word}"
    child = Child(subprocess.Popen(command, start_new_session=True, env=told, **pipes), word)
    _tell(f"started {child.popen.pid}")
    return child


def words_of(environment: Mapping[str, str]) -> str:
    """Return the words that what is started with an environment has to carry, so that it ends when we do."""
    return " ".join(filter(None, (environment.get(WORDS, ""), _watched())))


def remove_after(folder: str) -> None:
    """Have a folder removed when this process has ended, however it does."""
    _watched()
    _tell(f"remove {os.fsencode(folder).hex()}")


def run(words: Sequence[str], seconds: float | None = None) -> subprocess.CompletedProcess[str]:
    """Run a program to its end, at most so many seconds (subprocess.TimeoutExpired); nothing that it started stays behind.

    Of what it writes to stderr the end is kept, of the rest nothing: it may be more than there is memory.
    """
    child = start(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, bufsize=0)
    last: list[bytes] = [b""]
    reader = threading.Thread(target=_keep_end, args=(child.popen.stderr, last), daemon=True)
    reader.start()
    try:
        code = child.popen.wait(seconds)
    finally:
        child.kill()
        reader.join(_LAST)
    return subprocess.CompletedProcess(list(words), code, "", last[0].decode("utf-8", "replace"))


def _keep_end(stream: IO[bytes], last: list[bytes]) -> None:
    with stream:
        while data := stream.read(_KEPT):
            last[0] = (last[0] + data)[-_KEPT:]


def end_all(groups: Iterable[int], words: Iterable[str]) -> None:
    """Kill process groups, and all processes that carry one of the words."""
    for group in groups:
        with contextlib.suppress(OSError):
            os.killpg(group, signal.SIGKILL)
    words = list(words)
    for _ in range(_LOOKS):
        found = carrying(words)
        if not found:
            return
        for pid in found:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)


def carrying(words: Iterable[str]) -> list[int]:
    """Return the processes whose environment holds one of the words; none where the system does not show them."""
    wanted, found = [word.encode() for word in words], []
    for entry in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            held = entry.read_bytes()
            if any(word in held for word in wanted):
                found.append(int(entry.parent.name))
    return found


@dataclass(frozen=True)
class _Watcher:
    owner: int
    word: str
    pipe: IO[bytes]
    popen: subprocess.Popen[bytes]

    def end(self) -> None:
        """Let it look for the last time, and wait until it has."""
        if self.owner == os.getpid():
            self.pipe.close()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.popen.wait(_LAST)


_watcher: _Watcher | None = None


def _watched() -> str:
    """Return the word of this process, whose end the watcher awaits; "" where there can be none."""
    global _watcher
    if os.name != "posix" or not sys.executable:
        return ""
    if _watcher is None or _watcher.owner != os.getpid() or _watcher.popen.poll() is not None:
        word = secrets.token_hex(16)
        popen = subprocess.Popen(
            [sys.executable, "-I", "-S", __file__, word],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            start_new_session=True,
            cwd="/",
        )
        assert popen.stdin is not None
        _watcher = _Watcher(os.getpid(), word, popen.stdin, popen)
        atexit.register(_watcher.end)
    return _watcher.word


def _tell(line: str) -> None:
    if _watcher is not None and _watcher.owner == os.getpid():
        with contextlib.suppress(OSError, ValueError):
            _watcher.pipe.write(f"{line}\n".encode())


def _watch(word: str) -> None:
    """Wait until nobody holds the other end of stdin, and kill what has not ended."""
    groups: set[int] = set()
    folders: list[str] = []
    for line in sys.stdin:
        what, _, which = line.strip().partition(" ")
        if what == "remove":
            folders.append(os.fsdecode(bytes.fromhex(which)))
        else:
            (groups.add if what == "started" else groups.discard)(int(which))
    end_all(groups, [word])
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    _watch(sys.argv[1])
