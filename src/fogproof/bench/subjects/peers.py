"""Other packages at the same work, where they are installed: Mitsuba's sampling and test, miepython's Lorenz-Mie series."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic import phase_pdf
from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.checks import check_sampler
from fogproof.estimators import Directions
from fogproof.scene import HenyeyGreenstein, Mie

N = 1 << 18


def _sampling() -> dict[str, Way]:
    from fogproof.adapters.mitsuba import MitsubaPhase

    ours = Directions(HenyeyGreenstein(0.6))
    theirs = MitsubaPhase({"type": "hg", "g": 0.6}, (0.0, 0.0, 1.0))
    rng = np.random.default_rng(1)
    u = rng.random((N, 3))
    single = u.astype(np.float32)
    return {
        "fogproof": Way(lambda: ours.sample(u[:, :2]), N),
        "Mitsuba, arrays in and out": Way(lambda: theirs.sample(single), N),
    }


def _testing() -> dict[str, Way]:
    from fogproof.zoo.bug import Planted
    from fogproof.zoo.others.mitsuba import TESTS

    hg = Directions(HenyeyGreenstein(0.6))
    subject = Planted(lambda u: hg.sample(u).x, hg.pdf, hg.domain, 2)

    def ours() -> Any:
        return check_sampler(subject.sample, subject.pdf, subject.domain, dimensions=2, samples=1_000_000, seed=1)

    ways = {"check_sampler": Way(ours)}
    if TESTS[0].applies(subject):
        ways["ChiSquareTest"] = Way(lambda: TESTS[0].p_value(subject, np.random.default_rng(1)))
    return ways


def _spheres() -> dict[str, Way]:
    import miepython

    mu = np.linspace(-1, 1, 2001)
    sphere = Mie(2e-6, 550e-9, 1.33)
    size = np.pi * sphere.diameter / sphere.wavelength
    return {
        "fogproof, with error bounds": Way(lambda: phase_pdf(sphere, mu).value, len(mu)),
        "miepython": Way(lambda: miepython.i_unpolarized(1.33, size, mu, norm="one"), len(mu)),
    }


def benchmarks() -> list[Benchmark]:
    """Return them."""
    test = {"ChiSquareTest": Goal(">=", 0.2)}
    spheres = "fogproof, with error bounds"
    return [
        Benchmark("mitsuba-sampling", "Henyey-Greenstein directions", "sample", "fogproof", _sampling, {}, "mitsuba"),
        Benchmark("mitsuba-test", "A million samples judged", "check", "check_sampler", _testing, test, "mitsuba"),
        Benchmark("miepython", "Lorenz-Mie phase function", "cosine", spheres, _spheres, {}, "miepython"),
    ]
