"""A verdict as a picture and as HTML, for notebooks; matplotlib loads when a picture is asked for."""

from __future__ import annotations

import io
import math
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.text import p_value

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fogproof.checks.verdict import Verdict

_COLUMNS = 3
_SIZE = 3.6  # inches of one panel
_MOST = 9  # panels; what was rejected comes first
_COLOURS = {"rejected": "#b3261e", "inconclusive": "#8a6d00", "not rejected": "#1b6e3c"}


def plotted(verdict: Verdict) -> Figure:
    """Return a matplotlib figure with a panel for every finding that has data to show, rejected ones first."""
    order = {"rejected": 0, "inconclusive": 1, "not rejected": 2}
    shown = [f for f in sorted(verdict.findings, key=lambda f: order[f.outcome]) if f.figure][:_MOST]
    shown = [f for f in shown if f.figure and f.figure.get("kind") in _PANELS]
    if not shown:
        raise UnsupportedError("no finding of this verdict has data for a picture; print(verdict) says all there is")
    from matplotlib.figure import Figure

    columns = min(len(shown), _COLUMNS)
    rows = math.ceil(len(shown) / columns)
    figure = Figure(figsize=(_SIZE * columns, 0.85 * _SIZE * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for axis, finding in zip(axes, shown, strict=False):
        assert finding.figure is not None
        _PANELS[finding.figure["kind"]](axis, finding.figure)
        axis.set_title(f"{finding.check}: {finding.outcome}", fontsize=8, color=_COLOURS[finding.outcome])
        axis.tick_params(labelsize=7)
    for axis in axes[len(shown) :]:
        axis.set_axis_off()
    return figure


def as_html(verdict: Verdict) -> str:
    """Return the verdict as HTML that needs nothing else: outcome, findings, and the picture if there is one."""
    colour = _COLOURS[verdict.outcome]
    head = f"<b style='color:{colour}'>{escape(verdict.outcome)}</b> "
    head += escape(f"(alpha {verdict.alpha:g}, {verdict.samples} samples, seed {verdict.seed})")
    head += f"<br>likely: {escape(verdict.cause)}" if verdict.cause else ""
    rows = []
    for f in verdict.findings:
        p = "" if f.p_value is None else p_value(f.p_value)
        cells = (f.check, f.message, p, "" if f.resolution is None else str(f.resolution))
        first = f"<td style='color:{_COLOURS[f.outcome]}'>{escape(f.outcome)}</td>"
        rows.append(f"<tr>{first}{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>")
    names = "".join(f"<th>{name}</th>" for name in ("outcome", "check", "what was found", "p", "resolution"))
    table = f"<table><thead><tr>{names}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
    try:
        buffer = io.StringIO()
        plotted(verdict).savefig(buffer, format="svg")
        picture = buffer.getvalue()[buffer.getvalue().index("<svg") :]
    except (ImportError, UnsupportedError):
        picture = ""
    return f"<div>{head}{table}{picture}</div>"


def _numbers(values: Any) -> np.ndarray:
    """Return numbers that JSON had to spell out."""
    return np.array([float(value) for value in values])


def _mean(axis: Any, figure: dict[str, Any]) -> None:
    n, mean, stderr = (_numbers(figure[name]) for name in ("n", "mean", "stderr"))
    reference, error = float(figure["reference"]), float(figure["error"])
    axis.axhline(reference, color="black", linewidth=0.8)
    axis.axhspan(reference - error, reference + error, color="black", alpha=0.15)
    axis.errorbar(n, mean, 2 * np.where(np.isfinite(stderr), stderr, 0.0), fmt=".-", linewidth=0.8, capsize=2)
    axis.set_xscale("log")
    axis.set_xlabel("realisations", fontsize=7)


def _bins(axis: Any, figure: dict[str, Any]) -> None:
    edges, expected, observed = (_numbers(figure[name]) for name in ("edges", "expected", "observed"))
    finite = np.isfinite(edges[:-1]) & np.isfinite(edges[1:]) & (edges[1:] > edges[:-1])
    width = np.where(finite, edges[1:] - edges[:-1], 1.0)
    axis.stairs(
        np.where(finite, expected / width, np.nan), np.where(np.isfinite(edges), edges, np.nan), label="claimed"
    )
    middle = 0.5 * (edges[1:] + edges[:-1])
    axis.plot(middle[finite], (observed / width)[finite], ".", markersize=3, label="sampled")
    axis.set_xlabel(figure["label"], fontsize=7)
    axis.legend(fontsize=6, frameon=False)


def _z_map(axis: Any, figure: dict[str, Any]) -> None:
    x, y = (_numbers(edges) for edges in figure["edges"])
    z = np.array(figure["z"], dtype=float)
    image = axis.pcolormesh(x, y, z.T, cmap="RdBu_r", vmin=-6, vmax=6)
    axis.figure.colorbar(image, ax=axis, label="z", shrink=0.8)
    axis.set_xlabel(figure["labels"][0], fontsize=7)
    axis.set_ylabel(figure["labels"][1], fontsize=7)


_PANELS = {"mean": _mean, "bins": _bins, "z-map": _z_map}
