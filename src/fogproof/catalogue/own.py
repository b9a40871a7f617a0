"""Cases that others bring: a Python file, or an installed package, whose function `cases()` returns them.

    # my_cases.py
    from fogproof.catalogue import EstimatorCase, SamplerCase

    def cases():
        return [SamplerCase(name="lobe", make=MyLobe), EstimatorCase(name="glow", make=MyGlow, reference=0.5)]

A package names such a function, or the module that has one, in its entry-point group `fogproof.cases`. The origin, the path or the
name of the entry point, is what a user types; the stem of the file or that name is put before the names of the cases.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib.metadata
import importlib.util
import os
import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from fogproof.catalogue.cases import Case, EstimatorCase, SamplerCase
from fogproof.errors import InvalidInputError, shorten
from fogproof.foreign import EndedProcessError, import_from, loading
from fogproof.input_files import TEXT

GROUP = "fogproof.cases"
"""The entry-point group."""

_HEAD = 64


def is_file(pattern: str) -> bool:
    """Return whether a user's word names a file of cases: `path.py`, or `path.py::name` for some of them."""
    return pattern.partition("::")[0].endswith(".py")


def packages() -> list[str]:
    """Return the names under which installed packages offer cases."""
    return sorted({point.name for point in importlib.metadata.entry_points(group=GROUP)})


@cache
def own_cases(origin: str) -> tuple[Case, ...]:
    """Return the cases of a file or package, `origin` in each; every fault is one sentence. Read once a process."""
    prefix = Path(origin).stem if is_file(origin) else origin
    seen: dict[str, Case] = {}
    try:
        # What is printed on the way is for people: stdout may be JSON.
        with loading(), contextlib.redirect_stdout(sys.stderr):
            made = (_function_of_file if is_file(origin) else _function_of_package)(origin)()
            for case in made:  # one by one: a generator may never end
                if not isinstance(case, SamplerCase | EstimatorCase):
                    what = (
                        f"cases() must return SamplerCase and EstimatorCase of fogproof.catalogue, got {shorten(case)}"
                    )
                    raise InvalidInputError(f"{origin}: {what}", origin)
                if case.name in seen:
                    raise InvalidInputError(f"{origin}: two cases are called {case.name!r}", origin)
                seen[case.name] = replace(case, name=f"{prefix}/{case.name}", origin=origin)
    except InvalidInputError:
        raise
    except Exception as error:
        raise InvalidInputError(f"{origin}: {_explained(error, origin)}", origin) from None
    if not seen:
        raise InvalidInputError(f"{origin}: cases() returned none", origin)
    return tuple(seen.values())


def _function_of_file(origin: str) -> Callable[[], Any]:
    path = Path(origin).resolve()
    if path.is_dir():
        raise InvalidInputError(f"{origin} is a folder; a file of cases is asked for", origin)
    if not path.is_file():
        raise InvalidInputError(f"there is no file {origin}", origin)
    if path.stat().st_size > TEXT:
        raise InvalidInputError(f"{origin} has {path.stat().st_size} bytes; a file of cases has at most {TEXT}", origin)
    with path.open("rb") as file:
        if b"\0" in file.read(_HEAD):  # what begins so, Python tells of in words of its own
            raise InvalidInputError(f"{origin} is not UTF-8 text; save it as UTF-8", origin)
    import_from(str(path.parent))  # as if the file were run: it may import what lies beside it
    name = f"_cases_{hashlib.blake2b(os.fsencode(path), digest_size=8).hexdigest()}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their own module up
    spec.loader.exec_module(module)
    return _function(module, origin)


def _function_of_package(origin: str) -> Callable[[], Any]:
    (point, *_) = importlib.metadata.entry_points(group=GROUP, name=origin)
    return _function(point.load(), origin)


def _function(found: Any, origin: str) -> Callable[[], Any]:
    function = getattr(found, "cases", None) if not callable(found) else found
    if not callable(function):
        raise InvalidInputError(f"{origin}: has no function cases() that returns a list of cases", origin)
    named: Callable[[], Any] = function
    return named


def _explained(error: BaseException, origin: str) -> str:
    """Return what went wrong in somebody else's file, with the line of it, on one line."""
    if isinstance(error, SyntaxError):
        return f"line {error.lineno}: {error.msg}" if error.lineno else error.msg
    places = [f.lineno for f in traceback.extract_tb(error.__traceback__) if Path(f.filename).name == Path(origin).name]
    line = f"line {places[-1]}: " if places else ""
    if isinstance(error, EndedProcessError):
        return f"{line}{error}"
    return " ".join(f"{line}{type(error).__name__}: {error}".split())
