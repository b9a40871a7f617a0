"""How often do the checks reject what is right? p-values of every kind of check under the null, and whole verdicts.

    python tools/calibrate.py [--verdicts 100000] [--seeds 1000 100 3] [--workers 2] [--page docs/calibration.md]

Of each kind of check, at least `--verdicts` p-values of right subjects are counted at or below 1e-3. No kind may exceed the upper
end of its 99.9 % band, taken over all kinds together; exact kinds may not fall below the lower end either. Then right samplers are
checked whole at alpha = 1e-6, with `--seeds` seeds at 10^5, 10^6 and 10^8 samples: none may be rejected or inconclusive.
"""

from __future__ import annotations

import argparse
import platform
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import calibrate_estimators
import numpy as np
import planted

from fogproof.checks import (
    Finding,
    SamplerCheck,
    Subject,
    check_estimator,
    check_sampler,
    compare_estimators,
    fresh_seed,
)
from fogproof.checks.prepared import Prepared
from fogproof.contracts import Draw, Draws, Reference
from fogproof.domains import Discrete, HalfLine, Interval, Product, RealLine, UnitSphere, UnitSquare
from fogproof.estimators import Directions, FreePath
from fogproof.scene import HenyeyGreenstein, Rayleigh
from fogproof.verify import select

LEVEL = 1e-3
BAND = 1e-3  # probability outside the band, all kinds together
TILTED = (2 / 7, -3 / 7, 6 / 7)
POLE = (0.0, 0.0, 1.0)


def _directions(phase: Any, axis: tuple[float, float, float] = POLE) -> Subject:
    sampler = Directions(phase, axis)
    return Subject(sampler.sample, sampler.pdf, sampler.domain, 2)


def _path() -> Subject:
    path = FreePath(1.4, 0.5)
    return Subject(path.sample, path.pdf, path.domain, 1, path.atoms)


def _two_peaks() -> Subject:
    """Half the samples in each of two normal peaks of width 1e-4."""
    from scipy.special import ndtri

    def sample(u: np.ndarray) -> np.ndarray:
        left = u[:, 0] < 0.5
        v = 2 * np.where(left, u[:, 0], u[:, 0] - 0.5)
        return np.where(left, 0.2, 0.7) + 1e-4 * ndtri(np.clip(v, 1e-16, 1 - 1e-16))

    def pdf(x: np.ndarray) -> np.ndarray:
        bells = (np.exp(-0.5 * ((x - centre) / 1e-4) ** 2) for centre in (0.2, 0.7))
        return sum(bells) * 0.5 / (1e-4 * np.sqrt(2 * np.pi))

    return Subject(sample, pdf, Interval(0, 1), 1)


def _weighted() -> Subject:
    def sample(u: np.ndarray) -> Draw:
        return Draw(u[:, 0], weight=2 * u[:, 0] * 0.6)

    return Subject(sample, lambda x: np.ones(len(x)), Interval(0, 1), 1, albedo=0.6)


def _single() -> Subject:
    sampler = Directions(HenyeyGreenstein(0.5))
    return Subject(sampler.sample, sampler.pdf, sampler.domain, 2, precision="float32")


def _normal(u: np.ndarray) -> np.ndarray:
    from scipy.special import ndtri

    return ndtri(np.clip(u[:, 0], 1e-300, None))


def _outsider(name: str) -> Subject:
    (case,) = select([f"outsiders/{name}"])
    found = case.make()
    return Subject(found.sample, found.pdf, found.domain, found.dimensions, found.atoms)


def _given_up() -> Subject:
    """A cone of which a tenth is given up: labels under both conventions."""
    found = select(["outsiders/lights/cone/8/0"])[0].make()
    return Subject(lambda u: Draw(found.sample(u[:, :2]), valid=u[:, 2] < 0.9), found.pdf, found.domain, 3)


