"""The film: how many pixels an image has, and which of them are rendered."""

from __future__ import annotations

from dataclasses import dataclass

from fogproof.errors import InvalidValueError

LARGEST = 1 << 14
"""Pixels along a side, at most."""


@dataclass(frozen=True)
class Film:
    """The pixels of an image.

    width, height  of the whole film, in pixels
    crop           (x, y, width, height) of the part that is rendered, from the upper left corner, in pixels; None: all of it
    """

    width: int
    height: int
    crop: tuple[int, int, int, int] | None = None

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            _whole(name, getattr(self, name), 1, LARGEST)
        if self.crop is not None:
            crop = tuple(self.crop)
            if len(crop) != 4:
                raise InvalidValueError("crop", "must be [x, y, width, height] in pixels", self.crop)
            x, y, width, height = (_whole("crop", value, 0, LARGEST) for value in crop)
            if width < 1 or height < 1 or x + width > self.width or y + height > self.height:
                rule = f"must be [x, y, width, height] inside the film of {self.width} x {self.height} pixels"
                raise InvalidValueError("crop", rule, list(crop))
            object.__setattr__(self, "crop", crop)

    @property
    def window(self) -> tuple[int, int, int, int]:
        """The part that is rendered: (x, y, width, height)."""
        return self.crop or (0, 0, self.width, self.height)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the image."""
        return self.window[3], self.window[2]


def _whole(name: str, value: object, low: int, high: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidValueError(name, f"must be a whole number of pixels in [{low}, {high}]", value)
    return value
