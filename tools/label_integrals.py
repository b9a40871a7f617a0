"""How often does the integral of a pdf by points of a known law lie within its standard errors? Right samplers and wrong ones.

    python tools/label_integrals.py [--samplers 400] [--samples 60000]

Each pdf is a density times a random factor, so that its integral is known; its samples follow it, are clamped, folded, in another
place, of few digits, or follow another law altogether. Of the intervals that are stated, 68.3 % must hold the integral within one
standard error, 95.4 % within two, and none may be off by five.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof import Box, Interval, UnitHemisphere, UnitSphere, UnitSquare
from fogproof.checks.mixture import MixtureTest
from fogproof.checks.statistics.integrated import Integrated
from fogproof.checks.subject import Subject, in_domain

TURN = 2 * np.pi
Map = Callable[[np.ndarray], np.ndarray]


def _unit(x: np.ndarray) -> np.ndarray:
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))


def visible_normals(rng: np.random.Generator) -> tuple[Any, Map, list[Map], int]:
    """GGX normals seen from a direction (Heitz 2018), with the warp and without."""
    alpha, theta, phi = rng.uniform(0.05, 0.9, 2), rng.uniform(0.1, 1.45), rng.uniform(0, TURN)
    wi = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    tangent = (alpha[0] ** 2 * wi[0] ** 2 + alpha[1] ** 2 * wi[1] ** 2) / wi[2] ** 2
    lit = 2 / (1 + np.sqrt(1 + tangent)) / (np.pi * alpha[0] * alpha[1] * wi[2])

    def pdf(x: np.ndarray) -> np.ndarray:
        spread = (x[:, 0] / alpha[0]) ** 2 + (x[:, 1] / alpha[1]) ** 2 + x[:, 2] ** 2
        return np.asarray(np.maximum(x @ wi, 0) * lit / spread**2)

    def seen(u: np.ndarray, warped: bool) -> np.ndarray:
        v = _unit((wi * (alpha[0], alpha[1], 1.0))[None])[0]
        first = _unit(np.array([[-v[1], v[0], 0.0]]))[0]
        radius, angle = np.sqrt(u[:, 0]), TURN * u[:, 1]
        a, b = radius * np.cos(angle), radius * np.sin(angle)
        b = 0.5 * (1 - v[2]) * np.sqrt(1 - a * a) + 0.5 * (1 + v[2]) * b if warped else b
        c = np.sqrt(np.maximum(1 - a * a - b * b, 0.0))
        h = a[:, None] * first + b[:, None] * np.cross(v, first) + c[:, None] * v
        return _unit(np.stack([alpha[0] * h[:, 0], alpha[1] * h[:, 1], np.maximum(h[:, 2], 0)], axis=-1))

    return UnitHemisphere(), pdf, [lambda u: seen(u, True), lambda u: seen(u, False)], 2


def lobes(rng: np.random.Generator) -> tuple[Any, Map, list[Map], int]:
    """A tilted lobe of any width, or in another place, or with its lower half clamped to the horizon."""
    kappa, axis = 10 ** rng.uniform(-1, 4), _unit(rng.normal(size=(1, 3)))[0]
    frame = np.linalg.qr(np.stack([axis, [0.6, 0.8, 0.1], [0.0, 0.1, 1.0]], axis=1))[0].T
    frame *= np.sign(frame[0] @ axis)
    height = kappa / (TURN * -np.expm1(-2 * kappa))

    def sample(u: np.ndarray) -> np.ndarray:
        mu = np.maximum(1 + np.log1p(u[:, 0] * np.expm1(-2 * kappa)) / kappa, -1)
        sine = np.sqrt(np.maximum(1 - mu * mu, 0))
        return np.asarray(np.stack([mu, sine * np.cos(TURN * u[:, 1]), sine * np.sin(TURN * u[:, 1])], axis=-1) @ frame)

    def clamped(u: np.ndarray) -> np.ndarray:
        x = sample(u)
        x[:, 2] = np.maximum(x[:, 2], 0)
        return _unit(x)

    def pdf(x: np.ndarray) -> np.ndarray:
        return np.asarray(height * np.exp(kappa * (x @ axis - 1)))

    return UnitSphere(), pdf, [sample, clamped, lambda u: sample(u)[:, [1, 2, 0]]], 2


def powers(rng: np.random.Generator) -> tuple[Any, Map, list[Map], int]:
    """Powers of the coordinates, singular ones too, or with coordinates clamped, of few digits, or crowded at the ends."""
    k = int(rng.integers(2, 5))
    a = rng.uniform(0.55, 4.0, k)

    def sample(u: np.ndarray) -> np.ndarray:
        return np.asarray(u ** (1 / a))

    def pdf(x: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore"):
            return np.asarray(np.prod(a * x ** (a - 1), axis=1))

    wrong: list[Map] = [
        lambda u: np.clip(sample(u), 0.1, 0.9),
        lambda u: np.round(sample(u), 6),
        lambda u: np.asarray(1 - u**9),
    ]
    return (UnitSquare() if k == 2 else Box((0.0,) * k, (1.0,) * k)), pdf, [sample, *wrong], k


def teeth(rng: np.random.Generator) -> tuple[Any, Map, list[Map], int]:
    """Teeth on a line, whose samples lie in them, between them, or at one end."""
    n, share, base = int(rng.integers(3, 400)), rng.uniform(0.02, 0.98), rng.uniform(0, 0.5)

    def pdf(x: np.ndarray) -> np.ndarray:
        return np.where((n * x) % 1 < share, base + (1 - base) / share, base)

    def sample(u: np.ndarray) -> np.ndarray:
        v = (np.floor(n * u[:, 0]) + share * ((n * u[:, 0]) % 1)) / n
        return np.where(u[:, 1] < base, u[:, 0], v)

    return Interval(0, 1), pdf, [sample, lambda u: u[:, 0] ** 8, lambda u: np.maximum(sample(u), 0.3)], 2


FAMILIES = (visible_normals, lobes, powers, teeth)


def deviation(
    seed: int, samples: int, family: Callable[..., Any] | None = None, which: int | None = None
) -> tuple[str, float, str]:
    """Return which family and whose samples, how far the printed integral is off in standard errors, and why none is printed.

    family, which  not the seed's: a family, and the number of one of its samplers
    """
    rng = np.random.default_rng([seed, 1])
    family = family or FAMILIES[seed % len(FAMILIES)]
    domain, density, samplers, k = family(rng)
    factor, any_one = float(np.exp(rng.normal(0, 0.3))), int(rng.integers(len(samplers)))
    which = any_one if which is None else which
    name = f"{family.__name__}, {'right' if which == 0 else 'wrong'} samples"
    subject = Subject(samplers[which], lambda x: factor * density(x), domain, k)
    pilot = subject.draw(rng, 1 << 14).x
    mixture = MixtureTest.of(subject, domain.law(pilot), pilot, seed, samples).wider(pilot)
    draw = subject.draw(rng, samples)
    good = in_domain(domain, draw.x, subject.roundoff)
    sums, _ = mixture.count(draw, good, subject.density(draw.x[good]), 0)
    found = Integrated(sums.integral)
    return name, (found.mean - factor) / max(found.error, 1e-300), found.why_not


def main() -> None:
    """Print a table: of each family how many integrals are stated, and how many of them lie within one, two and five errors."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samplers", type=int, default=400)
    parser.add_argument("--samples", type=int, default=60_000)
    arguments = parser.parse_args()
    table: dict[str, Counter[str]] = {}
    for seed in range(arguments.samplers):
        name, z, why = deviation(seed, arguments.samples)
        for row in (table.setdefault(name, Counter()), table.setdefault("total", Counter())):
            row["samplers"] += 1
            row["not stated"] += bool(why)
            for errors in (1, 2, 5):
                row[f"within {errors}"] += not why and abs(z) < errors
        if not why and abs(z) > 4:
            print(f"seed {seed}, {name}: off by {z:.3g} standard errors")
    for name, row in table.items():
        print(f"{name:35}", *(f"{key} {count:4}  " for key, count in row.items()))


if __name__ == "__main__":
    main()