SUBJECTS: dict[str, Callable[[], Subject]] = {
    "Henyey-Greenstein, g = 0.7": lambda: _directions(HenyeyGreenstein(0.7)),
    "Henyey-Greenstein, g = 0.95": lambda: _directions(HenyeyGreenstein(0.95)),
    "Rayleigh, tilted axis": lambda: _directions(Rayleigh(), TILTED),
    "unit square by its Rosenblatt map": lambda: Subject(
        lambda u: np.sqrt(u), lambda x: 4 * x[:, 0] * x[:, 1], UnitSquare(), 2, cdf=lambda x: x * x
    ),
    "free path with a surface": _path,
    "exponential": lambda: Subject(lambda u: -np.log1p(-u[:, 0]), lambda x: np.exp(-x), HalfLine(0), 1),
    "normal": lambda: Subject(_normal, lambda x: np.exp(-0.5 * x * x) / np.sqrt(2 * np.pi), RealLine(), 1),
    "two peaks of width 1e-4": _two_peaks,
    "weights": _weighted,
    "single precision": _single,
    "the sun's disk": lambda: _outsider("lights/cone/0.2665/0"),
    "environment map": lambda: _outsider("maps/sphere/64x128"),
    "Poisson": lambda: _outsider("laws/poisson/17.3"),
    "Pareto, index 0.3": lambda: _outsider("laws/pareto/0.3"),
    "table of 1000 weights": lambda: _outsider("maps/table/1000"),
    "a cone, a tenth given up": lambda: Subject(
        *(lambda s: (s.sample, lambda x: 0.9 * s.pdf(x), s.domain, s.dimensions))(_given_up())
    ),
    "distance and direction": lambda: Subject(
        lambda u: np.column_stack([-np.log1p(-u[:, 0]), Directions(Rayleigh()).sample(u[:, 1:]).x]),
        lambda x: np.exp(-x[:, 0]) * Directions(Rayleigh()).pdf(x[:, 1:]),
        Product(HalfLine(0), UnitSphere()),
        3,
    ),
    "Student, 0.3 degrees": lambda: _outsider("laws/t/0.3"),
    "beta, both ends singular": lambda: _outsider("laws/beta/0.1-0.1"),
    "two values, one rare": lambda: Subject(
        lambda u: (u[:, 0] < 1e-3) * 1.0, lambda x: np.where(x == 1, 1e-3, 0.999), Discrete(2), 1
    ),
    "uniforms of its own": lambda: Subject(
        lambda rng, n: rng.random((n, 2)), lambda x: np.ones(len(x)), UnitSquare(), None
    ),
    "die of forty": lambda: Subject(
        lambda u: np.floor(40 * u[:, 0]), lambda x: np.full(len(x), 1 / 40), Discrete(40), 1
    ),
}

SHARES = {
    "free path with a surface": 1.0,
    "weights": 1.0,
    "Rayleigh, tilted axis": 0.1,
    "exponential": 0.1,
    "normal": 0.1,
}
"""Of the wanted number of verdicts, a subject gets this share, or a third: the kinds of check that few subjects need get enough."""

RIGHT = {
    **{
        f"Henyey-Greenstein, g = {g:g}": (lambda g=g: _directions(HenyeyGreenstein(g)))
        for g in (0.0, 0.3, -0.5, 0.8, 0.9, -0.95, 0.99, 0.999, -0.999)
    },
    "Henyey-Greenstein, g = 0.99, tilted axis": lambda: _directions(HenyeyGreenstein(0.99), TILTED),
    "free path with a surface": _path,
    "two peaks of width 1e-4": _two_peaks,
}


def _reported(rng: np.random.Generator, n: int) -> Draws:
    x = rng.normal(size=(n, 20)) + 1
    return Draws(x.mean(axis=1), cost=rng.poisson(3, n), stderr=x.std(axis=1, ddof=1) / np.sqrt(20))


def _one(value: float) -> Reference:
    return Reference(np.asarray(value), np.asarray(0.0), "", "")


def estimator_findings(samples: int, seed: int) -> Iterator[Finding]:
    """Yield what is found of right estimators: smooth, skewed, of two values, with standard errors, and in pairs."""

    def hits(rng: np.random.Generator, n: int) -> np.ndarray:
        return (rng.random(n) < 0.02) * 1.0

    def exponential(rng: np.random.Generator, n: int) -> np.ndarray:
        return rng.exponential(size=n)

    def rare(rng: np.random.Generator, n: int) -> np.ndarray:
        return (rng.random(n) < 1e-3) * rng.uniform(500, 1500, n)

    options: dict[str, Any] = {"samples": samples, "alpha": LEVEL, "seed": seed}
    yield from check_estimator(exponential, _one(1.0), variance=1.0, **options).findings
    yield from check_estimator(hits, _one(0.02), **options).findings
    yield from check_estimator(_reported, _one(1.0), cost=3.0, **options).findings
    for finding in check_estimator(rare, _one(1.0), variance=1e3 * (1 + 1 / 12) - 1, **options).findings:
        if finding.check == "mean":
            yield Finding("mean, no normal law", finding.outcome, finding.message, finding.p_value, finding.alpha)
    yield from compare_estimators(exponential, lambda rng, n: rng.uniform(0, 2, n), **options).findings


