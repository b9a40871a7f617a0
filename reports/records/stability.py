"""The record of a run over hard regions, as `fogproof stability` writes it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from fogproof.errors import InvalidInputError
from fogproof.input_files import parse_json, read_text
from fogproof.reports.records.runs import validated
from fogproof.stability.measuring import OURS, FormError
from fogproof.stability.record import SCHEMA, hidden

STABILITY = "stability.json"


@dataclass(frozen=True)
class Told:
    """What is known of a formula besides what was measured."""

    title: str
    of: str
    bound: float | None


@dataclass(frozen=True)
class StabilityRecord:
    """A whole run; `points` stood along the axes of most regions."""

    schema: str
    fogproof: str
    environment: dict[str, Any]
    command: str
    started: str
    seconds: float
    points: int
    formulas: dict[str, Told]
    measured: tuple[FormError, ...]
    state: Literal["finished", "interrupted"] = "finished"
    title: str = ""

    @property
    def ours(self) -> list[FormError]:
        """The rows of our own forms."""
        return [row for row in self.measured if row.form == OURS]

    @property
    def naive(self) -> list[FormError]:
        """The rows of others' forms, where each fails most."""
        worst: dict[tuple[str, str], FormError] = {}
        for row in self.measured:
            key = row.formula, row.form
            if row.form != OURS and (key not in worst or row.worst > worst[key].worst):
                worst[key] = row
        return list(worst.values())

    @property
    def broken(self) -> list[FormError]:
        """Rows of ours in which a bound is broken."""
        return [row for row in self.ours if row.violations]

    @property
    def hidden(self) -> list[tuple[str, str]]:
        """Naive forms that fail nowhere."""
        return hidden(self.measured)

    def themes(self) -> Iterator[tuple[str, list[FormError]]]:
        """Yield the themes, and what was measured of ours in each, the worst region of each formula and precision first."""
        names = dict.fromkeys(name.partition("/")[0] for name in self.formulas)
        for theme in names:
            yield theme, [row for row in self.ours if row.formula.startswith(f"{theme}/")]


def parse_stability(record: Any, origin: str = STABILITY) -> StabilityRecord:
    """Return the record as dataclasses; an `InvalidInputError` says what is wrong with it."""
    if not isinstance(record, dict) or record.get("schema") != SCHEMA:
        raise InvalidInputError(
            f"{origin}: is not a record of {SCHEMA}; 'fogproof stability -o DIR' makes one", "schema"
        )
    return validated(StabilityRecord, record, origin)


def stability_beside(folder: Path) -> tuple[StabilityRecord | None, str]:
    """Return the record in a folder, None if there is none, and in words why one that is there is not shown."""
    path = folder / STABILITY
    if not os.path.lexists(path):
        return None, ""
    try:
        return parse_stability(parse_json(read_text(path, "the record")), str(path)), ""
    except InvalidInputError as error:
        return None, str(error)
    except (ValueError, RecursionError) as error:
        return None, f"cannot read {path}: it is not JSON ({error})"
