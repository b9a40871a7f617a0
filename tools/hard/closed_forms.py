"""Rods, half spaces, flights and point sources, against the formulas of the books in many digits."""

from __future__ import annotations

import mpmath as mp
import numpy as np

from fogproof import analytic
from fogproof.scene import Ball, Box, Slab
from hard.case import Kind, albedo, anisotropy, number


def rod(c, L, g):
    """Reflectance and transmittance, by hyperbolic functions."""
    c, L, g = map(mp.mpf, (c, L, g))
    k, a = mp.sqrt((1 - c) * (1 - c * g)), 1 - c * (1 + g) / 2
    t = mp.tanh(k * L) / k if k else L
    return c * (1 - g) / 2 * t / (1 + a * t), 1 / (mp.cosh(k * L) * (1 + a * t))


def rods(which):
    def draw(rng):
        c, L, g = albedo(rng), number(rng, 1e-300, 700), anisotropy(rng)
        with mp.workdps(700 if L < 1e-20 else 60):
            truth = rod(c, L, g)[which]
        function = (analytic.rod_reflectance, analytic.rod_transmittance)[which]
        return lambda: function(c, L, g), truth, 0, f"{c} {L} {g}"

    return draw


def rod_orders(which):
    """The coefficients of the power series in the albedo, by mpmath's Taylor series."""

    def draw(rng):
        L, g, count = number(rng, 1e-2, 20), float(rng.uniform(-0.95, 0.95)), int(rng.integers(1, 9))
        with mp.workdps(80):
            truth = mp.taylor(lambda c: rod(c, L, g)[which], 0, count)[count]
        function = (analytic.rod_reflectance_orders, analytic.rod_transmittance_orders)[which]
        return lambda: last(function(L, count, g)), truth, abs(truth) * mp.mpf(10) ** -20, f"{L} {count} {g}"

    return draw


def last(reference):
    """Return the last element along the last axis."""
    return type(reference)(reference.value[..., -1], reference.error[..., -1], reference.method, reference.source)


def h_function(c, mu):
    """Chandrasekhar's H by the integral over theta."""
    c, mu = mp.mpf(c), mp.mpf(mu)

    def part(theta):
        return mp.log(1 - c * theta * mp.cot(theta)) / (mp.cos(theta) ** 2 + mu * mu * mp.sin(theta) ** 2)

    grid = [0, mp.pi / 64, mp.pi / 16, mp.pi / 4, 3 * mp.pi / 8, mp.pi / 2 - mu / 8, mp.pi / 2]
    return mp.exp(-mu / mp.pi * mp.quad(part, sorted(grid), maxdegree=8))


def half_spaces(what):
    def draw(rng):
        c = float(rng.choice([rng.random(), number(rng, 1e-9, 1), 1 - number(rng, 1e-6, 1)]))
        mu0, mu = float(rng.uniform(0.05, 1)), float(rng.uniform(0.05, 1))
        with mp.workdps(45):
            one = h_function(c, mu0)
            if what == "h":
                return lambda: analytic.chandrasekhar_h(c, mu0), one, one * mp.mpf(10) ** -18, f"{c} {mu0}"
            if what == "brdf":
                truth = mp.mpf(c) * one * h_function(c, mu) / (4 * mp.pi * (mp.mpf(mu0) + mp.mpf(mu)))
                return lambda: analytic.half_space_brdf(c, mu0, mu), truth, truth * mp.mpf(10) ** -18, f"{c} {mu0} {mu}"
            truth = 1 - mp.sqrt(1 - mp.mpf(c)) * one
        return lambda: analytic.half_space_reflectance(c, mu0), truth, mp.mpf(10) ** -25, f"{c} {mu0}"

    return draw


def spherical(rng):
    """The plane albedo averaged over a diffuse sky, by Gauss-Legendre quadrature in y = sqrt(mu)."""
    c = float(rng.choice([rng.random(), number(rng, 1e-200, 1), 1 - number(rng, 1e-12, 1)]))
    y, w = np.polynomial.legendre.leggauss(80)
    y, w = (1 + y) / 2, w / 2
    plane = analytic.half_space_reflectance(c, y * y).value
    truth = float(np.sum(4 * y**3 * w * plane))
    return lambda: analytic.half_space_spherical_albedo(c), mp.mpf(truth), 2e-14 * truth, f"{c}"


def half_space_orders(rng):
    """First order: 1/2 (1 - mu ln(1 + 1/mu))."""
    mu = float(rng.uniform(1e-3, 1))
    with mp.workdps(40):
        truth = (1 - mp.mpf(mu) * mp.log(1 + 1 / mp.mpf(mu))) / 2
    return lambda: _at(analytic.half_space_reflectance_orders(mu, 6), 1), truth, 0, f"{mu}"


