"""The time of a call is the estimator's own: neither reading the clock nor looking at what was drawn is in it."""

from dataclasses import replace

import numpy as np
import pytest
from study_fixtures import SMALL, study_from

from fogproof.study import batches as drawing
from fogproof.study.cells import cells_of
from fogproof.study.plan import batches_of

READING = 5e-6
LOOKING = 50e-6


class Clock:
    """Time passes where somebody spends it, and when the clock is read."""

    now = 0.0

    def thread_time(self):
        self.now += READING
        return self.now

    perf_counter = thread_time


class Spends:
    """An estimator whose call takes exactly so many seconds, and whose numbers take time to look at."""

    def __init__(self, clock, seconds):
        self.clock, self.seconds = clock, seconds

    def draw(self, rng, n):
        self.clock.now += self.seconds
        return Slow(rng.random(n), self.clock)


class Slow:
    def __init__(self, values, clock):
        self.values, self.clock = values, clock

    def __array__(self, dtype=None, copy=None):
        self.clock.now += LOOKING
        return np.asarray(self.values, dtype)


@pytest.mark.parametrize("points", ["random", "sobol"])
@pytest.mark.parametrize("seconds", [1e-6, 1e-5, 1e-4, 1e-3, 1e-2])
def test_the_time_is_that_of_the_call(monkeypatch, seconds, points):
    clock = Clock()
    monkeypatch.setattr(drawing, "time", clock)
    cells = cells_of(study_from(SMALL))
    cell = next(cell for cell in cells if cell.method.axis == "samples" and cell.points == points)
    batch = next(b for b in batches_of(cells) if b.cell == cell.index)
    known = replace(cell, _made={0: Spends(clock, seconds)})
    result = drawing.draw_batch(known, batch, 0.5)
    assert result.cpu / batch.replicates == pytest.approx(seconds, rel=0.06)
    assert result.wall / batch.replicates == pytest.approx(seconds, rel=0.12)
