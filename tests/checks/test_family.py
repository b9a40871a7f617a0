"""A family with an error in a corner of its parameters is rejected, and shrunk to a simple one; a right family is not."""

import numpy as np
import pytest
from hypothesis import strategies as st

import fogproof
from fogproof.checks import fresh_seed
from fogproof.checks.family import _rounds
from fogproof.doing import heard_by


class Tilted:
    """Henyey & Greenstein's function about +z, by uniforms; `bug` changes what is drawn."""

    domain, dimensions = fogproof.UnitSphere(), 2

    def __init__(self, g, bug=lambda g: g):
        self.g, self.drawn = g, bug(g)

    def sample(self, u):
        g, x = self.drawn, u[:, 0]
        mu = 1 - 2 * (1 - g) ** 2 * (1 - x) * (1 + g * x) / (1 - g + 2 * g * x) ** 2
        s, phi = np.sqrt(np.maximum(0, 1 - mu * mu)), 2 * np.pi * u[:, 1]
        return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)

    def pdf(self, x):
        return (1 - self.g**2) / (4 * np.pi * (1 + self.g**2 - 2 * self.g * x[:, 2]) ** 1.5)


class Mean:
    """An estimator of p that is wrong for small p."""

    def __init__(self, p):
        self.p, self.reference = p, p

    def draw(self, rng, n):
        return (rng.random(n) < (self.p if self.p > 0.1 else 0.0)).astype(float)


BUGS = {
    "a guard g < eps for abs(g) < eps": (
        lambda g: g if g > 1e-3 else 0.0,
        lambda g: -0.99 <= g < -1e-3,
        "parameter <= -",
    ),
    "a clamp at .8": (lambda g: min(g, 0.8), lambda g: 0.8 < g <= 0.99, "rejected for parameter >= 0."),
    "a flipped sign beyond .5": (
        lambda g: -g if g > 0.5 else g,
        lambda g: 0.5 < g <= 0.99,
        "rejected for parameter >= 0.",
    ),
}


@pytest.mark.parametrize("name", BUGS)
def test_an_error_in_a_corner_is_found_and_shrunk(name):
    bug, wrong, side = BUGS[name]
    seed = fresh_seed()
    verdict = fogproof.check_family(lambda g: Tilted(g, bug), st.floats(-0.99, 0.99), samples=1_000_000, seed=seed)
    assert verdict.outcome == "rejected", f"{verdict} (seed {seed})"
    simplest = float(verdict.settings["parameter"])
    assert wrong(simplest)
    assert simplest * 1024 % 1 == 0, f"{simplest} is not simple (seed {seed})"
    assert side in verdict.findings[0].message
    assert sum(f.alpha for f in verdict.findings[1:] if f.alpha) <= verdict.alpha
    again = fogproof.check_family(lambda g: Tilted(g, bug), st.floats(-0.99, 0.99), samples=1_000_000, seed=seed)
    assert again.settings["parameter"] == verdict.settings["parameter"]


def test_a_right_family_is_not_rejected():
    seed = fresh_seed()
    verdict = fogproof.check_family(Tilted, st.floats(-0.9, 0.9), members=16, samples=400_000, seed=seed)
    assert verdict.outcome == "not rejected", f"{verdict} (seed {seed})"
    assert verdict.samples <= 400_000 * 1.1
    assert verdict.resolution is not None


def test_estimators_and_lists():
    verdict = fogproof.check_family(Mean, [0.5, 0.3, 0.2, 0.1, 0.05], samples=200_000, seed=3, bounds=(0.0, 1.0))
    assert verdict.outcome == "rejected"
    assert verdict.settings["parameter"] == "0.1"
    assert "rejected for parameter <= 0.1" in verdict.findings[0].message


def test_a_member_that_raises_is_wrong():
    def make(g):
        if g < 0:
            raise fogproof.InvalidValueError("g", "must be >= 0", g)
        return Tilted(g)

    verdict = fogproof.check_family(make, [0.5, 0.1, -0.1], samples=60_000, seed=1)
    assert verdict.outcome == "rejected"
    assert "g must be >= 0" in str(verdict)


def test_alpha_is_spent_once():
    for members in (1, 2, 3, 64, 100):
        rounds = _rounds(members, 10**6, 1e-3)
        assert sum(kept * share for kept, _, share in rounds) <= 1e-3 / 2 * (1 + 1e-12)
        assert sum(kept * each for kept, each, _ in rounds) <= 10**6 + 1000 * sum(kept for kept, _, _ in rounds)


def test_nothing_to_try_is_told():
    with pytest.raises(fogproof.InvalidValueError, match="parameters must not be empty"):
        fogproof.check_family(Tilted, [])