def _at(reference, i):
    return type(reference)(reference.value[..., i], reference.error[..., i], reference.method, reference.source)


def flights(square):
    def draw(rng):
        n, g, length = int(rng.integers(0, 60)), anisotropy(rng), number(rng, 1e-6, 1e6)
        with mp.workdps(60):
            gg, ll = mp.mpf(g), mp.mpf(length)
            if square:
                truth = 2 * ll * ll * mp.fsum((n - k) * gg**k for k in range(n))
                return lambda: analytic.mean_square_displacement(n, g, length), truth, 0, f"{n} {g} {length}"
            truth = ll * mp.fsum(gg**k for k in range(n))
        return lambda: analytic.mean_displacement(n, g, length), truth, 0, f"{n} {g} {length}"

    return draw


def point_source(rng):
    """The residue and the integral over the cut, literally."""
    c, r = float(rng.uniform(0.3, 0.999)), number(rng, 1e-2, 30)
    with mp.workdps(40):
        cc, rr = mp.mpf(c), mp.mpf(r)
        kappa = _kappa(cc)
        slope = -2 * kappa / (mp.diff(lambda k: k / mp.atanh(k), kappa))
        cut = mp.quad(
            lambda nu: mp.exp(-rr / nu) / nu**2 / ((1 - cc * nu * mp.atanh(nu)) ** 2 + (mp.pi * cc * nu / 2) ** 2),
            [0, 0.05, 0.3, 0.7, 0.9, 0.99, 0.9999, 1 - mp.mpf(10) ** -8, 1 - mp.mpf(10) ** -16, 1],
        )
        truth = (slope * mp.exp(-kappa * rr) + cut) / (4 * mp.pi * rr)
    return lambda: analytic.point_source_fluence(c, r), truth, truth * mp.mpf(10) ** -16, f"{c} {r}"


def _kappa(c):
    low, high = mp.mpf(10) ** -30, 1 - mp.mpf(10) ** -30
    for _ in range(160):
        middle = (low + high) / 2
        low, high = (middle, high) if c * mp.atanh(middle) < middle else (low, middle)
    return low


def collisions(rng):
    """Without scattering 1 - exp(-R); with it, all of them are 1/(1 - c) in a large ball."""
    R = number(rng, 1e-6, 300)
    if rng.random() < 0.5:
        with mp.workdps(60):
            return lambda: analytic.point_source_collisions(0.0, R), -mp.expm1(-mp.mpf(R)), 0, f"0 {R}"
    c = float(rng.uniform(0, 0.9))
    with mp.workdps(60):
        return lambda: analytic.point_source_collisions(c, 1e4), 1 / (1 - mp.mpf(c)), 0, f"{c} 1e4"


def bodies(scatterings):
    def draw(rng):
        sides = [number(rng, 1e-3, 1e3) for _ in range(3)]
        kind, sigma = rng.integers(3), number(rng, 1e-6, 1e6)
        with mp.workdps(40):
            a, b, d = map(mp.mpf, sides)
            body, truth = (
                (Slab((0, 0, 0), (0, 0, 1), sides[0]), 2 * a),
                (Ball((0, 0, 0), sides[0]), 4 * a / 3),
                (Box((0, 0, 0), tuple(sides)), 4 * a * b * d / (2 * (a * b + b * d + a * d))),
            )[kind]
            if scatterings:
                return lambda: analytic.mean_scatterings(body, sigma), truth * mp.mpf(sigma), 0, f"{body} {sigma}"
        return lambda: analytic.mean_path_length(body), truth, 0, f"{body}"

    return draw


KINDS = {
    "rod_reflectance": Kind(rods(0), 12),
    "rod_transmittance": Kind(rods(1), 12),
    "rod_reflectance_orders": Kind(rod_orders(0), 0.3),
    "rod_transmittance_orders": Kind(rod_orders(1), 0.3),
    "chandrasekhar_h": Kind(half_spaces("h"), 0.3),
    "half_space_brdf": Kind(half_spaces("brdf"), 0.2),
    "half_space_reflectance": Kind(half_spaces("plane"), 0.3),
    "half_space_spherical_albedo": Kind(spherical, 3),
    "half_space_reflectance_orders": Kind(half_space_orders, 1),
    "mean_displacement": Kind(flights(False), 12),
    "mean_square_displacement": Kind(flights(True), 12),
    "point_source_fluence": Kind(point_source, 0.2),
    "point_source_collisions": Kind(collisions, 3),
    "mean_path_length": Kind(bodies(False), 12),
    "mean_scatterings": Kind(bodies(True), 12),
}
