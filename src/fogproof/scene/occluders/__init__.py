"""Things that cast shadows into a medium. They stand between a light and the ray, not between the camera and the medium."""

from __future__ import annotations

from typing import Annotated

from fogproof.scene.kinds import ByKind
from fogproof.scene.occluders.disk import Disk
from fogproof.scene.occluders.sphere import Sphere

__all__ = [
    "Disk",
    "Occluder",
    "Sphere",
]

Occluder = Sphere | Disk
KINDS: dict[str, type[Occluder]] = {"sphere": Sphere, "disk": Disk}
"""The `kind` of each occluder in files and requests."""

OccluderField = Annotated[Occluder, ByKind("fogproof.scene.occluders")]
