"""Mitsuba's emitters: the direction towards them from a point that is on no axis of theirs.

Shapes that a direction meets twice (cylinders, cubes) are left out: the density that Mitsuba gives belongs to the point, not to the
direction.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from fogproof.adapters.mitsuba import MitsubaEmitter
from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.mitsuba.builders import mitsuba_case

_NEAR, _FAR = (0.3, -0.4, 1.1), (1.5, 2.0, 6.0)


def _shining(**shape: Any) -> dict[str, Any]:
    return {**shape, "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [1.0, 1.0, 1.0]}}}


def _sky() -> dict[str, Any]:
    """Return an environment map of 16 x 8 texels with a small sun in it."""
    import numpy as np

    from fogproof.adapters.mitsuba import load

    texels = np.full((8, 16, 3), 0.2, dtype=np.float32)
    texels[:3] += np.linspace(0, 1, 16, dtype=np.float32)[:, None]
    texels[1, 5] = 60.0
    return {"type": "envmap", "bitmap": load().Bitmap(texels)}


def cases() -> list[SamplerCase]:
    """Return the cases of emitters."""
    shapes: dict[str, dict[str, Any]] = {
        "rectangle": _shining(type="rectangle"),
        "disk": _shining(type="disk"),
        "sphere": _shining(type="sphere", radius=1.0),
    }
    found = []
    for name, plugin in shapes.items():
        for place, point in (("near", _NEAR), ("far", _FAR)):
            found.append(
                mitsuba_case(
                    name=f"emitter/{name}/{place}",
                    title=f"area light on a {name}, {place}",
                    make=partial(MitsubaEmitter, plugin, point),
                )
            )
    found.append(
        mitsuba_case(
            name="emitter/sphere/inside",
            title="area light on a sphere, from inside",
            make=lambda: MitsubaEmitter(_shining(type="sphere", flip_normals=True), (0.3, 0.2, 0.1)),
        )
    )
    found.append(
        mitsuba_case(
            name="emitter/constant",
            title="constant environment",
            make=lambda: MitsubaEmitter({"type": "constant", "radiance": 1.0}),
        )
    )
    found.append(
        mitsuba_case(
            name="emitter/envmap",
            title="environment map of 16 x 8 texels with a sun",
            make=lambda: MitsubaEmitter(_sky),
        )
    )
    return found
