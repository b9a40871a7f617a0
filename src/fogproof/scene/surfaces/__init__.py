"""Opaque surfaces in or behind a medium, which reflect and may glow."""

from __future__ import annotations

from fogproof.scene.surfaces.plane import Plane
from fogproof.scene.surfaces.surface import Finish, Place, Surface

__all__ = ["Finish", "Place", "Plane", "Surface"]
