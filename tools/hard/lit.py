"""Single scattering of point lights, along rays that pass them, by closed forms and quadrature in many digits; the thin sky."""

from __future__ import annotations

import math

import mpmath as mp
from airlight_truth import airlight

from fogproof import analytic
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, PointLight, Ray, Rayleigh, Schlick
from hard.case import Kind, number


def geometry(rng):
    """Return sigma_t, h, a, b: lights before, beside and behind the camera, one ray in five endless."""
    h = number(rng, 1e-12, 30)
    a = h * number(rng, 0.1, 100) if rng.random() < 0.5 else number(rng, 1e-6, 100)
    a *= float(rng.choice([-1, -1, 1]))
    b = a + (number(rng, 1e-6, 100) if rng.random() < 0.5 else h * number(rng, 1e-3, 1e3))
    b = math.inf if rng.random() < 0.2 else max(a, b)
    sigma = 0.0 if rng.random() < 0.02 else number(rng, 1e-9, 300)
    return min(sigma, 645 / math.hypot(a, h)), h, a, b


def phase_function(rng):
    """Return a phase function; its parameter crowds towards 0 and +-1."""
    g = float(rng.choice([-1, 1]) * rng.choice([number(rng, 1e-9, 1), 1 - number(rng, 1e-4, 1)]))
    g = math.copysign(min(abs(g), 0.9999), g)
    return (Isotropic(), HenyeyGreenstein(g), Schlick(g), Rayleigh())[rng.integers(4)]


def integral(rng):
    given, phase = geometry(rng), phase_function(rng)
    return lambda: analytic.airlight_integral(*given, phase), airlight(*given, phase), 0, f"{given} {phase}"


def table(rng):
    sigma, h, a, b = geometry(rng)

    def call():
        found = analytic.airlight_table(sigma, [h], [a], [b])
        return type(found)(found.value.ravel()[0], found.error.ravel()[0], found.method, found.source)

    return call, airlight(sigma, h, a, b), 0, f"{sigma} {h} {a} {b}"


def scattered(rng):
    """A lamp at height 1, exactly beside the foot of the ray; intensity and coefficients are powers of two."""
    sigma_s, sigma_a = 2.0 ** rng.integers(-6, 3, 2)
    start, length = float(rng.integers(-8, 8)) / 4, float(rng.integers(1, 32)) / 4
    medium, light = Medium(float(sigma_a), float(sigma_s)), PointLight((1.0, 0.0, 0.0), 2.0)
    ray = Ray((0.0, 0.0, start), (0.0, 0.0, 1.0), length)
    with mp.workdps(50):
        core = airlight(float(sigma_a + sigma_s), 1.0, start, start + length)
        truth = mp.mpf(float(sigma_s)) * 2 / (4 * mp.pi) * core
    return lambda: analytic.single_scattering(medium, ray, light), truth, 0, f"{sigma_s} {sigma_a} {start} {length}"


def equiangular_square(rng):
    """Equiangular sampling: the second moment is that of twice the extinction, times the angle over h."""
    sigma, h = number(rng, 1e-3, 10), number(rng, 1e-2, 10)
    a = float(-number(rng, 1e-2, 10))
    b = a + number(rng, 1e-2, 20)
    with mp.workdps(40):
        angle = mp.atan(mp.mpf(b) / mp.mpf(h)) - mp.atan(mp.mpf(a) / mp.mpf(h))
        truth = angle / mp.mpf(h) * airlight(2 * sigma, h, a, b)
    return lambda: analytic.airlight_second_moment(sigma, h, a, b), truth, 0, f"{sigma} {h} {a} {b}"


def sky(rng):
    """Single scattering by Rayleigh's phase function in a plane slab."""
    tau, sun, view, azimuth = (
        number(rng, 1e-6, 10),
        float(rng.uniform(0.01, 1)),
        float(rng.uniform(0.01, 1)),
        float(rng.uniform(0, 6)),
    )
    with mp.workdps(50):
        t, s, v, phi = map(mp.mpf, (tau, sun, view, azimuth))
        cosine = s * v + mp.sqrt(1 - s * s) * mp.sqrt(1 - v * v) * mp.cos(phi)
        phase = 3 * (1 + cosine**2) / (16 * mp.pi)
        way = s / (s - v) * (mp.exp(-t / s) - mp.exp(-t / v)) if s != v else t / v * mp.exp(-t / v)
        truth = phase * way
    return lambda: analytic.plane_parallel_sky(tau, sun, view, azimuth), truth, 0, f"{tau} {sun} {view} {azimuth}"


def rayleigh_coefficient(rng):
    """2 pi^5/3 N d^6/lambda^4 ((n^2 - 1)/(n^2 + 2))^2."""
    d, n, N, wavelength = (
        number(rng, 1e-10, 1e-8),
        float(rng.uniform(1.1, 3)),
        number(rng, 1e10, 1e25),
        number(rng, 3e-7, 1e-6),
    )
    with mp.workdps(50):
        dd, nn, NN, ll = map(mp.mpf, (d, n, N, wavelength))
        truth = 2 * mp.pi**5 / 3 * NN * dd**6 / ll**4 * ((nn**2 - 1) / (nn**2 + 2)) ** 2
    return lambda: analytic.rayleigh_scattering_coefficient(d, n, N, wavelength), truth, 0, f"{d} {n} {N} {wavelength}"


KINDS = {
    "airlight_integral": Kind(integral, 30),
    "airlight_table": Kind(table, 3),
    "single_scattering": Kind(scattered, 2),
    "airlight_second_moment": Kind(equiangular_square, 2),
    "plane_parallel_sky": Kind(sky, 5),
    "rayleigh_scattering_coefficient": Kind(rayleigh_coefficient, 10),
}
