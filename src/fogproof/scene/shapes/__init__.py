"""Convex shapes that hold a medium, with vacuum outside; `Unbounded` fills space."""

from __future__ import annotations

from typing import Annotated

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
