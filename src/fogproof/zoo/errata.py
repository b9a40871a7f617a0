"""Misprints of lectures and textbooks on participating media, E1 to E12, as an implementer would type them in."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.analytic import phase_mean_cosine, single_scattering, transmittance
from fogproof.catalogue import SamplerCase
from fogproof.contracts import Reference
from fogproof.domains import HalfLine
from fogproof.scene import ExponentialMedium, HenyeyGreenstein, LinearMedium, Medium, PointLight, Ray
from fogproof.zoo.bug import Bug, Runnable, estimator_bug, sampler_bug
from fogproof.zoo.laws import Array, directions, even, hg, hg_cosine

LENGTH = 3.0
RAY = Ray((0, 0, 0), (0, 0, 1), LENGTH)
LAMP = PointLight((0.7, 0.0, 1.0), 5.0)
LINE: dict[str, Any] = {"domain": HalfLine(0.0), "options": {"dimensions": 1}}


def _ahead(u: Array) -> Array:
    """Uniform directions; where only the density is misprinted any sampler will do."""
    return directions(2 * u[:, 0] - 1, u[:, 1])


def _plus(g: float, x: Array) -> Array:
    return (1 - g * g) / (4 * np.pi * (1 + g * g + 2 * g * x[:, 2]) ** 1.5)


def _hazy(u: Array) -> Array:
    """Half isotropic, half the power's own law: the function that is meant."""
    forward = 2 * u[:, 0] ** (1 / 9) - 1
    return directions(np.where(u[:, 2] < 0.5, forward, 2 * u[:, 0] - 1), u[:, 1])


def _schlick(k: float, x: Array) -> Array:
    return (1 - k * k) / (4 * np.pi * (1 - k * x[:, 2]) ** 2)


def _schlick_sample(k: float, u: Array) -> Array:
    return directions((2 * u[:, 0] + k - 1) / (1 + k * (2 * u[:, 0] - 1)), u[:, 1])


def _airlight(rng: np.random.Generator, n: int) -> Array:
    """(1/4 pi) e^{-sigma |x x_t|} e^{-sigma d} / e^{-sigma d^2}: no sigma_s, and the square in the wrong place."""
    t = LENGTH * rng.random(n)
    d = np.hypot(t - 1, 0.7)
    return LENGTH * 5.0 / (4 * np.pi) * np.exp(-0.5 * t) * np.exp(-0.5 * d) / np.exp(-0.5 * d * d)


def _turned(rng: np.random.Generator, n: int, mu: float, looks: bool) -> Array:
    """Sample a direction from the phase function about one at cosine mu, and look along it, or along the old one."""
    cosine = hg_cosine(0.6, rng.random(n))
    across = np.sqrt((1 - mu * mu) * (1 - cosine * cosine)) * np.cos(2 * np.pi * rng.random(n))
    return 1 + (mu * cosine + across if looks else np.full(n, mu))


def _in_a_field() -> Reference:
    """Radiance 1 + cos(theta), scattered once: 1 + g mu."""
    mean = phase_mean_cosine(HenyeyGreenstein(0.6))
    return Reference(1 + 0.4 * mean.value, 0.4 * mean.error)


def _wrong_way(rng: np.random.Generator, n: int) -> Array:
    """The phase function's weight of a uniform direction w', and the radiance along w."""
    c = rng.uniform(-1, 1, n)
    return (1 - 0.36) / (1 + 0.36 - 1.2 * c) ** 1.5 * (1 + 0.4)


def _start_everywhere(rng: np.random.Generator, n: int) -> Array:
    """exp(-sigma(x) |x - y|) from a place along the ray: the extinction that the ray starts in, chosen at random."""
    first = 0.2 + 0.5 * rng.choice([0.0, 1.0, 2.0], n)
    return np.exp(-first * LENGTH)


