"""Whole numbers are exact: no rounding explains what a table says at the next entry, alone or beside other coordinates."""

import numpy as np
import pytest

from fogproof import Discrete, Draw, Interval, Product, UnitSphere, check_sampler
from fogproof.checks.subject import nudged
from fogproof.domains.law import whole_columns

W = np.array([0.1, 0.25, 0.05, 0.4, 0.2])
BOTH = Product(Discrete(5), Interval(0.0, 1.0))


def entry(u):
    return np.searchsorted(np.cumsum(W)[:-1], u, side="right").astype(float)


def of_table(x):
    return W[x.astype(int)]


def of_both(x):
    return of_table(x[:, 0]) * 2 * x[:, 1]


def table(u):
    return entry(u[:, 0])


def both(u):
    return np.column_stack([entry(u[:, 0]), np.sqrt(u[:, 1])])


@pytest.mark.parametrize(
    ("sample", "pdf", "domain", "k"),
    [(table, of_table, Discrete(5), 1), (both, of_both, BOTH, 2)],
    ids=["alone", "beside"],
)
@pytest.mark.parametrize("factor", [1.0, 1 + 1e-9, 5.0])
def test_a_probability_returned_wrong_at_one_entry(sample, pdf, domain, k, factor):
    def returning(u):
        x = sample(u)
        return Draw(x, pdf=pdf(x) * np.where(x.reshape(len(x), -1)[:, 0] == 1, factor, 1.0))

    verdict = check_sampler(returning, pdf, domain, dimensions=k, samples=20_000, seed=1)
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} == ({"returned pdf"} if factor > 1 else set())


@pytest.mark.parametrize(
    ("sample", "pdf", "domain", "k"),
    [(table, of_table, Discrete(5), 1), (both, of_both, BOTH, 2)],
    ids=["alone", "beside"],
)
def test_an_entry_without_probability_is_none_of_the_next_one(sample, pdf, domain, k):
    def holed(x):
        return np.where(x.reshape(len(x), -1)[:, 0] == 2, 0.0, pdf(x))

    verdict = check_sampler(sample, holed, domain, dimensions=k, samples=20_000, seed=1)
    assert "positive pdf" in {f.check for f in verdict.findings if f.outcome == "rejected"}


def test_rounding_moves_all_but_whole_numbers():
    x = np.array([[3.0, 0.6, 0.8, 0.0], [4.0, 0.0, 0.0, 1.0]])
    whole = whole_columns(Product(Discrete(7), UnitSphere()))
    assert whole == (True, False, False, False)
    moved = np.array(nudged(x, 2.0**-53, whole))
    assert np.all(moved[:, :, 0] == x[:, 0])
    assert np.all(np.abs(moved - x).max(axis=(1, 2)) > 0)
    assert np.array_equal(nudged(x[:, 0], 2.0**-53, whole_columns(Discrete(7))), [x[:, 0]])


@pytest.mark.parametrize("share", [0.3, 0.02, 0.98])
def test_two_entries_are_two_cells_whichever_is_the_rarer(share):
    w = np.array([share, 1 - share])

    def coin(u, claimed=share):
        return (u[:, 0] >= claimed).astype(float)

    right = check_sampler(coin, lambda x: w[x.astype(int)], Discrete(2), dimensions=1, samples=20_000, seed=1)
    assert right.outcome == "not rejected", str(right)
    wrong = check_sampler(
        lambda u: coin(u, share * 0.5), lambda x: w[x.astype(int)], Discrete(2), dimensions=1, samples=20_000, seed=1
    )
    assert wrong.outcome == "rejected"
