"""Images as they come: channels chosen by name, pixels in double precision, and what storage alone has rounded away."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fogproof.errors import InvalidInputError
from fogproof.images.formats import format_of
from fogproof.scene.cameras import Film

LARGEST = 1e70
"""Values that are larger are none: their fourth powers are no numbers."""
_TOLD = 8
"""Channels that are named where more are left out."""
ORDERS = (("R", "G", "B"), ("Y",), ("V",), ("L",), ("C0", "C1", "C2"))


@dataclass(frozen=True)
class RenderedImage:
    """One or several independent renders of an image.

    renders   (n, rows, columns, channels) pixels
    variance  (rows, columns, channels) of the mean of the renders' pixels as the file states it, or None
    rounding  relative error of storing a number: half a unit in the last place; and the smallest step near 0
    names     of the channels
    paths     of the files
    notes     in words, what of the files is not looked at
    """

    renders: np.ndarray
    variance: np.ndarray | None
    rounding: tuple[float, float]
    names: tuple[str, ...]
    paths: tuple[str, ...]
    notes: tuple[str, ...] = ()

    @property
    def value(self) -> np.ndarray:
        """Mean of the renders, (rows, columns, channels)."""
        mean: np.ndarray = self.renders[0] if len(self.renders) == 1 else self.renders.mean(axis=0)
        return mean


def read_picture(
    paths: Sequence[str | Path], film: Film | None, channels: int | None, layer: str = "", samples: int | None = None
) -> RenderedImage:
    """Read one image, or several independent renders of it.

    film      the film it must have, or None; an image of the whole film is cropped
    channels  how many channels the scene has; None: grey, and a coloured image is taken channel by channel
    layer     name before the channels in files of several layers
    samples   samples a pixel, where variance layers hold that of one sample (as pbrt's do); None: that of the pixel's mean
    """
    parts: list[np.ndarray] = []
    variances: list[np.ndarray] = []
    roundings: list[tuple[float, float]] = []
    names: tuple[str, ...] = ()
    notes: dict[str, None] = {}
    for path in map(Path, paths):
        found = format_of(path).read(path)
        own = _names(path, found, channels, layer)
        if names and own != names:
            raise InvalidInputError(
                f"{path}: has channels {', '.join(own)}; {paths[0]} has {', '.join(names)}", str(path)
            )
        names = own
        kinds = {found[name].dtype for name in own}
        if any(kind.kind in "iub" for kind in kinds):
            what = f"holds {', '.join(sorted(str(kind) for kind in kinds))}; 8-bit and tone-mapped pixels cannot be compared"
            raise InvalidInputError(f"{path}: {what}: write linear radiance as floats", str(path))
        value = _framed(path, np.stack([found[name] for name in own], axis=-1), film)
        if parts and value.shape != parts[0].shape:
            raise InvalidInputError(f"{path}: {_size(value)}; {paths[0]} has {_size(parts[0])}", str(path))
        roundings.append(max(_rounding(kind) for kind in kinds))
        layers = [_variance_name(found, name) for name in own]
        if all(layers):
            variance = np.stack([found[name] for name in layers if name], axis=-1).astype(np.float64)
            if np.all(variance >= 0):
                variances.append(_framed(path, variance, film) / (samples or 1))
            else:
                wrong = np.count_nonzero(~(variance >= 0))
                notes[f"{path}: {wrong} values of its variance layers are negative or NaN: they are not used"] = None
        if beside := [name for name in found if name not in own and name not in layers]:
            notes[f"channels that are not looked at: {_listed(beside)}"] = None
        value = value.astype(np.float64)
        huge = np.isfinite(value) & (np.abs(value) > LARGEST)
        if huge.any():
            notes[f"{path}: {np.count_nonzero(huge)} values beyond {LARGEST:g} count as infinite"] = None
            value[huge] = np.inf
        parts.append(value)
    renders = np.stack(parts)
    copies = renders.shape[-1] > 1 and channels is None and (renders == renders[..., :1])[np.isfinite(renders)].all()
    if copies:  # a grey scene rendered in colour: one channel says it all
        renders, names = renders[..., :1], names[:1]
    stated = None
    if len(variances) == len(parts):
        stated = np.mean(variances, axis=0)[..., : renders.shape[-1]] / len(parts)
    return RenderedImage(renders, stated, max(roundings), names, tuple(map(str, paths)), tuple(notes))


def _names(path: Path, found: dict[str, np.ndarray], channels: int | None, layer: str) -> tuple[str, ...]:
    """Return the names of the channels that hold the image."""
    if layer:
        found = {name.removeprefix(f"{layer}."): found[name] for name in found if name.startswith(f"{layer}.")}
        if not found:
            raise InvalidInputError(f"{path}: has no layer {layer!r}", str(path))
    beside = re.compile(r"(?i)(^|\.)(variance|error|a|alpha|z|depth|id)(\.|$)|^m2_")
    names = [name for name in found if not beside.search(name)]
    for order in ORDERS:
        prefixes = sorted(
            {name[: -len(order[0])] for name in names if name.endswith(order[0])}, key=lambda p: (len(p), p)
        )
        for prefix in prefixes:
            wanted = tuple(prefix + one for one in order)
            whole = (not prefix or prefix.endswith(".")) and all(one in names for one in wanted)
            if whole and (channels is None or len(wanted) == channels):
                return tuple(f"{layer}.{one}" if layer else one for one in wanted)
    if channels is not None and len(names) == channels:
        return tuple(f"{layer}.{one}" if layer else one for one in sorted(names, key=_by_number))
    needed = f"the scene has {channels} channels" if channels else "an image has Y, or R, G and B"
    raise InvalidInputError(f"{path}: has channels {_listed(found) or 'none'}; {needed}", str(path))


def _by_number(name: str) -> list[tuple[int, str]]:
    """Return a key by which C10 comes after C2."""
    return [
        (int(part), "") if part.isdigit() and part.isascii() else (-1, part) for part in re.split(r"([0-9]+)", name)
    ]


def _listed(names: Iterable[str]) -> str:
    ordered = sorted(names, key=_by_number)
    more = f" and {len(ordered) - _TOLD} more" if len(ordered) > _TOLD else ""
    return ", ".join(ordered[:_TOLD]) + more


def _variance_name(found: dict[str, np.ndarray], name: str) -> str | None:
    prefix, _, last = name.rpartition(".")
    for candidate in (f"variance.{name}", f"Variance.{name}", f"{name}.variance", f"{prefix}.variance.{last}"):
        if candidate in found:
            return candidate
    return None


def _framed(path: Path, value: np.ndarray, film: Film | None) -> np.ndarray:
    """Return the part of an image that the film asks for, or say how the sizes differ."""
    if film is None or value.shape[:2] == film.shape:
        return value
    if value.shape[:2] == (film.height, film.width):
        x, y, width, height = film.window
        return value[y : y + height, x : x + width]
    wanted = f"the scene's film has {film.shape[1]} x {film.shape[0]}"
    turned = "; rows and columns are exchanged" if value.shape[1::-1] == film.shape else ""
    raise InvalidInputError(f"{path}: {_size(value)}, {wanted}{turned}", str(path))


def _size(value: np.ndarray) -> str:
    return f"{value.shape[1]} x {value.shape[0]} pixels"


def _rounding(kind: np.dtype) -> tuple[float, float]:
    info = np.finfo(kind)
    return float(info.eps) / 2, float(info.smallest_subnormal)
