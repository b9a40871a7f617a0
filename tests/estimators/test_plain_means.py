"""Estimators and densities whose value is one line: held to the oracle over even points, where no chance hides a factor."""

from typing import get_args

import numpy as np
import pytest

from fogproof.analytic import emitted_radiance, phase_pdf, single_scattering, transmittance, transmittance_variance
from fogproof.estimators.airlight.placing import Placing
from fogproof.estimators.airlight.single_scattering import Airlight
from fogproof.estimators.free_paths.fog import UniformEmission
from fogproof.estimators.phase.directions import Directions
from fogproof.estimators.phase.functions import phase_value
from fogproof.estimators.tracking.ratio import ResidualRatioTransmittance
from fogproof.scene import (
    CornetteShanks,
    Draine,
    ExponentialMedium,
    HenyeyGreenstein,
    Isotropic,
    LinearMedium,
    Medium,
    Mixture,
    PointLight,
    Ray,
    Rayleigh,
    Schlick,
)


class Even:
    """A generator whose numbers are the middles of n equal parts: the mean over them is a midpoint rule."""

    def random(self, shape):
        n = np.atleast_1d(shape)[0]
        return ((np.arange(n) + 0.5) / n).reshape(shape)


@pytest.mark.parametrize(
    "medium",
    [
        Medium(0.6, 0.2, emission=3.0),
        LinearMedium(0.5, (0, 0, 0.4), albedo=0.3, emission=2.0),
        ExponentialMedium(1.5, (0, 0, -0.7), albedo=0.3, emission=2.0),
    ],
    ids=lambda it: type(it).__name__,
)
def test_emission_at_even_places_is_the_oracles(medium):
    ray = Ray((0, 0, 0), (0, 0, 1), 2.5)
    found = UniformEmission(medium, ray).draw(Even(), 20_000)
    assert found.value.mean() == pytest.approx(emitted_radiance(medium, ray).value, rel=1e-7)


def test_a_density_of_weights_that_do_not_quite_sum_to_one():
    mixed = Mixture((Isotropic(), HenyeyGreenstein(0.5)), (0.25, 0.75 + 8e-10))
    mu = np.linspace(-1, 1, 9)
    assert phase_value(mixed, mu) == pytest.approx(phase_pdf(mixed, mu).value, rel=1e-12)


@pytest.mark.parametrize("placing", get_args(Placing))
def test_airlight_at_even_places_is_the_oracles(placing):
    """One place each: whatever law it has, and wherever the light is, the mean over its uniform is the integral."""
    medium, ray, light = Medium(0.1, 0.4), Ray((0, 0, 0), (0, 0, 1), 2.5), PointLight((0.3, 0.2, 1.1), 3.0)
    found = Airlight(medium, ray, light, placing=placing).draw(Even(), 20_000)
    assert found.value.mean() == pytest.approx(single_scattering(medium, ray, light).value, rel=1e-3)


@pytest.mark.parametrize(
    "phase",
    [
        HenyeyGreenstein(0.7),
        HenyeyGreenstein(-0.3),
        Rayleigh(),
        Schlick(0.5),
        Draine(0.6, 2.0),
        CornetteShanks(0.4),
        Isotropic(),
    ],
    ids=str,
)
def test_the_density_that_comes_with_a_direction_is_the_oracles(phase):
    draw = Directions(phase).sample(np.random.default_rng().random((1000, 2)))
    assert draw.pdf == pytest.approx(phase_pdf(phase, draw.x[:, 2]).value, rel=1e-9)


@pytest.mark.parametrize("control", [0.0, 0.3, 0.6, 1.2])
def test_residual_ratio_tracking_has_the_oracles_mean_for_any_control(control):
    """The extinction lies in [0.5, 1.5] for all that is known: a large control leaves more below it than above."""
    medium, ray = LinearMedium(0.5, (0, 0, 0.4)), Ray((0, 0, 0), (0, 0, 1), 2.0)
    found = ResidualRatioTransmittance(medium, ray, 1.5, control).draw(np.random.default_rng(), 40_000).value
    truth = transmittance(medium, ray).value
    assert abs(found.mean() - truth) < 6 * found.std() / 200
    variance = transmittance_variance(medium, ray, "residual-ratio", max(1.5 - control, control - 0.5), control).value
    spread = np.std((found - found.mean()) ** 2) / 200
    assert abs(found.var() - variance) < 7 * spread
