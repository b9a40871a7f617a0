"""Terms of the rendering equation that are missing, or not attenuated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.images.causes.image_cause import ImageCause, Sight, fixed


def hypotheses(sight: Sight) -> Iterator[ImageCause]:
    """Yield the scene without one of its terms."""
    scene = sight.scene
    medium: Any = scene.medium
    without = []
    if np.any(scene.background):
        without.append(("no-background", replace(scene, background=0.0), "the background is missing"))
    if np.any(getattr(scene.medium, "emission", 0.0)) and not callable(scene.medium.emission):
        without.append(("no-emission", replace(scene, medium=replace(medium, emission=0.0)), "emission is missing"))
    if scene.scattering != "none":
        without.append(
            (
                "no-scattering",
                replace(scene, scattering="none"),
                "no order of scattering is there, only what comes straight",
            )
        )
    if scene.occluders:
        without.append(("no-shadow", replace(scene, occluders=()), "occluders cast no shadow"))
    for cause, other, words in without:
        yield fixed(cause, partial(sight.instead, other), words)
    if np.any(scene.background) and scene.scattering != "multiple":
        dark = replace(scene, background=0.0)

        def clear() -> np.ndarray:
            return np.asarray(sight.instead(dark) + np.asarray(scene.background))

        yield fixed("background-not-attenuated", clear, "the background is seen without attenuation")
