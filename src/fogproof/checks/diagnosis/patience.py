"""A subject that answers for so long and no longer: a slow program is not asked for ever what its error may be."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from fogproof.checks.subject import Subject
from fogproof.errors import FogproofError


class OutOfTimeError(FogproofError):
    """The time for questions is over."""


def limited(subject: Subject, seconds: float) -> Subject:
    """Return the subject; after so many seconds, every question to it raises `OutOfTimeError`."""
    if seconds == math.inf:
        return subject
    end = time.perf_counter() + seconds

    def timed(function: Callable[..., Any]) -> Callable[..., Any]:
        def asked(*arguments: Any) -> Any:
            if time.perf_counter() > end:
                raise OutOfTimeError(f"no answer is wanted after {seconds:.0f} s")
            return function(*arguments)

        return asked

    return replace(subject, sample=timed(subject.sample), pdf=timed(subject.pdf))
