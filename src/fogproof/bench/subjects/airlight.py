"""Single scattering of typical rays: the oracle's methods, Sun's and Pegoraro's, QUADPACK in its leanest form, mpmath, balls.

Typical means sigma_t and the distance h of the light from the ray log-uniform in 0.01 … 10, the camera -10 … 5 m from the foot,
rays of 0.1 … 20 m. Errors are relative ones against ball arithmetic, the median of the rays that a way was given.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable, Iterable
from functools import cache, partial
from typing import Any

import numpy as np

from fogproof.analytic.airlight.integral import ALTERNATIVES, airlight_integral, integrate
from fogproof.analytic.airlight.segments import whole
from fogproof.analytic.proven.airlight import rigorous_airlight
from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.scene import HenyeyGreenstein, Isotropic, PhaseFunction

MANY, FEW, VERY_FEW = 20_000, 60, 6
Segments = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@cache
def typical(n: int) -> Segments:
    """Return sigma_t [1/m], h, a, b [m] of n typical rays; the first are the same for every n."""
    rng = np.random.default_rng(2)
    u = rng.random((n, 4)).T
    a = -10 + 15 * u[2]
    return 10 ** (3 * u[0] - 2), 10 ** (3 * u[1] - 2), a, a + 10 ** (2.3 * u[3] - 1)


@cache
def _truth(phase: PhaseFunction) -> np.ndarray:
    return rigorous_airlight(*typical(FEW), phase).value


def _error(phase: PhaseFunction, value: Any) -> float:
    n = min(FEW, len(value))
    return float(np.median(np.abs(np.asarray(value)[:n] / _truth(phase)[:n] - 1)))


def _by_quad(functions: Any, phase: PhaseFunction) -> np.ndarray:
    """Return integrals over t by scipy.integrate.quad, 13 digits asked, split at the foot; `functions` is NumPy or math."""
    from scipy.integrate import quad

    exp, sqrt, g = functions.exp, functions.sqrt, float(getattr(phase, "g", 0.0))
    found = []
    for sigma, h, a, b in zip(*(part[:FEW].tolist() for part in typical(FEW)), strict=True):
        found.append(
            quad(_integrand(exp, sqrt, g, sigma, h, a), a, b, epsabs=0, epsrel=1e-13, limit=200, points=_foot(a, b))[0]
        )
    return np.array(found)


def _foot(a: float, b: float) -> list[float] | None:
    return [0.0] if a < 0 < b else None


def _integrand(exp: Any, sqrt: Any, g: float, sigma: float, h: float, a: float) -> Callable[[float], float]:
    h2 = h * h

    def plain(t: float) -> float:
        r2 = t * t + h2
        return float(exp(-sigma * (t - a + sqrt(r2))) / r2)

    def lobed(t: float) -> float:
        r2 = t * t + h2
        r = sqrt(r2)
        return float(exp(-sigma * (t - a + r)) / r2 * (1 - g * g) / (1 + g * g + 2 * g * t / r) ** 1.5)

    return lobed if g else plain


def _by_mpmath(phase: PhaseFunction) -> np.ndarray:
    import mpmath

    g, found = float(getattr(phase, "g", 0.0)), []
    for sigma, h, a, b in zip(*(part.tolist() for part in typical(VERY_FEW)), strict=True):
        f = _complex_integrand(mpmath, g, sigma, h, a)
        found.append(float(mpmath.quad(f, [a, 0, b] if a < 0 < b else [a, b])))
    return np.array(found)


def _complex_integrand(mp: Any, g: float, sigma: float, h: float, a: float) -> Callable[[Any], Any]:
    def f(t: Any) -> Any:
        r = mp.sqrt(t * t + h * h)
        lobe = (1 - g * g) / (1 + g * g + 2 * g * t / r) ** mp.mpf(1.5) if g else 1
        return mp.exp(-sigma * (t - a + r)) / (r * r) * lobe

    return f


def _ways(phase: PhaseFunction, methods: Iterable[str]) -> dict[str, Way]:
    def judged(run: Callable[[], Any], rays: int) -> Way:
        return Way(run, rays, partial(_error, phase))

    given = typical(MANY)
    ways = {"oracle": judged(lambda: airlight_integral(*given, phase=phase).value, MANY)}
    for name in methods:
        ways[name] = judged(partial(_by_method, given, phase, name), MANY)
    ways["quad, math"] = judged(partial(_by_quad, math, phase), FEW)
    ways["quad, NumPy"] = judged(partial(_by_quad, np, phase), FEW)
    if importlib.util.find_spec("mpmath"):
        ways["mpmath, 15 digits"] = judged(partial(_by_mpmath, phase), VERY_FEW)
    few = typical(VERY_FEW)
    ways["ball arithmetic"] = judged(lambda: rigorous_airlight(*few, phase).value, VERY_FEW)
    return ways


def _by_method(given: Segments, phase: PhaseFunction, name: Any) -> np.ndarray:
    return integrate(whole(*given), phase, name)[0]


def benchmarks() -> list[Benchmark]:
    """Return them."""
    goals = {"quad, math": Goal(">=", 50.0), "quad, NumPy": Goal(">=", 100.0)}
    return [
        Benchmark("airlight", "Airlight, isotropic", "ray", "oracle", lambda: _ways(Isotropic(), ALTERNATIVES), goals, "flint"),
        Benchmark(
            "airlight-hg", "Airlight, Henyey-Greenstein g = 0.8", "ray", "oracle",
            lambda: _ways(HenyeyGreenstein(0.8), ("equiangular", "pegoraro2010")),
            {"quad, math": Goal(">=", 50.0)}, "flint",
        ),
    ]  # fmt: skip
