"""How often are right estimators rejected, and stated biases missed? Whole verdicts; a part of `make calibrate`.

    python tools/calibrate_estimators.py [--verdicts 2000]

Right estimators are judged whole at alpha = 1e-2, where false alarms can be counted: rare events, two values, extreme scales,
declared bounds, few realisations, pairs. Then each law is shifted by the bias that its own pass says it would have caught.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.checks import Verdict, check_estimator, compare_estimators, fresh_seed
from fogproof.contracts import Draws

ALPHA = 1e-2
BAND = 1e-3  # probability that a right estimator crosses its band, all together
Law = Callable[[np.random.Generator, int], Any]


def _rare_bright(rng: np.random.Generator, n: int) -> np.ndarray:
    return rng.normal(1, 0.1, n) + (rng.random(n) < 1e-4) * 100.0


def _hits(rng: np.random.Generator, n: int) -> np.ndarray:
    return (rng.random(n) < 0.02) * 1.0


def _rare_hits(rng: np.random.Generator, n: int) -> np.ndarray:
    return (rng.random(n) < 1e-4) * 1.0


def _thinned(rng: np.random.Generator, n: int) -> np.ndarray:
    return 1e-4 * rng.uniform(0.5, 1.5, n)


def _exponential(rng: np.random.Generator, n: int) -> np.ndarray:
    return rng.exponential(size=n)


def _beta(rng: np.random.Generator, n: int) -> np.ndarray:
    return rng.beta(0.05, 0.5, n)


def _reported(rng: np.random.Generator, n: int) -> Draws:
    x = rng.exponential(size=(n, 5))
    return Draws(x.mean(axis=1), stderr=x.std(axis=1, ddof=1) / np.sqrt(5))


RIGHT: dict[str, Callable[[int, dict[str, Any]], Verdict]] = {
    "normal": lambda n, o: check_estimator(lambda r, m: r.normal(3, 1, m), 3.0, samples=n, **o),
    "exponential": lambda n, o: check_estimator(_exponential, 1.0, samples=n, **o),
    "hits": lambda n, o: check_estimator(_hits, 0.02, samples=n, **o),
    "rare hits": lambda n, o: check_estimator(_rare_hits, 1e-4, samples=n, **o),
    "rare hits, bounds": lambda n, o: check_estimator(_rare_hits, 1e-4, bounds=(0, 1), samples=n, **o),
    "rare bright, exact variance": lambda n, o: check_estimator(
        _rare_bright, 1.01, variance=0.01 + 1e-4 * (1 - 1e-4) * 1e4, samples=n, **o
    ),
    "bounds": lambda n, o: check_estimator(_beta, 0.05 / 0.55, bounds=(0, 1), samples=n, **o),
    "a few, bounds": lambda n, o: check_estimator(_beta, 0.05 / 0.55, bounds=(0, 1), samples=20, **o),
    "a few, light tails": lambda n, o: check_estimator(_exponential, 1.0, tails="light", samples=20, **o),
    "not negative": lambda n, o: check_estimator(
        lambda r, m: r.lognormal(0, 2, m), float(np.exp(2)), nonnegative=True, samples=n, **o
    ),
    "1e-300": lambda n, o: check_estimator(lambda r, m: 1e-300 * r.exponential(size=m), 1e-300, samples=n, **o),
    "1e300": lambda n, o: check_estimator(lambda r, m: 1e300 * r.exponential(size=m), 1e300, samples=n, **o),
    "standard errors of five": lambda n, o: check_estimator(_reported, 1.0, samples=n, **o),
    "nine channels": lambda n, o: check_estimator(lambda r, m: r.exponential(size=(m, 9)), np.ones(9), samples=n, **o),
    "resolution": lambda n, o: check_estimator(_exponential, 1.0, resolution=0.2, samples=n, **o),
    "enough for calls to be compared": lambda n, o: check_estimator(_exponential, 1.0, samples=4 * n, **o),
    "such of two values": lambda n, o: check_estimator(lambda r, m: (r.random(m) < 0.3) * 1.0, 0.3, samples=4 * n, **o),
    "hits against a continuous law": lambda n, o: compare_estimators(_rare_hits, _thinned, samples=n, **o),
    "two of hits": lambda n, o: compare_estimators(_hits, _hits, samples=n, **o),
    "exponential against uniform": lambda n, o: compare_estimators(
        _exponential, lambda r, m: r.uniform(0, 2, m), samples=n, **o
    ),
}
"""Right estimators, judged with n realisations."""

SHIFTED: dict[str, tuple[Law, float, dict[str, Any]]] = {
    "normal": (lambda r, m: r.normal(3, 1, m), 3.0, {}),
    "exponential": (_exponential, 1.0, {}),
    "bounds, uniform": (lambda r, m: r.random(m), 0.5, {"bounds": (-1, 2)}),  # which hold for the shifted law too
    "exact variance, uniform": (lambda r, m: r.random(m), 0.5, {"variance": 1 / 12}),
    "a few, normal": (lambda r, m: r.normal(3, 1, m), 3.0, {"tails": "light", "samples": 30}),
}
"""Laws that can be shifted, with their means; hits are shifted by their probability."""


def false_alarms(name: str, verdicts: int, samples: int, seed: int) -> int:
    """Return how many of so many verdicts reject a right estimator at `ALPHA`."""
    judge = RIGHT[name]
    return sum(judge(samples, {"alpha": ALPHA, "seed": seed + i}).outcome == "rejected" for i in range(verdicts))


def allowed(verdicts: int) -> int:
    """Return how many rejections chance explains, all right estimators together."""
    from scipy.stats import binom

    return int(binom.isf(BAND / len(RIGHT), verdicts, ALPHA))


def caught(name: str, trials: int, samples: int, seed: int) -> int:
    """Return how often a bias is caught that a pass of the same law says it would have caught but for one time in a hundred."""
    if name == "hits":
        verdict = check_estimator(_hits, 0.02, samples=samples, seed=seed)
        bias = _stated(verdict)
        return sum(_shifted_hits(0.02 + bias, samples, seed + 1 + i).outcome == "rejected" for i in range(trials))
    law, mean, options = SHIFTED[name]
    options = {"samples": samples, **options}
    stated = [_stated(check_estimator(law, mean, seed=seed + i, **options)) for i in range(9)]
    bias = float(np.median(stated))
    found = 0
    for i in range(trials):
        sign = 1 if i % 2 else -1

        def shifted(rng: np.random.Generator, n: int, step: float = sign * bias) -> np.ndarray:
            return law(rng, n) + step

        found += check_estimator(shifted, mean, seed=seed + 100 + i, **options).outcome == "rejected"
    return found


def _stated(verdict: Verdict) -> float:
    finding = next(f for f in verdict.findings if f.check == "mean")
    assert finding.resolution is not None, str(verdict)
    return finding.resolution.value


def _shifted_hits(p: float, samples: int, seed: int) -> Verdict:
    return check_estimator(lambda r, m: (r.random(m) < p) * 1.0, 0.02, samples=samples, seed=seed)


def section(verdicts: int, samples: int, seed: int) -> tuple[str, bool]:
    """Return the part of the result page about estimators, and whether all is well."""
    most, good = allowed(verdicts), True
    lines = [
        f"## Whole verdicts on right estimators, alpha = {ALPHA:g}",
        "",
        f"Of {verdicts} verdicts of {samples} realisations at most {most} may reject: 99.9 % bands over all together; most shares",
        "of alpha go to tests that are upper bounds, so that counts lie well below.",
        "",
        "| estimator | rejected | at most |",
        "|---|--:|--:|",
    ]
    for name in RIGHT:
        count = false_alarms(name, verdicts, samples, seed)
        good &= count <= most
        lines.append(f"| {name} | {count} | {most} |")
        print(lines[-1], file=sys.stderr, flush=True)
    trials = min(verdicts, 1000)
    least = int(0.99 * trials - 4 * np.sqrt(trials * 0.0099))
    lines += ["", "## Stated biases, alpha = 1e-6", "", "| law | caught | of | at least |", "|---|--:|--:|--:|"]
    for name in [*SHIFTED, "hits"]:
        count = caught(name, trials, 20_000, seed)
        good &= count >= least
        lines.append(f"| {name} | {count} | {trials} | {least} |")
        print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines) + "\n", good


def main() -> None:
    """Print the section; exit 1 if a band is crossed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--verdicts", type=int, default=2000)
    parser.add_argument("--samples", type=int, default=4000)
    arguments = parser.parse_args()
    text, good = section(arguments.verdicts, arguments.samples, fresh_seed() >> 2)
    print(text)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
