"""Many numbers at once: what is taken beside arguments and answers stays flat, and no answer depends on its neighbours."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest

import fogproof.analytic as oracle
from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.contracts import Reference
from fogproof.scene import ExponentialMedium, Ray

MEDIUM = ExponentialMedium(sigma_0=0.3, rate=(0, 0, -0.5), albedo=0.9, emission=2)


def _radiance(x: np.ndarray) -> Reference:
    return oracle.radiance_by_quadrature(MEDIUM, Ray(np.zeros(3), np.array([0.0, 0, 1]), 5 * x), 0.5)


ASKED: dict[str, Callable[[np.ndarray], Reference]] = {
    "ball_source": lambda x: oracle.ball_source(0.9, 1, x),
    "half_space_spherical_albedo": lambda x: oracle.half_space_spherical_albedo(x),
    "radiance_by_quadrature": _radiance,
    "rod_reflectance_orders": lambda x: oracle.rod_reflectance_orders(x, 3),
    "slab_brdf": lambda x: oracle.slab_brdf(0.9, 1, 0.5, x),
}
"""A way to ask for each number in (0, 1]."""


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("ball_source", 12_000),
        ("half_space_spherical_albedo", 8000),
        ("rod_reflectance_orders", 36_000),
        ("slab_brdf", 12_000),
    ],
)
def test_memory_stays_flat(name: str, most: int) -> None:
    x = np.linspace(0.1, 1, most)
    ASKED[name](x[:2])
    taken = []
    for some in (x[::2], x):
        tracemalloc.start()
        try:
            found = ASKED[name](some)
            taken.append(tracemalloc.get_traced_memory()[1] - 8 * 6 * found.value.size)
        finally:
            tracemalloc.stop()
    slope = (taken[1] - taken[0]) / (most / 2)
    assert slope < 400, f"{slope:.0f} bytes a number beside arguments and answers"


@pytest.mark.parametrize("name", ASKED)
def test_no_answer_depends_on_its_neighbours(name: str) -> None:
    x = np.random.default_rng(1).permutation(np.linspace(0.1, 1, 5000))
    whole = ASKED[name](x)
    for some in (slice(0, 3), slice(len(x) - 3, len(x))):
        alone = ASKED[name](x[some])
        assert np.all(np.abs(alone.value - whole.value[some]) <= alone.error + whole.error[some])


def test_blocks_are_put_together_in_order() -> None:
    calls: list[int] = []

    def formula(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        calls.append(len(x))
        return x + y, np.stack([x, y], axis=-1)

    x, y = np.arange(5.0)[:, None], np.array([10.0, 20.0, 30.0])
    total, both = in_blocks(formula, 4, x, y)
    assert calls == [4, 4, 4, 3]
    np.testing.assert_array_equal(total, x + y)
    np.testing.assert_array_equal(both, np.stack(np.broadcast_arrays(x, y), axis=-1))


def test_no_points_make_no_answers() -> None:
    (found,) = in_blocks(lambda x: (np.stack([x, x], axis=-1),), 4, np.empty((0, 3)))
    assert found.shape == (0, 3, 2)


def test_a_single_point_has_the_shape_of_its_answer() -> None:
    number, colour = in_blocks(lambda x: (x, np.stack([x, x, x], axis=-1)), 4, np.array(2.0))
    assert number.shape == ()
    assert colour.shape == (3,)
