"""Every quantity broadcasts every array argument: empty, of length 1, of many axes, and says by name what does not fit."""

import inspect

import numpy as np
import pytest

from fogproof import analytic
from fogproof.errors import InvalidValueError
from fogproof.quantities import quantities
from fogproof.scene import Medium, PointLight, Ray
from fogproof.scene.files import read_fields

SLOW = {"radiance_by_ode": ((0,), (2, 1))}
"""Shapes for those that cost a second a call."""

SHAPES = ((0,), (2, 0), (1,), (2, 1, 2))

CASES = [
    (name, path)
    for name, quantity in quantities().items()
    for path, mark in quantity.arrays.items()
    if not mark.table and (path.partition(".")[0] in quantity.example)
]


def single(quantity):
    """Return the arguments of the example with one number, point or ray in place of each array."""
    arguments = read_fields(quantity.arguments, quantity.example, "example")
    for path, mark in quantity.arrays.items():
        value = arguments.get(path)
        if isinstance(value, np.ndarray) and not mark.table:
            arguments[path] = value.reshape(-1, 3)[0] if mark.axes else value.ravel()[min(1, value.size - 1)]
    if "ray" in arguments:
        ray = arguments["ray"]
        arguments["ray"] = Ray(ray.origin.reshape(-1, 3)[0], ray.direction.reshape(-1, 3)[0], ray.length.ravel()[0])
    return arguments


def stretched(arguments, path, axes, shape):
    """Return the arguments with the array at a path repeated to a shape."""
    outer, _, inner = path.partition(".")
    whole = (*shape, 3) if axes else shape
    if inner:
        ray = arguments[outer]
        keys = {"origin": ray.origin, "direction": ray.direction, "length": ray.length}
        return {**arguments, outer: Ray(**{**keys, inner: np.broadcast_to(keys[inner], whole)})}
    return {**arguments, outer: np.broadcast_to(arguments[outer], whole).copy()}


@pytest.mark.parametrize(("name", "path"), CASES)
def test_an_array_gives_its_shape_to_the_answer(name, path):
    quantity = quantities()[name]
    alone = quantity.function(**single(quantity))
    tail = np.shape(alone.value)
    for shape in SLOW.get(name, SHAPES):
        found = quantity.function(**stretched(single(quantity), path, quantity.arrays[path].axes, shape))
        value, error = np.broadcast_arrays(found.value, found.error)
        assert value.shape == shape + tail
        same = value == alone.value
        with np.errstate(invalid="ignore"):
            assert np.all(same | (np.abs(value - alone.value) <= error + alone.error))


PAIRS = {
    name: [path for path, mark in quantity.arrays.items() if path in quantity.example and not mark.table]
    for name, quantity in quantities().items()
}


@pytest.mark.parametrize("name", [name for name, paths in PAIRS.items() if len(paths) > 1])
def test_what_does_not_broadcast_is_told_by_name(name):
    quantity = quantities()[name]
    arguments = single(quantity)
    for path, length in zip(PAIRS[name], (2, 3), strict=False):
        arguments = stretched(arguments, path, quantity.arrays[path].axes, (length,))
    with pytest.raises(InvalidValueError) as caught:
        getattr(analytic, name)(**arguments)
    assert "must broadcast" in str(caught.value)
    assert caught.value.argument in quantity.arguments


def test_a_declared_function_is_still_itself():
    function = analytic.phase_pdf
    assert list(inspect.signature(function).parameters) == ["phase", "mu"]
    assert function.__doc__.startswith("Return the phase function")
    with pytest.raises(TypeError, match="phase_pdf"):
        function()


EXTREMES = [
    lambda: analytic.sky_colour([1e-44, 5e-324, 0.5, 1e-44], [0.5, 0.5, 1e-44, 1e-44], 0.3),
    lambda: analytic.plane_parallel_sky(
        [0.3, 1e300, 0, 0.3], [5e-324, 0.5, 5e-324, 0.5], [5e-324, 5e-324, 1, 5e-324], 0.3
    ),
    lambda: analytic.single_scattering_variance(FOG, RAYS, LAMP_FAR, "equiangular"),
    lambda: analytic.single_scattering_second_moment(FOG, RAYS, LAMP_FAR, "free-path"),
    lambda: analytic.ambient_fog_variance(FOG, RAYS, 1e150, 3),
    lambda: analytic.rayleigh_scattering_coefficient(1e-9, 1e247, 1e25, 5e-7),
    lambda: analytic.mean_square_displacement(2**53, [-1, 0, 0.9], 1.0),
]
FOG = Medium(0.1, 0.4)
RAYS = Ray((0, 0, 0), (0, 0, 1), [1, 1e154, np.inf])
LAMP_FAR = PointLight((1e154, 0, 0), 3)


@pytest.mark.parametrize("ask", EXTREMES, ids=range(len(EXTREMES)))
def test_at_the_ends_of_float64_there_is_a_limit_and_no_nan(ask):
    found = ask()
    assert not np.isnan(found.value).any()
    assert np.isfinite(found.error).all()


def test_a_view_along_the_horizon_sees_the_sunlit_air():
    """mu_view -> 0: the optical path is endless, and L -> f_p(mu) exp(-tau/mu_sun)."""
    sky = analytic.plane_parallel_sky(0.3, 0.5, [1e-9, 1e-44, 5e-324], 0.0)
    mu = np.sqrt(0.75)
    limit = 3 / (16 * np.pi) * (1 + mu * mu) * np.exp(-0.6)
    np.testing.assert_allclose(sky.value, limit, rtol=1e-8)
    assert np.all(np.abs(sky.value[1:] - limit) <= sky.error[1:])
    assert np.all(sky.error < 1e-13)
