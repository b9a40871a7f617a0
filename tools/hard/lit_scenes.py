"""Lights with shadows and bounded media, the moments of their estimators, whole rays; balls by walks; the air's cross section."""

from __future__ import annotations

import mpmath as mp
import numpy as np
from airlight_truth import airlight

from fogproof import analytic
from fogproof.scene import Ball, Disk, Medium, PointLight, Ray, Scene, Slab
from hard.case import Kind, number

FORWARD = (0.0, 0.0, 1.0)


def beside(rng):
    """Return a medium, a light at height 1 beside a ray along z, the ray, and what the integral is multiplied by: all exact."""
    sigma_s, sigma_a = map(float, 2.0 ** rng.integers(-6, 3, 2))
    start, length = float(rng.integers(-8, 8)) / 4, float(rng.integers(1, 32)) / 4
    ray = Ray((0.0, 0.0, start), FORWARD, length)
    factor = mp.mpf(sigma_s) * 2 / (4 * mp.pi)
    return (
        Medium(sigma_a, sigma_s),
        PointLight((1.0, 0.0, 0.0), 2.0),
        ray,
        factor,
        sigma_a + sigma_s,
        start,
        start + length,
    )


def shadowed(rng):
    """A disk half way to the light casts a shadow twice its size on the ray."""
    medium, light, ray, _factor, sigma, a, b = beside(rng)
    radius = float(rng.integers(1, 64)) / 64
    disk = Disk((0.5, 0.0, 0.0), (1.0, 0.0, 0.0), radius)
    with mp.workdps(50):
        truth = mp.mpf(0)
        for low, high in ((a, min(b, -2 * radius)), (max(a, 2 * radius), b)):
            if low < high:
                truth += mp.exp(-mp.mpf(sigma) * (low - a)) * airlight(sigma, 1.0, low, high)
        truth *= mp.mpf(float(medium.sigma_s)) * 2 / (4 * mp.pi)
    return (
        lambda: analytic.single_scattering(medium, ray, light, occluders=[disk]),
        truth,
        0,
        f"{sigma} {a} {b} {radius}",
    )


def bounded(rng):
    """A lamp outside a ball or a layer, a ray inside: light is attenuated from where it enters."""
    sigma_s, sigma_a = number(rng, 1e-2, 3), number(rng, 1e-3, 1)
    ball = rng.random() < 0.5
    above = number(rng, 1e-3, 1e6)
    x, z0, length = float(rng.uniform(-0.5, 0.5)), float(rng.uniform(-0.7, 0.0)), float(rng.uniform(0.05, 0.7))
    shape = Ball((0.0, 0.0, 0.0), 1.0) if ball else Slab((0.0, 0.0, -1.0), (0.0, 0.0, -1.0), 2.0)
    place = 1.0 + above
    with mp.workdps(30):
        sigma, top, xx = mp.mpf(sigma_a) + mp.mpf(sigma_s), mp.mpf(place), mp.mpf(x)

        def inside(z):
            """Return the way to the light, and what of it is inside."""
            far = mp.sqrt(xx * xx + (top - z) ** 2)
            if not ball:
                return far, far * (1 - z) / (top - z)
            u = (-xx * xx + z * (top - z)) / far
            return far, -u + mp.sqrt(u * u + 1 - xx * xx - z * z)

        def integrand(t):
            far, way = inside(mp.mpf(z0) + t)
            return mp.exp(-sigma * (t + way)) / far**2

        value, off = mp.quad(integrand, mp.linspace(0, mp.mpf(length), 4), error=True)
        factor = mp.mpf(sigma_s) / (4 * mp.pi)
        truth, doubt = factor * value, factor * (off + value * mp.mpf(10) ** -20)
    medium, light = Medium(sigma_a, sigma_s), PointLight((0.0, 0.0, place), 1.0)
    ray = Ray((x, 0.0, z0), FORWARD, length)
    given = f"{sigma_a} {sigma_s} {shape} {place} {x} {z0} {length}"
    return lambda: analytic.single_scattering(medium, ray, light, shape=shape), truth, doubt, given


def moments(variance):
    """Equiangular sampling: the second moment is that of twice the extinction, times the angle over the height."""

    def draw(rng):
        medium, light, ray, factor, sigma, a, b = beside(rng)
        with mp.workdps(50):
            factor = mp.mpf(float(medium.sigma_s)) * 2 / (4 * mp.pi)
            square = factor**2 * (mp.atan(b) - mp.atan(a)) * airlight(2 * sigma, 1.0, a, b)
            truth = square - (factor * airlight(sigma, 1.0, a, b)) ** 2 if variance else square
        function = analytic.single_scattering_variance if variance else analytic.single_scattering_second_moment
        return lambda: function(medium, ray, light, "equiangular"), truth, 0, f"{sigma} {a} {b}"

    return draw


