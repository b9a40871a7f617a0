"""Samples that are already there, as `check_sampler`'s machinery takes them: every row of the file is counted once at most.

The first quarter (16384 rows at most) is the pilot, which sets scales and is not counted. The rest is what is tested, in the order
of the file.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.checks import Verdict
from fogproof.checks.diagnosis.causes import likely_cause
from fogproof.checks.pilot import PILOT
from fogproof.checks.promises import Watch
from fogproof.checks.sampler_parts import SamplerCheck
from fogproof.checks.subject import Subject
from fogproof.checks.verdict import Finding
from fogproof.contracts import Draw
from fogproof.errors import InvalidInputError, SubjectError

LEAST = 200
"""Rows that a file must have."""


class Recorded:
    """A sampler without a program: it hands out the rows of a `Draw`."""

    def __init__(self, draw: Draw) -> None:
        self._draw = draw
        n = len(draw.x)
        if n < LEAST:
            raise InvalidInputError(f"there are {n} samples; at least {LEAST} are needed", "file")
        self.pilot = min(PILOT, n // 4)
        self._at: int | None = None

    @property
    def tested(self) -> int:
        """How many rows are there to be tested."""
        return len(self._draw.x) - self.pilot

    def broken(self, subject: Subject) -> dict[str, Finding]:
        """Return what the pilot breaks of what every single sample promises: it is not counted, but it is looked at."""
        watch = Watch(subject)
        watch.look(Draw(*(None if part is None else part[: self.pilot] for part in self._draw)))  # type: ignore[arg-type]
        return {f.check: f for f in watch.findings() if f.outcome == "rejected"}

    def begin(self) -> None:
        """From now on every row is handed out once."""
        self._at = self.pilot

    def sample(self, rng: np.random.Generator, n: int) -> Draw:
        """Return the next n rows; before `begin` those of the pilot, and to explain a verdict some of those judged."""
        explaining = self._at == len(self._draw.x)
        if n == self.pilot and (self._at is None or explaining):
            rows = np.arange(n)
        elif self._at is None:
            rows = rng.integers(self.pilot, size=n)
        elif self._at + n <= len(self._draw.x):
            rows = np.arange(self._at, self._at + n)
            self._at += n
        elif n <= self.tested:
            rows = np.arange(self.pilot, self.pilot + n)
        else:
            raise SubjectError(f"there are no {n} samples", "file")  # the same ones twice would look like atoms
        x, *others = (None if part is None else part[rows] for part in self._draw)
        assert x is not None
        return Draw(x, *others)


def check_recorded(
    recorded: Recorded, subject: Subject, samples: int, resolution: float | None, alpha: float, seed: int | None
) -> Verdict:
    """Judge recorded samples; `subject` has `recorded.sample` as its sampler."""
    check = SamplerCheck.of(subject, resolution, min(samples, recorded.tested), alpha, seed)
    check = replace(check, prepared=replace(check.prepared, calls=None))  # there is nobody to call
    recorded.begin()
    verdict = check.run()
    early = recorded.broken(check.prepared.subject)
    kept = tuple(early.get(f.check, f) if f.outcome != "rejected" else f for f in verdict.findings)
    kept = tuple(finding for finding in kept if finding.check != "edge uniforms")
    return replace(verdict, findings=kept, cause=verdict.cause or likely_cause(kept))
