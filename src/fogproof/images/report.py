"""The record, the maps and the page of a comparison, in a folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.errors import NotInstalledError
from fogproof.images.formats import format_of
from fogproof.images.judging import ImageComparison
from fogproof.images.maps import REACH, maps, picture_png, z_png
from fogproof.reports.charts.p_values import FEWEST, PValueHistogram
from fogproof.reports.charts.pictures import render
from fogproof.reports.files import write_picture
from fogproof.reports.pages.images import write_image_page
from fogproof.whole_files import write_file

WRITTEN = (
    "index.html",
    "results.json",
    "maps.exr",
    "maps.npy",
    *(f"figures/{name}.png" for name in ("image", "reference", "z-map", "p-values")),
    "figures/p-values.svg",
)
"""The files of a comparison."""

WORST = 8
"""Tiles that are listed."""


def record_of(done: ImageComparison) -> dict[str, Any]:
    """Return a comparison, JSON-ready."""
    scene = done.scene
    return {
        "format": "fogproof-image-1",
        "images": list(done.picture.paths),
        "purpose": scene.purpose if scene else "",
        "pixels": [done.found.good.shape[1], done.found.good.shape[0], done.found.difference.shape[2]],
        "ratios": [
            {
                "channel": name,
                "ratio": ratio,
                "low": interval.low,
                "high": interval.high,
                "confidence": interval.confidence,
            }
            for name, ratio, interval in done.ratios
        ],
        "dependence": done.dependence.kind,
        "verdict": done.verdict.to_dict(),
    }


def write_comparison(done: ImageComparison, folder: Path) -> Path:
    """Write results.json, z-map and p-values as PNG and EXR, and the page; return the page's path."""
    found = maps(done.picture, done.found)
    record = record_of(done) | {
        "worst_tiles": [vars(tile) for tile in found.tiles[:WORST]],
    }
    image = np.nan_to_num(done.picture.value)
    reference = done.found.reference
    top = float(np.quantile(reference, 0.99)) or float(np.max(image))
    pictures = {
        "image": picture_png(image, top),
        "reference": picture_png(reference, top),
        "z-map": z_png(found.z),
    }
    p_values = render(PValueHistogram(found.p_values), "p-values") if len(found.p_values) >= FEWEST else None
    if p_values is not None:
        record["p_values"] = p_values.words
    # the record comes first: by it the other files are known as ours, wherever this is stopped
    write_file(folder / "results.json", json.dumps(record | {"tiles": list(found.p_values)}, indent=1))
    if p_values is not None:
        p_values.save(folder / "figures")
    for name, content in pictures.items():
        write_picture(folder / "figures" / f"{name}.png", content)
    names = done.picture.names
    layers = {f"z.{name}": found.z[..., c] for c, name in enumerate(names)}
    layers |= {f"ratio.{name}": found.ratio[..., c] for c, name in enumerate(names)}
    layers |= {f"reference.{name}": reference[..., c] for c, name in enumerate(names)}
    try:
        format_of("maps.exr").write(folder / "maps.exr", layers)
    except NotInstalledError:
        format_of("maps.npy").write(folder / "maps.npy", layers)
    known = done.verdict.resolution if done.verdict.outcome == "not rejected" else None
    said = str(known) if known else ""
    return write_image_page(record, pictures, folder, reach=REACH, resolution=said, p_values=p_values)
