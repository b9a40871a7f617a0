"""What lies under a layered medium and reflects: one module a kind, and the table of them. The ground is flat and opaque."""

from __future__ import annotations

from typing import Annotated, Any

from fogproof.errors import InvalidValueError
from fogproof.scene.grounds.lambert import LambertGround
from fogproof.scene.grounds.lommel_seeliger import LommelSeeligerGround
from fogproof.scene.grounds.minnaert import MinnaertGround
from fogproof.scene.kinds import ByKind

__all__ = ["Ground", "LambertGround", "LommelSeeligerGround", "MinnaertGround"]

Ground = LambertGround | MinnaertGround | LommelSeeligerGround

KINDS: dict[str, type[Ground]] = {
    "lambert": LambertGround,
    "minnaert": MinnaertGround,
    "lommel-seeliger": LommelSeeligerGround,
}
"""The `kind` of each ground in files and requests."""

GroundField = Annotated[Ground, ByKind("fogproof.scene.grounds")]


def require_ground(name: str, value: Any) -> None:
    """Raise unless a value is a ground."""
    if not isinstance(value, Ground):
        raise InvalidValueError(name, "must be a ground", value, "for example LambertGround(0.3)")
