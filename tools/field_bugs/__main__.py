"""Which bugs that shipped does `check_sampler` reject, and is the cause named rightly?

    python tools/field_bugs [--samples 300000] [--only TEXT] [--seed N]

One line a bug: rejected or not, the cause that was named, and the sentence that explains it. Exit 1 if one is missed, or if fewer
than 85 % of the causes are right.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from field_bugs import BUGS
from fogproof.checks import fresh_seed


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=300_000)
    parser.add_argument("--only", default="", help="bugs whose name contains this text")
    parser.add_argument("--seed", type=int, default=None)
    arguments = parser.parse_args()
    rejected = named = 0
    bugs = [bug for bug in BUGS if arguments.only in bug.name]
    for bug in bugs:  # a bug that cannot be judged is a miss
        verdict = bug.check(arguments.samples, fresh_seed() if arguments.seed is None else arguments.seed)
        right = verdict.outcome == "rejected" and verdict.cause in bug.causes
        rejected += verdict.outcome == "rejected"
        named += right
        mark = "" if right else f"   (right: {' or '.join(bug.causes)})"
        print(
            f"{'yes' if right else 'NO ':4} {verdict.outcome:12} {verdict.seconds:5.2f} s  {bug.name}: {verdict.cause}{mark}",
            flush=True,
        )
        if verdict.diagnosis:
            print(f"{'':26}{verdict.diagnosis}", flush=True)
    print(f"{rejected} of {len(bugs)} rejected, the cause of {named} named rightly ({named / max(len(bugs), 1):.0%})")
    sys.exit(0 if rejected == len(bugs) and named >= 0.85 * len(bugs) else 1)


if __name__ == "__main__":
    main()
