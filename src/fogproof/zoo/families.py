"""Families with an error in a corner of their parameters, each beside the right one; a search must find and shrink it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from fogproof.checks import Verdict, check_family
from fogproof.domains import Interval, UnitSphere
from fogproof.zoo.bug import Bug, named

CLAMP, EPS, STEEP = 0.95, 1e-3, 0.01


@dataclass(frozen=True)
class TiltedLobe:
    """Henyey & Greenstein's function about an axis; `drawn` is the g, `frame` the axis that its samples really have."""

    g: float
    axis: tuple[float, float, float]
    drawn: float
    frame: Callable[[np.ndarray], np.ndarray]
    domain: Any = field(default_factory=UnitSphere)
    dimensions: int = 2

    def sample(self, u: np.ndarray) -> np.ndarray:
        """Return points."""
        g, x = self.drawn, u[:, 0]
        mu = 1 - 2 * (1 - g) ** 2 * (1 - x) * (1 + g * x) / (1 - g + 2 * g * x) ** 2
        s, phi = np.sqrt(np.maximum(0, 1 - mu * mu)), 2 * np.pi * u[:, 1]
        return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1) @ self.frame(np.array(self.axis))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density claimed."""
        g, mu = self.g, x @ np.array(self.axis)
        return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5)


def frame(w: np.ndarray) -> np.ndarray:
    """Return rows of an orthonormal frame whose last one is w (Duff et al. 2017)."""
    sign = math.copysign(1.0, w[2])
    a = -1 / (sign + w[2])
    b = w[0] * w[1] * a
    return np.array([[1 + sign * w[0] ** 2 * a, sign * b, -sign * w[0]], [b, sign + w[1] ** 2 * a, -w[1]], w])


def frame_lost_at_the_pole(w: np.ndarray) -> np.ndarray:
    """Return the frame, but that of +z wherever w is nearly -z."""
    return np.eye(3) if w[2] < -0.99 else frame(w)


def frame_without_sign(w: np.ndarray) -> np.ndarray:
    """Return a frame that is right in the upper half alone."""
    return frame(np.array([w[0], w[1], abs(w[2])]))


@dataclass(frozen=True)
class Power:
    """Cosines with density (n + 1) mu^n, n = 2 / alpha^2 - 2 (Beckmann-like roughness); `drawn` is the alpha of the samples."""

    alpha: float
    drawn: float
    domain: Any = field(default_factory=lambda: Interval(0.0, 1.0))
    dimensions: int = 1

    def sample(self, u: np.ndarray) -> np.ndarray:
        """Return points."""
        return (1 - u[:, 0]) ** (1 / (2 / self.drawn**2 - 1))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density claimed."""
        n = 2 / self.alpha**2 - 2
        return (n + 1) * x**n


@dataclass(frozen=True)
class Depth:
    """Free paths of extinction sigma before a surface at `end`, given that they end before it."""

    sigma: float
    end: float
    drawn: float

    dimensions = 1

    @property
    def domain(self) -> Any:
        """Return the way to the surface."""
        return Interval(0.0, self.end)

    def sample(self, u: np.ndarray) -> np.ndarray:
        """Return points."""
        return np.minimum(-np.log1p(u[:, 0] * np.expm1(-self.drawn * self.end)) / self.drawn, self.end)

    def pdf(self, t: np.ndarray) -> np.ndarray:
        """Return the density claimed."""
        return self.sigma * np.exp(-self.sigma * t) / -np.expm1(-self.sigma * self.end)


