"""The examples in the docstrings of the checks run, and say what they say."""

import doctest

import numpy as np
import pytest

from fogproof import contracts
from fogproof.checks import bound, compare, convergence, estimator, generators, mis, planning

MODULES = [bound, compare, contracts, convergence, estimator, generators, mis, planning]


@pytest.mark.parametrize("module", MODULES, ids=[module.__name__ for module in MODULES])
def test_examples_run(module):
    results = doctest.testmod(module, extraglobs={"np": np})
    assert results.attempted > 0
    assert results.failed == 0
