"""A program at the other end of two pipes: started, fed and read without deadlock, and always ended with its children.

Whatever it does, nobody waits longer than the time limits say, and no more memory is taken than was asked for. What it writes to
stderr is kept, its beginning and its end. Processes that it started are ended with it, those that left its process group included:
they are known by a word in their environment (on Linux).
"""

from __future__ import annotations

import contextlib
import os
import select
import subprocess
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

from fogproof.children import start
from fogproof.errors import UnsupportedError
from fogproof.pipe.command import cannot_start, words_of
from fogproof.pipe.faults import BROKEN, BUFFERS, HANGS, SHORT, ProgramError, end_of, quoted
from fogproof.text import one_line
from fogproof.validate import time_limit

_KEPT = 2000  # bytes of stderr, at its beginning and at its end
_CHUNK = 1 << 16
_PIPE = 1 << 20  # bytes that a pipe may hold, where the system lets us choose
_SETPIPE = 1031  # Linux: F_SETPIPE_SZ
_LINE = 1 << 16  # longest line


@dataclass(frozen=True)
class Timeouts:
    """Seconds until the first line, until an answer, and from the end of input to the program's own end."""

    start: float = 10.0
    answer: float = 30.0
    end: float = 2.0

    def __post_init__(self) -> None:
        for field in fields(self):
            time_limit(f"{field.name} timeout", getattr(self, field.name))


