"""Maps of a comparison: where an image is off, in standard deviations and as a ratio, and how p-values of tiles are spread."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np

from fogproof.checks.statistics.tails import student_two_sided
from fogproof.images.picture import RenderedImage
from fogproof.images.residuals import Residuals

SIDE = 8
"""Pixels along a tile."""

REACH = 5.0
"""Standard deviations at which the colours of a z-map end."""


@dataclass(frozen=True)
class Tile:
    """A square of pixels: its upper left corner, its size, how far it is off in standard deviations, and its mean ratio."""

    row: int
    column: int
    rows: int
    columns: int
    z: float
    ratio: float


@dataclass(frozen=True)
class Maps:
    """Maps over the film.

    z         (rows, columns, channels) difference / standard deviation of each pixel: as stated by variance layers or renders,
              else from the differences in its tile
    ratio     (rows, columns, channels) image / reference
    tiles     the worst first
    p_values  of all tiles: uniform for a right image, but for skewness
    """

    z: np.ndarray
    ratio: np.ndarray
    tiles: tuple[Tile, ...]
    p_values: tuple[float, ...]


def maps(picture: RenderedImage, found: Residuals) -> Maps:
    """Return the maps of a comparison."""
    d = found.difference
    rows, columns, channels = d.shape
    with np.errstate(all="ignore"):
        excess = np.sign(d) * np.maximum(np.abs(d) - found.allowed, 0.0)
        if picture.variance is not None:
            deviation = np.sqrt(picture.variance)
        elif len(picture.renders) > 1:
            deviation = picture.renders.std(axis=0, ddof=1) / np.sqrt(len(picture.renders))
        else:
            deviation = _local(d)
        z = np.where(excess == 0, 0.0, excess / deviation)
        ratio = np.where(found.reference != 0, (found.reference + d) / found.reference, np.where(d == 0, 1.0, np.inf))
    tiles, p_values = [], []
    for row in range(0, rows, SIDE):
        for column in range(0, columns, SIDE):
            part = (slice(row, row + SIDE), slice(column, column + SIDE))
            good = found.good[part]
            n = int(good.sum()) * channels
            if n < SIDE * SIDE // 2:
                continue
            gap, room = d[part][good].ravel(), float(np.mean(found.allowed[part][good]))
            mean, spread = float(np.mean(gap)), float(np.std(gap, ddof=1)) / np.sqrt(n)
            off = max(abs(mean) - room, 0.0)
            t = 0.0 if off == 0 else np.inf if spread == 0 else off / spread
            base = float(np.mean(found.reference[part][good]))
            height, width = good.shape
            tiles.append(
                Tile(row, column, height, width, float(np.copysign(t, mean)), 1 + mean / base if base else np.inf)
            )
            p_values.append(student_two_sided(n - 1, t))
    return Maps(z, ratio, tuple(sorted(tiles, key=lambda tile: -abs(tile.z))), tuple(p_values))


def _local(d: np.ndarray) -> np.ndarray:
    """Return the standard deviation of differences of neighbours around each pixel, over sqrt(2)."""
    from scipy.ndimage import uniform_filter

    square = np.zeros_like(d)
    square[:, 1:] += 0.25 * (d[:, 1:] - d[:, :-1]) ** 2
    square[1:] += 0.25 * (d[1:] - d[:-1]) ** 2
    return np.asarray(np.sqrt(np.maximum(uniform_filter(square, (SIDE, SIDE, 0), mode="nearest"), 0.0)))


def z_png(z: np.ndarray, least: int = 320) -> bytes:
    """Return the z-map as a PNG: blue too dark, red too bright, white right; channels beside each other, pixels as squares."""
    from PIL import Image

    from fogproof.reports.charts.colours import diverging

    steps = np.array([_rgb(diverging(x)) for x in np.linspace(-1, 1, 255)], np.uint8)
    clean = np.clip(np.nan_to_num(z, nan=0.0, posinf=REACH, neginf=-REACH) / REACH, -1, 1)
    side_by_side = np.concatenate([clean[..., c] for c in range(clean.shape[2])], axis=1)
    pixels = steps[np.round(127 * (side_by_side + 1)).astype(int)]
    times = max(1, -(-least // side_by_side.shape[1]))
    picture = Image.fromarray(np.repeat(np.repeat(pixels, times, axis=0), times, axis=1))
    out = io.BytesIO()
    picture.save(out, "PNG")
    return out.getvalue()


def picture_png(value: np.ndarray, top: float, least: int = 320) -> bytes:
    """Return linear pixels as an sRGB PNG; `top` becomes white."""
    from PIL import Image

    cut = np.clip(np.nan_to_num(value, nan=0.0, posinf=top) / (top or 1.0), 0, 1)
    encoded = np.where(cut <= 0.0031308, 12.92 * cut, 1.055 * cut ** (1 / 2.4) - 0.055)
    three = encoded if value.shape[2] == 3 else np.repeat(encoded[..., :1], 3, axis=2)
    pixels = np.round(255 * three).astype(np.uint8)
    times = max(1, -(-least // pixels.shape[1]))
    out = io.BytesIO()
    Image.fromarray(np.repeat(np.repeat(pixels, times, axis=0), times, axis=1)).save(out, "PNG")
    return out.getvalue()


def _rgb(colour: str) -> tuple[int, int, int]:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
