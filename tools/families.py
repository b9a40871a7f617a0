"""Families with an error in a corner of their parameters: in how many searches is it found, and shrunk to a simple parameter?

    python tools/families.py [--seeds 10] [--right-seeds 100] [NAME …]

Each broken family is searched with several fresh seeds; the parameter that comes out must be wrong and as simple as stated. Each
has a right family beside it, the same without the error, which must never be rejected. Searches are written down as they end: who
starts again goes on.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

import fogproof
from fogproof.checks import fresh_seed

CLAMP, EPS, STEEP = 0.95, 1e-3, 0.01


@dataclass(frozen=True)
class Lobe:
    """Henyey & Greenstein's function about an axis; `drawn` is the g, `frame` the axis that its samples really have."""

    g: float
    axis: tuple[float, float, float]
    drawn: float
    frame: Callable[[np.ndarray], np.ndarray]
    domain: Any = fogproof.UnitSphere()
    dimensions: int = 2

    def sample(self, u: np.ndarray) -> np.ndarray:
        g, x = self.drawn, u[:, 0]
        mu = 1 - 2 * (1 - g) ** 2 * (1 - x) * (1 + g * x) / (1 - g + 2 * g * x) ** 2
        s, phi = np.sqrt(np.maximum(0, 1 - mu * mu)), 2 * np.pi * u[:, 1]
        return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1) @ self.frame(np.array(self.axis))

    def pdf(self, x: np.ndarray) -> np.ndarray:
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
    domain: Any = fogproof.Interval(0.0, 1.0)
    dimensions: int = 1

    def sample(self, u: np.ndarray) -> np.ndarray:
        return (1 - u[:, 0]) ** (1 / (2 / self.drawn**2 - 1))

    def pdf(self, x: np.ndarray) -> np.ndarray:
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
        return fogproof.Interval(0.0, self.end)

    def sample(self, u: np.ndarray) -> np.ndarray:
        return np.minimum(-np.log1p(u[:, 0] * np.expm1(-self.drawn * self.end)) / self.drawn, self.end)

    def pdf(self, t: np.ndarray) -> np.ndarray:
        return self.sigma * np.exp(-self.sigma * t) / -np.expm1(-self.sigma * self.end)


@dataclass(frozen=True)
class Coin:
    """An estimator of p."""

    reference: float
    drawn: float

    def draw(self, rng: np.random.Generator, n: int) -> np.ndarray:
        return (rng.random(n) < self.drawn).astype(float)


UP = (0.0, 0.0, 1.0)
_g = st.floats(-0.99, 0.99)
_axes = st.tuples(*3 * [st.floats(-1, 1)]).filter(lambda v: math.hypot(*v) > 1e-3)
_near_poles = st.one_of(_axes, st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.sampled_from([1.0, -1.0])))


def lobe(drawn: Callable[[float], float] = lambda g: g) -> Callable[[float], Lobe]:
    return lambda g: Lobe(g, UP, drawn(g), frame)


def tilted(made: Callable[[np.ndarray], np.ndarray] = frame) -> Callable[[Any], Lobe]:
    def make(v: Any) -> Lobe:
        w = np.array(v) / np.linalg.norm(v)
        return Lobe(0.5, tuple((w / np.linalg.norm(w)).tolist()), 0.5, made)

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


_alpha = st.one_of(st.floats(0.001, 1.0), st.floats(-3, 0).map(lambda e: 10**e))
_depths = st.tuples(st.floats(0.01, 10.0), st.floats(0.1, 10.0))
_p = st.floats(0.001, 1.0)

