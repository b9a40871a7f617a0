"""Tests of renders that differ by chance alone: which of two comes first says nothing, and noise falls with the samples.

What is symmetric about 0 has P(sum x / sqrt(sum x^2) >= t) <= exp(-t^2 / 2), whatever its law (Efron 1969): no skewness is to be
feared, and no variance to be known.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fogproof.checks.verdict import Finding, Outcome, Verdict
from fogproof.images.dependence import dependence
from fogproof.images.picture import RenderedImage
from fogproof.images.regions import families
from fogproof.images.residuals import Residuals

MORE = 4
"""Times as many samples: independent ones have a quarter of the variance, well-spread ones less."""


def exchanged(verdict: Verdict, first: RenderedImage, second: RenderedImage, alpha: float) -> Verdict:
    """Return the verdict with a finding on sums over regions: each pixel might as well have come from the other side."""
    if _depend(first):
        return verdict
    gap = first.value - second.value
    size = _size(first, second)
    parts = [("the image", np.ones(gap.shape[:2], bool))]
    for family, label in families(np.mean(size, axis=2)).items():
        parts += [(f"{family}, part {kind + 1}", label == kind) for kind in np.unique(label)]
    parts = parts if np.isfinite(gap).all() else []
    found = [(2 * symmetric_p((gap / size)[where].ravel()), what) for what, where in parts]
    if not found:
        return verdict
    p, what = min(found)
    p = min(1.0, p * len(found))
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"each pixel might as well have come from the other side; the least likely: {what}"
    finding = Finding("exchanged sides", outcome, message, p, alpha, cause="different-images")
    cause = "different-images" if outcome == "rejected" else verdict.cause
    return replace(verdict, findings=(*verdict.findings, finding), cause=cause)


def noise_falls(verdict: Verdict, few: RenderedImage, many: RenderedImage, alpha: float) -> Verdict:
    """Return the verdict with a finding on the noise of two or more renders each: 4 variances of many less that of few is <= 0.

    Of nearly normal noise both have the same law; rare bright values stand in few samples more seldom, and then do not alarm.
    """
    if min(len(few.renders), len(many.renders)) < 2:
        return replace(verdict, unchecked=(*verdict.unchecked, "noise: two renders of each are needed"))
    if _depend(few):
        return replace(verdict, unchecked=(*verdict.unchecked, "noise: pixels depend on each other"))
    variances = [one.renders.var(axis=0, ddof=1) / _size(few, many) ** 2 for one in (few, many)]
    excess = (MORE * variances[1] - variances[0]).ravel()
    if not np.any(variances) or not np.isfinite(excess).all():
        return verdict
    p = symmetric_p(excess) if np.sum(excess) > 0 else 1.0
    ratio = float(np.mean(variances[1]) / np.mean(variances[0])) if np.any(variances[0]) else math.inf
    told = f"{MORE} times as many samples have {ratio:.3g} times the variance; 1/{MORE} is due, or less"
    rises = p <= alpha
    result = Finding(
        "noise", "rejected" if rises else "not rejected", told, p, alpha, effect=ratio, cause="noise-stays"
    )
    return replace(verdict, findings=(*verdict.findings, result), cause="noise-stays" if rises else verdict.cause)


def symmetric_p(x: np.ndarray) -> float:
    """Return a bound of the probability that the sum of what is symmetric about 0 is as far on its side of 0."""
    square = float(np.sum(x * x))
    return math.exp(-0.5 * float(np.sum(x)) ** 2 / square) if square > 0 else 1.0


def _size(first: RenderedImage, second: RenderedImage) -> np.ndarray:
    """Return what differences are relative to: the same for both sides exchanged."""
    both = np.abs(0.5 * (first.value + second.value))
    return np.asarray(np.maximum(both, 0.1 * float(np.mean(both)) or 1.0))


def _depend(renders: RenderedImage) -> bool:
    """Return whether the pixels of renders depend on each other, as far as two of them show."""
    size = _size(renders, renders)
    nothing = np.zeros_like(size)
    found = Residuals(nothing, nothing, size, np.ones(size.shape[:2], bool))
    return len(renders.renders) > 1 and dependence(renders.renders, found).kind in ("shared", "neighbours")
