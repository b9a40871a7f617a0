"""Where `eval` is not 0 and the pdf is: found without statistics and without an albedo; edges and underflow are left alone."""

import numpy as np
import pytest

from fogproof import Discrete, Draw, HalfLine, Interval, Product, UnitHemisphere, UnitSphere, check_sampler

UP = {"dimensions": 2, "samples": 20_000}


def hemisphere(u):
    z, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


def cosine(x):
    return np.maximum(x[:, 2], 0) / np.pi


def both(x):
    return np.stack([cosine(x), 0.01 * np.abs(x[:, 2])], axis=-1)


def line(part):
    return lambda u: Draw(u[:, 0] * part)


HOLES = {
    "transmission never sampled": (hemisphere, cosine, UnitSphere(), {"eval": lambda x: np.abs(x[:, 2]), **UP}),
    "one channel of two": (hemisphere, cosine, UnitSphere(), {"eval": both, **UP}),
    "the last tenth": (
        line(0.9),
        lambda x: (x < 0.9) / 0.9,
        Interval(0, 1),
        {"eval": lambda x: np.ones(len(x)), "dimensions": 1},
    ),
    "one entry of a table": (
        lambda u: np.floor(9 * u[:, 0]),
        lambda i: (i < 9) / 9,
        Discrete(10),
        {"eval": lambda i: i + 1, "dimensions": 1},
    ),
    "half of a product": (
        lambda u: np.stack([-np.log1p(-u[:, 0]), 0.5 * u[:, 1]], axis=-1),
        lambda x: np.exp(-x[:, 0]) * 2 * (x[:, 1] < 0.5),
        Product(HalfLine(0), Interval(0, 1)),
        {"eval": lambda x: np.exp(-x[:, 0]), "dimensions": 2},
    ),
}


@pytest.mark.parametrize("name", HOLES)
def test_what_is_never_drawn_is_found(name):
    sample, pdf, domain, options = HOLES[name]
    verdict = check_sampler(sample, pdf, domain, **{"samples": 20_000, **options})
    finding = next(f for f in verdict.findings if f.check == "support of eval")
    assert finding.outcome == "rejected"
    assert finding.effect > 1e-3
    assert verdict.cause == "lost contribution"


def gauss(x):
    return np.exp(-0.5 * (x / 0.01) ** 2) / (0.01 * np.sqrt(2 * np.pi))


KEPT = {
    "cosine over the hemisphere": (hemisphere, cosine, UnitHemisphere(), {"eval": cosine, **UP}),
    "the same support on the sphere": (hemisphere, cosine, UnitSphere(), {"eval": lambda x: 0.5 * cosine(x), **UP}),
    "eval that is 0 at more places": (
        line(1.0), lambda x: np.ones(len(x)), Interval(0, 1), {"eval": lambda x: (x > 0.3) * 1.0, "dimensions": 1},
    ),
    "edges that differ by rounding": (
        line(0.7), lambda x: (x < 0.7) / 0.7, Interval(0, 1),
        {"eval": lambda x: (x < 0.7 * (1 + 1e-15)) * 1.0, "dimensions": 1},
    ),
    "a pdf that underflows": (
        lambda u: np.clip(0.01 * np.sqrt(2) * np.abs(np.sqrt(-np.log1p(-u[:, 0])) * np.cos(2 * np.pi * u[:, 1])), 0, 1),
        lambda x: 2 * gauss(x), Interval(0, 1), {"eval": lambda x: 1e3 * np.exp(-0.45 * (x / 0.01) ** 2), "dimensions": 2},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", KEPT)
def test_right_supports_are_left_alone(name):
    sample, pdf, domain, options = KEPT[name]
    verdict = check_sampler(sample, pdf, domain, **{"samples": 20_000, **options})
    finding = next(f for f in verdict.findings if f.check == "support of eval")
    assert finding.outcome == "not rejected", finding.message
    assert verdict.outcome == "not rejected", str(verdict)
