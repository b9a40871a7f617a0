"""The golden tables: proven values to compare any program with, shipped as `golden.json` beside this file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files
from typing import Any


@dataclass(frozen=True)
class Golden:
    """One proven value: |value - truth| <= radius, both exact decimal numbers ("inf" has radius "0").

    request  the question, as the oracle's protocol puts it: `quantity` and its arguments, which count as the float64
             numbers nearest to their decimals
    """

    request: dict[str, Any]
    value: str
    radius: str


def golden_values() -> tuple[Golden, ...]:
    """Return the golden tables, made by `tools/make_golden.py` in ball arithmetic with 38 digits."""
    document = json.loads(files("fogproof.analytic.proven").joinpath("golden.json").read_text(encoding="utf-8"))
    return tuple(Golden(**entry) for entry in document["values"])
