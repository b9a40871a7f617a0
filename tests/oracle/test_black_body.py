"""Invariant: what is hot glows by Planck's law, whatever the grid, and bad temperatures are named."""

import mpmath
import numpy as np
import pytest

from fogproof.analytic import black_body_radiance, coefficients, emitted_radiance
from fogproof.errors import InvalidValueError
from fogproof.scene import Ray, TemperatureGrid, VoxelGrid

GRID = VoxelGrid(np.arange(8.0).reshape(2, 2, 2) / 4, (-1, -1, -1), (1, 1, 1), albedo=0.4)
NEAREST = VoxelGrid(np.full((2, 1, 1), 0.8), (-1, -1, -1), (1, 1, 1), "nearest", albedo=0.4)
RAY = Ray((-3.0, 0.2, 0.1), (1, 0, 0), 6.0)


@pytest.mark.parametrize("temperature", [1.0, 300.0, 1500.0, 6500.0, 1e7])
@pytest.mark.parametrize("wavelength", [1e-7, 5.5e-7, 1e-5, 1.0])
def test_fifty_digits_agree(temperature, wavelength):
    with mpmath.workdps(50):
        h, c, k = (mpmath.mpf(x) for x in ("6.62607015e-34", "299792458", "1.380649e-23"))
        T, length = mpmath.mpf(temperature), mpmath.mpf(wavelength)
        truth = 2 * h * c**2 / length**5 / (mpmath.exp(h * c / (length * k * T)) - 1) * mpmath.mpf("1e-9")
        found = black_body_radiance(temperature, wavelength)
        assert abs(mpmath.mpf(float(found.value)) - truth) <= float(found.error)
        assert found.error <= 1e-12 * float(truth) + 1e-300


def test_all_wavelengths_together_are_stefan_and_boltzmanns():
    x = np.linspace(-12, 8, 4001)
    length = 1e-6 * np.exp(x)
    whole = np.trapezoid(black_body_radiance(1500.0, length).value * 1e9 * length, x)
    assert whole == pytest.approx(5.670374419e-8 * 1500.0**4 / np.pi, rel=1e-8)


def test_even_heat_in_even_smoke_is_a_closed_form():
    fire = TemperatureGrid(NEAREST, np.full((2, 1, 1), 1500.0), (6e-7, 2e-6))
    found = emitted_radiance(fire, RAY)
    truth = black_body_radiance(1500.0, [6e-7, 2e-6]).value * 0.6 * -np.expm1(-1.6)
    assert np.all(np.abs(found.value - truth) <= found.error + 1e-14 * truth)
    assert np.all(found.error <= 1e-12 * truth)


def test_the_temperature_is_interpolated_and_not_the_radiance():
    heat = 1000.0 + 100.0 * np.arange(8.0).reshape(2, 2, 2)
    fire = TemperatureGrid(GRID, heat, 1e-6)
    middle = coefficients(fire, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert middle.emission == pytest.approx(black_body_radiance(heat.mean(), 1e-6).value, rel=1e-14)
    found = emitted_radiance(fire, RAY)
    glow = black_body_radiance(heat, 1e-6).value
    brighter = emitted_radiance(VoxelGrid(GRID.sigma_t, GRID.lower, GRID.upper, albedo=0.4, emission=glow), RAY)
    assert brighter.value > 1.01 * found.value


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: TemperatureGrid(GRID, np.full((2, 2, 2), -1.0), 1e-6), "temperature"),
        (lambda: TemperatureGrid(GRID, np.full((2, 2, 2), np.nan), 1e-6), "temperature"),
        (lambda: TemperatureGrid(GRID, np.full((2, 2, 3), 1.0), 1e-6), "temperature"),
        (lambda: TemperatureGrid(GRID, np.full((2, 2, 2), 1.0), 0.0), "wavelengths"),
        (lambda: TemperatureGrid(3, np.full((2, 2, 2), 1.0), 1e-6), "grid"),
        (lambda: black_body_radiance(-1.0, 1e-6), "temperature"),
        (lambda: black_body_radiance(1.0, 0.0), "wavelength"),
    ],
)
def test_bad_values_are_named(make, argument):
    with pytest.raises(InvalidValueError) as raised:
        make()
    assert raised.value.argument == argument
    with pytest.raises(InvalidValueError, match="the temperature says what glows"):
        TemperatureGrid(VoxelGrid(GRID.sigma_t, GRID.lower, GRID.upper, emission=1.0), GRID.sigma_t, 1e-6)
