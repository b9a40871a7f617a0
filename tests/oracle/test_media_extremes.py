"""Media where numbers end: far away, far up, thin as nothing, no rays at all; and absorption beside a large sigma_s."""

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import (
    emitted_radiance,
    free_path,
    optical_thickness,
    radiance_by_ode,
    radiance_by_quadrature,
    transmittance,
    transmittance_lookups,
    transmittance_variance,
)
from fogproof.estimators import DeltaTransmittance, RatioTransmittance
from fogproof.scene import ExponentialMedium, LinearMedium, Medium, PiecewiseConstantMedium, Procedural, Ray, VoxelGrid

UP = (0.0, 0.0, 1.0)
LAYERS = PiecewiseConstantMedium([1.0, 2.0, 3.0], [0.3, 0.8])
VOXELS = VoxelGrid(np.full((2, 2, 2), 0.5), (-1, -1, 1), (1, 1, 3), "nearest")


def test_absorption_is_not_what_scattering_leaves():
    ray = Ray((0, 0, 0), UP, 1.0)
    medium = Medium(1e-12, 1.0, emission=1.0)
    with mp.workdps(40):
        sigma = mp.mpf(1e-12) + 1
        truth = mp.mpf(1e-12) * -mp.expm1(-sigma) / sigma
        for way in (emitted_radiance, radiance_by_quadrature, radiance_by_ode):
            found = way(medium, ray)
            assert abs(mp.mpf(float(found.value)) - truth) <= float(found.error) <= 1e-10 * truth
    grid = VoxelGrid(
        np.full((2, 2, 2), 1.0), (-1, -1, 0), (1, 1, 1), albedo=np.full((2, 2, 2), 1 - 2.0**-40), emission=1.0
    )
    found = emitted_radiance(grid, ray)
    assert np.isclose(found.value, 2.0**-40 * -np.expm1(-1.0), rtol=1e-12)


@pytest.mark.parametrize(("sigma_0", "top"), [(1.0, 800.0), (1e-300, 1000.0), (5e-324, 1400.0), (1e300, -900.0)])
def test_exponential_media_beyond_709_e_folds(sigma_0, top):
    ray = Ray((0, 0, -top), UP, 20.0)
    medium = ExponentialMedium(sigma_0, (0, 0, -1.0))
    with mp.workdps(40):
        truth = mp.mpf(sigma_0) * mp.exp(top) * -mp.expm1(-20)
        tau, through = optical_thickness(medium, ray), transmittance(medium, ray)
        if truth > mp.mpf("1.8e308"):
            assert tau.value == np.inf
        else:
            assert abs(mp.mpf(float(tau.value)) - truth) <= float(tau.error) <= 1e-12 * truth
        assert (
            abs(mp.mpf(float(through.value)) - mp.exp(-truth)) <= float(through.error) <= 1e-12 * through.value + 1e-300
        )


@pytest.mark.parametrize("far", [1e3, 1e6, 1e9])
@pytest.mark.parametrize("medium", [LAYERS, VOXELS], ids=["layers", "voxels"])
def test_the_ode_counts_the_rounding_of_places(medium, far):
    ray = Ray((0.3, 0.4, -far), UP, 2 * far)
    found, truth = radiance_by_ode(medium, ray, 0.0, 1.0), transmittance(medium, ray)
    assert abs(found.value - truth.value) <= found.error + truth.error
    assert found.error <= 1e-14 * far + 1e-9


def test_vacuum_between_unknown_nodes_says_nothing():
    def box(x):
        return np.where(np.abs(x[..., 2] - 0.011) < 0.005, 100.0, 0.0)

    found = optical_thickness(Procedural(box, 100.0), Ray((0, 0, -50), UP, 100.3))
    assert abs(found.value - 1.0) <= found.error
    declared = optical_thickness(Procedural(box, 100.0, detail=0.01), Ray((0, 0, -1), UP, 3.0))
    assert abs(declared.value - 1.0) <= declared.error <= 1e-9


@pytest.mark.parametrize("medium", [LAYERS, VOXELS], ids=["layers", "voxels"])
@pytest.mark.parametrize(
    "origin", [(0.2, 0.1, -1.0), (0.2, 0.1, 2.5), (9.0, 0.0, -1.0)], ids=["outside", "inside", "past"]
)
def test_trackers_look_as_often_as_the_oracle_says(medium, origin):
    """In the box alone: vacuum around voxels costs nothing, vacuum around layers, which have no box, does."""
    ray, majorant = Ray(origin, UP, 7.0), 1.25
    for tracking, tracker in (("delta", DeltaTransmittance), ("ratio", RatioTransmittance)):
        cost = np.asarray(tracker(medium, ray, majorant).draw(np.random.default_rng(), 100_000).cost)
        expected = transmittance_lookups(medium, ray, tracking, majorant)
        assert abs(cost.mean() - expected.value) <= 6 * cost.std() / np.sqrt(len(cost)) + expected.error
    if medium is LAYERS:
        assert transmittance_lookups(medium, ray, "ratio", majorant).value == 7.0 * majorant


def test_no_rays_have_no_answers():
    none = Ray(np.zeros((0, 3)), UP, 1.0)
    linear = LinearMedium(1.0, (0, 0, 0.1))
    for found in (
        transmittance(VOXELS, none),
        free_path(VOXELS, none, np.zeros(0)),
        free_path(linear, none, np.zeros(0)),
        transmittance_variance(linear, none, "ratio", 9.0),
        transmittance_variance(VOXELS, none, "delta"),
        transmittance_lookups(LAYERS, none, "delta", 9.0),
        radiance_by_quadrature(linear, none),
        radiance_by_ode(linear, none),
    ):
        assert found.value.shape == found.error.shape == (0,)
