"""At a point a medium has what stands there: the layer that begins at a boundary holds it, and nothing holds what is outside."""

import numpy as np
import pytest

from fogproof.analytic import coefficients
from fogproof.errors import InvalidValueError
from fogproof.scene import LinearMedium, PiecewiseConstantMedium, VoxelGrid

UP = (0.0, 0.0, 1.0)
COLOURED = np.array([[1.0, 2.0], [3.0, 4.0]])


@pytest.mark.parametrize(
    ("z", "sigma_t"), [(-0.01, 0.0), (0.0, 1.0), (0.99, 1.0), (1.0, 3.0), (1.99, 3.0), (2.0, 0.0), (9, 0)]
)
def test_layers_begin_at_their_boundaries_and_end(z, sigma_t):
    layers = PiecewiseConstantMedium((0, 1, 2), (1.0, 3.0), albedo=0.25)
    found = coefficients(layers, (5.0, -3.0, z), UP)
    assert (found.sigma_t, found.sigma_s, found.sigma_a) == (sigma_t, 0.25 * sigma_t, 0.75 * sigma_t)
    coloured = coefficients(PiecewiseConstantMedium((0, 1, 2), COLOURED), (5.0, -3.0, z), UP)
    assert np.array_equal(coloured.sigma_t, [sigma_t, sigma_t + (sigma_t > 0)])


def test_a_line_below_nothing_is_nothing_and_does_not_glow():
    places = [(0, 0, 0.25), (0, 0, 1.0), (0, 0, 4.0)]
    found = coefficients(LinearMedium(1.0, (0, 0, -1.0), emission=2.0), places, UP)
    assert found.sigma_t.tolist() == [0.75, 0, 0]
    assert found.emission.tolist() == [2, 0, 0]


@pytest.mark.parametrize("bad", [(0, 0), (0, 0, [1, 2]), "here", 1.0])
def test_what_is_no_place_is_named(bad):
    for place, direction, name in ((bad, UP, "x"), ((0, 0, 0), bad, "w")):
        with pytest.raises(InvalidValueError, match=f"^{name} must"):
            coefficients(LinearMedium(1.0, UP), place, direction)


@pytest.mark.parametrize("interpolation", ["nearest", "trilinear"])
def test_a_grid_ends_at_its_box(interpolation):
    grid = VoxelGrid(np.full((2, 2, 2), 1.5), (-1, -1, -1), (1, 1, 1), interpolation=interpolation)
    for place, inside in (((0, 0, 0.999), True), ((0, 0, 1.001), False), ((-1.5, 0, 0), False)):
        assert coefficients(grid, place, UP).sigma_t == 1.5 * inside
