"""The battery of relations on our own path tracer: each fault and the relations it breaks, and right runs without a false alarm.

python tools/relations.py [--samples 500000] [--runs 100] [--alpha 1e-3]
"""

from __future__ import annotations

import argparse
import sys

import fogproof
from fogproof.catalogue.relations.path_tracer import IN_A_BOX, IN_A_GRID, IN_A_SLAB, IN_COLOUR
from fogproof.catalogue.twins import renderers

FAULTS = {
    "density_ignores_the_transform": (IN_A_GRID, "moved"),
    "offset_by_coordinates": (IN_A_BOX, "moved"),
    "offset_in_metres": (IN_A_BOX, "scaled/0.001"),
    "pdf_of_the_first_channel": (IN_COLOUR, "channel-alone"),
    "majorant_of_the_first_channel": (IN_COLOUR, "channel-alone"),
    "light_counted_twice": (IN_A_BOX, "integrators/mis"),
    "attenuated_beyond_the_medium": (IN_A_BOX, "integrators/nee"),
    "majorant_exceeded": (IN_A_GRID, "majorant"),
    "boundaries_are_bounces": (IN_A_SLAB, "cut-slab"),
    "sum_of_channels": (IN_A_BOX, "equal-channels"),
    "clamped": (IN_A_SLAB, "linear-in-light"),
    "one_order_too_many": (IN_A_SLAB, "orders"),
    "a_cosine_too_many": (IN_A_SLAB, "reciprocity"),
    "border_of_half_a_voxel": (IN_A_BOX, "constant-grid/trilinear"),
    "flipped_near_the_horizon": (IN_A_BOX, "turned"),
}
"""Fault -> the setting in which it shows, and the relation that isolates it."""


def main() -> int:
    """Print both tables; 1 where a fault is missed or not isolated, or right runs are rejected more often than alpha."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=500_000)
    parser.add_argument("--runs", type=int, default=100, help="right runs, in four settings each")
    parser.add_argument("--alpha", type=float, default=1e-3, help="of each right run in each setting")
    options = parser.parse_args()
    missed = 0
    for name, (setting, relation) in FAULTS.items():
        results = fogproof.check_relations(getattr(renderers, name), setting, samples=options.samples)
        broken = [result.name for result in results if result.verdict.outcome == "rejected"]
        isolated = bool(broken) and all(found.startswith(relation) for found in broken)
        missed += not isolated
        print(f"{name:30} {'isolated' if isolated else 'MISSED':9} {', '.join(broken) or 'nothing broken'}", flush=True)
    alarms = held = 0
    for _ in range(options.runs):
        for setting in (IN_A_BOX, IN_COLOUR, IN_A_GRID, IN_A_SLAB):
            results = fogproof.check_relations(renderers.traced, setting, samples=2000, alpha=options.alpha)
            held += len(results)
            alarms += sum(result.verdict.outcome == "rejected" for result in results)
    print(f"{options.runs} right runs in 4 settings at alpha {options.alpha:g}: {held} comparisons, {alarms} rejected")
    expected = 4 * options.runs * options.alpha
    return 1 if missed or alarms > expected + 4 * expected**0.5 + 1 else 0


if __name__ == "__main__":
    sys.exit(main())
