"""Samples with the densities that they claim, and nothing else: no density can be asked for anywhere.

What can be tested is that q(x) / p(x) averages to the probability Q(A) in every part A of the domain, for a known law q: the
identity that makes importance sampling work. It needs p > 0 on the whole domain. The law is that of the domain, the parts are cells
of equal probability Q.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fogproof.checks import Finding, Verdict, check_estimator
from fogproof.checks.subject import Subject, in_domain
from fogproof.contracts import Draw, Reference
from fogproof.errors import SubjectError
from fogproof.pipe.recorded import LEAST

_ROWS_A_CELL = 400
_CELLS = 64


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
    if any(finding.outcome == "rejected" for finding in promises):
        return _with(Verdict((), alpha, n, seed or 0), promises)
    cut = n // 4
    law = subject.domain.law(draw.x[:cut][~at[:cut]])
    tested, atom, pdf = draw.x[cut:], at[cut:], draw.pdf[cut:]
    axes = len(law.axes)
    side = max(1, math.floor(min(_CELLS, len(tested) / _ROWS_A_CELL) ** (1 / axes)))
    place = np.minimum((law.coordinates(tested, np.full((len(tested), axes), 0.5)) * side).astype(np.intp), side - 1)
    cell = np.ravel_multi_index(tuple(place.T), (side,) * axes)
    values = np.zeros((len(tested), side**axes))
    with np.errstate(over="ignore"):
        values[np.arange(len(tested)), cell] = np.where(atom, 0.0, law.density(tested) / pdf)
    reference = Reference(np.full(side**axes, float(side) ** -axes))
    verdict = check_estimator(
        values, reference, nonnegative=True, tolerance=1e-12, precision=subject.precision, alpha=alpha, seed=seed
    )
    return _with(_renamed(verdict), promises)


def _promise(name: str, broken: np.ndarray, rule: str, shown: np.ndarray, cause: str) -> Finding:
    if not broken.any():
        return Finding(name, "not rejected", f"kept by all {len(broken)} samples")
    first = int(np.argmax(broken))
    message = f"{int(broken.sum())} of {len(broken)} samples are not {rule}, such as {shown[first].tolist()}"
    return Finding(name, "rejected", message, effect=float(broken.mean()), cause=cause)


def _renamed(verdict: Verdict) -> Verdict:
    """Say what the channels are."""
    findings = [
        replace(f, check=f.check.replace("mean", "1/pdf").replace("channel", "cell"))
        if f.check.startswith("mean")
        else f
        for f in verdict.findings
    ]
    cause = "wrong density or samples" if verdict.outcome == "rejected" else ""
    return replace(verdict, findings=tuple(findings), cause=cause)


def _with(verdict: Verdict, promises: list[Finding]) -> Verdict:
    cause = next((f.cause for f in promises if f.cause), verdict.cause)
    return replace(verdict, findings=(*promises, *verdict.findings), cause=cause)
