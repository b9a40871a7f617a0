"""The table of a study, `results.csv`, with one row a count."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from typing import Any

from fogproof.text import spreadsheet_cell

COLUMNS = (
    *("scene", "estimator", "points", "status", "count", "replicates", "mean", "reference", "reference_error"),
    *("rmse", "rmse_low", "rmse_high", "predicted", "seconds", "seconds_low", "seconds_high"),
    *("variance", "exact_variance", "order", "relative"),
)


def table(record: dict[str, Any]) -> str:
    """Return `results.csv`: a row for each count of each estimator."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    for scene in record["scenes"]:
        for estimator in scene["estimators"]:
            writer.writerows(_rows(scene, estimator))
    return out.getvalue()


def _rows(scene: dict[str, Any], estimator: dict[str, Any]) -> Iterable[list[Any]]:
    speed, variance = estimator["speed"], estimator["variance"] or {}
    for number, count in enumerate(estimator["counts"]):
        values = {
            **count,
            "scene": scene["name"],
            "estimator": estimator["name"],
            "points": estimator["points"],
            "status": estimator["status"],
            "reference": scene["reference"]["value"],
            "reference_error": scene["reference"]["error"],
            "seconds": speed["counts"][number]["seconds"],
            "seconds_low": speed["counts"][number]["low"],
            "seconds_high": speed["counts"][number]["high"],
            "variance": variance.get("measured"),
            "exact_variance": variance.get("exact"),
            "order": (estimator["order"] or {}).get("value"),
            "relative": (speed["relative"] or {}).get("value"),
        }
        yield [spreadsheet_cell(values[name]) for name in COLUMNS]
