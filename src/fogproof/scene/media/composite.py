"""Several media in one: nested, adjacent or overlapping, each with its phase function and in its shape."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, get_args

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.kinds import ByKind
from fogproof.scene.phase import PhaseFunction, PhaseOfMedia, require_phase
from fogproof.scene.shapes import EVERYWHERE, Shape, ShapeField, bounding_box
from fogproof.validate import channel_count

Overlap = Literal["refused", "sum", "first"]
"""What counts where media overlap: nothing is said, all of them together, or the first that is there."""

MOST_MEDIA = 64


@dataclass(frozen=True, eq=False)
class CompositeMedium:
    """Media together in one space, with vacuum where none of them is.

    media    1 to 64 media, each with one phase function of its own
    shapes   what each of them fills, in the same order; everything unless given. A medium that ends by itself ends there as well
    overlap  "refused": media whose bounding boxes overlap are no scene until somebody says which counts; "sum": where several are,
             their coefficients add up, and the phase function is the mean weighted by sigma_s; "first": the first of the list
             counts, as the inner of nested media does if it stands first
    """

    media: tuple[Annotated[Any, ByKind("fogproof.scene.media", default="homogeneous")], ...]
    shapes: tuple[ShapeField, ...] = ()
    overlap: Overlap = "refused"

    def __post_init__(self) -> None:
        media, shapes = self.media, self.shapes
        if not isinstance(media, tuple | list) or not 1 <= len(media) <= MOST_MEDIA:
            raise InvalidValueError("media", f"must be a list of 1 to {MOST_MEDIA} media", media)
        for one in media:
            if not all(hasattr(one, name) for name in ("channels", "albedo", "phase", "emission")):
                raise InvalidValueError("media", "must be a list of media", one, "for example [Medium(0.1, 0.9)]")
            if hasattr(one, "media"):
                raise UnsupportedError("a composite medium holds none: list all media in one", "media")
            require_phase("media.phase", one.phase, "must be one phase function in each of several media")
        shapes = tuple(shapes) or (EVERYWHERE,) * len(media)
        if len(shapes) != len(media) or not all(isinstance(shape, Shape) for shape in shapes):
            raise InvalidValueError("shapes", "must be one shape a medium, or none", list(shapes))
        if self.overlap not in get_args(Overlap):
            raise InvalidValueError("overlap", f"must be one of {', '.join(get_args(Overlap))}", self.overlap)
        object.__setattr__(self, "media", tuple(media))
        object.__setattr__(self, "shapes", shapes)
        if self.overlap == "refused":
            self._require_apart()
        _ = self.channels

    def _require_apart(self) -> None:
        boxes = [self._box(i) for i in range(len(self.media))]
        for i, (low, high) in enumerate(boxes):
            for j, (other_low, other_high) in enumerate(boxes[:i]):
                if np.all(np.maximum(low, other_low) < np.minimum(high, other_high)):
                    fix = "say overlap='sum' or overlap='first'"
                    raise InvalidValueError(
                        "overlap", "must say what counts where media overlap", f"media {j} and {i}", fix
                    )

    def _box(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the corners of a box around one of the media [m]."""
        low, high = bounding_box(self.shapes[i])
        medium = self.media[i]
        return (
            np.maximum(low, getattr(medium, "lower", (-np.inf,) * 3)),
            np.minimum(high, getattr(medium, "upper", (np.inf,) * 3)),
        )

    @property
    def lower(self) -> np.ndarray:
        """Corner of a box around all media [m]; infinite where they have no end."""
        corner: np.ndarray = np.min([self._box(i)[0] for i in range(len(self.media))], axis=0)
        return corner

    @property
    def upper(self) -> np.ndarray:
        """The opposite corner [m]."""
        corner: np.ndarray = np.max([self._box(i)[1] for i in range(len(self.media))], axis=0)
        return corner

    @property
    def phase(self) -> PhaseFunction | PhaseOfMedia:
        """The phase function, if all media have the same; else the mean of theirs weighted by what scatters at a place."""
        first: PhaseFunction = self.media[0].phase
        return first if all(one.phase == first for one in self.media) else PhaseOfMedia(self)

    @property
    def albedo(self) -> Any:
        """The albedo if all media have one and the same; else all there are in any of them."""
        return self._constant("albedo")

    @property
    def emission(self) -> Any:
        """As the albedo."""
        return self._constant("emission")

    def _constant(self, name: str) -> Any:
        values = [getattr(one, name) for one in self.media]
        if not self.sources_vary:
            return values[0]
        return np.concatenate([np.ravel(1.0 if callable(value) else value) for value in values])

    @property
    def sources_vary(self) -> bool:
        """Whether albedo or emission differ from place to place."""
        if any(getattr(one, "sources_vary", False) for one in self.media):
            return True
        first = self.media[0]
        return not all(
            np.array_equal(getattr(one, name), getattr(first, name))
            for one in self.media
            for name in ("albedo", "emission")
        )

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return all(getattr(one, "is_empty", False) for one in self.media)

    @property
    def channels(self) -> int | None:
        """How many channels the media have together; None if all are grey."""
        return channel_count(
            **{f"media_{i}": (0.0,) * one.channels if one.channels else 0.0 for i, one in enumerate(self.media)}
        )

    def channel(self, c: int) -> CompositeMedium:
        """Return the grey medium that channel c sees."""
        from fogproof.scene.media import medium_of_channel

        return replace(self, media=tuple(medium_of_channel(one, c) for one in self.media))
