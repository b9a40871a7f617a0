"""The record of a study, `results.json`, and its table, `results.csv`, with one row a count."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogproof.checks.json_values import jsonable
from fogproof.errors import InvalidInputError, shorten
from fogproof.input_files import parse_json, read_text
from fogproof.plan import plan
from fogproof.scene import Scattering, Scene
from fogproof.study.aggregate import levels_of
from fogproof.study.cells import Cell
from fogproof.study.convergence import CONFIDENCE
from fogproof.study.environment import environment
from fogproof.study.files import Study, StudyScene
from fogproof.study.judgement import tests_of
from fogproof.study.measures import Measured, measure
from fogproof.study.plan import Batch, Batches
from fogproof.study.question import UNITS
from fogproof.study.ranking import ranked
from fogproof.study.stored_batches import Store
from fogproof.text import state
from fogproof.verify import SCHEMA


@dataclass(frozen=True)
class Circumstances:
    """What a record says of the run and not of the estimators."""

    command: str
    started: str
    seconds: float
    executor: str
    workers: int
    interrupted: bool = False


def make_record(
    study: Study, cells: Sequence[Cell], batches: Batches, store: Store, run: Circumstances
) -> dict[str, Any]:
    """Return the JSON-ready record of what is in the store.

    "digest" sums up all that no clock has touched: it is the same wherever, and however often interrupted, the draws were made. It
    holds what this version's oracle and checks say of them as well: where those became stricter, equal draws have another digest,
    and the comparison of two runs looks at their moments (`history`).
    """
    levels = levels_of(store.rows(), cells, batches)
    alpha = study.alpha / max(1, sum(map(tests_of, cells)))
    failed: dict[int, int] = {}
    for index, *_ in store.failures():
        batch = batches[index]
        failed[batch.cell] = min(batch.size, failed.get(batch.cell, batch.size))
    measured: list[Measured] = []
    for cell in cells:  # random points stand right before their Sobol twin
        twin = measured[-1] if cell.points == "sobol" else None
        own = measure(cell, levels[cell.index], alpha, twin, failed.get(cell.index, 0))
        if twin is not None and own.status == "rejected" and not twin.judged.wrong:
            measured[-1] = measure(twin.cell, levels[twin.cell.index], alpha, own, twin.failed)
        measured.append(own)
    scenes = [_scene(number, study, measured) for number in range(len(study.scenes))]
    failures = [_failure(row, cells, batches) for row in store.failures()]
    done = len(store.done())
    sessions = [{"started": started, "environment": json.loads(text)} for started, text in store.sessions()]
    answers = [
        {"question": scene["question"], "scene": scene["name"], **{k: scene["answer"][k] for k in _ANSWER}}
        for scene in scenes
        if scene["question"]
    ]
    table: dict[str, Any] = jsonable(
        {
            "schema": SCHEMA,
            "kind": "study",
            "title": study.title,
            "fogproof": importlib.metadata.version("fogproof"),
            "environment": environment(),
            "command": run.command,
            "started": run.started,
            "seconds": run.seconds,
            "executor": run.executor,
            "workers": run.workers,
            "exit_code": exit_code(measured, bool(failures), done < len(batches)),
            "state": state(run.interrupted),
            "fingerprint": study.fingerprint,
            "digest": _digest(scenes),
            "seed": study.seed,
            "alpha": study.alpha,
            "confidence": CONFIDENCE,
            "settings": {
                "samples": study.samples,
                "replicates": study.replicates,
                "batch": study.batch,
                "sobol": study.sobol,
                "sobol_samples": next((cell.counts for cell in cells if cell.points == "sobol"), ()),
            },
            "batches": {"planned": len(batches), "done": done, "failed": len(failures)},
            "advice": advice(study, measured),
            "cpu_seconds": sum(m.record["speed"]["cpu_total"] for m in measured if m.record["speed"]),
            "answers": answers,
            "scenes": scenes,
            "failures": failures,
            "sessions": sessions,
            "mixed_environments": len({json.dumps(session["environment"], sort_keys=True) for session in sessions}) > 1,
            "history": None,
        }
    )
    return table


_ANSWER = ("best", "best_unbiased", "text")


def exit_code(measured: Iterable[Measured], failed: bool, missing: bool) -> int:
    """Return 1 if something was rejected that ought to be right, or failed; 3 if a variance may be infinite or work is missing.

    What is merely not judged yet, for want of samples, is measured all the same.
    """
    measured = list(measured)
    if failed or any(m.status == "rejected" for m in measured):
        return 1
    return 3 if missing or any(m.status == "inconclusive" and m.judged.infinite for m in measured) else 0


def advice(study: Study, measured: Sequence[Measured]) -> str:
    """Return which key of the study to raise for what is not judged unbiased yet, "" if nothing is open."""
    waiting = [m for m in measured if m.status == "inconclusive" and m.cell.points == "random"]
    more = [m for m in waiting if m.judged.times_as_many > 1]
    alike = [m for m in more if m.record["moments"]["m2"] == 0]
    said = []
    for lack, why in _LACKING.items():
        some = [m for m in more if m not in alike and m.judged.lacks == lack]
        if some:
            times = max(m.judged.times_as_many for m in some)
            replicates, last = (math.ceil(times * n) for n in (study.replicates, study.samples[-1]))
            said.append(
                f"Not judged unbiased yet, {why}: {_names(some)}. Raise `replicates` to {replicates} at least, or the last of"
                f" `samples` to {last}; what is drawn already is kept."
            )
    if alike:
        said.append(
            f"Not judged unbiased, all realisations are alike and are not the reference: {_names(alike)}. What has `bounds`, or"
            " a `variance` of 0, is judged: without them, values too rare to be met may make up the difference."
        )
    heavy = [m for m in waiting if m.judged.lacks == "tail"]
    if heavy:
        said.append(
            f"Not judged unbiased yet, a tail so heavy that no number of samples may be enough: {_names(heavy)}. What has `bounds`"
            " is judged."
        )
    beyond = [m for m in waiting if m.judged.lacks == "range"]
    if beyond:
        said.append(
            f"Not judged, numbers so large or small that their powers leave binary64: {_names(beyond)}. No key helps: choose a"
            " scene, or a unit, whose value is nearer to 1."
        )
    return " ".join(said)


_LACKING = {
    "samples": "too few samples",
    "law": "too few samples for so skewed values",
    "resolution": "too few samples to see an error as large as the reference",
    "calls": "too few replicates to tell whether realisations of one call depend on each other",
}


def _names(measured: Sequence[Measured]) -> str:
    return ", ".join(dict.fromkeys(f"{m.cell.scene.name} / {m.cell.name}" for m in measured))


def _scene(number: int, study: Study, measured: Sequence[Measured]) -> dict[str, Any]:
    scene = study.scenes[number]
    own = [m for m in measured if m.cell.scene is scene]
    reference = own[0].cell.reference
    return {
        "name": scene.name,
        "question": scene.question,
        "quantity": scene.quantity,
        "unit": UNITS[scene.quantity],
        "described": json.loads(study.text)["scenes"][number],
        "reference": {
            "value": float(reference.value),
            "error": float(reference.error),
            "method": reference.method,
            "source": reference.source,
        },
        "plan": None if scene.quantity == "radiance" else plan(_planned(scene)).to_dict(),
        "answer": ranked(own),
        "estimators": [m.record for m in own],
    }


def _planned(scene: StudyScene) -> Scene:
    """Return what is measured of a scene as a scene of its own: the transmittance is what is left of a background of 1."""
    followed: dict[str, Scattering] = {"fog": "ambient", "airlight": "single"}
    background = 1.0 if scene.quantity == "transmittance" else scene.background if scene.quantity == "fog" else 0.0
    scattering = followed.get(scene.quantity, "none")
    return Scene(scene.built_medium, scene.ray, scattering, scene.light, scene.occluders, scene.ambient, background)


def _digest(scenes: list[dict[str, Any]]) -> str:
    """Return the sum of everything that no clock has touched."""
    kept = [
        {
            **{key: value for key, value in scene.items() if key not in ("plan", "answer", "estimators")},
            "estimators": [{k: v for k, v in e.items() if k != "speed"} for e in scene["estimators"]],
        }
        for scene in scenes
    ]
    return hashlib.sha256(json.dumps(jsonable(kept), sort_keys=True).encode()).hexdigest()


def _failure(row: tuple[int, int, str], cells: Sequence[Cell], batches: Sequence[Batch]) -> dict[str, Any]:
    index, attempts, error = row
    batch = batches[index]
    cell = cells[batch.cell]
    place = {"scene": cell.scene.name, "estimator": cell.name, "count": batch.size}
    return {"batch": index, **place, "attempts": attempts, "error": error}


def read_results(path: Path) -> dict[str, Any]:
    """Return the record of a finished study, from its folder or file."""
    file = path / "results.json" if path.is_dir() else path
    try:
        record = parse_json(read_text(file, "the record"))
    except (ValueError, RecursionError) as error:
        raise InvalidInputError(f"cannot read {file}: it is not JSON ({error})", str(file)) from None
    if not isinstance(record, dict) or record.get("schema") != SCHEMA or record.get("kind") != "study":
        got = record.get("kind") if isinstance(record, dict) else record
        raise InvalidInputError(f"{file} is not the record of a study of {SCHEMA!r}, got {shorten(got)}", str(file))
    return record