@dataclass
class Tally:
    """p-values at or below the level, by kind of check: how many there were, how many small, and whether they are exact."""

    counted: Counter[str] = field(default_factory=Counter)
    small: Counter[str] = field(default_factory=Counter)
    exact: dict[str, bool] = field(default_factory=dict)
    values: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))

    def add(self, findings: Iterable[Finding]) -> None:
        """Take in the findings of one verdict about something that is right."""
        for finding in findings:
            if finding.p_value is not None:
                kind = kind_of(finding)
                self.counted[kind] += 1
                self.small[kind] += finding.p_value <= LEVEL
                self.exact[kind] = self.exact.get(kind, True) and finding.exact
                if finding.exact and len(self.values[kind]) < 20_000:
                    self.values[kind].append(finding.p_value)

    def merged(self, other: Tally) -> Tally:
        """Return both together."""
        values = {
            kind: self.values.get(kind, []) + other.values.get(kind, []) for kind in {**self.values, **other.values}
        }
        exact = {
            kind: self.exact.get(kind, True) and other.exact.get(kind, True) for kind in {**self.exact, **other.exact}
        }
        return Tally(self.counted + other.counted, self.small + other.small, exact, defaultdict(list, values))


def kind_of(finding: Finding) -> str:
    """Return the kind of check, without the name of an axis or a channel."""
    name = re.sub(r"labels in \d+ cells", "labels in cells", finding.check)
    return re.sub(r" (of|in) (mu|phi|r|r\^2|x|y|z|x: .*|from .*|cdf of .*|the order of p\(x\)|channel \d+)$", "", name)


def _reseeded(prepared: Prepared, seed: int) -> Prepared:
    """Return the same cells with other points of the known law to mix samples with."""
    mixture = prepared.counter.mixture
    if mixture is None:
        return prepared
    return replace(prepared, counter=replace(prepared.counter, mixture=replace(mixture, seed=seed)))


def sampler_tally(name: str, verdicts: int, samples: int, seed: int) -> Tally:
    """Judge a right sampler many times, all on the cells of one pilot."""
    check = SamplerCheck.of(SUBJECTS[name](), None, samples, LEVEL, seed)
    tally = Tally()
    for i in range(verdicts):
        again = SamplerCheck(_reseeded(check.prepared, seed + 1 + i), check.looks, LEVEL, seed + 1 + i, check.started)
        tally.add(again.run().findings)
    return tally


def estimator_tally(verdicts: int, samples: int, seed: int) -> Tally:
    """Judge right estimators many times."""
    tally = Tally()
    for i in range(verdicts):
        tally.add(estimator_findings(samples, seed + i))
    return tally


def bands(tally: Tally) -> dict[str, tuple[int, int]]:
    """Return for each kind how few and how many small p-values there may be: 99.9 % bands over all kinds together."""
    from scipy.stats import binom

    tail = 0.5 * BAND / max(len(tally.counted), 1)
    return {kind: (int(binom.ppf(tail, n, LEVEL)), int(binom.isf(tail, n, LEVEL))) for kind, n in tally.counted.items()}


def outside(tally: Tally) -> list[str]:
    """Return the kinds whose small p-values are too many, or too few where they are exact."""
    found = []
    for kind, (low, high) in bands(tally).items():
        if tally.small[kind] > high or (tally.exact[kind] and tally.small[kind] < low):
            found.append(kind)
    return found


def uniformity(p_values: Iterable[float]) -> float:
    """Return the p-value of Kolmogorov's test that the values are uniform on [0, 1]."""
    from scipy.special import kolmogorov

    p = np.sort(np.asarray(list(p_values)))
    n = len(p)
    distance = max(np.max(np.arange(1, n + 1) / n - p), np.max(p - np.arange(n) / n))
    return float(kolmogorov(np.sqrt(n) * distance))


def whole_verdicts(name: str, seeds: int, samples: int, seed: int) -> Counter[str]:
    """Check a right sampler with many seeds at the usual alpha; return how often each outcome came up."""
    subject = RIGHT[name]()
    outcomes: Counter[str] = Counter()
    for i in range(seeds):
        verdict = check_sampler(
            subject.sample,
            subject.pdf,
            subject.domain,
            dimensions=subject.dimensions,
            atoms=subject.atoms,
            samples=samples,
            seed=seed + i,
        )
        outcomes[verdict.outcome] += 1
        if verdict.outcome != "not rejected":
            print(f"{name}: {verdict}", file=sys.stderr, flush=True)
    return outcomes


_PART = 1000  # verdicts of one task


