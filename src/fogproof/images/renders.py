"""Scenes rendered by somebody's program and compared, one after the other, resumable."""

from __future__ import annotations

import contextlib
import hashlib
import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogproof.errors import FogproofError
from fogproof.images.compare import compare_image
from fogproof.images.kept import IMAGES, RECORD, begin, keep, kept
from fogproof.images.report import WRITTEN as COMPARISON
from fogproof.images.report import write_comparison
from fogproof.images.scene_names import scene_names
from fogproof.renderers.running import RenderFailure, code_of, render_one
from fogproof.renderers.table import Renderer
from fogproof.reports.files import locked
from fogproof.reports.pages.images import write_renders_page
from fogproof.scene import ImageScene
from fogproof.scene.files import read_image_scene
from fogproof.scene.to_json import to_json
from fogproof.text import state, unfinished
from fogproof.whole_files import write_file

WRITTEN = (*COMPARISON, RECORD, "scene.json", *IMAGES)
"""The files of one scene, in its own folder."""


@dataclass(frozen=True)
class Wanted:
    """How scenes are rendered and compared.

    seconds  longest a render may take, or None
    python   the interpreter that has the renderer
    """

    renderer: Renderer
    samples: int
    seed: int
    tolerance: float
    alpha: float
    python: str
    seconds: float | None = None

    @property
    def values(self) -> dict[str, str]:
        """What the command is told besides the scene."""
        told = {"python": self.python, "samples": str(self.samples), "seed": str(self.seed), "threads": "0"}
        return told | {"integrator": self.renderer.integrators[0]}


def render_scenes(scenes: Sequence[Path], wanted: Wanted, folder: Path) -> Iterator[dict[str, Any]]:
    """Render and compare each scene, and yield its row as soon as it is known; what was done before is taken as it is.

    A row says "not rejected", "rejected", "inconclusive", "not rendered" (the renderer has no such thing) or "error", `kept`
    if nothing was rendered for it, and `unwritten` why files are not there, if any could not be written. The scenes' folders
    are kept from other runs to the end.
    """
    places = [folder / name for name in scene_names(scenes)]
    with contextlib.ExitStack() as held:
        for place in (known := {place for place in places if place.exists()}):
            held.enter_context(locked(place))
        for path, place in zip(scenes, places, strict=True):
            try:
                scene = read_image_scene(path)
                if place not in known:
                    place.mkdir(parents=True, exist_ok=True)
                    held.enter_context(locked(place))
                row = _kept_or_rendered(path, scene, wanted, place)
            except FogproofError as error:
                row = _row(path.stem, "error", str(error))
            except OSError as error:
                reason = f"{error.strerror or error}: {error.filename or place}"
                row = _row(path.stem, "error", reason) | {"unwritten": [reason]}
            yield row


def _kept_or_rendered(path: Path, scene: ImageScene, wanted: Wanted, place: Path) -> dict[str, Any]:
    """Return a scene's row; what an earlier run has kept is made again as far as it is missing or changed."""
    source = json.dumps(to_json(scene), indent=1)
    key = _key(source, wanted)
    before = kept(place, key)
    if before is not None and not before.changed:
        return {**before.row, "kept": True}
    if before is not None and before.image is not None:
        row = _compare(path, before.image, scene, wanted, place) | {"seconds": before.row["seconds"]}
        with _noted(row):
            write_file(place / "scene.json", source)
        _keep(place, key, row)
        return {**row, "kept": True}
    started = time.perf_counter()
    row = _row(path.stem, "error", "the scene could not be written, and was not rendered")
    with _noted(row):
        begin(place, key)
        write_file(place / "scene.json", source)
    if "unwritten" in row:
        return row
    row = _render(path, scene, wanted, place)
    row["seconds"] = f"{time.perf_counter() - started:.1f}"
    _keep(place, key, row)
    return row


@contextlib.contextmanager
def _noted(row: dict[str, Any]) -> Iterator[None]:
    """Write files of a row in this block: if one cannot be, the row says so, and stays."""
    try:
        yield
    except (FogproofError, OSError) as error:
        row.setdefault("unwritten", []).append(str(error))


def _keep(place: Path, key: str, row: dict[str, Any]) -> None:
    """Keep a row whose files are all there; any other is made again by the next run."""
    if "unwritten" not in row:
        with _noted(row):
            keep(place, key, row, WRITTEN)


def write_page(rows: Sequence[dict[str, Any]], wanted: Wanted, folder: Path, asked: int = 0) -> Path:
    """Write the page of all rows so far and their record; `asked` is how many there will be, as many as there are by default."""
    title = unfinished(len(rows), asked)
    record: dict[str, Any] = {"format": "fogproof-renders-1", "renderer": wanted.renderer.name}
    record |= {"state": state(title), "title": title, "rows": list(rows)}
    write_file(folder / "results.json", json.dumps(record, indent=1))
    return write_renders_page(rows, wanted.renderer.name, folder, title)


def _key(source: str, wanted: Wanted) -> str:
    """Return what a row depends on, as a digest; a script that the command names is part of it."""
    parts = [source.encode(), json.dumps([wanted.tolerance, wanted.alpha]).encode()]
    parts += code_of(wanted.renderer, wanted.values)
    return hashlib.blake2b(b"\0".join(parts), digest_size=16).hexdigest()


def _render(path: Path, scene: ImageScene, wanted: Wanted, place: Path) -> dict[str, Any]:
    out = render_one(wanted.renderer, place / "scene.json", place / "image.exr", wanted.values, wanted.seconds)
    if isinstance(out, RenderFailure):
        return _row(path.stem, "not rendered" if out.refused else "error", out.reason)
    return _compare(path, out, scene, wanted, place)


def _compare(path: Path, image: Path, scene: ImageScene, wanted: Wanted, place: Path) -> dict[str, Any]:
    """Return the row of an image, and write its page."""
    try:
        done = compare_image([image], scene, tolerance=wanted.tolerance, alpha=wanted.alpha)
    except FogproofError as error:
        return _row(path.stem, "error", str(error))
    verdict = done.verdict
    resolution = "" if verdict.resolution is None else f"{verdict.resolution.value:.2g}"
    row = _row(path.stem, verdict.outcome, f"{verdict.cause}: {verdict.diagnosis}" if verdict.cause else "")
    told = [f"{ratio:.6g} ({interval.low:.6g} to {interval.high:.6g})" for _, ratio, interval in done.ratios]
    row |= {"ratio": ", ".join(told), "resolution": resolution}
    with _noted(row):
        row["page"] = f"{path.stem}/{write_comparison(done, place).name}"
    return row


def _row(scene: str, outcome: str, reason: str) -> dict[str, Any]:
    return {
        "scene": scene,
        "outcome": outcome,
        "reason": reason,
        "page": "",
        "ratio": "",
        "resolution": "",
        "seconds": "",
    }
