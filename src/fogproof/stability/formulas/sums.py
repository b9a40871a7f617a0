"""Long sums and products: moments of 10^9 numbers far from 0, transmittance and fog through thousands of layers and voxels."""

from __future__ import annotations

import math

import numpy as np

from fogproof import analytic
from fogproof.checks.statistics.moments import Moments
from fogproof.estimators import RegularFreePath, regular_tracking
from fogproof.scene import PiecewiseConstantMedium, Ray, VoxelGrid
from fogproof.stability.axes import both_signs, decades, of, uniforms
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import Formula, HardRegion, Naive

DOUBLINGS = 30
"""Three numbers, doubled so often, are 3e9."""

# --- moments --------------------------------------------------------------------------------------------------------------------


def three(offset, spread):
    """Three numbers around an offset, their spread in units of it."""
    return {"a": offset * (1 - spread), "b": offset, "c": offset * (1 + 2 * spread)}


def merged(a, b, c, read):
    found = np.empty(len(a))
    for i, batch in enumerate(np.stack([a, b, c], axis=1)):
        moments = Moments.of(batch)
        for _ in range(DOUBLINGS):
            moments = moments.merged(moments)
        found[i] = read(moments)
    return found


def variance(**x):
    return merged(**x, read=lambda m: m.m2 / m.n * m.scale**2)


def third(**x):
    return merged(**x, read=lambda m: m.m3 / m.n * m.scale**3)


def centred(power):
    def truth(a, b, c):
        mean = (a + b + c) / 3
        return ((a - mean) ** power + (b - mean) ** power + (c - mean) ** power) / 3

    return truth


def naive_variance(a, b, c):
    return (a * a + b * b + c * c) / 3 - ((a + b + c) / 3) ** 2


def naive_third(a, b, c):
    mean = (a + b + c) / 3
    return (a**3 + b**3 + c**3) / 3 - 3 * mean * (a * a + b * b + c * c) / 3 + 2 * mean**3


MOMENTS = (HardRegion("far from 0", {"offset": both_signs(1e-60, 1e60), "spread": decades(1e-12, 1.0)}, derived=three),)


# --- layers and voxels ----------------------------------------------------------------------------------------------------------

COUNTS = (1, 10, 100, 1000, 5000)
PATTERN = [((7 * i) % 11 + 1) / 10 for i in range(max(COUNTS))]
"""Extinction of the layers, in units of their mean, nothing that sums exactly."""


def up(length):
    return Ray((0.5, 0.5, 0.0), (0.0, 0.0, 1.0), length)


def layers(count, sigma):
    values = sigma * np.array(PATTERN[: int(count)])
    return PiecewiseConstantMedium(np.arange(int(count) + 1.0), values, albedo=0.5)


def voxels(count, sigma):
    values = sigma * np.array(PATTERN[: int(count)])
    return VoxelGrid(values[None, None], (0.0, 0.0, 0.0), (1.0, 1.0, float(count)), "nearest", albedo=0.5)


def rounded(sigma, share):
    """What the product of two floats is, rounded as theirs is."""
    return flint().arb(float((sigma * flint().arb(share)).mid()))


def total(count, sigma):
    return sum((rounded(sigma, PATTERN[i]) for i in range(int(float(count.mid())))), flint().arb(0))


def walked(count, sigma):
    return regular_tracking(voxels(count, sigma[0]), up(math.inf)).tau * np.ones_like(sigma)


def naive_product(count, sigma):
    value = np.ones(len(sigma), np.float32)
    for i in range(int(count)):
        value *= np.exp(-(sigma * PATTERN[i]).astype(np.float32))
    return value.astype(float)


@each("count", "sigma")
def free_path(xi, count, sigma):
    return RegularFreePath(voxels(count, sigma), up(math.inf)).sample(xi[:, None]).x


def true_free_path(xi, count, sigma):
    left, t = -(-xi).log1p(), flint().arb(0)
    for i in range(int(float(count.mid()))):
        inside = rounded(sigma, PATTERN[i])
        if left <= inside:
            return t + left / inside
        left, t = left - inside, t + 1
    return flint().arb.pos_inf()


THIN = {"count": of(*COUNTS), "sigma": decades(1e-12, 1e-2)}
MANY = (HardRegion("thousands", THIN),)

FORMULAS = [
    Formula(
        "sums/variance",
        "Variance of 3e9 numbers, merged batch by batch",
        "checks.check_estimator",
        variance,
        centred(2),
        MOMENTS,
        bound=2.0,
        naive=(Naive("E[x^2] - E[x]^2", "textbooks", naive_variance),),
    ),
    Formula(
        "sums/third_moment",
        "Third central moment of 3e9 numbers, merged batch by batch",
        "checks.check_estimator",
        third,
        centred(3),
        MOMENTS,
        bound=3.0,
        naive=(Naive("from moments about 0", "textbooks", naive_third),),
    ),
    Formula(
        "sums/voxels",
        "Optical thickness of thousands of voxels, walked one by one",
        "estimators.regular_tracking",
        each("count", "sigma")(lambda count, sigma: regular_tracking(voxels(count, sigma), up(math.inf)).tau[0]),
        total,
        MANY,
        bound=2.0,
        size=0.34,
        condition=False,
    ),
    Formula(
        "sums/free_path",
        "Free path through a hundred voxels",
        "estimators.RegularFreePath",
        free_path,
        true_free_path,
        (HardRegion("thin to thick", {"xi": uniforms, "sigma": decades(1e-3, 10.0)}, {"count": 100.0}),),
        bound=4.0,
        size=0.5,
    ),
    Formula(
        "sums/layers",
        "Transmittance of thousands of layers",
        "analytic.transmittance",
        each("count", "sigma")(lambda count, sigma: analytic.transmittance(layers(count, sigma), up(math.inf))),
        lambda count, sigma: (-total(count, sigma)).exp(),
        MANY,
        naive=(
            Naive("a running product in single precision", "renderers on graphics cards", each("count")(naive_product)),
        ),
        size=0.34,
        condition=False,
    ),
    Formula(
        "sums/layers_fog",
        "Ambient fog through thousands of layers",
        "analytic.ambient_fog",
        each("count", "sigma")(lambda count, sigma: analytic.ambient_fog(layers(count, sigma), up(math.inf), 2.0)),
        lambda count, sigma: -(-total(count, sigma)).expm1(),
        MANY,
        size=0.34,
        condition=False,
    ),
    Formula(
        "sums/voxels_oracle",
        "The oracle's optical thickness of thousands of voxels",
        "analytic.optical_thickness",
        each("count", "sigma")(lambda count, sigma: analytic.optical_thickness(voxels(count, sigma), up(math.inf))),
        total,
        MANY,
        size=0.34,
        condition=False,
    ),
]
