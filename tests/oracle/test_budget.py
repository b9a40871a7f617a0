"""Invariant: quadrature of a user's function ends after a counted number of looks at it, with a bound that holds,
or refuses by name before it takes memory."""

import numpy as np
import pytest

from fogproof import PointLight, Ray
from fogproof.analytic import free_path, single_scattering, transmittance
from fogproof.analytic.arithmetic import budget, panel_rule
from fogproof.errors import UnsupportedError
from fogproof.scene import Procedural, VoxelGrid
from fogproof.scene.lights import SphereLight

EDGES, VALUES = np.array([1.0, 2.0]), np.array([0.5, 1.3, 0.8])
BOX = {"lower": (0, 0, 0), "upper": (3, 1, 1)}
RAY = Ray((-1, 0.5, 0.5), (1, 0, 0), 6.0)
LAMP = PointLight((1.5, 3.0, 0.5), 10.0)
GRID = VoxelGrid(VALUES.reshape(3, 1, 1), **BOX, interpolation="nearest", albedo=0.9)


class Jumps:
    """An extinction with steps across x, which counts the places it is asked for."""

    def __init__(self):
        self.places = 0

    def __call__(self, x):
        self.places += x[..., 0].size
        return VALUES[np.searchsorted(EDGES, x[..., 0], side="right")]


def procedural(function, **more):
    return Procedural(function, majorant=1.3, **BOX, albedo=0.9, **more)


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(budget, "PLACES", 2**18)
    return 2**18


def test_jumps_end_in_a_bound(small):
    jumps, truth = Jumps(), single_scattering(GRID, RAY, LAMP)
    found = single_scattering(procedural(jumps), RAY, LAMP)
    assert jumps.places < budget.REFUSED * small
    off = abs(found.value - truth.value)
    assert off < found.error < 0.1 * truth.value


def test_more_looks_buy_a_better_bound(monkeypatch):
    errors = []
    for places in (2**18, 2**20):
        monkeypatch.setattr(budget, "PLACES", places)
        errors.append(single_scattering(procedural(Jumps()), RAY, LAMP).error)
    assert errors[1] < 0.5 * errors[0]


def test_smooth_media_do_not_notice(small):
    def smooth(x):
        return 0.5 + 0.1 * np.sin(x[..., 0])

    found = single_scattering(procedural(smooth), RAY, LAMP)
    assert found.error < 1e-12 * found.value


def test_a_light_with_extent(small):
    jumps, light = Jumps(), SphereLight((1.5, 3.0, 0.5), 0.25, 10.0)
    with pytest.raises(UnsupportedError, match="VoxelGrid"):
        single_scattering(procedural(jumps), RAY, light)
    assert jumps.places <= budget.REFUSED * small


@pytest.mark.parametrize("ask", [lambda m: transmittance(m, RAY), lambda m: single_scattering(m, RAY, LAMP)])
def test_a_tiny_detail_is_refused_before_memory_is_taken(ask):
    jumps = Jumps()
    with pytest.raises(UnsupportedError, match="larger `detail`"):
        ask(procedural(jumps, detail=1e-9))
    assert jumps.places < 10_000


def test_a_small_detail_under_a_lamp_is_refused_by_name(small):
    jumps = Jumps()
    with pytest.raises(UnsupportedError, match="places"):
        single_scattering(procedural(jumps, detail=2e-3), RAY, LAMP)
    assert jumps.places <= budget.REFUSED * small


def test_free_paths_in_jumps(small):
    jumps = Jumps()
    found = free_path(procedural(jumps), RAY, [1.0, 2.0])
    truth = free_path(GRID, RAY, [1.0, 2.0])
    assert jumps.places < budget.REFUSED * 2 * small
    assert (np.abs(found.value - truth.value) <= found.error + truth.error).all()
    assert (found.error < 1e-3).all()


def test_the_bound_for_steps_is_the_worst_step():
    place = np.linspace(0, 1, 4001)
    steps = (panel_rule.NODES[:, None] > place).astype(float)
    off = np.abs(panel_rule.WEIGHTS @ steps - (1 - place))
    bound = budget.of_bounded_variation(1.0, 1.0)
    assert 0.99 * bound < off.max() <= bound
