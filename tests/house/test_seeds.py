"""A test draws the same numbers in every run."""

import random

import numpy as np
import pytest


@pytest.fixture(scope="module")
def shared():
    return np.random.SeedSequence().entropy


def test_fresh_seeds_follow_from_the_name_of_the_test(request, shared):
    if request.config.getoption("fresh"):
        assert np.random.SeedSequence().entropy != random.Random(request.node.nodeid).getrandbits(128)
        return
    assert np.random.SeedSequence().entropy == random.Random(request.node.nodeid).getrandbits(128)
    assert shared == random.Random("tests/house/test_seeds.py::shared[0]").getrandbits(128)
