"""Bugs of estimators: transmittance, single scattering, orders, shares of strategies, sums and standard errors."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import phase_mean_cosine, single_scattering, slab_reflectance_orders, transmittance
from fogproof.catalogue.twins.paths import LiteralPaths
from fogproof.contracts import Draws, Reference
from fogproof.scene import HenyeyGreenstein, Medium, PointLight, Ray
from fogproof.scene.lights import Environment
from fogproof.scene.shapes import Slab
from fogproof.zoo.bug import Bug, estimator_bug
from fogproof.zoo.laws import Array

FOG, LENGTH = Medium(0.1, 0.4), 4.0
RAY = Ray((0, 0, 0), (0, 0, 1), LENGTH)
LAMP, H, FOOT = PointLight((0.7, 0.0, 1.5), 3.0), 0.7, 1.5
PHASE = HenyeyGreenstein(0.6)


def _scattered(rng: np.random.Generator, n: int) -> tuple[Array, Array]:
    """Return single scattering at uniform places, and the length of the way from there to the lamp."""
    t = LENGTH * rng.random(n)
    r = np.hypot(t - FOOT, H)
    return 0.4 * LENGTH * 3.0 * np.exp(-0.5 * (t + r)) / (4 * np.pi * r * r), r


def _airlight() -> Reference:
    return single_scattering(FOG, RAY, LAMP)


def _albedo_for_nothing(rng: np.random.Generator, n: int) -> Array:
    return np.where(rng.exponential(1 / 0.5, n) > LENGTH, 1.0, 0.8)


def _no_medium_to_light(rng: np.random.Generator, n: int) -> Array:
    value, r = _scattered(rng, n)
    return value * np.exp(0.5 * r)


def _only_where_scattered(rng: np.random.Generator, n: int) -> Array:
    return _scattered(rng, n)[0] * (rng.exponential(1 / 0.5, n) < LENGTH)


def _one_bounce_more() -> Bug:
    up = (0.0, 0.0, 1.0)
    beam, slab = Ray((0, 0, 3), (0, 0, -1)), Slab((0.0, 0.0, 0.0), up, 1.0)
    paths = LiteralPaths(Medium(0.1, 0.9), slab, beam, Environment(1.0), up, deepest=1, one_more=True)
    return estimator_bug("depth 1 scatters twice", "pbrt-v3#69", paths.draw, _once)


def _once() -> Reference:
    orders = slab_reflectance_orders(1.0, 1.0, 1)
    return Reference(0.9 * orders.value[1], 0.9 * orders.error[1])


def _weight_one(rng: np.random.Generator, n: int) -> Array:
    return 1 + rng.uniform(
        -1, 1, n
    )  # radiance 1 + mu from a uniform direction, the phase function over its pdf left out


def _cancelled(rng: np.random.Generator, n: int) -> Array:
    mu = np.float32(2e-7)
    return (1 - np.exp(-mu * rng.random(n, dtype=np.float32))) / mu


def _stalled(rng: np.random.Generator, n: int) -> Array:
    full = 2**24  # a sum of ones in single precision stays here
    return np.minimum(rng.binomial(40_000_000, 0.5, n), full) / full


def _finite_for_delta(rng: np.random.Generator, n: int) -> Array:
    value, _ = _scattered(rng, n)
    return value * 0.25 / (0.25 + 1 / (4 * np.pi) * 18)


def _empty_counted(rng: np.random.Generator, n: int) -> Array:
    """Resampling of 8 candidates for the integral of 3 x^2, half of them from empty reservoirs, which count all the same."""
    target = 3 * rng.random((n, 8)) ** 2 * (rng.random((n, 8)) < 0.5)
    return target.sum(axis=1) / 8


def _divided_again(rng: np.random.Generator, n: int) -> Draws:
    values = rng.exponential(1.0, (n, 20))
    return Draws(values.mean(axis=1), stderr=values.std(axis=1, ddof=1) / np.sqrt(20.0) / np.sqrt(19.0))


def bugs() -> list[Bug]:
    """Return them."""
    return [
        estimator_bug(
            "shadow ray returns the albedo at a collision",
            "VisRTX#298",
            _albedo_for_nothing,
            lambda: transmittance(FOG, RAY),
        ),
        estimator_bug("connection ignores the medium", "LuxCore#647", _no_medium_to_light, _airlight),
        estimator_bug("in-scattering only where the ray scattered", "vierkant#190", _only_where_scattered, _airlight),
        _one_bounce_more(),
        estimator_bug(
            "weight of the phase function left out",
            "mitsuba2#387",
            _weight_one,
            lambda: Reference(1 + phase_mean_cosine(PHASE).value),
        ),
        estimator_bug(
            "1 - exp in single precision", "mcx#164", _cancelled, 0.5 - 2e-7 / 6, ("bias",), precision="float32"
        ),
        estimator_bug("sums in single precision stall", "mitsuba2#82", _stalled, 0.5),
        estimator_bug("delta light has a density in its share", "vk_gltf_renderer#38", _finite_for_delta, _airlight),
        estimator_bug("candidates of target 0 are counted", "RTXDI#42", _empty_counted, 1.0),
        estimator_bug(
            "variance of the mean divided twice", "openmc#4016", _divided_again, 1.0, ("wrong standard errors",)
        ),
    ]
