"""Relations: right renderers keep them all, each fault breaks the one that isolates it, and settings are moved as a whole."""

import numpy as np
import pytest

import fogproof
from fogproof.analytic import optical_thickness
from fogproof.catalogue.relations.path_tracer import IN_A_BOX, IN_A_GRID, IN_A_SLAB, IN_COLOUR
from fogproof.catalogue.twins import renderers
from fogproof.catalogue.twins.renderers import traced
from fogproof.relations import RELATIONS, PathSetting, comparisons
from fogproof.relations.moved import scaled, translated, turned
from fogproof.scene import GaussianPuffs, Medium, PiecewiseConstantMedium, PointLight, Procedural, Ray
from fogproof.scene.shapes import Ball, HalfSpace

PUFFS = GaussianPuffs(np.array([[0.0, 0.5, 0.0]]), np.array([0.7]), np.array([2.0]))
LAYERS = PiecewiseConstantMedium((-1, 0, 2), (0.5, 0.25))
FOG = Medium(0.5, 0.25)
SETTINGS = {"box": IN_A_BOX, "colour": IN_COLOUR, "grid": IN_A_GRID, "slab": IN_A_SLAB}


def broken(render, setting, samples=10_000, **options):
    results = fogproof.check_relations(render, setting, samples=samples, **options)
    return {result.name for result in results if result.verdict.outcome == "rejected"}


@pytest.mark.parametrize("place", SETTINGS)
def test_our_path_tracer_keeps_every_relation(place):
    assert broken(traced, SETTINGS[place]) == set()


@pytest.mark.parametrize(
    ("fault", "place", "isolated_by"),
    [
        (renderers.majorant_of_the_first_channel, "colour", "channel-alone"),
        (renderers.light_counted_twice, "box", "integrators/mis"),
        (renderers.sum_of_channels, "box", "equal-channels"),
        (renderers.border_of_half_a_voxel, "box", "constant-grid/trilinear"),
        (renderers.flipped_near_the_horizon, "box", "turned"),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_a_fault_breaks_the_relation_that_isolates_it_and_no_other(fault, place, isolated_by):
    """All of them, with more samples: tools/relations.py."""
    found = broken(fault, SETTINGS[place], samples=50_000)
    assert found
    assert {name for name in found if not name.startswith(isolated_by)} == set()


def test_between_them_the_settings_allow_every_relation():
    """A relation that no setting allows is tested by nothing."""
    allowed = [{c.name.partition("/")[0] for c in comparisons(setting)} for setting in SETTINGS.values()]
    assert len(set.union(*allowed)) == len(RELATIONS)
    assert all(comparison.isolates for setting in SETTINGS.values() for comparison in comparisons(setting))


@pytest.mark.parametrize("move", [lambda s: translated(s, (3.0, -1.0, 0.5)), turned, lambda s: scaled(s, 8.0)])
@pytest.mark.parametrize(
    "setting",
    [
        IN_A_GRID,
        PathSetting(PUFFS, Ball((0.0, 0.0, 0.0), 3.0), Ray((0, 0, -9), (0, 0, 1), 18.0)),
        PathSetting(LAYERS, HalfSpace((0.0, 0.0, 1.5), (0.0, 0.0, 1.0)), Ray((1, 0, 9), (0, 0.6, -0.8))),
        PathSetting(FOG, Ball((0.0, 1.0, 0.0), 2.0), Ray((0, 0, -9), (0, 0, 1), 4.0), PointLight((1.0, 2.0, 3.0), 5.0)),
    ],
    ids=lambda value: type(value.medium).__name__ if isinstance(value, PathSetting) else None,
)
def test_moving_a_setting_leaves_its_thickness(move, setting):
    """The oracle sees the same thickness along the moved ray: points, directions, coefficients and arrays moved together."""
    there, first = move(setting), optical_thickness(setting.medium, setting.ray)
    assert optical_thickness(there.medium, there.ray).value == pytest.approx(float(first.value), rel=1e-12)
    assert float(first.value) > 0


def test_functions_of_place_cannot_be_moved():
    setting = IN_A_BOX.but(medium=Procedural(lambda x: np.ones(len(x)), 2.0))
    with pytest.raises(fogproof.UnsupportedError, match="function of place"):
        turned(setting)


def test_a_renderer_that_is_no_function_is_told():
    with pytest.raises(fogproof.InvalidValueError, match="render must be a function"):
        fogproof.check_relations(None, IN_A_BOX)


def test_alpha_is_shared():
    results = fogproof.check_relations(traced, IN_A_SLAB, samples=1000, alpha=1e-3, seed=3)
    assert sum(result.verdict.alpha for result in results) == pytest.approx(1e-3)
    again = fogproof.check_relations(traced, IN_A_SLAB, samples=1000, alpha=1e-3, seed=3)
    assert [r.verdict.p_value for r in again] == [r.verdict.p_value for r in results]
