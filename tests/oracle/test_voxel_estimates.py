"""Invariant: mean, variance and cost of estimators in voxels are those of their definitions, written out another way."""

from itertools import product

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import voxel_estimate_cost, voxel_estimate_mean, voxel_estimate_variance
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.oracle import answer

TWO = {"sigma": [0.5, 2.0], "length": [1.0, 0.7]}
THREE = {"sigma": [2.5, 0.3, 1.0], "length": [0.5, 0.8, 0.7]}
RAYS = [TWO, THREE, {"sigma": [1.3], "length": [2.0]}, {"sigma": [0.0, 3.0, 0.0], "length": [0.2, 0.3, 0.5]}]
UNBIASED = [
    ("telescoping", {"points": 2}),
    ("unbiased-march", {"points": 1}),
    ("unbiased-march", {"points": 5}),
    ("power-series", {"pivot": 1.0, "reach": 3.0}),
    ("power-series", {}),
    ("weighted", {"majorant": 1.2}),
    ("decomposition", {}),
    ("next-flight", {"majorant": 1.1}),
]


def depth_of(ray):
    return sum(mp.mpf(s) * mp.mpf(way) for s, way in zip(ray["sigma"], ray["length"], strict=True))


def inside(found, right):
    return abs(mp.mpf(float(found.value)) - right) <= found.error


def looks(ray, points, offset):
    """The optical depth that equidistant looks behind an offset find."""
    ends = np.cumsum(ray["length"])
    t = ends[-1] * (np.arange(points) + offset) / points
    voxel = np.minimum(np.searchsorted(ends, t, side="right"), len(ends) - 1)
    return ends[-1] * float(np.mean(np.array(ray["sigma"])[voxel]))


@pytest.mark.parametrize("ray", RAYS, ids=lambda ray: len(ray["sigma"]))
@pytest.mark.parametrize(("estimate", "options"), UNBIASED)
def test_unbiased_ones_have_the_transmittance_as_their_mean(ray, estimate, options):
    found = voxel_estimate_mean(**ray, estimate=estimate, **options)
    with mp.workdps(40):
        slack = 1e-12 if estimate == "telescoping" else 0  # it ends after 20 halvings
        assert abs(mp.mpf(float(found.value)) - mp.exp(-depth_of(ray))) <= found.error + slack
    assert found.error < 1e-12


def test_a_march_has_the_bias_of_its_law():
    offsets = (np.arange(3000) + 0.5) / 3000
    for ray, points in product((TWO, THREE), (1, 3, 4)):
        drawn = np.exp([-looks(ray, points, u) for u in offsets])
        mean, variance = (
            f(**ray, estimate="march", points=points) for f in (voxel_estimate_mean, voxel_estimate_variance)
        )
        assert abs(mean.value - drawn.mean()) < 1e-3 * drawn.max()
        assert abs(variance.value - drawn.var()) < 1e-3 * drawn.max() ** 2
        assert float(mean.value) > float(mp.exp(-depth_of(ray)))
        assert max(mean.error, variance.error) < 1e-13


def test_unbiased_march_by_all_sequences():
    """The mean square over all ordered tuples of two depths, up to order 7; the rest is bounded."""
    one, other = looks(TWO, 1, 0.1), looks(TWO, 1, 0.9)
    with mp.workdps(30):
        p, x = [mp.mpf(10) / 17, mp.mpf(7) / 17], [-mp.mpf(one), -mp.mpf(other)]
        reached = [mp.mpf(1), mp.mpf("0.1"), mp.mpf("0.1")]
        while len(reached) < 12:
            reached.append(reached[-1] * 2 / len(reached))
        total = mp.mpf("0.9") * sum(q * mp.exp(2 * v) for q, v in zip(p, x, strict=True))
        for N in range(2, 7):
            ends = reached[N] - reached[N + 1]
            for combs in product(range(2), repeat=N + 1):
                estimate = mp.mpf(0)
                for i in range(N + 1):
                    e = [mp.mpf(1)] + [mp.mpf(0)] * N
                    for j in range(N + 1):
                        if j != i:
                            d = x[combs[j]] - x[combs[i]]
                            e = [e[0]] + [e[k] + d * e[k - 1] for k in range(1, N + 1)]
                    terms = (e[k] / (mp.binomial(N, k) * mp.factorial(k) * reached[k]) for k in range(N + 1))
                    estimate += mp.exp(x[combs[i]]) * sum(terms) / (N + 1)
                chance = mp.mpf(1)
                for c in combs:
                    chance *= p[c]
                total += ends * chance * estimate**2
        right = total - mp.exp(-2 * depth_of(TWO))
    found = voxel_estimate_variance(**TWO, estimate="unbiased-march", points=1)
    assert abs(float(found.value) - float(right)) < 5e-3 * float(right)
    assert float(found.value) >= float(right)
    assert float(voxel_estimate_cost(**TWO, estimate="unbiased-march", points=1).value) == pytest.approx(
        1 + float(sum(reached[1:])) + float(reached[-1]) / 5, rel=1e-4
    )


