"""Families with an error in a corner of their parameters: in how many searches is it found, and shrunk to a simple parameter?

    python tools/families.py [--seeds 10] [--right-seeds 100] [NAME …]

Each broken family is searched with several fresh seeds; the parameter that comes out must be wrong and as simple as stated. Each
has a right family beside it, the same without the error, which must never be rejected. Searches are written down as they end: who
starts again goes on.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fogproof
from fogproof.checks import fresh_seed
from fogproof.zoo.families import families


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
    names = [name for name in families() if not given.names or any(part in name for part in given.names)]
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
    family, seed, started = families()[name], fresh_seed(), time.perf_counter()
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
    found: list[Any] = []

    def remembered(parameter: Any) -> Any:
        found.append(parameter)
        return make(parameter)

    verdict = fogproof.check_family(remembered, strategy, samples=samples, seed=seed)
    if verdict.outcome != "rejected":
        return None, verdict.samples
    return next(p for p in found if repr(p) == verdict.settings["parameter"]), verdict.samples


if __name__ == "__main__":
    sys.exit(main())
