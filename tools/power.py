"""Which planted errors does `check_sampler` reject, and how often? One row a mutant, `--seeds` fresh seeds each.

    python tools/power.py [--seeds 20] [--samples 1000000] [--alpha 1e-6] [--only TEXT] [-o build/power.json]

The subjects are Henyey-Greenstein directions with g = 0.8 and free paths before a surface at tau = 0.7. Rows marked
"right" hold no error and must never be rejected; rows with a number of samples of their own give the check
twice what the best test there is (Neyman & Pearson) would need.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.checks import Verdict, check_sampler, fresh_seed
from fogproof.contracts import Draw
from fogproof.domains import Interval, UnitSphere
from fogproof.estimators import Directions, FreePath
from fogproof.scene import HenyeyGreenstein

G = 0.8
SIGMA_T = 1.4
HG = Directions(HenyeyGreenstein(G))
PATH = FreePath(SIGMA_T, 0.5)
SURFACE = PATH.atoms[0.5]


@dataclass(frozen=True)
class Mutant:
    """A sampler, the density it claims, what else is declared, and whether an error is in it."""

    name: str
    sample: Callable[[np.ndarray], Any]
    pdf: Callable[[np.ndarray], np.ndarray] = HG.pdf
    domain: Any = field(default_factory=UnitSphere)
    options: dict[str, Any] = field(default_factory=lambda: {"dimensions": 2})
    wrong: bool = True
    samples: int | None = None

    def check(self, samples: int, alpha: float, seed: int) -> Verdict:
        """Return the verdict of one call."""
        samples = self.samples or samples
        return check_sampler(
            self.sample, self.pdf, self.domain, samples=samples, alpha=alpha, seed=seed, **self.options
        )


def _points(u: np.ndarray) -> np.ndarray:
    return HG.sample(u).x


def _squeezed(u: np.ndarray, column: int, low: float, high: float) -> np.ndarray:
    v = u.copy()
    v[:, column] = low + (high - low) * u[:, column]
    return v


def _scaled(factor: float) -> Mutant:
    return Mutant(f"pdf x {factor:g}", _points, lambda x: factor * HG.pdf(x))


def _other_g(g: float, samples: int | None = None) -> Mutant:
    within = f", {samples:.3g} samples" if samples else ""
    other = Directions(HenyeyGreenstein(g))
    return Mutant(f"g - {G - g:.3f}{within}", lambda u: other.sample(u).x, samples=samples)


def neyman_pearson(g: float, alpha: float = 1e-6, miss: float = 0.01) -> int:
    """Return how many samples the best of all tests needs to tell g from G, for a normal log-likelihood ratio.

    (z_alpha + z_miss)^2 / n is its chi-square distance, the integral of (p/q - 1)^2 q over the cosine.
    """
    from scipy.integrate import quad
    from scipy.special import ndtri

    def density(h: float, mu: float) -> float:
        return float((1 - h * h) / (2 * (1 + h * h - 2 * h * mu) ** 1.5))

    distance, _ = quad(lambda mu: (density(g, mu) / density(G, mu) - 1) ** 2 * density(G, mu), -1, 1)
    return int((ndtri(alpha) + ndtri(miss)) ** 2 / distance)


def _part_of_circle(turn: float) -> Mutant:
    return Mutant(f"phi < {2 * turn:g} pi", lambda u: _points(_squeezed(u, 1, 0, turn)))


def _flipped(u: np.ndarray) -> np.ndarray:
    return _points(u) * [1, 1, -1]


def _in_band(x: np.ndarray, middle: float) -> np.ndarray:
    return np.abs(x[:, 2] - middle) < 0.005


def _cumulative(mu: float) -> float:
    return (1 - G * G) / (2 * G) * (1 / np.sqrt(1 + G * G - 2 * G * mu) - 1 / (1 + G))


def _notch(middle: float) -> Mutant:
    left = 1 - (_cumulative(middle + 0.005) - _cumulative(middle - 0.005))
    return Mutant(
        f"pdf 0 in mu = {middle:.2f} +- .005", _points, lambda x: np.where(_in_band(x, middle), 0.0, HG.pdf(x) / left)
    )


def _skipped(u: np.ndarray) -> np.ndarray:
    first = _points(u[:, :2])
    return np.where(_in_band(first, -0.9)[:, None], _points(u[:, 2:]), first)


def _with_atom(u: np.ndarray) -> np.ndarray:
    return np.where(u[:, 2:] < 2e-4, np.array([0.6, 0.0, 0.8]), _points(u[:, :2]))


def _weight_zero(u: np.ndarray) -> Draw:
    return Draw(_points(u[:, :2]), weight=np.where(u[:, 2] < 0.01, 0.0, 1.0))


def _given_up(u: np.ndarray) -> Draw:
    return Draw(_points(u[:, :2]), valid=u[:, 2] >= 0.01)


def _mislabelled(u: np.ndarray) -> Draw:
    draw = PATH.sample(u[:, :1])
    assert draw.event is not None
    return draw._replace(event=np.where(u[:, 1] < 0.01, 0, draw.event))


def _fewer_surfaces(u: np.ndarray) -> np.ndarray:
    depth = -np.log1p(-u[:, 0] * (1 - SURFACE)) / SIGMA_T
    return np.where(u[:, 1] < 0.99 * SURFACE, PATH.surface, depth)


_PATH: dict[str, Any] = {"pdf": PATH.pdf, "domain": Interval(0.0, 0.5)}
MUTANTS = [
    Mutant("right: Henyey-Greenstein", HG.sample, wrong=False),
    Mutant("right: free path", PATH.sample, options={"dimensions": 1, "atoms": PATH.atoms}, wrong=False, **_PATH),
    _scaled(1.01),
    _scaled(0.99),
    _other_g(0.79),
    _other_g(0.795),
    _other_g(0.798),
    _other_g(0.79, 2 * neyman_pearson(0.79)),
    _other_g(0.798, 2 * neyman_pearson(0.798)),
    _part_of_circle(0.995),
    _part_of_circle(0.9995),
    Mutant("cos flipped in the sampler", _flipped),
    Mutant(
        "cos flipped in both, probe",
        _flipped,
        lambda x: HG.pdf(x * [1, 1, -1]),
        options={"dimensions": 2, "axis": (0.0, 0.0, 1.0), "mean_cosine": G},
    ),
    _notch(0.30),
    _notch(-0.90),
    Mutant("forward tail of .1 % dropped", lambda u: _points(_squeezed(u, 0, 0, 0.999))),
    Mutant("backward tail of .1 % dropped", lambda u: _points(_squeezed(u, 0, 0.001, 1))),
    Mutant("1 % of weight 0", _weight_zero, options={"dimensions": 3, "eval": HG.pdf}),
    Mutant("right: 1 % given up, pdf of the rest", _given_up, options={"dimensions": 3}, wrong=False),
    Mutant(
        "right: 1 % given up, pdf of all", _given_up, lambda x: 0.99 * HG.pdf(x), options={"dimensions": 3}, wrong=False
    ),
    Mutant("1 % given up, pdf x .98", _given_up, lambda x: 0.98 * HG.pdf(x), options={"dimensions": 3}),
    Mutant("atom of .02 %", _with_atom, options={"dimensions": 3}),
    Mutant("skipped mu = -.90 +- .005", _skipped, options={"dimensions": 4}),
    Mutant("1 % of surfaces mislabelled", _mislabelled, options={"dimensions": 2, "atoms": PATH.atoms}, **_PATH),
    Mutant("surface probability - 1 %", _fewer_surfaces, options={"dimensions": 2, "atoms": PATH.atoms}, **_PATH),
]


def rejections(mutant: Mutant, seeds: int, samples: int, alpha: float) -> dict[str, Any]:
    """Check one mutant with fresh seeds; return how often it was rejected, and by which findings."""
    outcomes: Counter[str] = Counter()
    found: Counter[str] = Counter()
    seconds = []
    for _ in range(seeds):
        verdict = mutant.check(samples, alpha, fresh_seed())
        outcomes[verdict.outcome] += 1
        found.update(f.check for f in verdict.findings if f.outcome == "rejected")
        seconds.append(verdict.seconds)
    return {
        "mutant": mutant.name,
        "wrong": mutant.wrong,
        "seeds": seeds,
        "rejected": outcomes["rejected"],
        "inconclusive": outcomes["inconclusive"],
        "by": dict(found.most_common(4)),
        "seconds": float(np.median(seconds)),
    }


def main() -> None:
    """Print the table and write it; exit 1 if an error was missed or a right sampler rejected."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--alpha", type=float, default=1e-6)
    parser.add_argument("--only", default="", help="mutants whose name contains this text")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/power.json"))
    arguments = parser.parse_args()
    rows = []
    for mutant in MUTANTS:
        if arguments.only in mutant.name:
            row = rejections(mutant, arguments.seeds, arguments.samples, arguments.alpha)
            rows.append(row)
            by = ", ".join(f"{name} {count}" for name, count in row["by"].items())
            print(f"{row['mutant']:32} {row['rejected']:3}/{row['seeds']}  {by}", flush=True)
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    arguments.output.write_text(
        json.dumps({"samples": arguments.samples, "alpha": arguments.alpha, "rows": rows}, indent=1)
    )
    wrong = [row for row in rows if row["rejected"] != (row["seeds"] if row["wrong"] else 0) or row["inconclusive"]]
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
