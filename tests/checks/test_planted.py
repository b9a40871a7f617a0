"""An error of exactly the stated size is caught, by every kind of finding; the short form of `tools/planted.py`."""

import pytest
from planted import caught, stated
from planted_errors import PLANTS

from fogproof.checks import fresh_seed

TRIALS = 6
SAMPLES = 8000
MORE = 30_000  # where every cell of the plane must hold enough of them


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: f"{plant.check}, {plant.right.__name__[1:]}")
def test_the_stated_resolution_is_true(plant):
    seed, samples = fresh_seed() >> 2, MORE if "joint" in plant.check else SAMPLES
    kind, size = stated(plant, samples, seed)
    hits = caught(plant, kind, size, TRIALS, samples, seed + 10)
    assert hits >= (TRIALS if plant.sure else TRIALS - 3), f"{hits} of {TRIALS}, seed {seed}"
