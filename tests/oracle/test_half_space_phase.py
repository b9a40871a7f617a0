"""Invariant: a half space of any phase function reflects what is stated, within the stated error."""

import numpy as np
import pytest
from doubling_truth import doubled_truth

from fogproof.analytic import (
    half_space_brdf,
    half_space_reflectance,
    half_space_spherical_albedo,
    slab_brdf,
    slab_reflectance,
)
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein

ALMOST_ISOTROPIC = HenyeyGreenstein(1e-18)
MU = np.array([0.05, 0.5, 1.0])


@pytest.mark.parametrize("albedo", [0.5, 0.999, 1.0])
def test_doubling_agrees_with_the_h_function(albedo):
    for one, other in (
        (half_space_reflectance(albedo, MU), half_space_reflectance(albedo, MU, ALMOST_ISOTROPIC)),
        (half_space_brdf(albedo, 0.5, MU), half_space_brdf(albedo, 0.5, MU, ALMOST_ISOTROPIC, 1.0)),
        (half_space_spherical_albedo(albedo), half_space_spherical_albedo(albedo, ALMOST_ISOTROPIC)),
    ):
        assert np.all(np.abs(one.value - other.value) <= one.error + other.error)
        assert np.all(other.error <= 1e-11 * other.value)


def test_adding_in_a_hundred_digits_agrees():
    truth, _ = doubled_truth(0.9, 60.0, 0.5, lambda degree: 0.5**degree, n=14, halvings=60)
    found = half_space_reflectance(0.9, 0.5, HenyeyGreenstein(0.5))
    assert found.value == pytest.approx(truth, rel=1e-9)
    assert found.error <= 1e-12


def test_another_solver_agrees():
    disort = pytest.importorskip("PythonicDISORT.pydisort").pydisort
    streams, mu0 = 48, 0.5
    chi = (0.7 ** np.arange(streams + 1.0))[None]
    nodes, up, _, _, radiance = disort(120.0, 0.95, streams, chi, mu0, 1 / mu0, 0.0, NLeg=streams)
    phase = HenyeyGreenstein(0.7)
    assert half_space_reflectance(0.95, mu0, phase).value == pytest.approx(float(up(0.0)), rel=1e-7)
    i = int(np.argmin(np.abs(nodes - 0.7)))
    found = half_space_brdf(0.95, mu0, float(nodes[i]), phase, 1.0)
    assert found.value == pytest.approx(float(radiance(0.0, 1.0)[i]), rel=1e-6)


def test_deep_slabs_tend_to_it():
    phase = HenyeyGreenstein(0.4)
    for one, other in (
        (half_space_reflectance(0.99, MU, phase), slab_reflectance(0.99, 1e5, MU, phase)),
        (half_space_brdf(1.0, 0.5, MU, phase, 2.0), slab_brdf(1.0, 1e14, 0.5, MU, phase, 2.0)),
    ):
        assert np.all(np.abs(one.value - other.value) <= one.error + other.error)
    assert half_space_reflectance(1.0, MU, phase).value.tolist() == [1, 1, 1]


def test_azimuth_must_be_given():
    with pytest.raises(InvalidValueError) as raised:
        half_space_brdf(0.5, 0.5, 0.5, HenyeyGreenstein(0.3))
    assert raised.value.argument == "azimuth"
    assert half_space_brdf(0.0, 0.5, MU, HenyeyGreenstein(0.3), 1.0).value.tolist() == [0, 0, 0]