def _marched(rng: np.random.Generator, n: int, shift: float, extra: int, steps: int = 64) -> Array:
    """A sum over steps of equal length, each jittered a little so that realisations differ."""
    dt = LENGTH / steps
    places = (np.arange(steps + extra) + shift + 1e-3 * rng.standard_normal((n, 1))) * dt
    return np.sum(2.0 * np.exp(-0.5 * places) * dt, axis=1)


def _optical_depth() -> Reference:
    tau = transmittance(ExponentialMedium(2.0, (0, 0, -0.5)), RAY)
    return Reference(-np.log(tau.value), tau.error / tau.value)


def _case(bug: Bug, **options: Any) -> Runnable:
    assert isinstance(bug.case, SamplerCase)
    return replace(bug.case, options={**bug.case.options, **options})


def _cancelling(u: Array) -> Array:
    g = 1e-9
    s = (1 - g * g) / (1 - g + 2 * g * u[:, 0])
    return directions(np.clip((1 + g * g - s * s) / (2 * g), -1, 1), u[:, 1])


def bugs() -> list[Bug]:
    """Return them."""
    source = "lecture on volume rendering"
    sampler, estimator = partial(sampler_bug, folder="errata"), partial(estimator_bug, folder="errata")
    measure = ("normalisation", "wrong measure")
    return [
        sampler("E1 plus 2 g cos", source, hg(0.7)[0], partial(_plus, 0.7), ("sign convention",)),
        sampler(
            "E2 hazy is not normalised", source, _hazy, lambda x: (5 + ((1 + x[:, 2]) / 2) ** 8) / (4 * np.pi), measure,
            options={"dimensions": 3},
        ),
        sampler(
            "E2 murky is not normalised", source, _ahead, lambda x: (17 + ((1 + x[:, 2]) / 2) ** 32) / (4 * np.pi), measure
        ),
        sampler(
            "E3 Schlick with k above 1", source, _ahead, partial(_schlick, 1.55 * 0.95 - 0.55 * 0.95**3),
            ("claimed hole", "negative pdf", "not a number", "normalisation", "wrong measure"),
        ),
        sampler(
            "E3 Schlick has not the mean g", source,
            partial(_schlick_sample, 1.55 * 0.8 - 0.55 * 0.8**3), partial(_schlick, 1.55 * 0.8 - 0.55 * 0.8**3),
            ("wrong mean cosine", "sign convention", "another parameter", "another law", "wrong formula"),
            options={"dimensions": 2, "axis": (0.0, 0.0, 1.0), "mean_cosine": 0.8},
        ),
        estimator(
            "E4 airlight without scattering", source, _airlight, lambda: single_scattering(Medium(0.1, 0.4), RAY, LAMP)
        ),
        estimator("E5 radiance of the wrong direction", source, _wrong_way, _in_a_field),
        sampler(
            "E6 distribution without its coefficient", source, lambda u: -np.log1p(-u[:, 0]) / 0.5,
            lambda t: np.exp(-0.5 * t), measure, **LINE,
        ),
        estimator(
            "E7 transmittance from one coefficient", source, _start_everywhere,
            lambda: transmittance(LinearMedium(0.2, (0, 0, 0.5)), RAY),
        ),
        estimator("E8 one step too many", source, partial(_marched, shift=0.5, extra=1), _optical_depth),
        estimator("E8 right ends of steps", source, partial(_marched, shift=1.0, extra=0), _optical_depth),
        estimator(
            "E9 radiance along the old direction", source, partial(_turned, mu=0.4, looks=False), _in_a_field
        ),
        sampler(
            "E10 g of exactly 1", source, lambda u: directions(np.ones(len(u)), u[:, 1]), partial(_plus, -1.0),
            ("normalisation", "wrong measure", "claimed hole", "not a number", "atom", "ignores its uniforms"),
        ),
        sampler("E11 division by 2 g", source, _cancelling, even, ("cancellation", "coarse numbers")),
        sampler(
            "E12 logarithm of xi", source, lambda u: -np.log(u[:, 0]) / 0.5, lambda t: 0.5 * np.exp(-0.5 * t),
            ("edge of the uniforms",), **LINE,
        ),
    ]  # fmt: skip
