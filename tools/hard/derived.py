"""What is derived from other quantities: slopes, path lengths and counts of scatterings, of rods and rays in closed form."""

from __future__ import annotations

import mpmath as mp
import numpy as np

from fogproof import analytic
from fogproof.scene import Medium, Ray
from hard.case import Kind, number

ARGUMENTS = ("albedo", "length", "g")


def rod(which, c, L, g):
    """Reflectance or transmittance of a rod."""
    k = mp.sqrt((1 - c) * (1 - c * g))
    t = mp.tanh(k * L) / k if k else L
    a = 1 - c * (1 + g) / 2
    return c * (1 - g) / 2 * t / (1 + a * t) if which == "rod_reflectance" else 1 / (mp.cosh(k * L) * (1 + a * t))


def one_rod(rng):
    """Return which quantity, and its arguments."""
    which = ("rod_reflectance", "rod_transmittance")[rng.integers(2)]
    c, g = map(float, (rng.uniform(0.01, 0.99), rng.uniform(-0.9, 0.9)))
    return which, dict(zip(ARGUMENTS, (c, number(rng, 1e-3, 30), g), strict=True))


def slope(rng):
    """The derivative of a rod by one of its arguments, and of what passes a ray by the extinction."""
    if rng.random() < 0.3:
        sigma, length = number(rng, 1e-3, 10), number(rng, 1e-3, 10)
        ray = Ray((0, 0, 0), (0, 0, 1), length)
        with mp.workdps(40):
            truth = -mp.mpf(length) * mp.exp(-mp.mpf(sigma) * mp.mpf(length))
        medium = Medium(sigma, 0.0)
        return (
            lambda: analytic.gradient("transmittance", "medium.sigma_t", medium=medium, ray=ray),
            truth,
            0,
            f"{sigma} {length}",
        )
    which, given = one_rod(rng)
    wrt = ARGUMENTS[rng.integers(3)]
    with mp.workdps(60):
        exact = {k: mp.mpf(v) for k, v in given.items()}
        truth = mp.diff(lambda x: rod(which, *{**exact, wrt: x}.values()), exact[wrt])
    return lambda: analytic.gradient(which, wrt, **given), truth, mp.mpf(10) ** -25, f"{which} {given} {wrt}"


def attenuated(which, given):
    """The rod with exp(-s l) of every path: more is absorbed, nothing else changes."""
    c, L, g = (mp.mpf(x) for x in given.values())
    return lambda s: rod(which, c / (1 + s), L * (1 + s), g)


def transform(rng):
    which, given = one_rod(rng)
    s = number(rng, 1e-6, 10)
    with mp.workdps(50):
        truth = attenuated(which, given)(mp.mpf(s))
    return lambda: analytic.path_length_transform(which, s, **given), truth, 0, f"{which} {given} {s}"


def length(order):
    """Mean and variance of the length of paths: derivatives of the logarithm of their transform."""
    function = (analytic.path_length_mean, analytic.path_length_variance)[order - 1]

    def draw(rng):
        which, given = one_rod(rng)
        with mp.workdps(80):
            law = attenuated(which, given)
            truth = (-1) ** order * mp.diff(lambda s: mp.log(law(s)), 0, order)
        return lambda: function(which, **given), truth, mp.mpf(10) ** -20, f"{which} {given}"

    return draw


def count_mean(rng):
    which, given = one_rod(rng)
    with mp.workdps(60):
        c, L, g = (mp.mpf(x) for x in given.values())
        truth = c * mp.diff(lambda x: mp.log(rod(which, x, L, g)), c)
    return lambda: analytic.scattering_count_mean(which, **given), truth, mp.mpf(10) ** -25, f"{which} {given}"


def count_law(rng):
    """The share of what has scattered n times: coefficients of the power series in the albedo, from a small circle."""
    which, given = one_rod(rng)
    n, points = int(rng.integers(0, 7)), 24
    with mp.workdps(200):
        c, L, g = (mp.mpf(x) for x in given.values())
        radius = mp.mpf(10) ** -8 / (1 + L)
        turns = [mp.expjpi(mp.mpf(2) * k / points) for k in range(points)]
        order = mp.re(sum(rod(which, radius * z, L, g) * z**-n for z in turns)) / points / radius**n
        truth = order * c**n / rod(which, c, L, g)

    def call():
        found = analytic.scattering_count_law(
            which, albedo=given["albedo"], count=6, length=given["length"], g=given["g"]
        )
        return type(found)(np.asarray(found.value)[..., n], np.asarray(found.error)[..., n], found.method, found.source)

    return call, truth, mp.mpf(10) ** -60, f"{which} {given} {n}"


KINDS = {
    "gradient": Kind(slope, 0.3),
    "path_length_transform": Kind(transform, 1),
    "path_length_mean": Kind(length(1), 0.2),
    "path_length_variance": Kind(length(2), 0.2),
    "scattering_count_mean": Kind(count_mean, 0.3),
    "scattering_count_law": Kind(count_law, 0.3),
}
