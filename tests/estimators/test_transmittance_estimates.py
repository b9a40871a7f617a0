"""Invariant: estimators of the transmittance are unbiased in any medium, not in the voxels alone where they are enumerated."""

import numpy as np
import pytest

from fogproof.analytic import transmittance
from fogproof.checks import check_estimator, fresh_seed
from fogproof.errors import FogproofError, InvalidValueError, UnsupportedError
from fogproof.estimators import (
    DecompositionTransmittance,
    JitteredMarch,
    NextFlightTransmittance,
    PowerSeriesTransmittance,
    TelescopingTransmittance,
    UnbiasedMarch,
    WeightedTransmittance,
)
from fogproof.scene import ExponentialMedium, Medium, PiecewiseConstantMedium, Procedural, Ray, VoxelGrid

ALPHA = 1e-9
RAY = Ray((-0.6, -0.7, -0.5), (0.48, 0.6, 0.64), 1.75)
GRID = VoxelGrid(np.random.default_rng(4).uniform(0.3, 2.0, (4, 3, 5)), (-1, -1, -1), (1, 1, 1), "trilinear")
USER = Procedural(lambda x: 1 + 0.5 * np.sin(3 * x[..., 0]), 1.5, detail=0.5)
MEDIA = {"grid": GRID, "exponential": ExponentialMedium(0.6, (0.2, 0.1, -0.9)), "function": USER}
ESTIMATORS = {
    "telescoping": lambda medium: TelescopingTransmittance(medium, RAY, 2, 0.3),
    "unbiased-march": lambda medium: UnbiasedMarch(medium, RAY),
    "power-series": lambda medium: PowerSeriesTransmittance(medium, RAY, 2.0, 3.0),
    "weighted": lambda medium: WeightedTransmittance(medium, RAY, 1.0),
    "decomposition": lambda medium: DecompositionTransmittance(medium, RAY, 0.1),
    "next-flight": lambda medium: NextFlightTransmittance(medium, RAY, 1.6),
}


@pytest.mark.parametrize("medium", MEDIA)
@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_they_are_unbiased(estimator, medium):
    made = ESTIMATORS[estimator](MEDIA[medium])
    right = transmittance(MEDIA[medium], RAY)
    verdict = check_estimator(made.draw, right, samples=40_000, alpha=ALPHA, seed=fresh_seed())
    verdict.raise_if_rejected()


def test_a_march_is_not():
    right = float(transmittance(GRID, RAY).value)
    verdict = check_estimator(JitteredMarch(GRID, RAY, 1).draw, right, samples=100_000, alpha=ALPHA, seed=fresh_seed())
    assert verdict.outcome == "rejected"


def test_constant_media_leave_nothing_to_chance():
    T = np.exp(-1.75 * 0.8)
    rng = np.random.default_rng(0)
    for made in (JitteredMarch, UnbiasedMarch, TelescopingTransmittance):
        assert np.allclose(made(Medium(0.3, 0.5), RAY).draw(rng, 100).value, T, rtol=1e-13)
    assert np.allclose(DecompositionTransmittance(Medium(0.3, 0.5), RAY, 0.8).draw(rng, 100).value, T, rtol=1e-13)


def test_a_ray_that_misses_the_medium_passes():
    aside, rng = Ray((5.0, 0, 0), (0, 0, 1), 3.0), np.random.default_rng(1)
    for estimator in (JitteredMarch, UnbiasedMarch, TelescopingTransmittance, PowerSeriesTransmittance,
                      WeightedTransmittance, NextFlightTransmittance):  # fmt: skip
        draws = estimator(GRID, aside).draw(rng, 50)
        assert np.all(draws.value == 1)
    assert np.all(DecompositionTransmittance(GRID, aside, 0.2).draw(rng, 50).value == 1)


REFUSED = [
    (lambda: UnbiasedMarch(GRID, RAY, 0), "points must be a whole number"),
    (lambda: TelescopingTransmittance(GRID, RAY, 2, 0.6), "ratio must lie in the open interval"),
    (lambda: PowerSeriesTransmittance(GRID, RAY, -1.0), "pivot must be finite and >= 0"),
    (lambda: PowerSeriesTransmittance(GRID, RAY, reach=0.0), "reach must be finite and > 0"),
    (lambda: WeightedTransmittance(GRID, RAY, 0.0), "majorant must be finite and > 0"),
    (lambda: WeightedTransmittance(GRID, RAY, 1e12), "majorant must make at most 1e"),
    (lambda: DecompositionTransmittance(GRID, RAY, 1.9), "control must lie below the extinction"),
    (
        lambda: DecompositionTransmittance(GRID, RAY, 0.1, 0.5),
        "control must lie below the extinction, and the majorant 0.5",
    ),
    (lambda: DecompositionTransmittance(GRID, RAY, 3.0), "control must not exceed the majorant"),
    (lambda: NextFlightTransmittance(Medium((1, 2), 0.0), RAY), "2 channels"),
    (lambda: JitteredMarch(Medium(1.0, 0.0), Ray((0, 0, 0), (0, 0, 1), np.inf)), "infinite ray"),
    (lambda: UnbiasedMarch(GRID, Ray((0, 0, 0), (0, 0, 1), [1.0, 2.0])), "looks along one ray"),
    (lambda: JitteredMarch(Procedural(lambda x: -(x[..., 0] ** 2), 1.0), RAY), "sigma_t must be finite and >= 0"),
    (lambda: PowerSeriesTransmittance(PiecewiseConstantMedium((0, 1), (np.nan,)), RAY), "sigma"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_bad_input_is_refused(make, message):
    with pytest.raises((InvalidValueError, UnsupportedError), match=message) as caught:
        make().draw(np.random.default_rng(0), 10)
    assert isinstance(caught.value, FogproofError)
