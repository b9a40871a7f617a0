"""A check of a sampler in parts: what is asked beforehand, batches drawn anywhere, and what their tally says."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from numbers import Integral
from typing import Any

import numpy as np

from fogproof.checks import map_density
from fogproof.checks.declared import declared, unchecked
from fogproof.checks.diagnosis import diagnosed, likely_cause
from fogproof.checks.escalation import EARLY, Stage, doubtful, judged, stages, total_weight
from fogproof.checks.figures import bins_figure, z_map_figure
from fogproof.checks.prepared import Prepared
from fogproof.checks.preparing import prepare
from fogproof.checks.statistics.cells import blocks
from fogproof.checks.streams import batch_generator, batch_sizes
from fogproof.checks.subject import Subject
from fogproof.checks.suite import tests_of
from fogproof.checks.tally import Tally
from fogproof.checks.verdict import Finding, Verdict
from fogproof.doing import doing
from fogproof.errors import InvalidValueError

_PATIENCE = 60.0  # seconds
More = Callable[[Tally, int], Tally]
"""Draws: the tally so far, and how many batches are wanted -> the tally of so many."""


@dataclass(frozen=True)
class SamplerCheck:
    """A check in parts: batches drawn anywhere and in any number of sittings, judged once they are together.

    Two of the same subject, samples and seed have the same cells, so tallies of theirs merge, in the order of their batches; those
    of another check are refused. A tally is written and read with `Tally.to_dict` and `read`.

    >>> from fogproof.checks import sampler_check
    >>> check = sampler_check(lambda u: u[:, 0], np.ones_like, Interval(0, 1), dimensions=1, samples=200_000, seed=1)
    >>> first, rest = check.tally([0]), check.tally(range(1, check.batches))
    >>> check.verdict(first.merged(rest)).outcome
    'not rejected'
    """

    prepared: Prepared
    looks: tuple[Stage, ...]
    alpha: float
    seed: int
    started: float

    @staticmethod
    def of(subject: Subject, resolution: float | None, samples: int, alpha: float, seed: int | None) -> SamplerCheck:
        """Validate the arguments, those of `check_sampler`, and ask all questions that need no samples."""
        started = time.perf_counter()
        subject, samples, seed = declared(subject, resolution, samples, alpha, seed)
        doing("questions that need no samples")
        with np.errstate(all="ignore"):  # what is infinite or undefined is found, not warned of
            prepared = prepare(subject, samples, seed)
        weight = total_weight(tests_of(prepared, prepared.counter.empty()))
        return SamplerCheck(prepared, stages(samples, resolution, alpha, weight), alpha, seed, started)

    @cached_property
    def fingerprint(self) -> str:
        """What all tallies of this check share: a digest of domain, seed, batches, cells, and the pilot's points and densities.

        Six digits of a few numbers: another machine's last bits do not matter, another sampler's values do.
        """
        subject, points = self.prepared.subject, self.prepared.pilot.points[:16]
        with np.errstate(all="ignore"):
            seen = [f"{x:.6g}" for x in (*points.ravel(), *(subject.density(points) if len(points) else ()))]
        empty = self.prepared.counter.empty()
        cells = [len(counts) for counts in empty.fine], None if empty.plane is None else empty.plane.shape
        text = repr((subject.domain, subject.dimensions, subject.atoms, self.seed, self.sizes, cells, seen))
        return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()

    @cached_property
    def sizes(self) -> list[int]:
        """The sizes of all batches: every look comes at the end of one."""
        ends = [look.samples for look in self.looks]
        return [size for start, end in pairwise([0, *ends]) for size in batch_sizes(end - start)]

    @cached_property
    def _ends(self) -> np.ndarray:
        """How many samples there are at the end of each batch."""
        return np.cumsum(self.sizes)

    @property
    def batches(self) -> int:
        """How many batches make up the largest number of samples."""
        return len(self.sizes)

    def tally(self, batches: Iterable[int]) -> Tally:
        """Draw and count the given batches, increasing numbers below `batches`."""
        batches = list(batches)
        if not all(isinstance(i, Integral) and 0 <= i < self.batches for i in batches):
            raise InvalidValueError("batches", f"must be whole numbers from 0 to {self.batches - 1}", batches)
        return replace(self._drawn(batches), check=self.fingerprint)

    def _more(self, tally: Tally, batches: int) -> Tally:
        return tally.merged(self._drawn(range(len(tally.batches), batches)))

    def _drawn(self, batches: Iterable[int]) -> Tally:
        tally = self.prepared.counter.empty()
        with np.errstate(all="ignore"):
            for index in batches:
                doing(f"sample {self._ends[index] - self.sizes[index]} of {self.prepared.samples} at most")
                draw = self.prepared.subject.draw(batch_generator(self.seed, "samples", 1, index), self.sizes[index])
                tally = tally.merged(self.prepared.counter.tally(draw, index))
        return tally

    def read(self, state: dict[str, Any]) -> Tally:
        """Return the tally that `Tally.to_dict` wrote."""
        return self._own(Tally.from_dict(state, self.prepared.counter.empty().watch))

    def _own(self, tally: Tally) -> Tally:
        """Return a tally of this check, or refuse one of another."""
        if tally.check != self.fingerprint:
            rule = "must be of this check: the same subject, samples, seed and version"
            raise InvalidValueError("tally", rule, f"that of {tally.check or 'none'}")
        numbered = all(isinstance(i, Integral) and 0 <= i < self.batches for i in tally.batches)
        if not numbered or tally.drawn != sum(self.sizes[i] for i in tally.batches):
            raise InvalidValueError("tally", "must have drawn what its batches hold", tally.drawn)
        return tally

    def verdict(self, tally: Tally) -> Verdict:
        """Judge a tally: with all batches by the whole of alpha, with fewer only what is beyond doubt."""
        whole = self._own(tally).drawn == self.prepared.samples
        look = self.looks[-1] if whole else Stage(tally.drawn, EARLY, final=False)
        findings = self._judged(tally, look)
        if not whole and all(f.outcome != "rejected" for f in findings):
            message = f"{len(tally.batches)} of {self.batches} batches are drawn"
            findings.append(Finding("all batches", "inconclusive", message))
        return explained(self.prepared.subject, self._verdict(findings, tally))

    def run(self, more: More | None = None, begun: Tally | None = None) -> Verdict:
        """Draw and judge, look by look, until something is rejected or nothing is doubtful, and look for the cause.

        more   the tally so far, how many batches are wanted -> the tally of so many, where others than this thread draw them
        begun  tally of the first batches, drawn in an earlier sitting
        """
        return explained(self.prepared.subject, self.unexplained(more, begun))

    def unexplained(self, more: More | None = None, begun: Tally | None = None) -> Verdict:
        """Return the same with no other word of its cause than the findings'."""
        tally, findings = self.prepared.counter.empty() if begun is None else self._own(begun), []
        for look in self.looks:
            enough = int(np.searchsorted(self._ends, look.samples)) + 1
            if enough < len(tally.batches):
                continue  # it has been looked at then, and was neither wrong nor right enough
            tally = (more or self._more)(tally, enough)
            findings = self._judged(tally, look)
            # What the map shows needs no samples, but its cause does: they are drawn until they show it too.
            rejected = any(f.outcome == "rejected" and f.check != map_density.NAME for f in findings)
            if rejected or (look.final and not doubtful(findings, self.alpha * look.share)):
                break
        return self._verdict(findings, tally)

    def _judged(self, tally: Tally, look: Stage) -> list[Finding]:
        with np.errstate(all="ignore"):
            return judge(self.prepared.refined(tally), tally, self.alpha * look.share, look.final)

    def _verdict(self, findings: list[Finding], tally: Tally) -> Verdict:
        subject = self.prepared.subject
        settings = {
            "domain": repr(subject.domain),
            "dimensions": subject.dimensions,
            "precision": subject.precision,
            "tests": sum(f.alpha is not None for f in findings),
            "looks": [look.samples for look in self.looks],
        }
        reproduce = (
            f"check_sampler(sample, pdf, {subject.domain!r}, dimensions={subject.dimensions}{_options(subject)},"
            f" samples={self.prepared.samples}, alpha={self.alpha!r}, seed={self.seed})"
        )
        seconds = time.perf_counter() - self.started
        pilot = self.prepared.pilot
        return Verdict(
            tuple(findings),
            self.alpha,
            tally.drawn,
            self.seed,
            seconds,
            settings,
            likely_cause(findings),
            reproduce,
            unchecked=(
                *unchecked(subject, pilot.channels, bool(pilot.labels)),
                *self.prepared.unheld(tally),
                *self.prepared.disbelieved,
            ),
        )


