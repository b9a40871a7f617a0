"""Numbers and paths that options take, judged before anything runs: what no run could use is bad usage, not an outcome."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from fogproof.validate import LONGEST


@dataclass
class _Number(click.ParamType):  # type: ignore[type-arg]  # generic since click 8.3, and not before
    """A finite number from `low` to `high`; an open end is not among them."""

    low: float
    high: float
    opens: bool = False
    closes: bool = True
    name = "float"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number, or say what it must be."""
        try:
            x = float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            x = math.nan
        inside = (self.low < x if self.opens else self.low <= x) and (x <= self.high if self.closes else x < self.high)
        if not (inside and math.isfinite(x)):
            ends = f"{'(' if self.opens else '['}{self.low:g}, {self.high:g}{']' if self.closes else ')'}"
            self.fail(f"must be a number in {ends}, got {value}", param, ctx)
        return x


PROBABILITY = _Number(1e-90, 1, closes=False)
"""A false-alarm probability: its share for each of many cases is still one that arithmetic can keep."""

SECONDS = _Number(0, LONGEST, opens=True)
"""A time limit [s]."""

SECONDS_OR_NONE = _Number(0, LONGEST)
"""A time limit [s], or 0 for none."""

RELATIVE = _Number(0, 1, closes=False)
"""A relative error that does not matter."""

POSITIVE = _Number(0, math.inf, opens=True, closes=False)


class _Path(click.Path):
    """A path; "" is none: `Path("")` would be the folder one stands in, though a variable of the shell was not set."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path, or say what stands in its way."""
        if not os.fspath(value):
            self.fail("is empty: name a file or folder; a variable of the shell may not be set", param, ctx)
        if not self.file_okay and os.path.islink(value) and not os.path.exists(value):
            self.fail(f"{value} is a link that leads nowhere; remove it, or make what it leads to", param, ctx)
        return super().convert(value, param, ctx)


class _Output(_Path):
    """A file to write; with `dash` also "-", which is stdout and stands for None."""

    def __init__(self, dash: bool) -> None:
        super().__init__(path_type=Path, dir_okay=False, readable=False)
        self._dash = dash

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path, None for stdout, or say what stands in its way."""
        if os.fspath(value) == "-":
            if self._dash:
                return None
            self.fail("must be a file: an image does not go to stdout; for a file called so, write ./-", param, ctx)
        if os.fspath(value).endswith(("/", os.sep)):
            self.fail(f"{value} is the name of a folder; add that of a file", param, ctx)
        return super().convert(value, param, ctx)


FOLDER = _Path(path_type=Path, file_okay=False)
"""A folder to write into, which may not be there yet."""

FILE = _Output(dash=False)
"""A file to write, or a device."""

FILE_OR_STDOUT = _Output(dash=True)
"""The same, or "-" for stdout, which comes as None."""

NAMED = _Path(readable=False)
"""The name of what is read, as a text; "-" may mean stdin."""

PLACE = _Path(path_type=Path)
"""What is read: whether it is there, and what it is, is said where it is opened."""
