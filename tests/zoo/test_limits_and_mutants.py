"""The best test's count is what theory says; mutants change what they say they change, and nothing where nothing is used."""

import numpy as np
import pytest

from fogproof.catalogue import SamplerCase
from fogproof.contracts import Draw
from fogproof.domains import Interval
from fogproof.zoo.bug import Planted
from fogproof.zoo.limits import chi_square_distance, samples_needed
from fogproof.zoo.mutants.estimators import MUTATIONS as ESTIMATORS
from fogproof.zoo.mutants.of_uniforms import OfUniforms
from fogproof.zoo.mutants.samplers import MUTATIONS


def case(sample, dimensions=2, **more):
    subject = Planted(sample, lambda x: np.ones(len(x)), Interval(0, 1), dimensions, **more)
    return SamplerCase(name="mine", make=lambda: subject)


def mutation(name):
    return next(m for m in MUTATIONS if m.name == name)


def test_the_limit_of_henyey_and_greensteins_g():
    """g = .79 for .8: 2.2e4 samples at alpha 1e-6 and power .99, by integration of the two laws."""
    mu, weight = np.polynomial.legendre.leggauss(400)
    law = {g: (1 - g * g) / 2 / (1 + g * g - 2 * g * mu) ** 1.5 * weight for g in (0.79, 0.795, 0.8)}
    assert samples_needed(chi_square_distance(law[0.79], law[0.8])) == pytest.approx(2.2e4, rel=0.03)
    assert samples_needed(chi_square_distance(law[0.795], law[0.8])) == pytest.approx(8.5e4, rel=0.03)
    assert samples_needed(0.0) == np.inf
    assert chi_square_distance(np.array([1.0, 0.5]), np.array([1.0, 0.0])) == np.inf


def test_a_likelihood_ratio_reaches_the_limit_and_less_does_not():
    rng, distance = np.random.default_rng(), 0.01
    n = round(samples_needed(distance, alpha=0.01, miss=0.1))
    up = 0.5 + 0.5 * np.sqrt(distance)  # a coin against a fair one, at that distance
    for share, bounds in ((1.0, (0.84, 0.95)), (0.25, (0.0, 0.4))):
        m = round(share * n)
        heads = rng.binomial(m, up, 20_000)
        rejected = np.mean(heads > m / 2 + 2.326 * np.sqrt(m) / 2)
        assert bounds[0] < rejected < bounds[1]


@pytest.mark.parametrize("name", ["bent", "bent-last", "ripple", "skipped", "tail"])
def test_the_density_of_changed_uniforms_is_theirs(name):
    plant = mutation(name).plant
    assert isinstance(plant, OfUniforms)
    u = np.random.default_rng().random((400_000, 2))
    changed = plant.change(u.copy())
    column = int(name == "bent-last")
    edges = np.array([0.0, 0.1, 0.25, 0.41, 0.42, 0.6, 0.75, 0.9, 0.999, 1.0])
    counts = np.histogram(changed[:, column], edges)[0]
    fine = np.linspace(0, 1, 2_000_001)[:-1] + 2.5e-7
    density = plant.density(np.stack([fine, fine], axis=-1))
    mass = np.histogram(fine, edges, weights=density / len(fine))[0]
    assert mass.sum() == pytest.approx(1, abs=1e-4)
    assert np.all(np.abs(counts - 4e5 * mass) < 7 * np.sqrt(4e5 * mass + 1) + 20)


def test_uniforms_that_nobody_uses_are_left_alone():
    second = case(lambda u: u[:, 1])
    mutated = mutation("bent").plant(second)
    u = np.random.default_rng().random((1000, 2))
    assert np.array_equal(mutated.subject.sample(u), u[:, 1] ** 1.1)
    assert mutation("reused").plant(second) is None  # one that matters cannot be used for another
    assert mutation("bent-last").plant(second) is None


def test_what_is_lost_on_the_way_to_the_points_needs_more_samples():
    """A tail of the first uniform is a tail of the points, or is spread over all of them."""
    kept = mutation("tail").plant(case(lambda u: u[:, 0], 1)).needed()
    assert 1e4 < kept < 1e5  # 1 / (1e-3) of the distance: 5e4
    spread = mutation("tail").plant(case(lambda u: (u[:, 0] + u[:, 1]) % 1)).needed()
    assert spread > 1e6


def test_a_symmetric_law_is_its_own_mirror():
    assert mutation("mirrored").plant(case(lambda u: u[:, 0], 1)).equal
    slanted = Planted(lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, Interval(0, 1), 1)
    assert not mutation("mirrored").plant(SamplerCase(name="mine", make=lambda: slanted)).equal


def test_errors_of_what_is_returned_need_that_it_is():
    bare, full = case(lambda u: u[:, 0]), case(lambda u: Draw(u[:, 0], np.ones(len(u)), np.ones(len(u))))
    for name in ("returned-pdf", "weight"):
        assert mutation(name).plant(bare) is None
        assert mutation(name).plant(full) is not None
    assert mutation("label").plant(full) is None
    assert mutation("atom").plant(full) is None


def test_names_of_mutations_are_their_own():
    names = [m.name for m in (*MUTATIONS, *ESTIMATORS)]
    assert len(set(names)) == len(names)
