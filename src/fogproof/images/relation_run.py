"""Relations of scenes by somebody's program, one after the other, resumable: what was rendered is not rendered again."""

from __future__ import annotations

import contextlib
import fnmatch
import hashlib
import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.errors import FogproofError, InvalidInputError, SubjectError, UnsupportedError
from fogproof.images.battery import Battery, ImageRelation, Render, image_relations, planned
from fogproof.images.kept import digest_of
from fogproof.images.picture import read_picture
from fogproof.relations import Comparison, ImageSetting
from fogproof.renderers.running import RenderFailure, code_of, render_one
from fogproof.renderers.table import Renderer
from fogproof.reports.files import prepare_folder
from fogproof.reports.pages.images import write_relations_page
from fogproof.scene import ImageScene
from fogproof.scene.files import read_image_scene
from fogproof.scene.to_json import to_json
from fogproof.text import state, unfinished
from fogproof.whole_files import write_file


@dataclass(frozen=True)
class RelationRun:
    """How a program is asked for relations.

    alpha        false-alarm probability of the whole run, shared by its scenes
    integrators  its ways to render; the first is its usual one
    only         patterns of the names of relations that are wanted; all if empty
    seconds      longest a render may take, or None
    force        replace renders in the folder that are not ours
    """

    renderer: Renderer
    integrators: tuple[str, ...]
    samples: int
    renders: int
    seed: int
    tolerance: float
    alpha: float
    python: str
    only: tuple[str, ...] = ()
    oracle: bool = True
    seconds: float | None = None
    force: bool = False


def run_relations(scenes: Sequence[Path], run: RelationRun, folder: Path) -> Iterator[dict[str, Any]]:
    """Yield a row for each relation of each scene as soon as it is known.

    Outcomes are "not rejected", "rejected", "inconclusive", "not rendered" (the renderer has no such thing) and "error".
    `unwritten` says why files of a row are not there, if any could not be written.
    """
    for path in scenes:
        try:
            scene = read_image_scene(path)
        except FogproofError as error:
            yield _row(path.stem, "", "", "error", str(error))
            continue
        commands = Commands(run, folder / path.stem / "renders")
        battery = _battery(commands.render, run, len(scenes))
        wanted = _wanted(scene, battery, run)
        started = time.perf_counter()
        for relation in image_relations(scene, battery, wanted) if wanted else ():
            row = _row_of(path.stem, relation, time.perf_counter() - started)
            if commands.unwritten:
                row["unwritten"] = [*commands.unwritten]
                commands.unwritten.clear()
            started = time.perf_counter()
            yield row


def relation_names(scenes: Sequence[Path], run: RelationRun) -> list[str]:
    """Return the names of the relations that a run will ask for, scene by scene."""
    battery = _battery(Commands(run, Path()).render, run, len(scenes))
    return [one.name for path in scenes for one in _wanted(read_image_scene(path), battery, run)]


def _battery(render: Render, run: RelationRun, scenes: int) -> Battery:
    return Battery(
        render,
        run.integrators,
        run.renderer.takes("threads"),
        run.renderer.takes("seed"),
        run.renders if run.renderer.takes("seed") else 1,
        tolerance=run.tolerance,
        alpha=run.alpha / scenes,
        oracle=run.oracle,
    )


def _wanted(scene: ImageScene, battery: Battery, run: RelationRun) -> list[Comparison]:
    return [
        one
        for one in planned(scene, battery)
        if not run.only or any(fnmatch.fnmatchcase(one.name, pattern) for pattern in run.only)
    ]


