"""One question to a program, one array back; a program that died is started again for the next question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import TracebackType

import numpy as np

from fogproof.pipe.blocks import DTYPES, bytes_of, encoded, from_lines
from fogproof.pipe.faults import BROKEN, ProgramError
from fogproof.pipe.process import Process, Timeouts
from fogproof.pipe.protocol import AheadError, BrokenLineError, Greeting, read_greeting, request_line, require_answer


class Program:
    """A program that speaks the protocol; use it in a `with` statement, which ends it.

    command   the command line, as a text that is split like a shell's, or as words; no shell is started
    timeouts  how long it may take

    `notes` and `said` (to stderr) tell afterwards what it did besides, `failure` that it ended otherwise than well, `ahead` that
    an answer was left which nobody had asked for; `shown` are points of its first large answer.
    """

    def __init__(self, command: str | Sequence[str], timeouts: Timeouts | None = None) -> None:
        self._command, self._timeouts = command, timeouts or Timeouts()
        self._process: Process | None = None
        self.notes: list[str] = []
        self.shown: np.ndarray | None = None
        self.said, self.failure, self.ahead, self._waiting, self._before = "", "", "", False, 0
        self.greeting = self._start()

    def __enter__(self) -> Program:
        return self

    def __exit__(self, _kind: type[BaseException] | None, _error: object, _trace: TracebackType | None) -> None:
        self.stop()

    def another(self) -> Program:
        """Start the same program once more, for questions that may spoil it."""
        return Program(self._command, self._timeouts)

    def ask(
        self, request: str, rows: np.ndarray, n: int, columns: int, seed: int, parameters: Mapping[str, float]
    ) -> np.ndarray:
        """Return the answer (n, columns) to a request with n rows of numbers (n, k), in the type of the program."""
        if n == 0:
            return np.empty((0, columns))
        if self._process is None:
            again = self._start()
            if again != self.greeting:
                raise self.refuse(f"greets with {again} after a new start, with {self.greeting} before")
        assert self._process is not None
        try:
            return self._answered(self._process, request, rows, n, columns, seed, parameters)
        except ProgramError:
            self.stop()
            raise
        except BrokenLineError as broken:
            if isinstance(broken, AheadError):
                self.ahead = str(broken)
            raise self.refuse(str(broken), broken.cause) from None
        except BaseException:
            self.stop()
            raise

    def _answered(
        self,
        process: Process,
        request: str,
        rows: np.ndarray,
        n: int,
        columns: int,
        seed: int,
        parameters: Mapping[str, float],
    ) -> np.ndarray:
        extra = process.unasked()
        kind, seconds = self.greeting.type, self._timeouts.answer
        if extra:
            wide = (
                " (are its numbers float64?)"
                if kind == "float32" and len(extra) >= 4 * len(self.greeting.columns)
                else ""
            )
            raise BrokenLineError(f"wrote more than it was asked for: {_shown(extra)}{wide}")
        self._waiting = True
        process.send(request_line(request, n, rows.shape[1], seed, parameters))
        process.send(encoded(rows, kind))
        require_answer(process.line(seconds, f'the answer to "{request}" of {n} rows{_of(rows)}'), n, self._before)
        if kind == "text":
            lines = process.lines(n, seconds, f'{n} rows of {columns} numbers for "{request}"')
            try:
                answer = from_lines(lines, columns)
            except ValueError as error:
                raise BrokenLineError(f'answers "{request}" wrongly: {error}') from None
        else:
            answer = np.empty((n, columns), dtype=DTYPES[kind])
            size = answer.nbytes

            def told(came: int) -> str:
                half = kind == "float64" and came == size // 2
                hint = " (exactly half: are they float32?)" if half else ""
                return f'{n} rows of {columns} {kind} for "{request}", {came} of {size} bytes{hint},'

            process.fill(bytes_of(answer), seconds, told)
        process.answers += 1
        self._waiting, self._before = False, n
        return answer

    def refuse(self, what: str, cause: str = BROKEN) -> ProgramError:
        """End the program and return the error that says what it did; `what` completes "the program ...\"."""
        if self._process is None:
            return ProgramError(f"the program {what}", cause)
        error = self._process.broken(what, cause)
        self.stop()
        return error

    def stop(self) -> None:
        """End the program and its children."""
        if self._process is not None:
            process, self._process = self._process, None
            process.stop()
            self.said, self.failure = process.said, self.failure or process.failure
            if not self._waiting and process.extra and not self.ahead:
                again = process.rest.startswith(b'{"n"')
                more = f"wrote {process.extra} bytes more than it was asked for: {_shown(process.rest)}"
                self.ahead = "answered once more than it was asked" if again else more
            if process.note:
                self.notes.append(process.note)

    def _start(self) -> Greeting:
        self._process, self._waiting, self._before = Process(self._command, self._timeouts), False, 0
        try:
            return read_greeting(self._process.line(self._timeouts.start, "its greeting"))
        except BrokenLineError as broken:
            raise self.refuse(str(broken)) from None
        except BaseException:
            self.stop()
            raise


def _of(rows: np.ndarray) -> str:
    return "" if rows.shape[1] else " without uniforms, as the spec has no dimensions,"


def _shown(data: bytes) -> str:
    if data.startswith(b"{") and b"\n" in data:
        return f"{data.partition(bytes([10]))[0][:80].decode('utf-8', 'replace')!r} and what follows"
    text = data[:60].decode("latin-1")
    return repr(text) if text.isprintable() or text.strip().isprintable() else f"bytes {data[:16].hex(' ')}"
