"""Derivatives: right estimators pass, wrong ones are rejected and what they average to instead is named."""

import doctest

import numpy as np
import pytest

import fogproof
from fogproof import analytic, gradient_check
from fogproof.estimators.derivatives.airlight import AirlightSlopes
from fogproof.estimators.derivatives.slab_walks import SlabSlopes, SlabWalk
from fogproof.estimators.derivatives.transmittance import FreePathScore, RatioTrackingSlopes
from fogproof.scene import HenyeyGreenstein, Medium, PiecewiseConstantMedium, PointLight, Ray

RAY = Ray((0, 0, 0), (0, 0, 1), 2.0)
LAMP = PointLight((1.0, 1.0, 0.5), 3.0)
FOG = {"medium": Medium(0.3, 0.5, HenyeyGreenstein(0.4)), "ray": RAY}
LIT = {**FOG, "light": LAMP}
COEFFICIENTS = ("medium.sigma_a", "medium.sigma_s", "medium.phase.g")


def check(draw, *about, samples=40_000, **options):
    return fogproof.check_gradient(draw, *about, samples=samples, **options)


def test_examples():
    results = doctest.testmod(gradient_check, extraglobs={"np": np})
    assert (results.attempted > 0, results.failed) == (True, 0)


def test_right_ones_pass():
    score = FreePathScore(0.8, 2.0)
    verdict = check(score.draw, "transmittance", "medium.sigma_t", FOG)
    assert verdict.outcome == "not rejected"
    assert verdict.reproduce.startswith("check_gradient(")
    assert (
        check(AirlightSlopes(FOG["medium"], RAY, LAMP).draw, "single_scattering", COEFFICIENTS, LIT).outcome
        == "not rejected"
    )
    layers = PiecewiseConstantMedium((0, 1, 2), (0.5, 1.0))
    slopes = RatioTrackingSlopes((0.5, 1.0), (1.0, 1.0), 1.5)
    assert (
        check(slopes.draw, analytic.transmittance, "medium.sigma_t", {"medium": layers, "ray": RAY}).outcome
        == "not rejected"
    )
    known = analytic.gradient("slab_reflectance", "albedo", albedo=0.8, tau=1.0, mu0=0.5)
    walks = SlabSlopes(SlabWalk(0.8, 1.0, 0.5))
    assert check(lambda rng, n: walks.draw(rng, n).value[:, 0], known).outcome == "not rejected"
    assert check(lambda rng, n: rng.normal(float(known), 1, n), float(known)).outcome == "not rejected"


def passing(factor):
    """exp(-1.6) of the realisations, times a factor."""
    return lambda rng, n: np.where(rng.standard_exponential(n) > 1.6, factor, 0.0)


@pytest.mark.parametrize(
    ("factor", "told"),
    [
        (2.0, "its sign flipped"),
        (-1.0, "half the derivative"),
        (-4.0, "twice the derivative"),
        (1.0, "the quantity itself"),
        (-2 / np.exp(-1.6), "the derivative of the quantity's logarithm"),
    ],
)
def test_what_it_averages_to_is_named(factor, told):
    verdict = check(passing(factor), "transmittance", "medium.sigma_t", FOG)
    assert verdict.outcome == "rejected"
    assert told in verdict.diagnosis


def test_a_derivative_by_another_parameter_is_named():
    """Emission by sigma_a, where that by sigma_s was wanted, and a parameter that nothing depends on."""
    glowing = {"medium": Medium(0.3, 0.5, emission=2.0), "ray": RAY}
    taken = float(analytic.gradient("emitted_radiance", "medium.sigma_a", **glowing))
    verdict = check(lambda rng, n: rng.normal(taken, 0.5, n), "emitted_radiance", "medium.sigma_s", glowing)
    assert "the derivative by sigma_a" in verdict.diagnosis
    still = check(lambda rng, n: rng.normal(0, 0.1, n), "emitted_radiance", "medium.sigma_a", glowing)
    assert "do not depend on the parameter" in still.diagnosis


def test_the_wrong_channel_is_told():
    right = AirlightSlopes(FOG["medium"], RAY, LAMP, "uniform")
    verdict = check(lambda rng, n: right.draw(rng, n).value * [1, 1, -1], "single_scattering", COEFFICIENTS, LIT)
    assert verdict.diagnosis == "the estimates average to the derivative with its sign flipped (channel 2)"


def test_a_rare_term_that_was_never_drawn_is_no_pass():
    """Its sign is wrong, and its standard error small: what an unseen event would have to bring is said."""
    rare = lambda rng, n: np.where(rng.random(n) < 1e-7, 3e6, 0.0) - 0.1 + 1e-3 * rng.standard_normal(n)  # noqa: E731
    verdict = check(rare, 0.2)
    assert verdict.outcome != "not rejected"


def test_few_expensive_realisations():
    few = np.random.default_rng(1).normal(-0.4, 0.02, 30)
    assert fogproof.check_gradient(few, -0.4, tails="light").outcome == "not rejected"
    assert fogproof.check_gradient(few, 0.4, tails="light").outcome == "rejected"
    assert fogproof.check_gradient(few, 0.4).outcome == "inconclusive"


@pytest.mark.parametrize(
    ("about", "told"),
    [
        (("transmittance",), "wrt must name the parameter"),
        ((0.5, "medium.sigma_t"), "quantity must be a quantity of the oracle"),
        (("transmitance", "medium.sigma_t", FOG), "must be a quantity of fogproof.analytic"),
        (("transmittance", "medium.sigma", FOG), "'sigma' is none of"),
    ],
)
def test_wrong_arguments_are_told(about, told):
    with pytest.raises(fogproof.InvalidValueError, match=told):
        check(passing(1.0), *about)
