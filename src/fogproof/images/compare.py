"""An image against the oracle's: one verdict inside one false-alarm probability."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fogproof.analytic import image
from fogproof.checks.verdict import Verdict
from fogproof.contracts import Reference
from fogproof.images.copies import distinct, require_other_files
from fogproof.images.judging import ALPHA, TOLERANCE, ImageComparison, checked, judge, ratios
from fogproof.images.picture import RenderedImage, read_picture
from fogproof.images.residuals import residuals
from fogproof.scene import ImageScene


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
    require_other_files(paths)
    picture = read_picture(paths, scene.camera.film, scene.channels, layer, samples)
    return compare_renders(
        picture, scene, reference=reference, tolerance=tolerance, alpha=alpha, correlated=correlated, explain=explain
    )


def compare_renders(
    picture: RenderedImage,
    scene: ImageScene,
    *,
    reference: Reference | None = None,
    tolerance: float = TOLERANCE,
    alpha: float = ALPHA,
    correlated: bool = False,
    explain: bool = True,
) -> ImageComparison:
    """Compare images that have been read with the oracle's; see `compare_image`."""
    started = time.perf_counter()
    tolerance, alpha = checked(tolerance, alpha)
    truth = image(scene) if reference is None else reference
    channels = picture.renders.shape[-1]
    value, error = (
        np.broadcast_to(x if x.ndim == 3 else x[..., None], (*x.shape[:2], channels)) for x in truth_of(truth)
    )
    picture, said = distinct(picture, value)
    found = residuals(picture, value, error, tolerance)
    brightest = (
        float(np.max(scene.background)) if scene.scattering == "none" and not np.any(scene.medium.emission) else 0.0
    )
    findings, unchecked, how = judge(picture, found, alpha, correlated, brightest or float(np.max(value)))
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
        unchecked=(*said, *unchecked),
    )
    return ImageComparison(verdict, ratios(found, picture.names), picture, found, how, scene)


def truth_of(reference: Reference) -> tuple[np.ndarray, np.ndarray]:
    """Return value and error as arrays of one shape."""
    return reference.value, np.broadcast_to(reference.error, reference.value.shape)
