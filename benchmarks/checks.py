"""How long does a verdict take, and how much memory, next to drawing the samples alone?

    python benchmarks/checks.py [--repeat 7] [--largest 1000000]

Times are processor times of the fastest of several runs, in milliseconds and as a ratio to drawing the same samples: they depend
little on what else the machine does. Memory is the peak that NumPy holds during the call.
"""

from __future__ import annotations

import argparse
import time
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.checks import check_estimator, check_sampler, fresh_seed
from fogproof.checks.preparing import prepare
from fogproof.checks.streams import batch_generator, batch_sizes
from fogproof.checks.subject import Subject
from fogproof.contracts import Reference
from fogproof.domains import HalfLine, Interval, UnitSphere
from fogproof.estimators import Directions, FreePath
from fogproof.scene import HenyeyGreenstein

TILTED = (2 / 7, -3 / 7, 6 / 7)


def _subjects() -> dict[str, tuple[Any, Any, Any, dict[str, Any]]]:
    hg, tilted = Directions(HenyeyGreenstein(0.8)), Directions(HenyeyGreenstein(0.95), TILTED)
    path = FreePath(1.4, 0.5)
    return {
        "Henyey-Greenstein, g = 0.8": (hg.sample, hg.pdf, UnitSphere(), {"dimensions": 2}),
        "g = 0.95, tilted axis": (tilted.sample, tilted.pdf, UnitSphere(), {"dimensions": 2}),
        "free path with a surface": (path.sample, path.pdf, Interval(0, 0.5), {"dimensions": 1, "atoms": path.atoms}),
        "exponential": (lambda u: -np.log1p(-u[:, 0]), lambda x: np.exp(-x), HalfLine(0), {"dimensions": 1}),
    }


def fastest(run: Callable[[], Any], repeat: int) -> float:
    """Return the seconds of the fastest of some runs."""
    best = np.inf
    for _ in range(repeat):
        started = time.process_time()
        run()
        best = min(best, time.process_time() - started)
    return best


def peak(run: Callable[[], Any]) -> float:
    """Return the peak memory of a run in MB."""
    tracemalloc.start()
    run()
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return most / 1e6


def draw_all(sample: Any, dimensions: int, samples: int) -> None:
    """Draw as the check does, and do nothing with it."""
    for index, n in enumerate(batch_sizes(samples)):
        sample(batch_generator(1, "samples", 1, index).random((n, dimensions)))


def _misfits() -> dict[str, Subject]:
    """Densities whose integral is wrong by 1e-6 or a little more, to be found without a single tested sample."""
    hg, tilted, path = Directions(HenyeyGreenstein(0.8)), Directions(HenyeyGreenstein(0.99), TILTED), FreePath(1.4, 0.5)

    def notched(depth: float) -> Callable[[np.ndarray], np.ndarray]:
        return lambda x: np.where(np.abs(x - 0.637) < 5e-5, depth, 1.0)

    def first(u: np.ndarray) -> np.ndarray:
        return u[:, 0]

    return {
        "Henyey-Greenstein, x (1 + 1e-6)": Subject(hg.sample, lambda x: hg.pdf(x) * (1 + 1e-6), UnitSphere(), 2),
        "g = 0.99, tilted, x (1 - 1e-6)": Subject(tilted.sample, lambda x: tilted.pdf(x) * (1 - 1e-6), UnitSphere(), 2),
        "free path, x (1 + 2e-6)": Subject(
            path.sample, lambda x: path.pdf(x) * (1 + 2e-6), Interval(0, 0.5), 1, path.atoms
        ),
        "a hole of width 1e-4": Subject(first, notched(0.0), Interval(0, 1), 1),
        "a dent of width 1e-4, 1 % deep": Subject(first, notched(0.99), Interval(0, 1), 1),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=7)
    parser.add_argument("--largest", type=int, default=1_000_000)
    arguments = parser.parse_args()
    print(f"{'subject':28} {'samples':>9} {'drawing':>9} {'verdict':>9} {'less drawing':>13} {'ratio':>6} {'MB':>6}")
    for name, (sample, pdf, domain, options) in _subjects().items():
        samples = 100_000
        while samples <= arguments.largest:
            repeat = max(1, min(arguments.repeat, 10_000_000 // samples))

            def verdict(n: int = samples, s: Any = sample, p: Any = pdf, d: Any = domain, o: Any = options) -> Any:
                return check_sampler(s, p, d, samples=n, seed=1, **o)

            def drawing(n: int = samples, s: Any = sample, o: Any = options) -> None:
                draw_all(s, o["dimensions"], n)

            drawn, taken, memory = fastest(drawing, repeat), fastest(verdict, repeat), peak(verdict)
            print(
                f"{name:28} {samples:9} {drawn * 1e3:9.1f} {taken * 1e3:9.1f} {(taken - drawn) * 1e3:13.1f}"
                f" {taken / drawn:6.2f} {memory:6.1f}",
                flush=True,
            )
            samples *= 10
    reference = Reference(np.asarray(1.0), np.asarray(0.0), "", "")
    for samples in (100_000, 1_000_000):

        def estimate(n: int = samples) -> Any:
            return check_estimator(lambda rng, m: rng.exponential(size=m), reference, samples=n, seed=1)

        taken, memory = fastest(estimate, arguments.repeat), peak(estimate)
        print(f"{'estimator, exponential':28} {samples:9} {'':9} {taken * 1e3:9.1f} {'':13} {'':6} {memory:6.1f}")
    print(f"\n{'normalisation':34} {'ms':>6}  found")
    for name, subject in _misfits().items():
        finding = prepare(subject, 1_000_000, fresh_seed()).normalisation(0)
        taken = fastest(lambda subject=subject: prepare(subject, 1_000_000, fresh_seed()), arguments.repeat)
        print(f"{name:34} {taken * 1e3:6.1f}  {finding.outcome}: {finding.message}")


if __name__ == "__main__":
    main()
