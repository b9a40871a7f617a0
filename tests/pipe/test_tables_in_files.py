"""Entries of tables with the probabilities that they claim, and nothing else: right ones pass, at few entries and many."""

import numpy as np
import pytest

from fogproof.pipe.check import Settings, check_file

LAWS = {
    "five": ({"kind": "discrete", "n": 5}, np.array([0.1, 0.25, 0.05, 0.4, 0.2])),
    "two": ({"kind": "discrete", "n": 2}, np.array([0.03, 0.97])),
    "many": ({"kind": "discrete", "n": 3000}, np.random.default_rng(3).gamma(2.0, size=3000)),
    "endless": ({"kind": "discrete", "n": float("inf")}, 0.7 ** np.arange(100.0)),
    "beside": (
        {"kind": "product", "parts": [{"kind": "discrete", "n": 4}, {"kind": "interval", "a": 0, "b": 1}]},
        np.array([0.1, 0.2, 0.3, 0.4]),
    ),
}


def rows(law, seed, tilt=0.0):
    """Columns x…, pdf of 40 000 samples from a generator of this seed."""
    weights = LAWS[law][1] / LAWS[law][1].sum()
    rng = np.random.default_rng(seed)
    k = np.searchsorted(np.cumsum(weights)[:-1], rng.random(40_000), side="right")
    claimed = weights * (1 + tilt * np.where(np.arange(len(weights)) % 2, 1, -1))
    claimed /= claimed.sum()
    if law != "beside":
        return np.column_stack([k, claimed[k]]), "x,pdf"
    t = np.sqrt(rng.random(40_000))
    return np.column_stack([k, t, claimed[k] * 2 * t]), "x,x,pdf"


@pytest.mark.parametrize("law", LAWS)
def test_right_tables_pass_whatever_the_seeds(tmp_path, law):
    """One of them is the seed of the samples themselves: the checks draw nothing that samples may be made of."""
    for seed in range(4):
        table, header = rows(law, seed)
        np.savetxt(tmp_path / "x.csv", table, delimiter=",", header=header, comments="", fmt="%.17g")
        verdict = check_file(tmp_path / "x.csv", {"domain": LAWS[law][0]}, Settings(seed=seed)).verdict
        assert verdict.outcome == "not rejected", verdict


@pytest.mark.parametrize("law", LAWS)
def test_tables_that_claim_other_probabilities_are_rejected(tmp_path, law):
    table, header = rows(law, 1, tilt=0.3)
    np.savetxt(tmp_path / "x.csv", table, delimiter=",", header=header, comments="", fmt="%.17g")
    verdict = check_file(tmp_path / "x.csv", {"domain": LAWS[law][0]}, Settings(seed=1)).verdict
    assert verdict.outcome == "rejected", verdict


def test_distances_beyond_the_wall_are_no_swapped_columns(tmp_path):
    """Free paths whose clamp to the ray's end is forgotten, a fifth of them; and right ones in the wrong columns."""
    spec = {
        "medium": {"sigma_a": 0.3, "sigma_s": 0.5},
        "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 2},
    }
    t = -np.log1p(-np.random.default_rng().random(20_000)) / 0.8
    p = np.where(t < 2, 0.8 * np.exp(-0.8 * t), np.exp(-1.6))
    for columns, cause in (((t, p), "outside the domain"), ((p, np.minimum(t, 2)), "layout")):
        np.save(tmp_path / "t.npy", np.column_stack(columns))
        verdict = check_file(tmp_path / "t.npy", {**spec, "columns": ["x", "pdf"]}).verdict
        assert (verdict.outcome, verdict.cause) == ("rejected", cause), verdict
