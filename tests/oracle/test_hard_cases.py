"""Invariant: every public function of the oracle has hard cases with a truth of their own, and keeps its promise on them.

`make oracle-hard` draws 10^5 of these; here are two of each kind that costs little.
"""

import numpy as np
import oracle_hard
import pytest

CHEAP = [name for name, kind in oracle_hard.kinds().items() if kind.share >= 1]


def test_every_public_function_has_its_cases():
    assert not oracle_hard.missing()


@pytest.mark.parametrize("name", CHEAP)
def test_promises_hold(name):
    rng = np.random.default_rng()
    for _ in range(2):
        case = oracle_hard.judged(oracle_hard.kinds()[name], rng)
        assert not isinstance(case, str), case
        assert oracle_hard.share(case) <= 1, case


@pytest.mark.parametrize("name", ["phase_pdf", "rod_reflectance", "transmittance"])
def test_a_broken_promise_is_seen(name):
    rng = np.random.default_rng()
    cases = [oracle_hard.judged(oracle_hard.kinds()[name], rng) for _ in range(10)]
    assert any(oracle_hard.share(case._replace(value=case.value + 3 * case.error)) > 1 for case in cases)
