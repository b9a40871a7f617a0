"""The pixels of a sheet."""

from __future__ import annotations

import importlib.util
import io
from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING

from fogproof.reports.charts.sheet import Dots, Group, Mark, Outline, Points, Sheet, Words
from fogproof.text import visible

if TYPE_CHECKING:
    from PIL import Image, ImageFont

SCALE = 1.5
"""Pixels of the picture for each of the sheet."""
_FINER = 2
"""Shapes are drawn this much larger and made smaller again, which smooths their edges."""


def png(sheet: Sheet) -> bytes:
    """Return the sheet as a PNG file; equal sheets give equal bytes."""
    from PIL import Image

    scale = SCALE * _FINER
    image = Image.new("RGB", (round(sheet.width * scale), round(sheet.height * scale)), sheet.paper)
    _draw(image, sheet.shapes, scale)
    image = image.reduce(_FINER)
    for shape in sheet.shapes:
        for words in shape.shapes if isinstance(shape, Group) else [shape]:
            if isinstance(words, Words):
                _write(image, words)
    out = io.BytesIO()
    image.quantize(128, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(out, "PNG", compress_level=3)
    return out.getvalue()


def text_width(text: str, size: float) -> float:
    """Return the width of a line of text [px]."""
    return float(_font(size).getlength(visible(text)))


def _draw(image: Image.Image, shapes: Sequence[Mark | Group], scale: float, corner: tuple[int, int] = (0, 0)) -> None:
    """Draw on an image whose upper left corner lies at `corner` [pixels] of the sheet."""
    from PIL import ImageDraw

    pens = ImageDraw.Draw(image), ImageDraw.Draw(image, "RGBA")  # the second mixes colours, at a price

    def places(points: Points) -> list[tuple[float, float]]:
        return [(scale * x - corner[0], scale * y - corner[1]) for x, y in points]

    for shape in shapes:
        match shape:
            case Group(box, inside):
                x, y, width, height = (round(scale * value) for value in box)
                part = image.crop((x, y, x + width, y + height))
                _draw(part, inside, scale, (x, y))
                image.paste(part, (x, y))
            case Dots(at, colour, radius):
                for a, b in places(at):
                    r = scale * radius
                    pens[0].ellipse((a - r, b - r, a + r, b + r), colour)
            case Outline():
                pen = pens[shape.opacity < 1]
                alpha = f"{round(255 * shape.opacity):02x}" if shape.opacity < 1 else ""
                for points in shape.paths:
                    line = places(points)
                    if shape.crisp:  # a cell: its first and third corner are opposite
                        (a, b), (c, d) = line[0], line[2]
                        pen.rectangle((min(a, c), min(b, d), max(a, c), max(b, d)), shape.fill)
                    elif shape.fill and len(line) > 2:
                        pen.polygon(line, fill=shape.fill + alpha)
                    if shape.stroke:
                        thick = max(round(scale * shape.width), 1)
                        for piece in _dashes(line, [scale * part for part in shape.dash]) if shape.dash else [line]:
                            pen.line(piece, shape.stroke + alpha, thick)


def _dashes(points: Points, dash: list[float]) -> list[Points]:
    """Return the pieces of the line through `points` that a pattern (on, off) leaves."""
    pieces: list[Points] = []
    done, left, drawing = [points[0]], dash[0], True
    for (x, y), (a, b) in pairwise(points):
        length = hypot(a - x, b - y)
        at = 0.0
        while length - at > left:
            at += left
            corner = (x + (a - x) * at / length, y + (b - y) * at / length)
            if drawing:
                pieces.append([*done, corner])
            done, drawing = [corner], not drawing
            left = dash[not drawing]
        left -= length - at
        done.append((a, b))
    return [*pieces, done] if drawing and len(done) > 1 else pieces


def _write(image: Image.Image, words: Words) -> None:
    from PIL import Image, ImageDraw

    font = _font(words.size * SCALE)
    anchor = {"start": "ls", "middle": "ms", "end": "rs"}[words.anchor]
    at = (words.x * SCALE, words.y * SCALE)
    if not words.turned:
        ImageDraw.Draw(image).text(at, visible(words.text), words.colour, font, anchor)
        return
    room = int(2 * font.size)
    ink = Image.new("L", (image.height, room))  # a strip of the sheet, turned: up is right
    ImageDraw.Draw(ink).text((image.height - at[1], 1.5 * font.size), visible(words.text), 255, font, anchor)
    image.paste(words.colour, (round(at[0] - 1.5 * font.size), 0), ink.transpose(Image.Transpose.ROTATE_90))


@cache
def _font(size: float) -> ImageFont.FreeTypeFont:
    """Return DejaVu Sans, which comes with matplotlib; asking for its place does not load that library."""
    from PIL import ImageFont

    found = importlib.util.find_spec("matplotlib")
    assert found is not None
    assert found.origin is not None
    return ImageFont.truetype(
        str(Path(found.origin).parent / "mpl-data/fonts/ttf/DejaVuSans.ttf"), size
    )  # older ones take no Path