@dataclass(frozen=True)
class Commands:
    """Renders of one scene's settings by a command, kept in a folder.

    unwritten  why files were not written since the last relation
    """

    run: RelationRun
    folder: Path
    unwritten: list[str] = field(default_factory=list)

    def render(self, setting: ImageSetting, which: int) -> np.ndarray:
        """Return one of the independent renders of a setting, (rows, columns, channels)."""
        scene = json.dumps(to_json(setting.scene), indent=1)
        values = self._values(setting, scene, which)
        key = hashlib.blake2b(
            b"\0".join([scene.encode(), *code_of(self.run.renderer, values)]), digest_size=12
        ).hexdigest()
        out, done = self.folder / f"{key}.exr", self.folder / f"{key}.json"
        images = (out, out.with_name(f"{out.name}.npy"))
        told = {"format": "fogproof-render-1", **values}
        image = kept = next((one for one in images if _finished(done, one)), None)
        if image is None:
            source = self.folder / f"{key}.scene.json"
            try:
                prepare_folder(self.folder, tuple(one.name for one in (*images, done, source)), self.run.force)
                write_file(done, json.dumps(told | {"state": "unfinished"}))
                write_file(source, scene)
                found = render_one(self.run.renderer, source, out, values, self.run.seconds)
            except (FogproofError, OSError) as error:
                self.unwritten.append(str(error))
                raise
            if isinstance(found, RenderFailure):
                if found.refused:
                    raise UnsupportedError(found.reason, "scene")
                raise SubjectError(found.reason)
            image = found
        picture = read_picture([image], setting.scene.camera.film, setting.scene.channels)
        if kept is None:  # only what is whole, and can be read, is taken up again
            try:
                write_file(done, json.dumps(told | {"state": "finished", "digest": digest_of(image)}))
            except InvalidInputError as error:  # it is judged all the same, and rendered again by the next run
                self.unwritten.append(str(error))
        return np.asarray(picture.renders[0])

    def _values(self, setting: ImageSetting, scene: str, which: int) -> dict[str, str]:
        """Return what the command is told: a seed of its own for each render, whatever else is rendered."""
        run = self.run
        what = json.dumps([run.seed, scene, setting.integrator, setting.threads, setting.more, setting.copy, which])
        seed = int.from_bytes(hashlib.blake2b(what.encode(), digest_size=4).digest(), "big") >> 1
        return {
            "python": run.python,
            "samples": str(run.samples * setting.more),
            "seed": str(seed),
            "threads": str(setting.threads),
            "integrator": setting.integrator,
        }


def _finished(done: Path, image: Path) -> bool:
    """Return whether an image is there as the record of its render says."""
    with contextlib.suppress(OSError, ValueError):
        told = json.loads(done.read_bytes())
        return isinstance(told, dict) and told.get("state") == "finished" and told.get("digest") == digest_of(image)
    return False


def write_record(
    rows: Sequence[dict[str, Any]], run: RelationRun, folder: Path, asked: int = 0, whole: bool = True
) -> Path:
    """Write the record of all rows so far and the page; return the page's path.

    asked  how many rows there will be
    whole  whether no more will come
    """
    title = "" if whole else unfinished(len(rows), max(asked, len(rows)), True)
    record = {
        "format": "fogproof-relations-1",
        "state": state(title),
        "title": title,
        "renderer": run.renderer.name,
        "integrators": list(run.integrators),
        "samples": run.samples,
        "renders": run.renders,
        "seed": run.seed,
        "tolerance": run.tolerance,
        "alpha": run.alpha,
        "rows": list(rows),
    }
    write_file(folder / "results.json", json.dumps(record, indent=1))
    return write_relations_page(rows, run.renderer.name, folder, title)


def _row_of(scene: str, relation: ImageRelation, seconds: float) -> dict[str, Any]:
    row = _row(scene, relation.name, relation.isolates, relation.outcome, relation.reason)
    row |= {"first": relation.first, "second": relation.second, "seconds": f"{seconds:.1f}"}
    verdict = relation.verdict
    if verdict is None:
        return row
    rejected = [finding for finding in verdict.findings if finding.outcome == "rejected"]
    effects = [finding.effect for finding in verdict.findings if finding.effect is not None]
    if effects and verdict.outcome != "inconclusive":
        row["difference"] = f"{(rejected[0].effect if rejected else effects[0]) or 0.0:+.2g}"
    if verdict.resolution is not None:
        row["resolution"] = f"{verdict.resolution.value:.2g}"
    if rejected:
        row["message"] = f"{rejected[0].check}: {rejected[0].message}"
    elif verdict.outcome == "inconclusive":
        row["message"] = next((one.message for one in verdict.findings if one.outcome == "inconclusive"), "")
    row["p_value"] = verdict.p_value
    return row


def _row(scene: str, relation: str, isolates: str, outcome: str, reason: str) -> dict[str, Any]:
    return {
        "scene": scene,
        "relation": relation,
        "isolates": isolates,
        "outcome": outcome,
        "reason": reason,
        "first": "",
        "second": "",
        "difference": "",
        "resolution": "",
        "message": "",
        "p_value": None,
        "seconds": "",
    }
