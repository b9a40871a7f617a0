"""Pictures of the theory, made by the functions that the checks prove: the oracle's curves, the estimators' points."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fogproof.checks.streams import batch_generator
from fogproof.errors import InvalidInputError, NotInstalledError, shorten, stop_behind
from fogproof.reports.charts.pictures import Picture
from fogproof.reports.gallery.airlight import FoggyScene, Glow, SamplesAroundALight
from fogproof.reports.gallery.errors import ErrorAgainstWork
from fogproof.reports.gallery.media import Fog, Transmittances, closed_media, tracked_media
from fogproof.reports.gallery.multiple import AerialView, Fire, Snow
from fogproof.reports.gallery.phase import Approximation, LinearPanel, PolarPanel, SphereSizes
from fogproof.reports.gallery.plots import Plot, render_plot
from fogproof.reports.gallery.sky import SkyAndSunset
from fogproof.reports.gallery.tracking import Collisions
from fogproof.reports.pages.templates import fill
from fogproof.text import state, unfinished
from fogproof.whole_files import write_file


def drawings(seed: int) -> dict[str, tuple[str, Plot]]:
    """Return file name -> (title, drawing); each draws from a random stream of its own."""

    def stream(name: str) -> np.random.Generator:
        return batch_generator(seed, f"gallery/{name}", 0, 0)

    return {
        "phase-polar": ("Phase functions", PolarPanel()),
        "phase-henyey-greenstein": ("Henyey-Greenstein, sampled", LinearPanel(stream("linear"))),
        "phase-schlick": ("Henyey-Greenstein and Schlick", Approximation()),
        "phase-mie": ("Lorenz-Mie at three sizes", SphereSizes()),
        "transmittance": ("Transmittance in closed form", Transmittances(stream("closed"), closed_media())),
        "transmittance-tracked": ("Transmittance by tracking", Transmittances(stream("tracked"), tracked_media())),
        "delta-tracking": ("Delta tracking's collisions", Collisions(stream("collisions"))),
        "fog": ("Fog over distance", Fog(stream("fog"))),
        "foggy-scene": ("A scene in fog", FoggyScene()),
        "samples-around-a-light": ("Samples around a light", SamplesAroundALight(stream("samples"))),
        "error-against-work": ("Error against work", ErrorAgainstWork(stream("errors"))),
        "glow": ("The glow of a light", Glow(stream("glow"))),
        "snow": ("Snow is white: multiple scattering", Snow(stream("snow"))),
        "fire": ("Fire", Fire(stream("fire"))),
        "aerial-view": ("Aerial view", AerialView(stream("aerial"))),
        "sky-and-sunset": ("Blue sky, red sunset", SkyAndSunset(stream("sky"))),
    }


def write_gallery(folder: str | Path, seed: int = 0, names: Sequence[str] = ()) -> Path:
    """Write `folder/gallery.html`, its pictures as `folder/figures/*.png` and `*.svg`, and `gallery.json`; return the page's path.

    KeyboardInterrupt goes on after what has been drawn is written.

    names  which pictures to draw, all for none
    """
    folder = Path(folder)
    known = drawings(seed)
    for name in names:
        if name not in known:
            raise InvalidInputError(f"no picture is called {shorten(name)}; known are {', '.join(known)}", name)
    pictures: list[tuple[str, Picture, str]] = []
    missing: list[tuple[str, str]] = []
    asked = [name for name in known if not names or name in names]
    stopped: BaseException | None = None
    try:
        for name in asked:
            title, drawing = known[name]
            try:
                picture = render_plot(drawing, name)
            except NotInstalledError as error:
                if names:  # it was asked for
                    raise
                missing.append((title, str(error)))
                continue
            picture.save(folder / "figures")
            pictures.append((title, picture, f"fogproof gallery {name} -o DIR --seed {seed}"))
    except BaseException as error:
        stopped = stop_behind(error)
        if stopped is None:
            raise
    part = unfinished(len(pictures), len(asked) - len(missing), stopped is not None)
    record = {
        "schema": "fogproof/gallery/1",
        "seed": seed,
        "state": state(stopped),
        "title": part,
        "pictures": [
            {"name": picture.stem, "title": title, "words": picture.words, "reproduce": command}
            for title, picture, command in pictures
        ],
        "missing": [{"title": title, "reason": reason} for title, reason in missing],
    }
    write_file(folder / "gallery.json", json.dumps(record, indent=1) + "\n")
    page = fill(
        "gallery.html",
        kind="gallery",
        pictures=pictures,
        missing=missing,
        headline=(
            f"{part} pictures" if part else "Light in fog, in pictures",
            f"{len(pictures)} pictures, seed {seed}",
        ),
        tone="plain",
    )
    path = write_file(folder / "gallery.html", page)
    if stopped is not None:
        raise stopped
    return path
