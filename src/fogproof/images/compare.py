"""An image against the oracle's, or against another: one verdict inside one false-alarm probability."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fogproof.analytic import image
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.verdict import EffectInterval, Finding, Verdict
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.images.dependence import Dependence, dependence, in_cells
from fogproof.images.faults import faults, notes
from fogproof.images.picture import RenderedImage, read_picture
from fogproof.images.pooled import pooled_tests
from fogproof.images.residuals import Residuals, residuals
from fogproof.scene import ImageScene

ALPHA = 1e-6
TOLERANCE = 1e-5
"""Relative error that does not matter: sums of many samples in single precision are off by about as much."""


@dataclass(frozen=True)
class ImageComparison:
    """A verdict on an image, and what it rests on.

    ratios      of the means of image and reference, one a channel, with its interval
    picture     the image
    found       its residuals
    dependence  how its pixels depend on each other
    scene       None where two images were compared
    """

    verdict: Verdict
    ratios: tuple[tuple[str, float, EffectInterval], ...]
    picture: RenderedImage
    found: Residuals
    dependence: Dependence
    scene: ImageScene | None


def compare_image(
    paths: Sequence[str | Path],
    scene: ImageScene,
    *,
    reference: Reference | None = None,
    tolerance: float = TOLERANCE,
    alpha: float = ALPHA,
    layer: str = "",
    samples: int | None = None,
    correlated: bool = False,
    explain: bool = True,
) -> ImageComparison:
    """Compare one image, or several independent renders of it, with the oracle's image of a scene.

    reference   the oracle's image, where it is there already
    tolerance   relative error that does not matter
    alpha       false-alarm probability of all tests together
    layer       of the channels, in files of several
    samples     samples a pixel, where variance layers hold that of one sample
    correlated  pixels are known to share random numbers: only several renders tell how means scatter
    explain     look for the cause of what is rejected
    """
    started = time.perf_counter()
    tolerance, alpha = _checked(tolerance, alpha)
    picture = read_picture(paths, scene.camera.film, scene.channels, layer, samples)
    truth = image(scene) if reference is None else reference
    channels = picture.renders.shape[-1]
    value, error = (
        np.broadcast_to(x if x.ndim == 3 else x[..., None], (*x.shape[:2], channels)) for x in truth_of(truth)
    )
    found = residuals(picture, value, error, tolerance)
    brightest = (
        float(np.max(scene.background)) if scene.scattering == "none" and not np.any(scene.medium.emission) else 0.0
    )
    findings, unchecked, how = _judge(picture, found, alpha, correlated, brightest or float(np.max(value)))
    cause, diagnosis = "", ""
    rejected = [finding for finding in findings if finding.outcome == "rejected"]
    if rejected:
        cause = next((finding.cause for finding in rejected if finding.cause not in ("", "bias")), "bias")
        if explain and cause in ("bias", "8-bit"):
            from fogproof.images.causes import diagnose

            explained = diagnose(scene, picture, found)
            cause, diagnosis = explained or (cause, "")
    verdict = Verdict(
        tuple(findings),
        alpha,
        int(found.good.sum()),
        0,
        time.perf_counter() - started,
        {"tolerance": tolerance, "renders": len(picture.renders), "images": list(picture.paths)},
        cause,
        diagnosis=diagnosis,
        unchecked=tuple(unchecked),
    )
    return ImageComparison(verdict, ratios(found, picture.names), picture, found, how, scene)


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

    Pixel by pixel their difference has mean 0 and the noise of both (Welch 1947); what both have wrong is not seen.
    """
    started = time.perf_counter()
    tolerance, alpha = _checked(tolerance, alpha)
    a, b = read_picture(first, None, None, layer), read_picture(second, None, None, layer)
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
    findings, unchecked, how = _judge(a, found, alpha, correlated, float(np.nanmax(b.value)), positive=False)
    settings = {"tolerance": tolerance, "images": [*a.paths, *b.paths]}
    rejected = any(finding.outcome == "rejected" for finding in findings)
    verdict = Verdict(
        tuple(findings), alpha, int(good.sum()), 0, time.perf_counter() - started, settings,
        "different-images" if rejected else "", unchecked=tuple(unchecked),
    )  # fmt: skip
    return ImageComparison(verdict, ratios(found, a.names), a, found, how, None)


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