def p_values(verdicts: int, samples: int, seed: int, pool: ProcessPoolExecutor) -> Tally:
    """Collect p-values, at least `verdicts` of every kind of check."""
    streams = np.random.SeedSequence(seed)
    jobs = [pool.submit(estimator_tally, size, samples, _seed(streams)) for size in _parts(verdicts)]
    for name in SUBJECTS:
        wanted = int(np.ceil(SHARES.get(name, 0.34) * verdicts))
        jobs += [pool.submit(sampler_tally, name, size, samples, _seed(streams)) for size in _parts(wanted)]
    total = Tally()
    for done, job in enumerate(jobs):
        total = total.merged(job.result())
        print(f"\r{done + 1}/{len(jobs)}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return total


def _parts(verdicts: int) -> list[int]:
    return [_PART] * (verdicts // _PART) + [verdicts % _PART] * (verdicts % _PART > 0)


def _seed(streams: np.random.SeedSequence) -> int:
    return int(streams.spawn(1)[0].generate_state(1, np.uint64)[0] >> np.uint64(2))


def page(tally: Tally, wholes: dict[tuple[str, int], Counter[str]], settings: str) -> str:
    """Return the result page."""
    lines = [
        "# Calibration",
        "",
        "How often the checks reject what is right, as measured by `make calibrate`.",
        "",
        settings,
        "",
        f"## p-values at or below {LEVEL:g}",
        "",
        "The band holds the count of a uniform p-value with probability 99.9 % over all kinds together. Exact p-values are",
        "uniform; the others are upper bounds, whose counts may be smaller. `uniform` is the p-value of Kolmogorov's test of it.",
        "",
        "| kind of check | p-values | small | band | sort | uniform |",
        "|---|--:|--:|---|---|--:|",
    ]
    for kind, (low, high) in sorted(bands(tally).items()):
        sort = "exact" if tally.exact[kind] else "bound"
        uniform = f"{uniformity(tally.values[kind]):.2g}" if tally.exact[kind] and tally.values[kind] else ""
        band = f"{low} to {high}" if tally.exact[kind] else f"up to {high}"
        lines.append(f"| {kind} | {tally.counted[kind]} | {tally.small[kind]} | {band} | {sort} | {uniform} |")
    lines += [
        "",
        f"Outside their bands: {', '.join(outside(tally)) or 'none'}.",
        "",
        "## Whole verdicts on right samplers, alpha = 1e-6",
        "",
        "| sampler | samples | seeds | rejected | inconclusive |",
        "|---|--:|--:|--:|--:|",
    ]
    for (name, samples), outcomes in wholes.items():
        row = (name, f"{samples:.0e}", sum(outcomes.values()), outcomes["rejected"], outcomes["inconclusive"])
        lines.append("| " + " | ".join(map(str, row)) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the page; exit 1 if a kind of check is outside its band or a right sampler did not pass."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--verdicts", type=int, default=100_000, help="p-values of each kind")
    parser.add_argument("--samples", type=int, default=4000, help="of one of these verdicts")
    parser.add_argument("--seeds", type=int, nargs=3, default=(1000, 100, 3), help="at 10^5, 10^6 and 10^8 samples")
    parser.add_argument("--trials", type=int, default=1000, help="errors planted of each kind")
    parser.add_argument("--estimators", type=int, default=2000, help="whole verdicts on each estimator")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--page", type=Path, default=Path("docs/calibration.md"))
    arguments = parser.parse_args()
    seed = fresh_seed()
    streams = np.random.SeedSequence(seed).spawn(1)[0]
    with ProcessPoolExecutor(arguments.workers) as pool:
        tally = p_values(arguments.verdicts, arguments.samples, seed, pool)
        jobs = {
            (name, samples): pool.submit(whole_verdicts, name, seeds, samples, _seed(streams))
            for samples, seeds in zip((10**5, 10**6, 10**8), arguments.seeds, strict=True)
            for name in RIGHT
            if seeds
        }
        wholes = {key: job.result() for key, job in jobs.items()}
    settings = (
        f"Verdicts of {arguments.samples} samples on {len(SUBJECTS)} samplers and five estimators; seed {seed};"
        f" NumPy {np.__version__}, Python {platform.python_version()}."
    )
    resolutions, true = planted.section(arguments.trials, 30_000, _seed(streams))
    estimators, kept = calibrate_estimators.section(arguments.estimators, arguments.samples, _seed(streams))
    text = f"{page(tally, wholes, settings)}\n{resolutions}\n{estimators}"
    arguments.page.parent.mkdir(parents=True, exist_ok=True)
    arguments.page.write_text(text)
    print(text)
    failed = [key for key, outcomes in wholes.items() if set(outcomes) - {"not rejected"}]
    sys.exit(1 if failed or outside(tally) or not (kept and true) else 0)


if __name__ == "__main__":
    main()
