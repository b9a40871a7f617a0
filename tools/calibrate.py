"""How often do the checks reject what is right? Many small verdicts, and whole runs of the catalogue, with fresh seeds.

    python tools/calibrate.py [--runs 20] [--verdicts 10000] [-o build/calibration.json]

p-values of exact tests must be uniform; those that are bounds must be uniform or larger.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fogproof import verify
from fogproof.catalogue import all_cases
from fogproof.checks import Verdict, check_estimator, check_sampler, fresh_seed
from fogproof.contracts import Reference
from fogproof.domains import Discrete, HalfLine, Interval, UnitSphere, UnitSquare
from fogproof.estimators import Directions, FreePath
from fogproof.scene import HenyeyGreenstein, Rayleigh


@dataclass
class PValues:
    """p-values by what they promise, and what was rejected.

    The tests of one verdict look at the same samples, so only one p-value of each sort is taken from it, each test in turn:
    those of different verdicts are independent.
    """

    exact: list[float] = field(default_factory=list)
    bounds: list[float] = field(default_factory=list)
    verdicts: int = 0
    rejected: int = 0
    inconclusive: int = 0
    examples: list[str] = field(default_factory=list)

    def add(self, verdict: Verdict) -> None:
        """Take in one verdict about something that is right."""
        for exact, values in ((True, self.exact), (False, self.bounds)):
            found = [f.p_value for f in verdict.findings if f.p_value is not None and f.exact == exact]
            if found:
                values.append(found[self.verdicts % len(found)])
        self.verdicts += 1
        self.rejected += verdict.outcome == "rejected"
        self.inconclusive += verdict.outcome == "inconclusive"
        if verdict.outcome != "not rejected":
            self.examples.append(str(verdict))


def _subjects() -> list[tuple]:
    """Right samplers on several domains: (sample, pdf, domain, options)."""
    hg, rayleigh, path = Directions(HenyeyGreenstein(0.7)), Directions(Rayleigh()), FreePath(1.4, 0.5)
    return [
        (hg.sample, hg.pdf, hg.domain, {"dimensions": 2}),
        (rayleigh.sample, rayleigh.pdf, UnitSphere(), {"dimensions": 2}),
        (path.sample, path.pdf, path.domain, {"dimensions": 1, "atoms": path.atoms}),
        (lambda u: -np.log1p(-u[:, 0]), lambda x: np.exp(-x), HalfLine(0), {"dimensions": 1}),
        (lambda u: u[:, 0], lambda x: np.ones(len(x)), Interval(0, 1), {"dimensions": 1, "cdf": lambda x: x}),
        (lambda u: u, lambda x: np.ones(len(x)), UnitSquare(), {"dimensions": 2, "cdf": lambda x: x}),
        (lambda u: np.floor(40 * u[:, 0]), lambda x: np.full(len(x), 1 / 40), Discrete(40), {"dimensions": 1}),
    ]


def small_verdicts(count: int, samples: int, seed: int, alpha: float = 1e-12) -> PValues:
    """Check right samplers and estimators `count` times in all."""
    subjects = _subjects()
    found = PValues()
    for i in range(count):
        case_seed = verify.case_seed(seed, f"calibration {i}")
        which = i % (len(subjects) + 1)
        if which == len(subjects):
            one = Reference(np.asarray(0.5), np.asarray(0.0), "", "")
            found.add(check_estimator(lambda rng, n: rng.random(n), one, samples=samples, alpha=alpha, seed=case_seed))
        else:
            sample, pdf, domain, options = subjects[which]
            found.add(check_sampler(sample, pdf, domain, samples=samples, alpha=alpha, seed=case_seed, **options))
    return found


def catalogue_runs(runs: int, alpha: float) -> tuple[PValues, dict[str, int]]:
    """Run the whole catalogue `runs` times; return its p-values and how often each status came up."""
    found, statuses = PValues(), {}
    for _ in range(runs):
        seed = fresh_seed()
        for result in verify.run(list(all_cases()), seed=seed, alpha=alpha, workers=2):
            statuses[result.status] = statuses.get(result.status, 0) + 1
            if result.verdict is not None:
                found.add(result.verdict)
    return found, statuses


def uniformity(p_values: Iterable[float]) -> float:
    """Return the p-value of Kolmogorov's test that the values are uniform on [0, 1]."""
    from scipy.special import kolmogorov

    p = np.sort(np.asarray(list(p_values)))
    n = len(p)
    distance = max(np.max(np.arange(1, n + 1) / n - p), np.max(p - np.arange(n) / n))
    return float(kolmogorov(np.sqrt(n) * distance))


def too_small(p_values: Iterable[float], level: float, alpha: float) -> bool:
    """Return whether more values lie at or below `level` than chance explains, with false-alarm probability alpha."""
    from scipy.special import bdtrc

    p = np.asarray(list(p_values))
    hits = int(np.count_nonzero(p <= level))
    return hits > 0 and bool(bdtrc(hits - 1, len(p), level) < alpha)


def main() -> None:
    """Print and write the calibration; exit 1 if a right sampler was rejected or p-values are not what they promise."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=20, help="full runs of the catalogue")
    parser.add_argument("--verdicts", type=int, default=10_000, help="small verdicts")
    parser.add_argument("--samples", type=int, default=4000, help="samples of a small verdict")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/calibration.json"))
    arguments = parser.parse_args()
    seed = fresh_seed()
    small = small_verdicts(arguments.verdicts, arguments.samples, seed)
    runs, statuses = catalogue_runs(arguments.runs, 1e-6)
    report = {"seed": seed, "samples": arguments.samples, "statuses": statuses}
    for name, found in (("small verdicts", small), ("catalogue", runs)):
        everything = [*found.exact, *found.bounds]
        report[name] = {
            "exact p-values": len(found.exact),
            "p-value of their uniformity": uniformity(found.exact),
            "bounds": len(found.bounds),
            "rejected": found.rejected,
            "inconclusive": found.inconclusive,
            "share at or below": {
                str(level): float(np.mean(np.array(everything) <= level)) for level in (1e-4, 1e-3, 1e-2, 0.1)
            },
            "examples": found.examples[:5],
        }
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    arguments.output.write_text(json.dumps(report, indent=1) + "\n")
    print(json.dumps(report, indent=1))
    bad = small.rejected or set(statuses) - {"passed", "known", "skipped"}
    bad = bad or any(uniformity(found.exact) < 1e-6 for found in (small, runs))
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
