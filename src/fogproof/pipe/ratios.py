"""Samples with the densities that they claim, and nothing else: no density can be asked for anywhere.

What can be tested is that q(x) / p(x) averages to the probability Q(A) in every part A of the domain, for a known law q: the
identity that makes importance sampling work. It needs p > 0 on the whole domain. The law q is that of the domain inside of cells,
whose shares follow a first quarter of the points, which is not judged: so q / p varies little where p is right.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks import Finding, Verdict, check_estimator
from fogproof.checks.declared import unchecked
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject, in_domain
from fogproof.checks.telling import few_digits
from fogproof.contracts import Draw, Reference
from fogproof.domains import Domain, Law
from fogproof.errors import SubjectError
from fogproof.pipe.declared_means import declared_means
from fogproof.pipe.recorded import LEAST

_ROWS_A_PART = 8000  # fewer leave ratios too skewed for a test of their mean
_PARTS = 64
_FEW = 8  # points of the pilot in a cell: q leaves out emptier ones
_SAME = 5.0  # standard errors within which all cells are off by the same factor
_LOGARITHMS = 0.01  # of densities that are negative: what logarithms have
_PILOT_A_CELL = 30  # points of the pilot that tell how much of q lies in a fine cell


@dataclass(frozen=True)
class _Cells:
    """Cells of equal probability under a law, `side` along each axis.

    A point that has probability itself lies anywhere in its interval: the identity holds for it and that place together.
    """

    law: Law
    side: int
    rng: np.random.Generator

    @property
    def count(self) -> int:
        return int(self.side ** len(self.law.axes))

    def endless(self, domain: Domain) -> np.ndarray:
        """Return which cells may have no end: the outermost ones of a domain that has none."""
        if np.isfinite(domain.measure):
            return np.zeros(self.count, dtype=bool)
        place = np.array(np.unravel_index(np.arange(self.count), (self.side,) * len(self.law.axes)))
        return np.asarray(((place == 0) | (place == self.side - 1)).any(axis=0))

    def of(self, x: np.ndarray) -> np.ndarray:
        """Return the cell of each point (n,)."""
        axes = len(self.law.axes)
        place = self.law.coordinates(x, self.rng.random((len(x), axes))) * self.side
        corner = np.minimum(place.astype(np.intp), self.side - 1)
        return np.asarray(np.ravel_multi_index(tuple(corner.T), (self.side,) * axes))


def check_ratios(subject: Subject, draw: Draw, alpha: float, seed: int | None) -> Verdict:
    """Judge points by their claimed densities alone."""
    assert draw.pdf is not None
    n = len(draw.x)
    if n < LEAST:
        raise SubjectError(f"there are {n} samples; at least {LEAST} are needed", "file")
    at = np.zeros(n, dtype=bool)
    for hits in subject.at_atom(draw.x).values():
        at |= hits
    outside = ~(in_domain(subject.domain, draw.x, subject.roundoff) | at)
    bad = ~at & ~((draw.pdf > 0) & np.isfinite(draw.pdf))
    promises = [
        _promise("domain", outside, f"a point of {subject.domain}", draw.x, "outside the domain"),
        _promise("positive pdf", bad, "of positive finite density", draw.pdf, "claimed hole"),
    ]
    few = few_digits(subject, draw.x[outside])
    if few:
        promises[0] = replace(promises[0], message=promises[0].message + few, cause="coarse numbers")
    negative = float(np.mean(draw.pdf < 0))
    if negative > 0:
        told = " (are they logarithms?)" if negative > _LOGARITHMS else ""
        promises[1] = replace(promises[1], message=promises[1].message + told, cause="negative pdf")
    if any(finding.outcome == "rejected" for finding in promises):
        return _with(Verdict((), alpha, n, seed or 0), promises)
    cut = n // 4
    law = subject.domain.law(draw.x[:cut][~at[:cut]])
    side = max(1, math.floor((cut / _PILOT_A_CELL) ** (1 / len(law.axes))))
    cells = _Cells(law, side, batch_generator(seed or 0, "cells", 0, 0))  # no stream that the samples may be made of
    pilot = np.bincount(cells.of(draw.x[:cut][~at[:cut]]), minlength=cells.count).astype(float)
    pilot[(pilot < _FEW) | cells.endless(subject.domain)] = 0.0  # where ratios have no bound
    if not pilot.any():
        raise SubjectError(f"{n} samples are too few to tell where they are", "file")
    share = pilot / pilot.sum()  # of q; inside a cell it is the domain's known law
    parts = int(min(max((n - cut) // _ROWS_A_PART, 1), _PARTS, cells.count))
    before = np.cumsum(share) - 0.5 * share
    part = np.minimum((before * parts).astype(np.intp), parts - 1)  # of about equal shares
    tested, atom, pdf = draw.x[cut:], at[cut:], draw.pdf[cut:]
    fine = cells.of(tested)
    values = np.zeros((len(tested), parts + 1))  # the last is the whole
    with np.errstate(over="ignore"):
        ratio = share[fine] * cells.count * law.density(tested) / pdf
    values[np.arange(len(tested)), part[fine]] = values[:, -1] = np.where(atom, 0.0, ratio)
    reference = Reference(np.append(np.bincount(part, share, parts), 1.0))
    verdict = check_estimator(
        values, reference, nonnegative=True, tolerance=1e-12, precision=subject.precision, alpha=alpha / 2, seed=seed
    )
    verdict = replace(_scaled(_renamed(verdict), values, np.asarray(reference.value)), alpha=alpha)
    weights = 0 if draw.weight is None else int(np.prod(draw.weight.shape[1:], dtype=int))
    return replace(
        _with(verdict, [*promises, *declared_means(subject, draw, alpha / 2, seed)]),
        unchecked=unchecked(subject, weights, draw.event is not None),
    )


def _promise(name: str, broken: np.ndarray, rule: str, shown: np.ndarray, cause: str) -> Finding:
    if not broken.any():
        return Finding(name, "not rejected", f"kept by all {len(broken)} samples")
    first = int(np.argmax(broken))
    message = f"{int(broken.sum())} of {len(broken)} samples are not {rule}, such as {shown[first].tolist()}"
    return Finding(name, "rejected", message, effect=float(broken.mean()), cause=cause)


def _renamed(verdict: Verdict) -> Verdict:
    """Say what the channels are."""
    findings = [_of_cells(f) if f.check.startswith("mean") else f for f in verdict.findings]
    cause = "wrong density or samples" if verdict.outcome == "rejected" else ""
    return replace(verdict, findings=tuple(findings), cause=cause)


def _of_cells(finding: Finding) -> Finding:
    def told(words: str) -> str:
        return words.replace("mean of channel", "1/pdf of cell")

    known = finding.resolution
    resolution = None if known is None else replace(known, kind=told(known.kind))
    return replace(finding, check=told(finding.check), message=told(finding.message), resolution=resolution)


def _scaled(verdict: Verdict, values: np.ndarray, right: np.ndarray) -> Verdict:
    """Name one factor on all densities, where every cell is off by it."""
    if verdict.outcome != "rejected":
        return verdict
    mean, error = values.mean(axis=0) / right, values.std(axis=0) / math.sqrt(len(values)) / right
    if abs(mean[-1] - 1) > _SAME * error[-1] and bool(np.all(np.abs(mean[:-1] - mean[-1]) <= _SAME * error[:-1])):
        said = f"the densities are {1 / mean[-1]:.3g} times those of the samples, everywhere"
        return replace(verdict, cause="normalisation", diagnosis=said)
    return verdict


def _with(verdict: Verdict, promises: list[Finding]) -> Verdict:
    cause = next((f.cause for f in promises if f.cause), verdict.cause)
    return replace(verdict, findings=(*promises, *verdict.findings), cause=cause)