def test_power_series_by_the_double_sum():
    for ray, c, r in ((TWO, "1.5", "3"), (THREE, "4", "2.5")):
        with mp.workdps(60):
            S, c, r = sum(map(mp.mpf, ray["length"])), mp.mpf(c), mp.mpf(r)
            Y = [(mp.mpf(way) / S, c - S * mp.mpf(s)) for s, way in zip(ray["sigma"], ray["length"], strict=True)]
            m1, m2 = sum(w * y for w, y in Y), sum(w * y * y for w, y in Y)
            P = [mp.mpf(1)]
            for k in range(1, 80):
                P.append(P[-1] * min(mp.mpf(1), r / k))
            total = sum(
                P[max(k, n)] / (P[k] * P[n]) * m2 ** min(k, n) * m1 ** abs(k - n) / (mp.factorial(k) * mp.factorial(n))
                for k, n in product(range(80), repeat=2)
            )
            right = mp.exp(-2 * c) * total - mp.exp(-2 * depth_of(ray))
            options = {"estimate": "power-series", "pivot": float(c), "reach": float(r)}
            found = voxel_estimate_variance(**ray, **options)
            assert inside(found, right)
            assert inside(voxel_estimate_cost(**ray, **options), sum(P[1:]))
        assert found.error < 1e-10 * found.value


@pytest.mark.parametrize("m", [0.9, 1.4, 4.0, 30.0])
def test_next_flight_by_its_differential_equation(m):
    """E[Z^2]' = A' - m A + m (1 - q) E[Z^2], backwards from 1 at the end of the ray."""
    with mp.workdps(30):
        ends, s = [mp.mpf(0), *map(mp.mpf, np.cumsum(TWO["length"]).tolist())], [mp.mpf(x) for x in TWO["sigma"]]
        S, M = ends[-1], mp.mpf(m)

        def once(y, voxel):
            left = sum(s[j] * (ends[j + 1] - max(ends[j], y)) for j in range(voxel, len(s)))
            a = mp.exp(-M * (S - y))
            return 2 * a * mp.exp(-left) - a * a

        square = mp.mpf(1)
        for voxel in (1, 0):
            low, high, rate = ends[voxel], ends[voxel + 1], 2 * s[voxel] - s[voxel] ** 2 / M

            def source(y, voxel=voxel, low=low, rate=rate):
                return M * (1 - s[voxel] / M) ** 2 * mp.exp(-rate * (y - low)) * once(y, voxel)

            rest = mp.exp(-rate * (high - low)) * (square - once(high, voxel))
            square = once(low, voxel) + rest + mp.quad(source, [low, high])
        right = square - mp.exp(-2 * depth_of(TWO))
    found = voxel_estimate_variance(**TWO, estimate="next-flight", majorant=m)
    assert inside(found, right)
    assert found.error < 1e-10 * found.value
    assert float(voxel_estimate_cost(**TWO, estimate="next-flight", majorant=m).value) == pytest.approx(1.7 * m)


