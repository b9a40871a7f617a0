"""The command group; each command is imported when it is called, so that --help stays quick."""

from __future__ import annotations

import contextlib
import errno
import importlib
import io
import os
import sys
import traceback
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from fogproof.cli.signals import code_of, stoppable
from fogproof.cli.streams import leave_stdout, silence, take_streams
from fogproof.cli.terminal import BAD_INPUT, FAULT, UNREAD, code_of_stdout, say
from fogproof.errors import FogproofError, InvalidValueError, stop_behind
from fogproof.text import one_line

_COMMANDS = {
    "verify": "Check every sampler and estimator against its reference.",
    "list": "Show the cases of the catalogue.",
    "check": "Judge somebody else's program over a pipe, or a file of samples.",
    "oracle": "Answer JSON requests with reference values and error bounds.",
    "compare": "Compare another renderer's image with the oracle.",
    "export": "Write a scene for another renderer.",
    "render": "Render scenes with another program, and compare each with the oracle.",
    "relations": "Hold a renderer to what is true of every scene, without an oracle.",
    "golden": "Write reference values with error bounds for offline test suites.",
    "plan": "Say which terms a scene needs, and which methods serve it.",
    "study": "Measure speed against error, resumable, on one core or a cluster.",
    "stability": "Measure formulas against 50-digit truth in regions where floating point fails.",
    "report": "Make the page of a run again, or compare two runs.",
    "zoo": "Run known bugs against the checks, and print which are killed.",
    "bench": "Measure speed against error, as ratios.",
    "gallery": "Draw the theory's pictures: oracle's curves, estimators' samples.",
}


_EPOCH = "SOURCE_DATE_EPOCH"
_LAST = 253402300799  # the end of the year 9999


class _LazyGroup(click.Group):
    """A group whose commands live in modules of the same name."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in _COMMANDS:
            return None
        command: click.Command = importlib.import_module(f"fogproof.cli.{name}_command").command
        return command

    def make_context(self, *arguments: Any, **extra: Any) -> click.Context:
        with _seen_as_unread():  # --help and --version print from here
            return super().make_context(*arguments, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            _require_epoch(os.environ.get(_EPOCH))
            with _seen_as_unread():
                return super().invoke(ctx) or code_of_stdout(ctx)
        except Exception as error:
            stop = stop_behind(error)
            if stop is None:
                raise
            raise stop from None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(_COMMANDS.items()))


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="fogproof")
def cli() -> None:
    """Prove Monte Carlo volume estimators right or wrong."""


def main(arguments: list[str] | None = None) -> Any:
    """Run the command line. Every end is a sentence and a code; 1 means that something was rejected, and nothing else."""
    ours = arguments is None
    take_streams(ours)
    warnings.showwarning = _warn
    with stoppable() as listening:
        try:
            code = _run(arguments)
        except KeyboardInterrupt as stop:  # while the end was told
            code = code_of(stop)
        leave_stdout(ours)
        sys.exit(listening.code or code)  # a signal may have waited until everything was written


def _run(arguments: list[str] | None) -> int:
    code = FAULT
    try:
        code = cli.main(arguments, standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()
    except FogproofError as error:
        code = _say(error, BAD_INPUT)
    except click.ClickException as error:
        words = io.StringIO()
        error.show(words)
        code = _say(words.getvalue().rstrip("\n"), BAD_INPUT, "")
    except (click.Abort, KeyboardInterrupt) as stop:
        code = _say(
            "stopped", code_of(stop.__cause__ or stop.__context__ or stop)
        )  # click makes an Abort of the signal's
    except BrokenPipeError:
        silence(sys.stdout)
        code = UNREAD
    except OSError as error:
        code = _say(_of_the_system(error), BAD_INPUT)
        if error.errno in (errno.ENOSPC, errno.EIO) and error.filename is None:
            silence(sys.stdout)
    except RuntimeError as error:
        if not any(words in str(error) for words in ("can't start new thread", "before it is started")):
            return _fault(error)
        code = _say("the system allows no more threads; end some, or raise its limit (ulimit -u)", BAD_INPUT)
    except MemoryError:
        code = _say("there is not enough memory for this; ask for less at a time", BAD_INPUT)
    except BaseException as error:  # nothing of ours asks for the end: a module that is loaded does
        code = _fault(error)
    return code


def _require_epoch(told: str | None) -> None:
    """Refuse an environment variable that libraries read: they would fail by it in the midst of a case, and it would be blamed."""
    if told is None or (told.isascii() and told.isdigit() and int(told[:20]) <= _LAST):
        return
    rule = f"must be a whole number of seconds since 1970, from 0 to {_LAST}"
    raise InvalidValueError(f"the environment variable {_EPOCH}", rule, told, "unset it, or mend it")


def _of_the_system(error: OSError) -> str:
    if error.errno in (errno.EMFILE, errno.ENFILE):
        return "too many files are open; raise the system's limit (ulimit -n)"
    if error.errno == errno.ENOENT and error.filename is None and _is_nowhere():
        return "the folder one stands in is gone; go to another one (cd), and give the command again"
    if error.errno == errno.EBADF and error.filename is None:
        return "stdin can only be written to, or stdout only be read from; turn the arrows round (< in, > out)"
    return f"{error.strerror or error}{f': {error.filename}' if error.filename else ''}"


def _is_nowhere() -> bool:
    try:
        os.getcwd()
    except FileNotFoundError:
        return True
    return False


def _fault(error: BaseException) -> int:
    if isinstance(error, SystemExit) and os.environ.get("_FOGPROOF_COMPLETE"):
        raise error  # click's, where a shell completes a word
    from fogproof_command.startup import end_of  # an environment made before it was there works all the same

    explained, known = end_of(error)
    if known != FAULT:
        return _say(one_line(explained), known)
    where = traceback.extract_tb(error.__traceback__)[-1]
    what = f"{type(error).__name__}: {error} ({Path(where.filename).name}, line {where.lineno})"
    if os.environ.get("FOGPROOF_DEBUG"):
        traceback.print_exc()
    return _say(f"a fault of fogproof's own, please report it with the command: {what}", FAULT)


def _say(message: object, code: int, who: str = "fogproof: ") -> int:
    with contextlib.suppress(OSError):
        say(f"{who}{message}", err=True)
    return code


def _warn(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: object = None,
    line: str | None = None,
) -> None:
    """Tell a warning that somebody's file raises as a sentence: whatever it holds cannot move the cursor."""
    _say(f"{Path(filename).name}, line {lineno}: {category.__name__}: {one_line(str(message))}", 0)


@contextlib.contextmanager
def _seen_as_unread() -> Iterator[None]:
    """End with our code where nobody reads: click would end with 1, which here means that something was rejected."""
    try:
        yield
    except BrokenPipeError:
        silence(sys.stdout)
        raise click.exceptions.Exit(UNREAD) from None
