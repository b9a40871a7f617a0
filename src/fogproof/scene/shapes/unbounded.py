"""All of space, as what holds a medium."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Unbounded:
    """All of space."""