class Process:
    """A running program. `send` queues bytes, `line` and `fill` read; all three move stdin, stdout and stderr at once."""

    def __init__(self, command: str | Sequence[str], timeouts: Timeouts) -> None:
        if os.name != "posix":
            raise UnsupportedError("programs over pipes need a POSIX system; write a file of samples instead", "--exec")
        self.words = words_of(command)
        self.timeouts = timeouts
        self.answers = 0
        self._asked = self._heard = 0.0  # when input went out and output came last
        try:
            self._child = start(
                self.words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0
            )
        except (OSError, ValueError) as error:
            raise cannot_start(self.words[0], error) from None
        self._popen = self._child.popen
        streams = self._popen.stdin, self._popen.stdout, self._popen.stderr
        self._in, self._out, self._err = (stream.fileno() for stream in streams if stream is not None)
        self._open = {self._in, self._out, self._err}
        for pipe in self._open:
            os.set_blocking(pipe, False)
            _widen(pipe)
        self._pending: deque[memoryview] = deque()
        self._ahead = b""
        self._said, self._last, self._said_bytes = b"", b"", 0
        self.note = self.failure = ""
        self._late = self.extra = 0  # bytes that came after the end of the input, and all that nobody asked for
        self.rest = b""  # the first of those
        self._ended_itself = False

    def send(self, data: bytes | memoryview) -> None:
        """Queue bytes for stdin; they are written while an answer is awaited."""
        if len(data):
            self._pending.append(memoryview(data))
            self._asked = time.monotonic()

    def line(self, seconds: float, awaited: str) -> bytes:
        """Return the next line without its end."""
        deadline = time.monotonic() + seconds
        while b"\n" not in self._ahead:
            if len(self._ahead) > _LINE:
                raise self.broken(f"wrote {quoted(self._ahead)} and no end of line where {awaited} was due")
            so_far = f" ({quoted(self._ahead)} and no end of line came)" if self._ahead else ""
            self._ahead += self._some(deadline, seconds, f"{awaited}{so_far}", _LINE)
        line, _, self._ahead = self._ahead.partition(b"\n")
        if len(line) > _LINE:
            raise self.broken(f"wrote {quoted(line)}, a line of {len(line)} bytes, where {awaited} was due")
        return line.removesuffix(b"\r")

    def lines(self, count: int, seconds: float, awaited: str) -> list[bytes]:
        """Return the next lines without their ends, all within the time limit."""
        deadline, parts, found, size = time.monotonic() + seconds, [self._ahead], self._ahead.count(b"\n"), 0
        while found < count:
            parts.append(self._some(deadline, seconds, f"{awaited} ({found} of {count} lines came)", _CHUNK))
            found, size = found + parts[-1].count(b"\n"), size + len(parts[-1])
            if size > _LINE * (found + 1):
                raise self.broken(f"wrote {quoted(parts[1])} and no end of line where {awaited} was due")
        *lines, self._ahead = b"".join(parts).split(b"\n", count)
        return lines

    def fill(self, view: memoryview, seconds: float, told: Callable[[int], str]) -> None:
        """Read exactly the bytes that the view holds; `told` says what is awaited, given how many have come."""
        deadline = time.monotonic() + seconds
        at = min(len(self._ahead), len(view))
        view[:at], self._ahead = self._ahead[:at], self._ahead[at:]
        while at < len(view):
            if self._pending:
                self._turn(deadline, seconds, told(at))
            try:
                came = os.readv(self._out, [view[at:]])
            except BlockingIOError:
                self._turn(deadline, seconds, told(at))
                continue
            if not came:
                raise self._ended(told(at))
            at += came
            self._heard = time.monotonic()

    def unasked(self) -> bytes:
        """Return some of what the program has written though nothing was asked, without waiting."""
        if not self._ahead:
            with contextlib.suppress(BlockingIOError, OSError):
                self._ahead = os.read(self._out, 4096)
        return self._ahead

    def broken(self, what: str, cause: str = BROKEN) -> ProgramError:
        """Return the error for what a program did ("the program ..."), with what stands on stderr."""
        self._listen()
        if self._popen.poll() is not None and cause != "dies":
            what = f"{what}, and {end_of(self._popen.returncode)}"
        said = f"; on stderr: {self.said[:1000]}" if self.said else "; it wrote nothing to stderr"
        after = f" (after {self.answers} answers)" if self.answers else ""
        return ProgramError(f"the program {what}{after}{said}", cause)

    @property
    def said(self) -> str:
        """What the program wrote to stderr: the beginning and the end of it, on one line."""
        middle = self._said_bytes - len(self._said) - len(self._last)
        gap = f" [... {middle} bytes ...] ".encode() if middle > 0 else b""
        return one_line((self._said + gap + self._last).decode("utf-8", "replace"))

    def stop(self) -> None:
        """End the input, wait a moment for the program to end by itself, and end it and its children whatever it does.

        `note` says afterwards what it did that was not asked of it, `failure` how it ended otherwise than well by itself.
        """
        if not self._open:
            return
        before = self._popen.poll()
        with contextlib.suppress(OSError):
            self._close(self._in)
        deadline = time.monotonic() + self.timeouts.end
        try:
            while self._popen.poll() is None and time.monotonic() < deadline:
                for pipe in self._ready(0.02):
                    if pipe == self._err:
                        self._listen()
                    elif pipe == self._out:
                        self._unread(self._read(_CHUNK))
        finally:
            code = self._popen.poll()
            self._child.kill()
        while self._out in self._open and (rest := self._read(_CHUNK)):
            self._unread(rest)
        self.extra, self._ended_itself = len(self._ahead) + self._late, code is not None
        self.rest = self._ahead + self.rest
        self._listen()
        for pipe in list(self._open):
            self._close(pipe)
        if self.extra:
            self.note = f"it wrote {self.extra} bytes more than it was asked for"
        elif code is None:
            self.note = f"it did not end within {self.timeouts.end:g} s of the end of its input, and was killed"
        if code:
            after = "after the end of its input" if before is None else "before its input did"
            self.failure = f"the program {end_of(code)} {after}, {self.answers} whole answers notwithstanding"
            self.failure += f"; on stderr: {self.said[:1000]}" if self.said else "; it wrote nothing to stderr"

    def _unread(self, data: bytes) -> None:
        self._late += len(data)
        self.rest += data[: max(_KEPT - len(self.rest), 0)]

    def _some(self, deadline: float, seconds: float, awaited: str, most: int) -> bytes:
        while True:
            self._turn(deadline, seconds, awaited)
            with contextlib.suppress(BlockingIOError):
                data = os.read(self._out, most)
                if not data:
                    raise self._ended(awaited)
                self._heard = time.monotonic()
                return data

    def _turn(self, deadline: float, seconds: float, awaited: str) -> None:
        """Write what is pending and keep what is said until stdout can be read."""
        while True:
            left = deadline - time.monotonic()
            if left <= 0:
                left_over = sum(map(len, self._pending))
                unread = f"; it left {left_over} bytes of its input unread" if left_over else ""
                raise self._silent(f"gave no answer within {seconds:g} s where {awaited} was due{unread}", seconds)
            ready = self._ready(left)
            if self._err in ready:
                self._listen()
            if self._in in ready:
                self._write()
            if self._out in ready or self._out not in self._open:
                return

    def _silent(self, what: str, seconds: float) -> ProgramError:
        """Return what to say of a program that gave no answer in time; the end of its input tells whether it waits for us.

        One that was still writing is slow, and what it writes then says nothing.
        """
        slow = time.monotonic() - self._heard < 0.5 * seconds
        error, runs = self.broken(what, HANGS), self._popen.poll() is None
        if slow or not runs:
            return error
        self.stop()
        if self._late:
            self.note = ""
            hint = "let it flush its output after every answer, and read its input as it comes (mawk -W interactive)"
            more = f"it wrote {self._late} bytes more once its input had ended, so they had stood in a buffer: {hint}"
            return ProgramError(f"{error}; {more}", BUFFERS)
        if self._ended_itself and self._heard > self._asked:
            return ProgramError(f"{error}; it ended with its input: it took its answer for complete", SHORT)
        return error

    def _ready(self, seconds: float) -> set[int]:
        poll = select.poll()
        for pipe in self._open - {self._in}:
            poll.register(pipe, select.POLLIN)
        if self._pending and self._in in self._open:
            poll.register(self._in, select.POLLOUT)
        return {pipe for pipe, _ in poll.poll(max(seconds, 0) * 1000)}

    def _write(self) -> None:
        block = self._pending.popleft()
        try:
            written = os.write(self._in, block[:_PIPE])
            if written < len(block):
                self._pending.appendleft(block[written:])
        except BlockingIOError:
            self._pending.appendleft(block)
        except OSError:  # it reads no more: what it says or does next will tell
            self._close(self._in)

    def _listen(self) -> None:
        while self._err in self._open:
            try:
                data = os.read(self._err, _CHUNK)
            except BlockingIOError:
                return
            if not data:
                self._close(self._err)
            self._said_bytes += len(data)
            room = _KEPT - len(self._said)
            self._said += data[:room]
            self._last = (self._last + data[room:])[-_KEPT:]
            if len(data) == _CHUNK:
                return  # others wait too

    def _read(self, most: int) -> bytes:
        try:
            data = os.read(self._out, most)
        except BlockingIOError:
            return b""
        if not data:
            self._close(self._out)
        return data

    def _close(self, pipe: int) -> None:
        if pipe in self._open:
            self._open.discard(pipe)
            for stream in (self._popen.stdin, self._popen.stdout, self._popen.stderr):
                if stream is not None and not stream.closed and stream.fileno() == pipe:
                    with contextlib.suppress(OSError):
                        stream.close()

    def _ended(self, awaited: str) -> ProgramError:
        """Return what to say of a program whose output has ended."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._popen.wait(self.timeouts.end)
        self._listen()
        code = self._popen.poll()
        what = "closed its output and runs on" if code is None else end_of(code)
        return self.broken(f"{what} where {awaited} was due", "dies")


def _widen(pipe: int) -> None:
    with contextlib.suppress(ImportError, OSError):
        import fcntl

        fcntl.fcntl(pipe, _SETPIPE, _PIPE)
