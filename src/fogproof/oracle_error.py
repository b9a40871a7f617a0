"""The oracle's own error against the truth: its answers beside the golden tables, which are proven by ball arithmetic."""

from __future__ import annotations

import json
from dataclasses import dataclass
from fractions import Fraction

from fogproof.analytic.proven.golden import Golden, golden_values
from fogproof.contracts import Reference
from fogproof.quantities import quantities
from fogproof.scene.files import read_fields


@dataclass(frozen=True)
class OracleError:
    """How far one quantity of the oracle is from the truth on the hard cases of the golden tables.

    values    how many of its values were compared
    relative  the largest |value - truth| / |truth|
    share     the largest |value - truth| / error: the promise is <= 1
    broken    how many values break the promise
    hardest   the question with the largest share, as JSON would put it
    """

    quantity: str
    values: int
    relative: float
    share: float
    broken: int
    hardest: str


def oracle_errors() -> tuple[OracleError, ...]:
    """Compare every golden value with the oracle's answer, one row a quantity."""
    by_quantity: dict[str, list[tuple[float, float, str]]] = {}
    for golden in golden_values():
        question = {key: value for key, value in golden.request.items() if key != "quantity"}
        quantity = golden.request["quantity"]
        known = quantities()[quantity]
        try:
            found = compare(golden, known.function(**read_fields(known.arguments, question, "request")))
        except Exception:  # no answer is a promise broken, and no reason to lose the rest
            found = float("inf"), float("inf")
        by_quantity.setdefault(quantity, []).append((*found, json.dumps(golden.request)))
    rows = []
    for quantity, values in by_quantity.items():
        _, share, hardest = max(values, key=lambda row: row[1])
        broken = sum(not row[1] <= 1 for row in values)
        rows.append(OracleError(quantity, len(values), max(row[0] for row in values), share, broken, hardest))
    return tuple(rows)


def compare(golden: Golden, answer: Reference) -> tuple[float, float]:
    """Return the largest relative error that the proven ball allows, and its share of the error that the oracle states."""
    value, stated = float(answer.value), float(answer.error)
    if golden.value == "inf" or value in (float("inf"), float("-inf")) or value != value:
        right = golden.value == str(value)
        return (0.0, 0.0) if right else (float("inf"), float("inf"))
    truth, radius = Fraction(golden.value), Fraction(golden.radius)
    off = abs(Fraction(value) - truth)
    size = abs(truth) + radius
    relative = float((off + radius) / size) if size else 0.0
    if stated == 0:  # an exact answer: as near as the ball can tell
        return relative, 0.0 if off <= radius else float("inf")
    return relative, float(off / Fraction(stated)) if stated < float("inf") else 0.0