FAMILIES = {
    "guard g < eps for |g| < eps": Family(
        lobe(lambda g: 0.0 if g < EPS else g), lobe(), _g, lambda g: g < -EPS, _short
    ),
    "clamp at g = 0.95": Family(lobe(lambda g: min(g, CLAMP)), lobe(), _g, lambda g: g > CLAMP, _short),
    "sign flipped for g < 0": Family(lobe(abs), lobe(), _g, lambda g: g < 0, _short),
    "sign flipped for g > 0.5": Family(lobe(lambda g: -g if g > 0.5 else g), lobe(), _g, lambda g: g > 0.5, _short),
    "wrong for alpha < 0.01": Family(
        lambda a: Power(a, 1.1 * a if a < STEEP else a), lambda a: Power(a, a), _alpha, lambda a: a < STEEP, lambda a: True
    ),
    "alpha clamped at 0.05": Family(
        lambda a: Power(a, max(a, 0.05)), lambda a: Power(a, a), _alpha, lambda a: a < 0.05, lambda a: True
    ),
    "frame lost near the pole": Family(
        tilted(frame_lost_at_the_pole), tilted(), _near_poles, lambda v: _cosine(v) < -0.99, lambda v: v[0] == v[1] == 0
    ),
    "frame right in the upper half alone": Family(
        tilted(frame_without_sign), tilted(), _axes, lambda v: v[2] < 0, lambda v: v[0] == v[1] == 0
    ),
    "optical depth clamped at 20": Family(
        lambda p: Depth(*p, min(p[0], 20 / p[1])), lambda p: Depth(*p, p[0]), _depths,
        lambda p: p[0] * p[1] > 20, lambda p: _short(p[0]) and _short(p[1]),
    ),
    "dead below p = 0.01": Family(
        lambda p: Coin(p, p if p >= STEEP else 0.0), lambda p: Coin(p, p), _p, lambda p: p < STEEP, lambda p: True
    ),
}  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="parts of the families' names; all by default")
    parser.add_argument("--seeds", type=int, default=10, help="searches of each broken family")
    parser.add_argument("--right-seeds", type=int, default=100, help="searches of each right family")
    parser.add_argument("--samples", type=int, default=10_000_000, help="of a search of a broken family")
    parser.add_argument("--right-samples", type=int, default=1_000_000, help="of a search of a right one")
    parser.add_argument(
        "--log", type=Path, default=Path("build/families.jsonl"), help="searches done; those are not done again"
    )
    given = parser.parse_args()
    given.log.parent.mkdir(parents=True, exist_ok=True)
    done = [json.loads(line) for line in given.log.read_text().splitlines()] if given.log.exists() else []
    names = [name for name in FAMILIES if not given.names or any(part in name for part in given.names)]
    wanted = [(name, "broken", i) for i in range(given.seeds) for name in names]
    wanted += [(name, "right", i) for i in range(given.right_seeds) for name in names]
    budget = {"broken": given.samples, "right": given.right_samples}
    done = [row for row in done if row["budget"] == budget[row["side"]]]
    known = {(row["family"], row["side"], row["number"]) for row in done}
    with given.log.open("a") as log:
        for name, side, number in wanted:
            if (name, side, number) not in known:
                row = searched(name, side, budget[side]) | {"number": number}
                done.append(row)
                print(json.dumps(row), file=log, flush=True)
    asked = set(wanted)
    return told(names, [row for row in done if (row["family"], row["side"], row["number"]) in asked])


def searched(name: str, side: str, samples: int) -> dict[str, Any]:
    """Search one family with a fresh seed; return what came of it."""
    family, seed, started = FAMILIES[name], fresh_seed(), time.perf_counter()
    parameter, drawn = search(family.broken if side == "broken" else family.right, family.strategy, samples, seed)
    found = parameter is not None and family.wrong(parameter)
    return {
        "family": name, "side": side, "seed": seed, "budget": samples, "drawn": drawn, "parameter": repr(parameter),
        "rejected": parameter is not None, "found": found, "simple": found and family.simple(parameter),
        "seconds": round(time.perf_counter() - started, 2),
    }  # fmt: skip


def told(names: list[str], rows: list[dict[str, Any]]) -> int:
    """Print the table; return 1 if a family is not found in nine of ten searches, or a right one rejected."""
    bad = False
    print(f"{'family':38} {'found':>7} {'simple':>7} {'false':>7} {'samples':>9} {'seconds':>8}  simplest parameters")
    for name in names:
        broken, right = (
            [row for row in rows if row["family"] == name and row["side"] == side] for side in ("broken", "right")
        )
        found, simple = (sum(row[key] for row in broken) for key in ("found", "simple"))
        false = sum(row["rejected"] for row in right)
        most = max((row["drawn"] for row in broken), default=0)
        rates = f"{found:>4}/{len(broken)} {simple:>4}/{len(broken)} {false:>3}/{len(right)}"
        shown = ", ".join(dict.fromkeys(row["parameter"] for row in broken))
        print(f"{name:38} {rates} {most:9.1e} {sum(row['seconds'] for row in broken + right):8.0f}  {shown}")
        bad |= simple < 0.9 * len(broken) or false > 0
    return int(bad)


def search(make: Callable[[Any], Any], strategy: Any, samples: int, seed: int) -> tuple[Any, int]:
    """Return the simplest rejected parameter of a family, None if none is, and how many samples were drawn."""
    options = {"bounds": (0.0, 1.0)} if strategy is _p else {}
    found: list[Any] = []

    def remembered(parameter: Any) -> Any:
        found.append(parameter)
        return make(parameter)

    verdict = fogproof.check_family(remembered, strategy, samples=samples, seed=seed, **options)
    if verdict.outcome != "rejected":
        return None, verdict.samples
    return next(p for p in found if repr(p) == verdict.settings["parameter"]), verdict.samples


if __name__ == "__main__":
    sys.exit(main())
