"""Samples that fill no volume: all in one plane, as where one uniform serves twice, or one coordinate of several is never drawn."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.diagnosis.hypothesis import Setting
from fogproof.domains.law import whole_columns

_FLAT = 1e-9  # width of the samples over that of the claim, besides rounding
_POINTS = 4096
_DIGITS = 12  # of a coefficient that are no rounding


def in_a_plane(setting: Setting, rounding: float) -> tuple[str, str]:
    """Return the class of error and in words the equations that all samples fulfil where the claim has a width, "" without any.

    Columns that could be drawn each by itself, and fulfil one together, share a uniform.

    rounding  of a coordinate, relative

    Their plane is spanned by the singular vectors of lengths that are not 0. Points on a line are many, or it is no line.
    """
    x = setting.contrast.x[:_POINTS]
    if x.ndim != 2 or any(whole_columns(setting.domain)):
        return "", ""
    flat = _FLAT + math.sqrt(x.shape[1]) * rounding
    middle = x.mean(axis=0)
    _, lengths, axes = np.linalg.svd(x - middle, full_matrices=False)
    normals = axes[lengths <= flat * lengths[0]]
    if not 0 < len(normals) < x.shape[1] or len(np.unique(x, axis=0)) < len(x) // 2:
        return "", ""
    claim = (setting.claimed_points(_POINTS) - middle) @ normals.T
    if np.any(np.std(claim, axis=0) <= 1e3 * flat * lengths[0] / math.sqrt(len(x))):
        return "", ""
    told = _equations(normals, middle)
    words = f"all samples lie where {' and '.join(told)}: they fill no volume, and have no density"
    if len(setting.law.axes) == x.shape[1] and any(equation.count("x[") > 1 for equation in told):
        return "correlation", f"{words}, as where columns share a uniform"
    return "lower dimension", words


def _equations(normals: np.ndarray, point: np.ndarray) -> list[str]:
    """Return equations of the plane with so many normals (m, k) through a point (k,), each solved for a column of its own."""
    reduced, free = normals.copy(), list(range(normals.shape[1]))
    for row in range(len(reduced)):
        column = free[int(np.argmax(np.round(np.abs(reduced[row, free]), _DIGITS)))]
        free.remove(column)
        reduced[row] /= reduced[row, column]
        others = np.arange(len(reduced)) != row
        reduced[others] -= np.outer(reduced[others, column], reduced[row])
    told = []
    for row in reduced[np.argsort(np.abs(reduced).argmax(axis=1))]:
        terms = "".join(_term(c, k) for k, c in enumerate(row.tolist()) if abs(c) > 10.0**-_DIGITS)
        terms = terms.removeprefix(" + ").replace(" - ", "-", terms.startswith(" - "))
        told.append(f"{terms} = {round(float(row @ point), _DIGITS) + 0.0:.5g}")
    return told


def _term(coefficient: float, column: int) -> str:
    size = f"{abs(coefficient):.5g} "
    return f" {'-' if coefficient < 0 else '+'} {'' if size == '1 ' else size}x[{column}]"
