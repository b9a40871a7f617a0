"""Why a start failed, in a sentence: too little memory to load libraries, or a file that bears the name of a module.

The standard library alone: this is asked while nothing else can be relied on.
"""

from __future__ import annotations

import os
import sys

BAD_INPUT = 2
FAULT = 70
_NO_ROOM = ("failed to map segment", "cannot allocate memory", "cannot apply additional memory protection")


class StandInError(SystemExit):
    """A module in another's place asked for the end of the process: no `except Exception` on the way takes it for a subject's."""


def end_of(error: BaseException) -> tuple[str, int]:
    """Return the sentence and the exit code for an error while modules are loaded; the code is `FAULT` if it is our own."""
    if isinstance(error, StandInError):
        return str(error), BAD_INPUT
    behind = _behind(error)
    if any(isinstance(one, MemoryError) or any(words in str(one).lower() for words in _NO_ROOM) for one in behind):
        return "there is not enough memory to load what this needs; allow more (ulimit -v)", BAD_INPUT
    stands = stand_in(error)
    if stands:
        return stands, BAD_INPUT
    if isinstance(error, SystemExit):
        last = (_passed(error) or ["what is loaded"])[0]
        return f"{last} ends the process (exit code {error.code or 0}), before a result was there; mend it", BAD_INPUT
    return f"{type(error).__name__}: {error}", FAULT


def stand_in(error: BaseException) -> str:
    """Return the sentence for an error by a file that stands in a module's place, "" for any other."""
    for one in _behind(error):
        for filename in (*_passed(one), _asked(one)):
            name = shadowed(filename)
            if name:
                told = filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))
                listed = any(os.path.abspath(filename).startswith(os.path.abspath(path) + os.sep) for path in told)
                fix = "rename it, or take its folder out of PYTHONPATH" if listed else "rename it"
                return f"{filename} stands in the place of the module {name}; {fix}"
    return ""


def shadowed(filename: str) -> str:
    """Return the name of the installed or standard module in whose place a file is found, "" if it is in nobody's."""
    if not filename:
        return ""
    folder, file = os.path.split(os.path.abspath(filename))
    if os.path.basename(filename) == "__init__.py":
        folder, file = os.path.split(folder)
    name = file.removesuffix(".py")
    homes = _homes()
    if any(folder == home or folder.startswith(home + os.sep) for home in homes):
        return ""
    if name in sys.stdlib_module_names:
        return name
    found = (os.path.join(home, name) for home in homes)
    return name if any(os.path.isfile(f"{path}.py") or os.path.isfile(f"{path}/__init__.py") for path in found) else ""


def _homes() -> set[str]:
    """Return the folders of what is installed, and of Python's own modules."""
    own = os.path.dirname(os.path.abspath(os.__file__))
    try:
        import sysconfig

        paths = [*sysconfig.get_paths().values()]
    except (AttributeError, ImportError):  # itself in somebody's place
        paths = [path for path in sys.path if os.path.basename(path) in ("site-packages", "dist-packages")]
    return {own, *map(os.path.abspath, paths)}


def _passed(error: BaseException) -> list[str]:
    """Return the files an error came through, the innermost first. Without `traceback`, which may be what is missing."""
    files: list[str] = []
    at = error.__traceback__
    while at is not None:
        files.insert(0, at.tb_frame.f_code.co_filename)
        at = at.tb_next
    return files


def _asked(error: BaseException) -> str:
    """Return the file of the module that lacks what it was asked for, "" if an error is about something else."""
    if isinstance(error, AttributeError):
        module = error.obj
    elif isinstance(error, ImportError) and error.name:
        module = sys.modules.get(error.name.partition(".")[0])
    else:
        module = None
    return str(getattr(module, "__file__", None) or "") if isinstance(module, type(sys)) else ""


def _behind(error: BaseException) -> list[BaseException]:
    """Return an error and all that caused it."""
    found: list[BaseException] = []
    ahead: list[BaseException | None] = [error]
    while ahead:
        one = ahead.pop()
        if one is not None and one not in found:
            found.append(one)
            ahead += [one.__context__, one.__cause__]
    return found
