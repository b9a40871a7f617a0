"""Convex shapes that hold a medium, with vacuum outside; `Unbounded` fills space."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from fogproof.scene.kinds import ByKind
from fogproof.scene.shapes.ball import Ball
from fogproof.scene.shapes.box import Box
from fogproof.scene.shapes.half_space import HalfSpace
from fogproof.scene.shapes.slab import Slab
from fogproof.scene.shapes.unbounded import Unbounded

__all__ = [
    "Ball",
    "Box",
    "HalfSpace",
    "Shape",
    "Slab",
    "Unbounded",
]

Shape = Unbounded | HalfSpace | Slab | Ball | Box
KINDS: dict[str, type[Shape]] = {
    "unbounded": Unbounded,
    "half-space": HalfSpace,
    "slab": Slab,
    "ball": Ball,
    "box": Box,
}
"""The `kind` of each shape in files and requests."""

EVERYWHERE = Unbounded()
"""What a medium fills if nothing else is said."""

ShapeField = Annotated[Shape, ByKind("fogproof.scene.shapes")]


def bounding_box(shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of a box around a shape [m], infinite where it says of none."""
    low, high = getattr(shape, "bounds", ((-np.inf,) * 3, (np.inf,) * 3))
    return np.array(low), np.array(high)
