"""A process between us and the one in which other people's code runs: it passes on what that one says, and tells how it ends.

The server of processes would be the parent of all that it forks: killed by a subject, it could start nothing more, and nobody
would know whose fault that was. A process that calls `stand_between` goes on in a child, whose parent it is from then on. The
child holds nothing that leads to us, but a pipe to its parent, in which an answer has a frame that nobody writes by chance: a word
that only the two know, its length and its digest. Of a parent that the subject has killed nothing more comes.
"""

from __future__ import annotations

import contextlib
import hashlib
import multiprocessing
import multiprocessing.connection
import os
import secrets
import signal
import struct
import threading
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NoReturn

SAID, ENDED, WROTE = "said", "ended", "wrote"
"""What is told of a subject: (SAID, bytes), as often as it says something; at last (ENDED, exit code), or (WROTE, None)."""
CLOSED = 74
"""The exit code of a process that cannot say its answer: EX_IOERR of sysexits.h."""
_HEAD = struct.Struct("16sQ16s")
"""Of an answer: the word, the length in bytes, the digest. Shorter than PIPE_BUF, so that it is written as a whole."""
_LOOK = 0.05
"""Seconds between looks for the end of a child whose pipe is still open: its own children may hold it."""


class _ForeignError(Exception):
    """Bytes that are no answer."""


def stand_between(to: Any) -> Callable[[bytes], None]:
    """Lead a session, go on in a child of this process, and return how that says an answer.

    Called before there are threads. Where nothing can be forked, nobody stands between.

    to  a `multiprocessing.connection.Connection`, to write what is told
    """
    alone: Callable[[bytes], None] = partial(_send, to)
    if not hasattr(os, "fork"):
        return alone
    with contextlib.suppress(OSError):  # signals to our parent's group are not for us, nor the subject's for that group
        os.setsid()
    word = secrets.token_bytes(16)
    try:
        said, says = os.pipe()
        life, lives = os.pipe()  # its writing end is the parent's alone: it closes when that ends
        child = os.fork()
    except OSError:
        return alone
    if child:
        os.close(says)
        os.close(life)
        _pass_on(child, said, word, to)
    os.close(said)
    os.close(lives)
    to.close()
    with contextlib.suppress(RuntimeError):  # where no more threads may be started nothing watches
        threading.Thread(target=_end_with, args=(life,), daemon=True).start()
    return partial(_say, says, _identity(says), word)


def _send(to: Any, answer: bytes) -> None:
    try:
        to.send((SAID, answer))
    except OSError:  # who started us is gone, or a subject has closed this
        os._exit(CLOSED)


def _say(says: int, pipe: tuple[int, int], word: bytes, answer: bytes) -> None:
    try:
        if _identity(says) != pipe:  # a subject has closed it, and opened something else
            os._exit(CLOSED)
        os.write(says, _HEAD.pack(word, len(answer), _digest(answer)))
        rest = memoryview(answer)
        while rest:
            rest = rest[os.write(says, rest) :]
    except OSError:
        os._exit(CLOSED)


def _identity(descriptor: int) -> tuple[int, int]:
    found = os.fstat(descriptor)
    return found.st_dev, found.st_ino


def _digest(answer: bytes) -> bytes:
    return hashlib.blake2b(answer, digest_size=16).digest()


def _end_with(life: int) -> None:
    with contextlib.suppress(OSError):  # a subject may have closed it
        os.read(life, 1)
        os._exit(1)


def _pass_on(child: int, said: int, word: bytes, to: Any) -> NoReturn:
    """Tell what a child says until it has ended, and then how; end it where nobody listens any more."""
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        parent = multiprocessing.parent_process()
        assert parent is not None
        held, watched, code = bytearray(), [said, parent.sentinel], None
        while True:
            code = _exit_code(child) if code is None else code
            ready = multiprocessing.connection.wait(watched, _LOOK if code is None else 0.0)
            if not ready and code is None:
                os.kill(child, signal.SIGCONT)  # a subject that stops itself would be waited for without end
            if parent.sentinel in ready:
                break
            if said not in ready:
                if code is not None:
                    to.send((ENDED, code))
                    break
            elif data := os.read(said, 1 << 16):
                held += data
                for answer in _answers(held, word):
                    to.send((SAID, answer))
            else:
                watched.remove(said)
    except _ForeignError:
        with contextlib.suppress(OSError):
            to.send((WROTE, None))
    finally:
        with contextlib.suppress(OSError):
            os.kill(child, signal.SIGKILL)
        os._exit(0)


def _exit_code(child: int) -> int | None:
    """Return the exit code of a child, the negative of a signal that ended it, None while it lives."""
    try:
        found, status = os.waitpid(child, os.WNOHANG)
    except ChildProcessError:  # exit codes of children are not kept
        return 1
    return os.waitstatus_to_exitcode(status) if found else None


def _answers(held: bytearray, word: bytes) -> Iterator[bytes]:
    """Yield the answers that are whole, and drop them from what is held."""
    while held:
        if held[: len(word)] != word[: len(held)]:
            raise _ForeignError
        if len(held) < _HEAD.size:
            return
        _, length, digest = _HEAD.unpack_from(held)
        if len(held) < _HEAD.size + length:
            return
        answer = bytes(held[_HEAD.size : _HEAD.size + length])
        if _digest(answer) != digest:
            raise _ForeignError
        del held[: _HEAD.size + length]
        yield answer
