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


def test_what_is_kept_of_a_run_is_judged_alike(tmp_path):
    """Exact answers have error 0, so that no digit of the truth may be lost on the way to the file."""
    kept = tmp_path / "parts.jsonl"
    for name in ("white_furnace", "phase_pdf"):
        name, index, cases = oracle_hard.batch((name, 7, 3))
        kept.write_text(oracle_hard.line_of(name, 7, index, cases) + '{"name": "cut off', encoding="utf-8")
        again = oracle_hard.kept(kept, 7)[name, index]
        assert [oracle_hard.share(case) for case in again] == pytest.approx([oracle_hard.share(case) for case in cases])
        assert not oracle_hard.kept(kept, 8)
