"""The figure of a finding, read from its record: one class a kind."""

from __future__ import annotations

from typing import Any, cast

from fogproof.errors import InvalidInputError, shorten
from fogproof.reports.charts.bins import Bins
from fogproof.reports.charts.pictures import PictureChart
from fogproof.reports.charts.running_mean import RunningMean
from fogproof.reports.charts.z_map import ZMap
from fogproof.reports.validation import adapter

KINDS = {"z-map": ZMap, "bins": Bins, "mean": RunningMean}


def parse_figure(figure: dict[str, Any], origin: str = "figure") -> PictureChart:
    """Return the drawing that `figure` describes; a fault is an `InvalidInputError` that names it."""
    import pydantic

    kind = figure.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise InvalidInputError(
            f"{origin}.kind must be one of {', '.join(KINDS)}, got {shorten(kind)}", f"{origin}.kind"
        )
    try:
        return cast(PictureChart, adapter(KINDS[kind]).validate_python(figure))
    except pydantic.ValidationError as error:
        fault = error.errors()[0]
        place = ".".join([origin, *(str(part) for part in fault["loc"])])
        raise InvalidInputError(f"{place}: {fault['msg']}", place) from None
