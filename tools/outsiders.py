"""Every outsider of the catalogue, as it is and with each of three errors planted: one line each, and a summary.

    python tools/outsiders.py [--only TEXT] [--samples 1000000] [--twins] [--alpha 1e-6] [-o build/outsiders.json]

Right ones must never be rejected, and all but 2 % must be decided; wrong ones must be rejected.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

from fogproof.catalogue import all_cases
from fogproof.catalogue.outsiders.subjects import ERRORS, Outsider
from fogproof.checks import check_sampler, fresh_seed


def verdict_of(subject: Outsider, samples: int, alpha: float) -> dict[str, Any]:
    """Check one subject with a fresh seed."""
    started, seed = time.perf_counter(), fresh_seed()
    verdict = check_sampler(
        subject.sample,
        subject.pdf,
        subject.domain,
        dimensions=subject.dimensions,
        atoms=subject.atoms,
        samples=samples,
        alpha=alpha,
        seed=seed,
    )
    why = [f"{f.check}: {f.message}"[:160] for f in verdict.findings if f.outcome == verdict.outcome][:2]
    seconds = time.perf_counter() - started
    return {"outcome": verdict.outcome, "seed": seed, "seconds": seconds, "why": why, "cause": verdict.cause}


def main() -> None:
    """Print the table; exit 1 if a right outsider was rejected, too many were undecided, or an error was missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="")
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--alpha", type=float, default=1e-6)
    parser.add_argument("--twins", action="store_true")
    parser.add_argument("-o", "--output", type=Path)
    arguments = parser.parse_args()
    cases = [c for c in all_cases() if c.name.startswith("outsiders/") and arguments.only in c.name]
    rows = []
    for case in cases:
        subject = case.make()
        variants = {"right": subject}
        if arguments.twins:
            variants |= {name: broken(subject) for name, broken in ERRORS.items()}
        for variant, each in variants.items():
            row = {"case": case.name, "variant": variant, **verdict_of(each, arguments.samples, arguments.alpha)}
            rows.append(row)
            good = row["outcome"] == ("not rejected" if variant == "right" else "rejected")
            why = "" if good else "; ".join(row["why"])
            print(f"{case.name:42} {variant:32} {row['outcome']:13} {row['seconds']:6.2f} s  {why}", flush=True)
    count = Counter((row["variant"], row["outcome"]) for row in rows)
    for (variant, outcome), times in sorted(count.items()):
        print(f"{variant}: {outcome} {times}")
    if arguments.output:
        arguments.output.parent.mkdir(parents=True, exist_ok=True)
        arguments.output.write_text(json.dumps(rows, indent=1))
    right = sum(times for (variant, _), times in count.items() if variant == "right")
    wrong = len(rows) - right
    caught = sum(times for (variant, outcome), times in count.items() if variant != "right" and outcome == "rejected")
    bad = count["right", "rejected"] > 0 or count["right", "inconclusive"] > 0.02 * right or caught < wrong
    sys.exit(bad)


if __name__ == "__main__":
    main()
