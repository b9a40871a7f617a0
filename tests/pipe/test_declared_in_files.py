"""A file with densities of its own is held to what else its spec declares; a spec declares nothing that is not looked at."""

import numpy as np
import pytest

from fogproof.analytic import rod_reflectance_orders
from fogproof.errors import InvalidInputError, InvalidValueError
from fogproof.pipe.check import Settings, check_file
from fogproof.pipe.spec import spec_of

N, DOWN = 100_000, float(np.exp(-1.5))
ALPHA = 1e-6
COSINE = {"domain": "hemisphere", "axis": [0, 0, 1], "columns": ["x", "x", "x", "pdf", "weight", "event"]}
FLIGHT = {"domain": {"kind": "half-line", "a": 0}, "columns": ["x", "pdf"]}


def hemisphere(weight=0.9, share=0.5):
    u = np.random.default_rng().random((N, 4))
    z, phi = np.sqrt(1 - u[:, 0]), 2 * np.pi * u[:, 1]
    r = np.sqrt(u[:, 0])
    weights = weight + 0.1 * (u[:, 2] - 0.5)
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), z, z / np.pi, weights, u[:, 3] > share])


def flight(at_surface=DOWN):
    t = -np.log1p(-np.random.default_rng().random(N)) / 0.5
    out = t >= 3
    return np.column_stack([np.where(out, 3.0, t), np.where(out, at_surface, 0.5 * np.exp(-0.5 * t))])


def judged(tmp_path, rows, **spec):
    np.save(tmp_path / "rows.npy", rows)
    return check_file(tmp_path / "rows.npy", spec, Settings(alpha=ALPHA)).verdict


RIGHT = {
    "hemisphere": (hemisphere, {**COSINE, "albedo": 0.9, "events": {"0": 0.5, "1": 0.5}, "mean_cosine": 2 / 3}),
    "flight": (flight, {**FLIGHT, "atoms": [{"at": 3, "probability": DOWN}]}),
}


@pytest.mark.parametrize("name", RIGHT)
def test_right_ones_pass(tmp_path, name):
    make, spec = RIGHT[name]
    verdict = judged(tmp_path, make(), **spec)
    assert (verdict.outcome, verdict.unchecked) == ("not rejected", ())


def with_nan():
    rows = hemisphere()
    rows[7, 4] = np.nan
    return rows


@pytest.mark.parametrize(
    ("make", "spec", "cause"),
    [
        (lambda: hemisphere(weight=0.8), {**COSINE, "albedo": 0.9}, "wrong weight"),
        (with_nan, {**COSINE, "albedo": 0.9}, "not a number"),
        (lambda: hemisphere(share=0.7), {**COSINE, "events": {"0": 0.5, "1": 0.5}}, "wrong event label"),
        (hemisphere, {**COSINE, "mean_cosine": 0.6}, "wrong mean cosine"),
        (lambda: flight(0.3), {**FLIGHT, "atoms": [{"at": 3, "probability": 0.3}]}, "wrong probability of an atom"),
        (lambda: flight(0.5 * DOWN), {**FLIGHT, "atoms": [{"at": 3, "probability": DOWN}]}, "wrong pdf returned"),
    ],
)
def test_what_is_declared_is_looked_at(tmp_path, make, spec, cause):
    verdict = judged(tmp_path, make(), **spec)
    assert (verdict.outcome, verdict.cause) == ("rejected", cause)
    assert verdict.alpha == ALPHA
    assert sum(f.alpha or 0.0 for f in verdict.findings) <= ALPHA * (1 + 1e-9)


def test_what_nothing_was_declared_for_is_unchecked(tmp_path):
    verdict = judged(tmp_path, hemisphere(weight=0.8), **COSINE)
    assert verdict.outcome == "not rejected"
    assert any("weights" in one for one in verdict.unchecked)
    assert any("event" in one for one in verdict.unchecked)


@pytest.mark.parametrize("key", ["variance", "cost", "bounds", "nonnegative", "tails", "tolerance", "error"])
def test_keys_of_estimators_are_refused_for_samplers(key):
    given = {"bounds": [0, 1], "nonnegative": True, "tails": "light"}.get(key, 0.5)
    with pytest.raises(InvalidInputError, match=f"{key} says something of an estimator, and this is a sampler"):
        spec_of({**FLIGHT, key: given}, "spec")


@pytest.mark.parametrize(
    "key",
    ["atoms", "events", "axis", "mean_cosine", "albedo", "uniform_bits", "quasi_random", "exact", "interpolation"],
)
def test_keys_of_samplers_are_refused_for_estimators(key):
    given = {
        "atoms": [],
        "events": {"0": 1.0},
        "axis": [0, 0, 1],
        "uniform_bits": 32,
        "quasi_random": True,
        "exact": True,
        "interpolation": "linear",
    }
    with pytest.raises(InvalidInputError, match=f"{key} says something of a sampler, and this is an estimator"):
        spec_of({"reference": 0.5, key: given.get(key, 0.5)}, "spec")


def test_a_share_of_a_reference_of_0_is_refused_with_its_fix(tmp_path):
    np.save(tmp_path / "x.npy", np.random.default_rng().standard_normal(2000))
    with pytest.raises(InvalidValueError, match=r"absolute part where the reference is 0.*\(0, absolute\)"):
        check_file(tmp_path / "x.npy", {"reference": 0, "tolerance": 0.01})
    passed = check_file(tmp_path / "x.npy", {"reference": 0, "tolerance": [0, 0.5]}, Settings(alpha=1e-7)).verdict
    assert passed.outcome == "not rejected", passed


def test_events_without_labels_are_refused(tmp_path):
    np.save(tmp_path / "x.npy", np.random.default_rng().random((2000, 1)))
    spec = {"domain": {"kind": "interval", "a": 0, "b": 1}, "columns": ["x"], "events": {"0": 0.8, "1": 0.2}}
    (tmp_path / "pdf.csv").write_text("0,1\n1,1\n")
    with pytest.raises(InvalidInputError, match="no column event; write one"):
        check_file(tmp_path / "x.npy", {**spec, "table": str(tmp_path / "pdf.csv")})


def test_orders_are_held_to_those_of_a_quantity_and_else_said_to_be_unchecked(tmp_path):
    """Values of one each, orders with the probabilities of the reference; and the same with every order off by one."""
    quantity = {"quantity": "rod_reflectance_orders", "length": 1.5, "count": 4}
    truth = np.asarray(rod_reflectance_orders(1.5, 4).value)
    rng = np.random.default_rng()
    order = rng.choice(len(truth) + 1, size=20_000, p=[*truth, 1 - truth.sum()])
    rows = np.column_stack([(order < len(truth)) * 1.0, np.minimum(order, len(truth) - 1)])
    for shift, outcome in ((0, "not rejected"), (1, "rejected")):
        np.save(tmp_path / "v.npy", np.column_stack([rows[:, 0], rows[:, 1] + shift]))
        spec = {"columns": ["value", "order"], "bounds": [0, 1]}
        verdict = check_file(tmp_path / "v.npy", {**spec, "quantity": quantity}).verdict
        assert verdict.outcome == outcome, str(verdict)
    plain = check_file(tmp_path / "v.npy", {**spec, "reference": float(truth.sum())}).verdict
    assert any(words.startswith("orders (give references") for words in plain.unchecked)
    np.save(tmp_path / "v.npy", rows[:, :1])
    with pytest.raises(InvalidInputError, match="1 columns value, and 5 expectations"):
        check_file(tmp_path / "v.npy", {"columns": ["value"], "quantity": quantity})
