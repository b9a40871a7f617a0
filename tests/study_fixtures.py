"""A small study, and ways to draw it, that the tests of studies share."""

import json

from fogproof.study.batches import draw_batch
from fogproof.study.cells import cells_of
from fogproof.study.executors import crew
from fogproof.study.files import study_of
from fogproof.study.plan import batches_of
from fogproof.study.record import Circumstances, make_record
from fogproof.study.run import draw_missing
from fogproof.study.store import opened

RAY = {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 2}
GRID = {"kind": "random-grid", "cells": [1, 1, 16], "lower": [-1, -1, 0], "upper": [1, 1, 2], "high": 1.5}
LIT = {
    "name": "lit",
    "quantity": "airlight",
    "question": "Which is best beside a lamp?",
    "medium": {"sigma_a": 0.1, "sigma_s": 0.4},
    "ray": {"origin": [0, 0, -2], "direction": [0, 0, 1], "length": 5},
    "light": {"position": [0.6, -0.8, 0.5], "intensity": 3},
}
BALL = {
    "name": "ball",
    "quantity": "radiance",
    "medium": {"sigma_a": 0.1, "sigma_s": 0.9},
    "ray": {"origin": [0.3, 0, -3], "direction": [0, 0, 1]},
    "light": {"kind": "environment", "radiance": 1},
    "shape": {"kind": "ball", "center": [0, 0, 0], "radius": 1},
}
HOW = Circumstances("a test", "now", 0.0, "threads", 1)


def kinds(*names):
    return [{"kind": name} if isinstance(name, str) else name for name in names]


SMALL = {
    "samples": [64, 512, 4096],
    "replicates": 8,
    "batch": 1024,
    "scenes": [
        {**LIT, "estimators": kinds("airlight", "mis", "marched-airlight")},
        {"name": "grid", "quantity": "transmittance", "medium": GRID, "ray": RAY,
         "estimators": kinds("regular", "ratio", "march")},
    ],
}  # fmt: skip


def study_from(table):
    return study_of(json.dumps(table, sort_keys=True), "/")


def toml(table):
    """Return a study of plain values as TOML; inline tables are enough for that."""

    def value(v):
        if isinstance(v, dict):
            return "{" + ", ".join(f"{k} = {value(x)}" for k, x in v.items()) + "}"
        if isinstance(v, list | tuple):
            return "[" + ", ".join(map(value, v)) + "]"
        return json.dumps(v)

    lines = [f"{k} = {value(v)}" for k, v in table.items() if k != "scenes"]
    for scene in table["scenes"]:
        lines += ["[[scenes]]", *(f"{k} = {value(v)}" for k, v in scene.items())]
    return "\n".join(lines) + "\n"


def drawn(study, folder, *, cells=None, where="threads", workers=2, draw=None):
    """Draw what is missing and return the record; `cells` may have been tampered with, which threads alone can see."""
    cells = cells or cells_of(study)
    batches = batches_of(cells)

    def here(text, path, batch, reference):
        return draw_batch(cells[batch.cell], batch, reference)

    with opened(folder, study) as store:
        with crew(where, workers) as hands:
            draw_missing(study, cells, batches, store, hands, draw=draw or here)
        return make_record(study, cells, batches, store, HOW)


def estimator(record, name, scene=0):
    return next(e for e in record["scenes"][scene]["estimators"] if e["name"] == name)
