"""Whole numbers are exact: no rounding explains what a table says at the next entry, alone or beside other coordinates."""

import numpy as np
import pytest

from fogproof import Discrete, Draw, Interval, Product, Reference, UnitSphere, check_sampler
from fogproof.checks.subject import nudged
from fogproof.domains.law import whole_columns
from fogproof.errors import SubjectError

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


def test_functions_of_a_table_get_integers():
    """As the sampler gives them: what indexes a table with its own points may do so here."""
    seen = []

    def weights(k):
        seen.append(k.dtype.kind)
        return W[k]

    def index(u):
        return entry(u[:, 0]).astype(int)

    more = {
        "cdf": lambda k: np.cumsum(W)[k],
        "eval": lambda k: 2 * weights(k),
        "reference": lambda k: Reference(weights(k)),
        "albedo": 2.0,
    }
    verdict = check_sampler(index, weights, Discrete(5), dimensions=1, samples=20_000, **more)
    assert verdict.outcome == "not rejected", str(verdict)
    assert set(seen) == {"i"}


@pytest.mark.parametrize(
    ("pdf", "domain", "fix"),
    [
        (lambda x: W[x[:, 0]], BOTH, "index with x.astype(int)"),
        (lambda k: W[np.minimum(k, 4)], Discrete(np.inf), "index with x.astype(int)"),
        (lambda k: 2 ** (-1 - np.minimum(k, 3)), Discrete(5), "write a float, as in 2.0**-k"),
    ],
    ids=["beside", "without an end", "powers"],
)
def test_the_other_type_is_told_with_its_fix(pdf, domain, fix):
    sample, k = (both, 2) if domain is BOTH else (table, 1)
    with pytest.raises(SubjectError, match="pdf") as caught:
        check_sampler(sample, pdf, domain, dimensions=k, samples=20_000)
    assert fix in str(caught.value)
