"""Invariant: slabs hold their errors whatever the phase function: peaks under other names, kinks, an infinite density."""

import numpy as np
import pytest

from fogproof.analytic import slab_reflectance, slab_transmittance
from fogproof.analytic.multiple import slab_by_doubling
from fogproof.scene import DoubleHenyeyGreenstein, Draine, FournierForand, HenyeyGreenstein, Mixture, Tabulated

PEAK = HenyeyGreenstein(0.999)
SAME = [Draine(0.999, 0.0), DoubleHenyeyGreenstein(0.999, 0.999, 0.4), Mixture((PEAK, Draine(0.999, 0.0)), (0.3, 0.7))]
QUANTITIES = (slab_reflectance, slab_transmittance)


@pytest.mark.parametrize("phase", SAME, ids=lambda phase: type(phase).__name__)
@pytest.mark.parametrize(("albedo", "tau"), [(0.99, 1.0), (1.0, 20.0)])
def test_one_function_under_four_names(phase, albedo, tau):
    for quantity in QUANTITIES:
        one, other = quantity(albedo, tau, 0.6, PEAK), quantity(albedo, tau, 0.6, phase)
        assert abs(one.value - other.value) <= min(one.error, other.error)


SLOW = [
    FournierForand(1.33, 4.9),
    FournierForand(1.1, 3.5835),
    Tabulated.normalised((-1, -0.2, 0.3, 0.9, 1), (1, 0, 2, 1, 10)),
    Tabulated.normalised((-1, 0.9, 0.90001, 1), (1, 1, 30, 30)),
    Tabulated.normalised((-1, 0.99, 0.999, 1), (1, 1, 300, 30)),
]


@pytest.mark.parametrize("phase", SLOW, ids=range(len(SLOW)))
def test_moments_that_fall_slowly(phase, monkeypatch):
    """Against twice as many nodes and moments."""
    albedo, tau, mu0 = np.array([0.3, 1.0, 1.0, 0.9]), np.array([0.1, 3.0, 0.1, 3.0]), np.array([1.0, 0.6, 0.6, 0.2])
    found = slab_reflectance(albedo, tau, mu0, phase)
    monkeypatch.setattr(slab_by_doubling, "LEVELS", (60, 80))
    slab_by_doubling.phase_moments.cache_clear()
    finer = slab_reflectance(albedo, tau, mu0, phase)
    slab_by_doubling.phase_moments.cache_clear()
    assert np.all(np.abs(found.value - finer.value) <= found.error)
