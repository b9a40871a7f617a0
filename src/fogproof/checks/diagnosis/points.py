"""Points that come again and again: is what lies beyond them clamped to them, or do they have a probability of their own?"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.checks.diagnosis.contrast import Contrast
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.contracts import Draw
from fogproof.domains import Domain, Product, UnitHemisphere, UnitSphere
from fogproof.domains.law import whole_columns
from fogproof.errors import shorten

Reading = Callable[[np.ndarray], np.ndarray]

_DRAWN = 1 << 15  # samples among which they are looked for
_MOST = 64  # points that are looked at
_DIGITS = 12  # of a coordinate that are no rounding
_OFTEN = 10  # times that a point must come
_INNERMOST = 16  # directions that may lie on one circle
_FLAT = 1e-9  # distance from their plane, of their own distances or of one
_NEARLY = 1e-6  # the same of few on an arc so short that rounding tilts the plane
_BEYOND = 3.0  # standard errors of a probability that is none by chance
_APART = 1e3  # times what rounding does: single values
_CHANCE = 5.0  # standard errors that chance makes


def clamped(contrast: Contrast, subject: Subject) -> str:
    """Return in words which coordinate is clamped at what, "" if none is.

    Its outermost value comes as often as the pdf has probability beyond it, and no value between comes nearly as often: numbers of
    few bits are none that were clamped. Points of a known law tell that probability without a quadrature. Few of them may lie where
    no sample does; that the pdf integrates to one is a control variate.
    """
    n = len(contrast.x)
    weight = subject.density(contrast.z) / contrast.q[n:]
    weight = np.where(np.isfinite(weight), weight, 0.0)  # not at a pole
    for name, read in _readings(contrast, subject.domain):
        other = read(contrast.z)
        values, counts = np.unique(read(contrast.x), return_counts=True)
        between = int(counts[1:-1].max(initial=0))
        for end, beyond in ((-1, other > values[-1]), (0, other < values[0])):
            share = counts[end] / n
            if counts[end] < _OFTEN * max(between, 1):
                continue
            lost, spread = _with_control(weight * beyond, weight, 1.0)
            chance = _CHANCE * math.hypot(spread, math.sqrt(share * (1 - share) / n))
            if lost > _BEYOND * spread and abs(lost - share) < chance:
                told = (
                    f"{share:.3g} of the samples have {name} = {values[end]:.6g}, and the pdf has {lost:.3g} beyond it"
                )
                return f"{told}: what lies there is clamped to it"
    return ""


def _with_control(y: np.ndarray, control: np.ndarray, mean: float) -> tuple[float, float]:
    """Return the mean of y (n,) and its standard error, given the mean of a control variate (n,)."""
    variance = float(np.var(control))
    slope = float(np.mean((y - y.mean()) * (control - control.mean()))) / variance if variance > 0 else 0.0
    rest = y - slope * (control - mean)
    return float(rest.mean()), float(rest.std()) / math.sqrt(len(y))


def _readings(contrast: Contrast, domain: Domain) -> Iterator[tuple[str, Reading]]:
    """Yield names, and what they say of points: the coordinates that are no whole numbers, then the cosines to axes of caps."""
    for k, whole in enumerate(whole_columns(domain)):
        if not whole:
            yield f"x[{k}]" if domain.shape else "x", partial(_coordinate, k)
    first = 0
    for part in domain.parts if isinstance(domain, Product) else (domain,):
        last = first + math.prod(part.shape)
        if isinstance(part, (UnitSphere, UnitHemisphere)):
            axis = _ring(contrast.x[:, first:last])
            if axis is not None:
                to = ", ".join(f"{c:.4f}" for c in np.round(axis, 4) + 0.0)  # no -0
                yield f"a cosine to ({to})", partial(_cosine, slice(first, last), axis)
        first = last


def _coordinate(k: int, x: np.ndarray) -> np.ndarray:
    return x.reshape(len(x), -1)[:, k]


def _cosine(columns: slice, axis: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.round(x[:, columns] @ axis, _DIGITS)


def _ring(x: np.ndarray) -> np.ndarray | None:
    """Return the axis (3,) of the circle on which the innermost directions lie, None if there is no such circle."""
    ring = x[np.argsort(x @ x.mean(axis=0))[-_INNERMOST:]]
    for flat in (_NEARLY, _FLAT, _FLAT):  # from few of them, which may lie on a short arc, to all
        middle = ring.mean(axis=0)
        _, lengths, axes = np.linalg.svd(ring - middle, full_matrices=False)
        if not lengths[2] < flat * lengths[1]:
            return None
        ring = x[np.abs((x - middle) @ axes[2]) < _FLAT]
    return np.asarray(axes[2] * np.sign(axes[2] @ middle))


def _constant(contrast: Contrast, subject: Subject) -> tuple[str, Subject] | None:
    """Return in words which reading has one value again and again, as none of its others, and the subject without such samples."""
    for name, read in _readings(contrast, subject.domain):
        values, counts = np.unique(read(contrast.x), return_counts=True)
        most = int(np.argmax(counts))
        if counts[most] >= _OFTEN * max(int(np.delete(counts, most).max(initial=0)), 1):
            value, share = float(values[most]), float(counts[most] / len(contrast.x))
            words = f"{share:.3g} of the samples have {name} = {value:.6g}, to which a pdf gives no probability"
            words += ", and none lies beyond it, as of a clamp" * (most in (0, len(values) - 1))
            return words, chosen(subject, partial(_unlike, read, value))
    return None


def _unlike(read: Reading, value: float, x: np.ndarray) -> np.ndarray:
    return read(x) != value


def single_points(subject: Subject, samples: int, seed: int) -> tuple[str, str, Subject]:
    """Return "clamped", "atom" or "sheet", and in words where the samples come back to and how often; "" if nowhere.

    The third is the subject with these points declared, or without the samples of a sheet, where one coordinate is a constant: what
    lies between them is the rest.
    """
    contrast = Contrast.of(subject, min(_DRAWN, samples), batch_generator(seed, "diagnosis", 2, 0), jumps=True)
    if contrast is None:
        return "", "", subject
    points, counts = np.unique(contrast.x, axis=0, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:_MOST]
    again = order[counts[order] >= _OFTEN]
    found = {_key(points[i]): float(counts[i] / len(contrast.x)) for i in again.tolist()}
    rest = replace(subject, atoms={**subject.atoms, **found})
    if told := clamped(contrast, subject):
        return "clamped", told, rest
    if not found:
        constant = _constant(contrast, subject)
        if constant is None:
            return "", "", subject
        return "sheet", *constant
    point, share = next(iter(found.items()))
    named = shorten(list(point) if isinstance(point, tuple) else point)
    words = f"{share:.3g} of the samples are {named}, to which a pdf gives no probability"
    return "atom", f"{words}: if that is meant, declare atoms={{point: probability}}", rest


def chosen(subject: Subject, keep: Callable[[np.ndarray], np.ndarray]) -> Subject:
    """Return the subject without the samples x (n, ...) of which keep(x) is false."""

    def sample(*arguments: Any) -> Draw:
        result = subject.sample(*arguments)
        draw = result if isinstance(result, Draw) else Draw(result)
        valid = np.ones(len(draw.x), dtype=bool) if draw.valid is None else np.asarray(draw.valid, dtype=bool)
        return Draw(draw.x, valid=valid & keep(np.asarray(draw.x)))

    return replace(subject, sample=sample)


def _key(point: np.ndarray) -> tuple[float, ...] | float:
    return tuple(point.tolist()) if point.ndim else float(point)


def few_values(contrast: Contrast, subject: Subject) -> str:
    """Return in words which coordinate takes few values alone, "" if none does.

    Values that rounding puts side by side, as of a lobe narrower than it tells apart, are not few, and those of as few points of
    several coordinates belong to the points.
    """
    half = np.full((len(contrast.x), len(contrast.law.axes)), 0.5)
    u = contrast.law.coordinates(contrast.x, half)
    moves = [np.abs(contrast.law.coordinates(moved, half) - u) for moved in subject.nudged(contrast.x)]
    rounding = np.median(np.max(moves, axis=0), axis=0) + 10.0**-_DIGITS
    points = len(np.unique(contrast.x, axis=0)) if len(u.T) > 1 else len(u) + 1
    for name, column, least, stepped in zip(
        contrast.law.axes, u.T, _APART * rounding, _stepped(contrast, subject.domain), strict=True
    ):
        values = np.unique(np.round(column, _DIGITS))
        few = 1 < len(values) <= len(column) // _OFTEN and len(values) < points
        if not stepped and few and np.median(np.diff(values)) > least:
            return f"{name} takes {len(values)} values alone"
    return ""


def _stepped(contrast: Contrast, domain: Domain) -> list[bool]:
    """Return of which axes of the known law single values have probability."""
    if not isinstance(domain, Product):
        return [contrast.law.stepped] * len(contrast.law.axes)
    flags: list[bool] = []
    first = 0
    for part in domain.parts:
        last = first + math.prod(part.shape)
        law = part.law(contrast.x[:0, first:last].reshape(0, *part.shape))
        flags += [law.stepped] * len(law.axes)
        first = last
    return flags
