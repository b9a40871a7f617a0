"""All relations: those of rays and of images alike, those along one ray, those of images alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.relations.anywhere import ANYWHERE
from fogproof.relations.film import ON_THE_FILM
from fogproof.relations.paths import ALONG_A_RAY
from fogproof.relations.scenes import OF_SCENES
from fogproof.relations.setting import Comparison, ImageSetting

Relation = Callable[[Any], Iterator[Comparison]]

RELATIONS: tuple[Relation, ...] = (*ANYWHERE, *ALONG_A_RAY)
"""Of radiance along a ray."""

IMAGE_RELATIONS: tuple[Relation, ...] = (*ANYWHERE, *OF_SCENES, *ON_THE_FILM)
"""Of images."""


def comparisons(setting: Any) -> list[Comparison]:
    """Return every comparison that a setting allows; what cannot be moved or changed is left out."""
    relations = IMAGE_RELATIONS if isinstance(setting, ImageSetting) else RELATIONS
    return [comparison for relation in relations for comparison in _allowed(relation, setting)]


def _allowed(relation: Relation, setting: Any) -> list[Comparison]:
    try:
        return list(relation(setting))
    except (UnsupportedError, InvalidValueError):  # a scene that cannot be written cannot be compared
        return []
