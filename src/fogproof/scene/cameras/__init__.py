"""Cameras: which ray belongs to which place on the film.

The film has `width` x `height` pixels; row 0 is the upper one, column 0 the left one, and a pixel's value is the mean of the
radiance over it (a box filter of one pixel). Looking along the axis with `up` pointing up, right is right: the world is
right-handed. Each kind is a module here with a dataclass, and has a `film` and a `wall`: the distance along the axis of a plane
across it on which rays end, inf for none.
"""

from __future__ import annotations

from typing import Annotated

from fogproof.scene.cameras.film import Film
from fogproof.scene.cameras.one_ray import OneRay
from fogproof.scene.cameras.orthographic import Orthographic
from fogproof.scene.cameras.perspective import Perspective
from fogproof.scene.kinds import ByKind

__all__ = [
    "Camera",
    "Film",
    "OneRay",
    "Orthographic",
    "Perspective",
]

Camera = Perspective | Orthographic | OneRay
KINDS: dict[str, type[Camera]] = {
    "perspective": Perspective,
    "orthographic": Orthographic,
    "one-ray": OneRay,
}
"""The `kind` of each camera in files and requests."""

CameraField = Annotated[Camera, ByKind("fogproof.scene.cameras")]
