"""Rays through media: transmittance, fog, emission, furnaces, free paths and the variance of their estimators, in closed form."""

from __future__ import annotations

import mpmath as mp
from media_truth import exact, exponential_tau, fog, linear_tau

from fogproof import analytic
from fogproof.scene import ExponentialMedium, LinearMedium, Medium, Ray
from hard.case import Kind, number

FORWARD = (0.0, 0.0, 1.0)


def homogeneous(rng):
    """Return sigma_a, sigma_s, emission, length, ambient, background."""
    tau, s, share = number(rng, float(rng.choice([1e-300, 1e-6])), 1e3), number(rng, 1e-8, 1e8), rng.random()
    light = [number(rng, 1e-6, 1e6) * float(rng.random() < 0.8) for _ in range(3)]
    return float(share * tau / s), float((1 - share) * tau / s), light[0], s, light[1], light[2]


def of_fog(function, ambient_too=True):
    def draw(rng):
        a, s, emission, length, ambient, background = homogeneous(rng)
        if not ambient_too:
            ambient = background = 0.0
        medium, ray = Medium(a, s, emission=emission), Ray((0, 0, 0), FORWARD, length)
        truth = fog(a, s, emission, length, ambient, background)
        call = (lambda: function(medium, ray, ambient, background)) if ambient_too else (lambda: function(medium, ray))
        return call, truth, 0, f"{a} {s} {emission} {length} {ambient} {background}"

    return draw


def of_thickness(function, passed):
    """Homogeneous, linear and exponential media."""

    def draw(rng):
        kind, length = rng.integers(3), number(rng, 1e-6, 1e3)
        tau, bend = number(rng, 1e-12, 600), float(rng.uniform(-3, 3))
        origin, d = (0.0, 0.0, 0.0), FORWARD
        sigma = tau / length
        if kind == 0:
            medium = Medium(sigma, 0.0)
            with mp.workdps(60):
                truth = exact(sigma) * exact(length)
        elif kind == 1:
            gradient = (0.0, 0.0, bend * sigma / length)
            with mp.workdps(60):
                medium, truth = LinearMedium(sigma, gradient), exact(linear_tau(sigma, gradient, origin, d, length))
        else:
            rate = (0.0, 0.0, bend / length)
            with mp.workdps(60):
                truth = exact(exponential_tau(sigma, rate, origin, d, length))
            medium = ExponentialMedium(sigma, rate)
        ray = Ray(origin, d, length)
        if passed:
            with mp.workdps(60):
                truth = mp.exp(-truth)
        return lambda: function(medium, ray), truth, abs(truth) * mp.mpf(10) ** -30, f"{medium} {length}"

    return draw


def furnace(function):
    def draw(rng):
        a, s, _, length, light, _ = homogeneous(rng)
        emission = light if function is analytic.thermal_furnace else 0.0
        medium = Medium(a if function is analytic.thermal_furnace else 0.0, s, emission=emission)
        return (
            lambda: function(medium, Ray((0, 0, 0), FORWARD, length), light),
            mp.mpf(light),
            0,
            f"{medium} {length} {light}",
        )

    return draw


def path(rng):
    sigma, tau = number(rng, 1e-6, 1e6), number(rng, 1e-12, 100)
    with mp.workdps(40):
        truth = exact(tau) / exact(sigma)
    return lambda: analytic.free_path(Medium(sigma, 0.0), Ray((0, 0, 0), FORWARD), tau), truth, 0, f"{sigma} {tau}"


def of_tracking(what):
    """Ratio and delta tracking through homogeneous media, by their moments in closed form."""

    def draw(rng):
        sigma, length, over = number(rng, 1e-3, 10), number(rng, 1e-2, 5), float(rng.uniform(1, 4))
        tracking, majorant = str(rng.choice(["delta", "ratio"])), float(sigma * over)
        medium, ray = Medium(sigma, 0.0), Ray((0, 0, 0), FORWARD, length)
        with mp.workdps(50):
            s, t, m = exact(sigma), exact(length), exact(majorant)
            T = mp.exp(-s * t)
            square = T if tracking == "delta" else T**2 * mp.exp(s * s * t / m)
            lookups = m * t if tracking == "ratio" else m * (1 - T) / s
            truth = {"second": square, "variance": square - T**2, "lookups": lookups}[what]
        function = {
            "second": analytic.transmittance_second_moment,
            "variance": analytic.transmittance_variance,
            "lookups": analytic.transmittance_lookups,
        }[what]
        return lambda: function(medium, ray, tracking, majorant), truth, 0, f"{sigma} {length} {tracking} {majorant}"

    return draw


def fog_variance(rng):
    """(albedo ambient - background)^2 T (1 - T) of free paths."""
    a, s, length = number(rng, 1e-3, 10), number(rng, 1e-3, 10), number(rng, 1e-3, 10)
    ambient, background = number(rng, 1e-2, 1e2), number(rng, 1e-2, 1e2)
    with mp.workdps(60):
        T = mp.exp(-(exact(a) + exact(s)) * exact(length))
        truth = (exact(s) / (exact(a) + exact(s)) * exact(ambient) - exact(background)) ** 2 * T * (1 - T)
    medium, ray = Medium(a, s), Ray((0, 0, 0), FORWARD, length)
    return (
        lambda: analytic.ambient_fog_variance(medium, ray, ambient, background),
        truth,
        0,
        f"{a} {s} {length} {ambient} {background}",
    )


KINDS = {
    "transmittance": Kind(of_thickness(analytic.transmittance, True), 10),
    "optical_thickness": Kind(of_thickness(analytic.optical_thickness, False), 10),
    "ambient_fog": Kind(of_fog(analytic.ambient_fog), 10),
    "radiance_by_quadrature": Kind(of_fog(analytic.radiance_by_quadrature), 1),
    "radiance_by_ode": Kind(of_fog(analytic.radiance_by_ode), 0.5),
    "emitted_radiance": Kind(of_fog(analytic.emitted_radiance, False), 10),
    "white_furnace": Kind(furnace(analytic.white_furnace), 5),
    "thermal_furnace": Kind(furnace(analytic.thermal_furnace), 5),
    "free_path": Kind(path, 5),
    "transmittance_second_moment": Kind(of_tracking("second"), 3),
    "transmittance_variance": Kind(of_tracking("variance"), 3),
    "transmittance_lookups": Kind(of_tracking("lookups"), 3),
    "ambient_fog_variance": Kind(fog_variance, 5),
}
