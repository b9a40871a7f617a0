"""What an image's differences from its reference are held to, inside one false-alarm probability."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.arguments import alpha_of
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.verdict import EffectInterval, Finding, Verdict
from fogproof.errors import InvalidInputError, InvalidValueError
from fogproof.images.dependence import Dependence, dependence, in_cells
from fogproof.images.faults import faults, notes
from fogproof.images.picture import RenderedImage
from fogproof.images.pooled import pooled_tests
from fogproof.images.residuals import Residuals
from fogproof.images.unlike import one_unlike
from fogproof.scene import ImageScene

ALPHA = 1e-6
TOLERANCE = 1e-5
"""Relative error that does not matter: sums of many samples in single precision are off by about as much."""


EXACT = 0.5
"""Share of pixels that are the reference, to within what is allowed, from which on equal renders have no noise."""


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


def judge(
    picture: RenderedImage,
    found: Residuals,
    alpha: float,
    correlated: bool,
    brightest: float,
    files: Sequence[RenderedImage] = (),
) -> tuple[list[Finding], list[str], Dependence]:
    """Return findings, what was not checked, and how pixels depend on each other.

    brightest  the largest value that one path can bring, see `faults`
    files      the two images as they came, where `picture` stands for their difference; what is too bright is then no bet
    """
    shown = files or (picture,)
    findings = [finding for one in shown for finding in faults(one, found, brightest, alpha)]
    unchecked = [note for one in shown for note in notes(one)]
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
    exact = same and np.mean(np.abs(found.difference) <= found.allowed) >= EXACT
    if not exact:
        for one in shown:
            _require_different(one)
    if same and not exact:  # they count as one, whose pixels tell by their scatter whether there is noise
        unchecked.append("all renders are the same, so they count as one: is each given a seed of its own?")
        picture = replace(picture, renders=picture.renders[:1])
        how = dependence(picture.renders, found)
    if exact:
        findings.append(_exactly(found))
    elif how.kind == "shared":
        findings += _by_render(picture, found, alpha)
        odd = one_unlike(picture, found, alpha)
        findings += [odd] if odd else []
    else:
        pooled, more = pooled_tests(
            in_cells(found) if how.kind == "neighbours" else found, alpha, picture.names, positive=not files
        )
        findings += pooled
        unchecked += more
    return findings, unchecked, how


def _require_different(picture: RenderedImage) -> None:
    """Refuse files that are given as independent renders and are equal: by the scatter of such, anything looks certain."""
    seen: dict[bytes, str] = {}
    for path, pixels in zip(picture.paths, picture.renders if picture.paths else (), strict=True):
        key = hashlib.blake2b(pixels.tobytes()).digest()
        if key in seen:
            what = f"{seen[key]} and {path} are the same pixel by pixel, and no independent renders"
            raise InvalidInputError(f"{what}: render each with a seed of its own, or give one of them", path)
        seen[key] = path


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
            mean_test(
                name, name, Moments.of(means), 0.0, allowed, alpha / channels, known=Known(light=True), uncertain=0.0
            )
        )
    return findings


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


def checked(tolerance: float, alpha: float) -> tuple[float, float]:
    """Return tolerance and alpha, or say what is wrong with them."""
    if not 0 <= tolerance < 1:
        raise InvalidValueError("tolerance", "must lie in [0, 1), relative", tolerance)
    return tolerance, alpha_of(alpha)
