"""Invariant: a study that is not changed draws the same from one version to the next, by every method.

`tests/data/study-draws.json` holds the mean, the root mean square and the extremes of each cell's first batch under one seed. A row
may change only with a mend of what is drawn, or of how batches share the stream, that is meant and named in CHANGELOG.md: whoever
has an unfinished study then has to start it anew. `python tests/study/test_draws_stay.py` writes the table.
"""

import json
import math
from pathlib import Path

import pytest

from fogproof.study.batches import COLUMNS, draw_batch
from fogproof.study.cells import cells_of
from fogproof.study.files import read_study
from fogproof.study.methods.table import METHODS, kind_of
from fogproof.study.plan import batches_of

DATA = Path(__file__).parents[1] / "data"
TABLE = DATA / "study-draws.json"
SAME = 1e-12  # processors differ in the last digits of exp and log


@pytest.fixture(scope="module")
def cells():
    return cells_of(read_study(DATA / "every-method.toml"))


def drawn(cells):
    """Return (mean, root mean square, least, largest) of the first batch of each cell, the reference being 0."""
    batches = {}
    for batch in batches_of(cells):
        batches.setdefault(batch.cell, batch)
    rows = {}
    for cell in cells:
        first, *_, squares = (
            dict(zip(COLUMNS, row, strict=True)) for row in draw_batch(cell, batches[cell.index], 0.0).moments.tolist()
        )
        rows[name_of(cell)] = [first["mean"], math.sqrt(squares["mean"]), first["low"], first["high"]]
    return rows


def name_of(cell):
    return f"{cell.scene.name}: {cell.name}"


def test_every_method_draws_what_it_drew(cells):
    wanted = json.loads(TABLE.read_text())
    rows = drawn(cells)
    assert list(rows) == list(wanted)
    changed = [name for name in rows if rows[name] != pytest.approx(wanted[name], rel=SAME, abs=0)]
    assert not changed, "the draws of a study have changed: see the head of this file"


def test_every_method_is_in_the_table(cells):
    assert {kind_of(cell.method) for cell in cells} == set(METHODS)


if __name__ == "__main__":
    TABLE.write_text(json.dumps(drawn(cells_of(read_study(DATA / "every-method.toml"))), indent=1) + "\n")