def explained(subject: Subject, verdict: Verdict) -> Verdict:
    """Return a verdict with the cause that explains its rejection; the search takes no longer than the check, or a minute."""
    patience = max(verdict.seconds, _PATIENCE)
    cause, diagnosis = diagnosed(subject, verdict.findings, verdict.samples, verdict.seed, patience)
    return replace(verdict, cause=cause, diagnosis=diagnosis)


def judge(prepared: Prepared, tally: Tally, alpha: float, final: bool = True) -> list[Finding]:
    """Return all findings about the samples so far; the statistical ones share alpha."""
    findings = [prepared.normalisation(tally), *prepared.findings, *tally.watch.findings()]
    statistical = judged(tests_of(prepared, tally), alpha, final)
    return findings + _illustrated(prepared, tally, statistical)


def _illustrated(prepared: Prepared, tally: Tally, findings: list[Finding]) -> list[Finding]:
    """Return the findings with a figure on the first, and on every rejected one that counts cells."""
    if not prepared.counted:
        return findings
    marginals, plane = prepared.grid.marginals, prepared.grid.plane
    if plane is None or tally.plane is None:
        figure = bins_figure(marginals[0], tally.fine[0])
    else:
        figure = z_map_figure((marginals[0], marginals[1]), plane, blocks(tally.plane, len(plane.mass)))
    shown = []
    for index, finding in enumerate(findings):
        wanted = index == 0 or finding.outcome == "rejected"
        shown.append(replace(finding, figure=figure) if wanted else finding)
    return shown


def _options(subject: Subject) -> str:
    """Return what else was declared, as arguments of a call; functions go by the names of their arguments."""
    functions = [
        f", {name}={name}" for name in ("cdf", "eval", "reference", "inverse") if getattr(subject, name) is not None
    ]
    names = ("atoms", "axis", "mean_cosine", "albedo", "events", "uniform_bits", "quasi_random", "breaks", "support")
    values = [f", {name}={_plain(getattr(subject, name))!r}" for name in names if getattr(subject, name)]
    precision = [f", precision={subject.precision!r}"] if subject.precision != "float64" else []
    return "".join(functions + values + precision)


def _plain(value: Any) -> Any:
    """Return a declared value without NumPy in it: the line that repeats a verdict needs no import of it."""
    if isinstance(value, Mapping):
        return {_plain(key): _plain(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