def test_weighted_is_delta_tracking_under_a_bound_and_decomposition_with_all_of_it_is_exact():
    T = float(mp.exp(-depth_of(TWO)))
    for m in (2.0, 5.0):
        weighted = voxel_estimate_variance(**TWO, estimate="weighted", majorant=m)
        assert float(weighted.value) == pytest.approx(T * (1 - T), rel=1e-12)
        one = voxel_estimate_cost(**TWO, estimate="weighted", majorant=m).value
        other = voxel_estimate_cost(**TWO, estimate="decomposition", majorant=m).value
        assert float(one) == pytest.approx(float(other), rel=1e-13)
    small = voxel_estimate_variance(**TWO, estimate="weighted", majorant=1.0)
    # m - |m - s| (s + |m - s|)/m is 1/2 in the first voxel, and -2 in the second, where null collisions have the weight -3.
    assert float(small.value) == pytest.approx(np.exp(-0.5 * 1.0 + 2.0 * 0.7) - T * T, rel=1e-12)
    same = {"sigma": [1.5, 1.5], "length": [0.4, 0.8]}
    for estimate, options in (
        ("decomposition", {"control": 1.5}),
        ("march", {}),
        ("unbiased-march", {}),
        ("telescoping", {}),
    ):
        assert voxel_estimate_variance(**same, estimate=estimate, **options).value < 1e-15


REFUSED = [
    ({"sigma": [], "length": []}, "sigma must be a list of 1 to 64 numbers"),
    ({"length": [1.0]}, "length must be one number a voxel"),
    ({"sigma": [-1.0, 1.0]}, "sigma must be finite and >= 0"),
    ({"length": [0.0, 1.0]}, "length must be finite and > 0"),
    ({"sigma": [0.5, 2000.0]}, "sigma must make an optical depth of at most 500"),
    ({"estimate": "ratio"}, "estimate must be one of march, telescoping"),
    ({"estimate": "march", "points": 0}, r"points must be a whole number in \[1, 4096\], got 0"),
    ({"estimate": "telescoping", "ratio": 0.5}, r"ratio must lie in the open interval \(1/4, 1/2\)"),
    ({"estimate": "power-series", "reach": 0.0}, r"reach must lie in \(0, 10000\]"),
    ({"estimate": "weighted", "majorant": 0.0}, "majorant must be finite and > 0"),
    ({"estimate": "decomposition", "majorant": 1.0}, "majorant must not lie below the greatest sigma 2"),
    ({"estimate": "decomposition", "control": 0.6}, r"control must lie in \[0, 0.5\], the least sigma"),
    ({"sigma": [0.0, 0.0], "estimate": "weighted"}, "majorant must be > 0"),
]


@pytest.mark.parametrize(("changed", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_bad_input_is_refused(changed, message):
    with pytest.raises(InvalidValueError, match=message):
        voxel_estimate_mean(**{**TWO, "estimate": "march", **changed})


def test_more_values_than_are_enumerated_are_refused():
    with pytest.raises(UnsupportedError, match="find 6 different optical depths, and at most 4 are enumerated"):
        voxel_estimate_mean(np.arange(1.0, 7.0), np.ones(6), "unbiased-march", points=1)
    with pytest.raises(UnsupportedError, match="differ by an optical depth of up to 119, too much to enumerate"):
        voxel_estimate_mean([1.0, 60.0, 120.0], [0.3, 0.3, 0.4], "unbiased-march", points=1)
    with pytest.raises(UnsupportedError, match=r"looks are off the pivot by 397 \(root mean square\)"):
        voxel_estimate_variance([1.0, 2.0], [1.0, 1.0], "power-series", pivot=400.0, reach=0.1)
    for estimate in ("weighted", "next-flight"):
        with pytest.raises(
            UnsupportedError, match=r"mean square of the estimate has the size .* take a larger majorant"
        ):
            voxel_estimate_variance([1.0, 3.0], [1.0, 1.0], estimate, majorant=1e-3)


def test_requests():
    found = answer({"quantity": "voxel_estimate_variance", **TWO, "estimate": "next-flight", "majorant": 3})
    assert found["value"] == float(voxel_estimate_variance(**TWO, estimate="next-flight", majorant=3.0).value)


def test_moments_beyond_float64_are_refused():
    with pytest.raises(UnsupportedError, match=r"a moment of the estimate 'next-flight' is beyond 1\.8e308"):
        voxel_estimate_cost([0.5, 3], [1, 0.7], "next-flight", majorant=1e-160)