def whole(rng):
    """Background, emission and light scattered once, together."""
    medium, light, ray, _, sigma, a, b = beside(rng)
    emission, background = float(2.0 ** rng.integers(-3, 3)), float(2.0 ** rng.integers(-3, 3))
    glowing = Medium(medium.sigma_a, medium.sigma_s, emission=emission)
    scene = Scene(glowing, ray, "single", light=light, background=background)
    with mp.workdps(50):
        passed = mp.exp(-mp.mpf(sigma) * (b - a))
        glow = mp.mpf(float(medium.sigma_a)) * emission * (1 - passed) / sigma
        lit = mp.mpf(float(medium.sigma_s)) * 2 / (4 * mp.pi) * airlight(sigma, 1.0, a, b)
        truth = background * passed + glow + lit
    return lambda: analytic.radiance(scene), truth, 0, f"{sigma} {a} {b} {emission} {background}"


def ball_walks(rng):
    """Photons on analog walks through a ball that scatters and absorbs, within six standard errors."""
    c, R, photons = float(rng.uniform(0.05, 0.999)), number(rng, 0.05, 20), 20_000
    mu = np.sqrt(rng.random(photons))  # of a diffuse sky, to the normal
    x, w = np.zeros((photons, 3)), np.zeros((photons, 3))
    x[:, 2] = -R
    turn = 2 * np.pi * rng.random(photons)
    sine = np.sqrt(1 - mu * mu)
    w[:, 0], w[:, 1], w[:, 2] = sine * np.cos(turn), sine * np.sin(turn), mu
    left = 0
    while len(x):
        x = x + w * rng.exponential(size=len(x))[:, None]
        out = np.sum(x * x, axis=1) > R * R
        left += int(out.sum())
        x = x[~out]
        x = x[rng.random(len(x)) < c]
        w = rng.normal(size=x.shape)
        w /= np.linalg.norm(w, axis=1)[:, None]
    share = left / photons
    doubt = 6 * np.sqrt((share * (1 - share) + 1 / photons) / photons)
    return lambda: analytic.ball_albedo(c, R), mp.mpf(share), mp.mpf(float(doubt)), f"{c} {R}"


def air_truth(wavelength, column):
    """Bodhaine's cross section of a molecule [m^2]; with `column`, times how many stand above a square metre of the sea."""
    with mp.workdps(60):
        s = (mp.mpf(10) ** -6 / mp.mpf(wavelength)) ** 2
        n = 1 + (5792105 / (mp.mpf("238.0185") - s) + 167917 / (mp.mpf("57.362") - s)) / 10**8
        nitrogen = mp.mpf("1.034") + mp.mpf("3.17e-4") * s
        oxygen = mp.mpf("1.096") + mp.mpf("1.385e-3") * s + mp.mpf("1.448e-4") * s**2
        parts = [("78.084", nitrogen), ("20.946", oxygen), ("0.934", mp.mpf(1)), ("0.036", mp.mpf("1.15"))]
        king = sum(mp.mpf(a) * b for a, b in parts) / sum(mp.mpf(a) for a, _ in parts)
        number_density = 101325 / (mp.mpf("1.380649e-23") * mp.mpf("288.15"))
        truth = 24 * mp.pi**3 * ((n**2 - 1) / (n**2 + 2)) ** 2 / (mp.mpf(wavelength) ** 4 * number_density**2) * king
        return (
            truth * 101325 * mp.mpf("6.02214076e23") / (mp.mpf("28.9647e-3") * mp.mpf("9.80665")) if column else truth
        )


def air(column):
    """The same at any wavelength."""

    def draw(rng):
        wavelength = float(rng.uniform(230e-9, 1690e-9))
        function = analytic.air_optical_depth if column else analytic.air_cross_section
        return lambda: function(wavelength), air_truth(wavelength, column), 0, f"{wavelength}"

    return draw


KINDS = {
    "single_scattering/shadow": Kind(shadowed, 2),
    "single_scattering/bounded": Kind(bounded, 0.5),
    "single_scattering_second_moment": Kind(moments(False), 2),
    "single_scattering_variance": Kind(moments(True), 2),
    "radiance": Kind(whole, 2),
    "ball_albedo/walks": Kind(ball_walks, 0.2),
    "air_cross_section": Kind(air(False), 3),
    "air_optical_depth": Kind(air(True), 3),
}
