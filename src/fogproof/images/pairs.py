"""Two images that should show the same, without an oracle."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fogproof.checks.verdict import Finding, Verdict
from fogproof.errors import InvalidValueError
from fogproof.images.copies import distinct, one_render, require_other_files
from fogproof.images.judging import ALPHA, TOLERANCE, ImageComparison, checked, judge, ratios
from fogproof.images.picture import RenderedImage, read_picture
from fogproof.images.residuals import Residuals


def compare_pictures(
    first: Sequence[str | Path],
    second: Sequence[str | Path],
    *,
    tolerance: float = TOLERANCE,
    alpha: float = ALPHA,
    layer: str = "",
    correlated: bool = False,
) -> ImageComparison:
    """Compare two images that should show the same, each of one or several independent renders, without an oracle.

    Pixel by pixel their difference has mean 0 and the noise of both (Welch 1947); what both have wrong is not seen. One render that
    stands on both sides says nothing of either: that is inconclusive.
    """
    tolerance, alpha = checked(tolerance, alpha)
    require_other_files([*first, *second])
    a, b = read_picture(first, None, None, layer), read_picture(second, None, None, layer)
    done = compare_pair(a, b, tolerance=tolerance, alpha=alpha, correlated=correlated)
    words = one_render(a, b)
    if not words:
        return done
    findings = (Finding("renders", "inconclusive", words), *done.verdict.findings)
    return replace(done, verdict=replace(done.verdict, findings=findings))


def compare_pair(
    a: RenderedImage, b: RenderedImage, *, tolerance: float, alpha: float, correlated: bool = False
) -> ImageComparison:
    """Compare images that have been read; see `compare_pictures`."""
    started = time.perf_counter()
    (a, said), (b, more) = distinct(a, 0.0), distinct(b, 0.0)
    if a.renders.shape[1:] != b.renders.shape[1:]:
        sizes = [f"{x.renders.shape[2]} x {x.renders.shape[1]} of {x.renders.shape[3]} channels" for x in (a, b)]
        raise InvalidValueError("images", "must have the same size", sizes)
    # A weight must not know its own pixel's noise: it comes from the neighbours.
    flat = _neighbourhood(0.5 * (a.value + b.value))
    rounding = np.abs(b.value) * (a.rounding[0] + b.rounding[0]) + b.rounding[1]
    good = np.isfinite(a.renders).all(axis=(0, 3)) & np.isfinite(b.renders).all(axis=(0, 3))
    with np.errstate(invalid="ignore"):
        gap = np.where(good[..., None], a.value - b.value, 0.0)
        allowed = np.where(
            good[..., None], np.where(np.abs(gap) > 2 * rounding, 0, rounding) + tolerance * np.abs(b.value), 0.0
        )
    found = Residuals(gap, allowed, flat, good)
    brightest = float(np.max(np.abs(b.value[good]), initial=0.0))
    findings, unchecked, how = judge(_differences(a, b, flat), found, alpha, correlated, brightest, (a, b))
    settings = {"tolerance": tolerance, "images": [*a.paths, *b.paths]}
    rejected = any(finding.outcome == "rejected" for finding in findings)
    verdict = Verdict(
        tuple(findings), alpha, int(good.sum()), 0, time.perf_counter() - started, settings,
        "different-images" if rejected else "", unchecked=(*said, *more, *unchecked),
    )  # fmt: skip
    return ImageComparison(verdict, ratios(found, a.names), a, found, how, None)


def _differences(a: RenderedImage, b: RenderedImage, flat: np.ndarray) -> RenderedImage:
    """Return images that differ from `flat` by what the renders of both differ by, pair by pair where there are pairs."""
    if len(a.renders) == len(b.renders):
        return replace(a, renders=flat + (a.renders - b.renders))
    return replace(a, renders=(flat + (a.value - b.value))[None])


def _neighbourhood(value: np.ndarray) -> np.ndarray:
    """Return the mean of the pixels around each, without itself."""
    from scipy.ndimage import uniform_filter

    clean = np.where(np.isfinite(value), value, 0.0)
    side = min(5, *value.shape[:2])
    if side < 2:
        return np.broadcast_to(np.mean(clean, axis=(0, 1)), value.shape)
    size = (side, side, 0)
    around = (uniform_filter(clean, size, mode="wrap") * side * side - clean) / (side * side - 1)
    return np.asarray(np.maximum(around, 1e-3 * float(np.mean(np.abs(clean)))))
