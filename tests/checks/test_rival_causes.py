"""A cause is named where it explains the misfit and nothing else does as well: no few entries for a ramp, no atom for a law."""

import numpy as np
import pytest
from scipy.special import ndtri

from fogproof import Discrete, HalfLine, Interval, Product, RealLine, Rotations, UnitDisk, check_sampler

N = 30_000
TEN = np.array([0.19, 0.03, 0.13, 0.07, 0.11, 0.09, 0.12, 0.08, 0.1, 0.08])
TURN = 2 * np.pi


def drawn(p):
    cumulated = np.cumsum(p) / np.sum(p)
    return lambda u: np.minimum(np.searchsorted(cumulated, u[:, 0], side="right"), len(p) - 1)


def ten(i):
    return TEN[i.astype(int)]


def quaternions(u, power=0.5, angle=TURN):
    r = u[:, 0] ** power
    s, a, b = np.sqrt(1 - r * r), angle * u[:, 1], angle * u[:, 2]
    return np.stack([s * np.sin(a), s * np.cos(a), r * np.sin(b), r * np.cos(b)], axis=-1)


def ones(x):
    return np.ones(len(x))


def without_sign(u):
    """A concentric map (Shirley & Chiu 1997) whose radius is never negative."""
    x, y = (2 * u - 1).T
    wide = np.abs(x) > np.abs(y)
    with np.errstate(all="ignore"):
        phi = np.where(wide, np.pi / 4 * y / x, np.pi / 2 - np.pi / 4 * x / y)
    r, phi = np.abs(np.where(wide, x, y)), np.where((x == 0) & (y == 0), 0, phi)
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)


CASES = {  # sampler, pdf, domain, dimensions; the cause and words of what explains it
    "a ramp": ((drawn(TEN * np.linspace(0.8, 1.2, 10)), ten, Discrete(10), 1), "shape", ""),
    "two entries": (
        (drawn(TEN + 0.03 * np.isin(range(10), 3) - 0.03 * np.isin(range(10), 6)), ten, Discrete(10), 1),
        "few entries",
        "2 entries, 3, 6",
    ),
    "never the last": ((lambda u: np.minimum(drawn(TEN)(u), 8), ten, Discrete(10), 1), "clamped", "9, never comes"),
    "rounded": ((lambda u: np.rint(9 * u[:, 0]), lambda i: 0.1 * ones(i), Discrete(10), 1), "rounded index", "half"),
    "r of quaternions": ((lambda u: quaternions(u, 1), ones, Rotations(), 3), "missing square root", "2 and 3"),
    "half angles": ((lambda u: quaternions(u, 0.5, np.pi), ones, Rotations(), 3), "skipped region", "over pi"),
    "r without its sign": ((without_sign, lambda x: ones(x) / np.pi, UnitDisk(), 2), "lost sign", "sign of r"),
    "a shared uniform": (
        (
            lambda u: np.stack([-np.log1p(-u[:, 0]), -np.log1p(-u[:, 0])], axis=-1),
            lambda x: np.exp(-x.sum(axis=1)),
            Product(HalfLine(0), HalfLine(0)),
            1,
        ),
        "correlation",
        "share a uniform",
    ),
    "points that rounding repeats": (
        (
            lambda u: np.where(u[:, 0] < 0.01, 0.5, 0.6 * ndtri(np.clip(u[:, 1], 1e-16, 1 - 1e-16))),
            lambda x: np.exp(-0.5 * x * x) / np.sqrt(TURN),
            RealLine(),
            2,
        ),
        "wrong scale",
        "of the samples are 0.5",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_cause_is(name):
    (sample, pdf, domain, dimensions), cause, words = CASES[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=N)
    assert (verdict.outcome, verdict.cause) == ("rejected", cause), str(verdict)
    assert words in verdict.diagnosis, verdict.diagnosis


def test_one_entry_too_probable_is_no_constant_factor():
    """The table sums to 1.01, but its other entries are right: enough samples show that."""
    w = np.array([0.1, 0.25, 0.05, 0.4, 0.2])

    def table(x):
        return np.where(x == 2, 0.06, w[x.astype(int)])

    def entry(u):
        return np.searchsorted(np.cumsum(w)[:-1], u[:, 0], side="right").astype(float)

    verdict = check_sampler(entry, table, Discrete(5), dimensions=1, samples=400_000, seed=1)
    assert verdict.cause == "few entries", str(verdict)
    constant = check_sampler(
        entry, lambda x: 1.01 * w[x.astype(int)], Discrete(5), dimensions=1, samples=400_000, seed=1
    )
    assert constant.cause == "normalisation", str(constant)


def test_samples_that_are_nearly_all_one_point_are_no_other_law():
    """An exponential a million times too long, clamped to 1: turned round it would fit, were it not a single point."""

    def clamped(u):
        return np.minimum(-np.log1p(-u[:, 0]) * 1000, 1.0)

    def pdf(x):
        return 1000 * np.exp(-1000 * x)

    verdict = check_sampler(clamped, pdf, Interval(0.0, 1.0), dimensions=1, samples=40_000, seed=1)
    assert verdict.cause in ("atom", "clamped"), str(verdict)