def test_families_that_make_nothing_are_explained():
    def broken(parameter):
        raise ZeroDivisionError("no such member")

    verdict = fogproof.check_family(broken, iter([1.0, 2.0]), samples=10_000)
    assert verdict.outcome == "rejected"
    assert "no such member" in str(verdict)
    assert verdict.samples == 0  # nothing was drawn of what could not be made


def test_what_no_member_can_mend_is_said_to_the_caller():
    class Unknown:
        def draw(self, rng, n):
            return rng.random(n)

    for make, options, words in (
        (lambda parameter: None, {}, "make must return"),
        (lambda parameter: Mean.draw, {}, "make must return"),
        (lambda parameter: Unknown(), {}, "make must return estimators that have a `reference`"),
        (Tilted, {"mean_cosine": 0.3}, "axis must be given with mean_cosine"),
    ):
        with pytest.raises(fogproof.InvalidValueError, match=words):
            fogproof.check_family(make, [0.5, 0.3], samples=10_000, **options)


def test_one_member_that_is_nothing_is_wrong():
    verdict = fogproof.check_family(lambda p: Mean(p) if p > 0.2 else None, [0.5, 0.3, 0.1], samples=30_000)
    assert verdict.outcome == "rejected"
    assert verdict.settings["parameter"] == "0.1"


def test_samples_are_the_most_that_are_drawn():
    for members, samples in ((1, 1000), (3, 3000), (7, 10**5), (64, 6400), (64, 2 * 10**5)):
        drawn = []

        class Counted(Mean):
            def draw(self, rng, n):
                drawn.append(n)  # noqa: B023
                return super().draw(rng, n)

        verdict = fogproof.check_family(Counted, [0.3 + i / 1000 for i in range(members)], samples=samples)
        assert verdict.samples == sum(drawn) <= samples
    with pytest.raises(fogproof.InvalidValueError, match="samples must be at least 300, 100 for each of 3 members"):
        fogproof.check_family(Mean, [0.3, 0.4, 0.5], samples=10)


def test_what_looks_worst_gets_more_although_nothing_can_be_told_yet():
    """Of members that are too skewed for a test so far, not the first ones but the suspicious ones."""

    class Skewed:
        reference = 1.0

        def __init__(self, number):
            self.factor = 1.3 if number == 50 else 1.0

        def draw(self, rng, n):
            return self.factor * rng.exponential(1.0, n)

    verdict = fogproof.check_family(Skewed, range(64), samples=1_000_000, alpha=1e-6)
    assert verdict.outcome == "rejected"
    assert verdict.settings["parameter"] == "50"


@pytest.mark.parametrize(
    ("make", "parameters", "word"),
    [
        (3, [1.0], "make"),
        (Tilted, 5, "parameters"),
        (Tilted, float, "parameters"),
        (Tilted, st.floats(2, 1), "parameters"),
        (Tilted, st.floats(0, 1).filter(lambda p: False), "parameters"),
    ],
)
def test_what_is_no_family_is_explained(make, parameters, word):
    with pytest.raises(fogproof.InvalidValueError, match=word):
        fogproof.check_family(make, parameters, samples=10_000)


def test_a_wrong_option_is_no_fault_of_a_member():
    for options in ({"bounds": (1.0, 0.0)}, {"tails": "thin"}, {"tolerance": -1.0}):
        with pytest.raises(fogproof.InvalidValueError, match=next(iter(options))):
            fogproof.check_family(Mean, [0.5, 0.3], samples=10_000, **options)


def test_no_decision_says_what_decides():
    class Heavy:
        reference = float(np.exp(4.5))

        def __init__(self, spread):
            self.spread = spread

        def draw(self, rng, n):
            return rng.lognormal(0, self.spread, n)

    verdict = fogproof.check_family(Heavy, [3.0], samples=2000)
    assert verdict.outcome == "inconclusive"
    assert "At 3.0, with 2000: mean " in verdict.findings[0].message
    assert "ask for about" in verdict.findings[0].message
    assert "It got 1 / 1 of samples=2000" in verdict.findings[0].message


def test_the_cause_is_looked_for_once_and_what_is_done_is_told():
    """A list: every member of a round is judged, three are wrong, and only the simplest of them is explained."""
    told = []
    with heard_by(told.append):
        verdict = fogproof.check_family(lambda g: Tilted(g, lambda g: -g), [0.8, 0.7, 0.6], samples=300_000)
    assert (verdict.outcome, verdict.cause) == ("rejected", "sign convention"), verdict
    assert "opposite direction" in verdict.diagnosis
    looking = {what.partition(": ")[0] for what in told if "looking for the cause" in what}
    assert looking == {"0.8"}
    assert any(what.startswith("2. 0.7: sample 0 of") for what in told)
