"""Does the catalogue ever raise a false alarm? Whole runs of it, each with a fresh seed.

    python tools/repeat_verify.py [CASE ...] [--runs 20] [--workers 2]

Prints every result that is not as expected with the command that repeats it, and the run time of each. Exit 1 if there is one.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections import Counter

from fogproof.checks import fresh_seed
from fogproof.verify import run, select

ALPHA = 1e-6


def main() -> None:
    """Run, count, and tell."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE")
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    cases = select(arguments.cases)
    statuses: Counter[str] = Counter()
    seconds = []
    unexpected = 0
    for i in range(arguments.runs):
        seed = fresh_seed()
        started = time.perf_counter()
        for result in run(cases, seed=seed, alpha=ALPHA, workers=arguments.workers):
            statuses[result.status] += 1
            if not result.good:
                unexpected += 1
                print(f"{result.status}: fogproof verify '{result.case.name}' --seed {seed}")
                print(f"  {result.reason or result.verdict}", flush=True)
        seconds.append(time.perf_counter() - started)
        print(f"run {i + 1}: seed {seed}, {seconds[-1]:.0f} s", file=sys.stderr, flush=True)
    counts = ", ".join(f"{count} {status}" for status, count in statuses.items())
    print(f"{arguments.runs} runs of {len(cases)} cases: {counts}; median run {statistics.median(seconds):.0f} s")
    sys.exit(1 if unexpected else 0)


if __name__ == "__main__":
    main()