@dataclass(frozen=True)
class Coin:
    """An estimator of p."""

    reference: float
    drawn: float

    @property
    def options(self) -> dict[str, Any]:
        """A coin shows 0 or 1."""
        return {"bounds": (0.0, 1.0)}

    def draw(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Return n tosses."""
        return (rng.random(n) < self.drawn).astype(float)


UP = (0.0, 0.0, 1.0)


def lobe(drawn: Callable[[float], float] = lambda g: g) -> Callable[[float], TiltedLobe]:
    """Return lobes about z, drawn with another g."""
    return lambda g: TiltedLobe(g, UP, drawn(g), frame)


def tilted(made: Callable[[np.ndarray], np.ndarray] = frame) -> Callable[[Any], TiltedLobe]:
    """Return lobes about any axis, in a frame made some way."""

    def make(v: Any) -> TiltedLobe:
        w = np.array(v) / np.linalg.norm(v)
        return TiltedLobe(0.5, tuple((w / np.linalg.norm(w)).tolist()), 0.5, made)

    return make


def _cosine(v: Any) -> float:
    return v[2] / math.hypot(*v)


@dataclass(frozen=True)
class Family:
    """A broken family beside the right one.

    wrong   whether a parameter is wrong: what the search returns must be
    simple  whether a parameter is as simple as the stated one
    """

    broken: Callable[[Any], Any]
    right: Callable[[Any], Any]
    strategy: Any
    wrong: Callable[[Any], bool]
    simple: Callable[[Any], bool]


def _short(x: float) -> bool:
    return x * 1024 % 1 == 0


@cache
def families() -> dict[str, Family]:
    """Return them by their titles; needs Hypothesis."""
    from hypothesis import strategies as st

    asymmetry = st.floats(-0.99, 0.99)
    axes = st.tuples(*3 * [st.floats(-1, 1)]).filter(lambda v: math.hypot(*v) > 1e-3)
    near_poles = st.one_of(axes, st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.sampled_from([1.0, -1.0])))

    alpha = st.one_of(st.floats(0.001, 1.0), st.floats(-3, 0).map(lambda e: 10**e))
    depths = st.tuples(st.floats(0.01, 10.0), st.floats(0.1, 10.0))
    probabilities = st.floats(0.001, 1.0)

    return {
        "guard g < eps for |g| < eps": Family(
            lobe(lambda g: 0.0 if g < EPS else g), lobe(), asymmetry, lambda g: g < -EPS, _short
        ),
        "clamp at g = 0.95": Family(lobe(lambda g: min(g, CLAMP)), lobe(), asymmetry, lambda g: g > CLAMP, _short),
        "sign flipped for g < 0": Family(lobe(abs), lobe(), asymmetry, lambda g: g < 0, _short),
        "sign flipped for g > 0.5": Family(lobe(lambda g: -g if g > 0.5 else g), lobe(), asymmetry, lambda g: g > 0.5, _short),
        "wrong for alpha < 0.01": Family(
            lambda a: Power(a, 1.1 * a if a < STEEP else a), lambda a: Power(a, a), alpha, lambda a: a < STEEP, lambda a: True
        ),
        "alpha clamped at 0.05": Family(
            lambda a: Power(a, max(a, 0.05)), lambda a: Power(a, a), alpha, lambda a: a < 0.05, lambda a: True
        ),
        "frame lost near the pole": Family(
            tilted(frame_lost_at_the_pole), tilted(), near_poles, lambda v: _cosine(v) < -0.99, lambda v: v[0] == v[1] == 0
        ),
        "frame right in the upper half alone": Family(
            tilted(frame_without_sign), tilted(), axes, lambda v: v[2] < 0, lambda v: v[0] == v[1] == 0
        ),
        "optical depth clamped at 20": Family(
            lambda p: Depth(p[0], p[1], min(p[0], 20 / p[1])), lambda p: Depth(p[0], p[1], p[0]), depths,
            lambda p: p[0] * p[1] > 20, lambda p: _short(p[0]) and _short(p[1]),
        ),
        "dead below p = 0.01": Family(
            lambda p: Coin(p, p if p >= STEEP else 0.0), lambda p: Coin(p, p), probabilities, lambda p: p < STEEP, lambda p: True
        ),
    }  # fmt: skip


@dataclass(frozen=True)
class FamilySearch:
    """The search of the broken side of a family, as `check_family` does it."""

    title: str
    needs = "hypothesis"

    def run(self, alpha: float, seed: int, samples: int | None = None) -> Verdict:
        """Search with at most so many samples, and as many again to shrink."""
        family = families()[self.title]
        return check_family(family.broken, family.strategy, samples=samples or 10_000_000, alpha=alpha, seed=seed)


TITLES = {
    "guard g < eps for |g| < eps": ("uniform law", "another parameter"),
    "clamp at g = 0.95": ("another parameter",),
    "sign flipped for g < 0": ("sign convention",),
    "sign flipped for g > 0.5": ("sign convention",),
    "wrong for alpha < 0.01": ("another parameter", "wrong power", "wrong scale"),
    "alpha clamped at 0.05": ("another parameter", "wrong power", "wrong scale"),
    "frame lost near the pole": ("rotated frame", "sign convention"),
    "frame right in the upper half alone": ("rotated frame", "outside the domain", "sign convention"),
    "optical depth clamped at 20": ("wrong scale", "another parameter"),
    "dead below p = 0.01": ("bias",),
}
"""Title -> causes that are right."""


def bugs() -> list[Bug]:
    """Return the broken sides."""
    return [
        Bug(named("families", title), title, "field", causes, FamilySearch(title)) for title, causes in TITLES.items()
    ]