def truth_of(reference: Reference) -> tuple[np.ndarray, np.ndarray]:
    """Return value and error as arrays of one shape."""
    return reference.value, np.broadcast_to(reference.error, reference.value.shape)


def ratios(found: Residuals, names: Sequence[str]) -> tuple[tuple[str, float, EffectInterval], ...]:
    """Return the ratio of the means of image and reference for each channel, with a 99 % interval."""
    told = []
    for c, name in enumerate(names):
        d, reference = found.difference[..., c][found.good], found.reference[..., c][found.good]
        base = float(np.mean(reference)) if len(d) else 0.0
        if not base:
            continue
        reach = normal_quantile(0.005) * float(np.std(d)) / np.sqrt(len(d)) + float(
            np.mean(found.allowed[..., c][found.good])
        )
        ratio = 1 + float(np.mean(d)) / base
        told.append((name, ratio, EffectInterval(ratio - reach / abs(base), ratio + reach / abs(base), 0.99)))
    return tuple(told)


def _checked(tolerance: float, alpha: float) -> tuple[float, float]:
    if not 0 <= tolerance < 1:
        raise InvalidValueError("tolerance", "must lie in [0, 1), relative", tolerance)
    if not 0 < alpha < 1:
        raise InvalidValueError("alpha", "must lie in (0, 1)", alpha)
    return tolerance, alpha


def _judge(
    picture: RenderedImage, found: Residuals, alpha: float, correlated: bool, brightest: float, positive: bool = True
) -> tuple[list[Finding], list[str], Dependence]:
    """Return findings, what was not checked, and how pixels depend on each other."""
    findings, unchecked = faults(picture, found, brightest, alpha), notes(picture)
    how = dependence(picture.renders, found)
    if correlated:
        how = Dependence("shared", how.z, "pixels are declared to share random numbers")
    if how.words:
        unchecked.append(how.words)
    if any(finding.cause == "black" or finding.check == "light" for finding in findings):
        return findings, unchecked, how
    if not found.good.any():
        return findings, unchecked, how
    same = len(picture.renders) > 1 and all(
        np.array_equal(r, picture.renders[0], equal_nan=True) for r in picture.renders
    )
    if same:
        findings.append(_exactly(found))
    elif how.kind == "shared":
        findings += _by_render(picture, found, alpha)
    else:
        pooled, more = pooled_tests(
            in_cells(found) if how.kind == "neighbours" else found, alpha, picture.names, positive
        )
        findings += pooled
        unchecked += more
    return findings, unchecked, how


def _exactly(found: Residuals) -> Finding:
    """Judge renders that are all the same: there is no noise, and every pixel is held to what is allowed."""
    size = np.abs(found.difference) - found.allowed
    row, column, _ = np.unravel_index(int(np.argmax(size)), size.shape)
    worst = float(np.max(np.abs(found.difference) / np.maximum(np.abs(found.reference), 1e-300)))
    if np.max(size) <= 0:
        return Finding(
            "pixels", "not rejected", "all renders are the same, and every pixel is the reference to what is allowed"
        )
    message = f"all renders are the same: no noise; {np.mean(size > 0):.1%} of the pixels are off, by up to {worst:.3g} of them,"
    return Finding("pixels", "rejected", f"{message} most at row {row}, column {column}", effect=worst, cause="bias")


def _by_render(picture: RenderedImage, found: Residuals, alpha: float) -> list[Finding]:
    """Test the means of whole renders, whose scatter alone is known where pixels share random numbers."""
    n, channels = len(picture.renders), picture.renders.shape[-1]
    findings = []
    for c in range(channels):
        name = f"mean of {picture.names[c]} of each render"
        base = float(np.mean(found.reference[..., c][found.good]))
        if n < 3:
            message = (
                f"pixels share random numbers, and {n} {'renders tell' if n > 1 else 'render tells'} not how the mean"
            )
            findings.append(Finding(name, "inconclusive", message + " scatters: give 8 or more, each of its own seed"))
            continue
        means = picture.renders[..., c][:, found.good].mean(axis=1) - base
        allowed = float(np.mean(found.allowed[..., c][found.good]))
        findings.append(
            mean_test(name, name, Moments.of(means), 0.0, allowed, alpha / channels, known=Known(light=True))
        )
    return findings
