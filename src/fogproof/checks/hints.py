"""Hints about a density: where it jumps, where it is 0, and a map under which samples are uniform.

Hints are looked into before they are used, at samples and at evenly spread points. One that the pdf contradicts is told, and the
check goes on without it: no verdict rests on a hint that is wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fogproof.checks.density.charts import Chart
from fogproof.checks.density.lattice import lattice
from fogproof.checks.jacobian import agrees
from fogproof.checks.promises import at_any_atom
from fogproof.checks.subject import Subject, call, in_domain, numbers
from fogproof.errors import FogproofError, shorten

_SPREAD = 1 << 14  # points of the domain at which the pdf is looked at
_MOST_PIECES = {1: 1 << 17, 2: 1 << 14}  # cells of a line and of a plane
_EDGE = 1e-9  # of the unit cube that rounding may leave


def supported(subject: Subject, points: np.ndarray) -> tuple[Subject, str]:
    """Return the subject on its support, or as it was and why its `support` is not used; `points` are a pilot sample."""
    support = subject.support
    if support is None:
        return subject, ""
    law = subject.domain.law(points)
    own = support.law(points)
    y = own.place(lattice(_SPREAD, len(own.axes), np.full(len(own.axes), 0.5)))
    beyond = in_domain(support, y, subject.roundoff) & ~in_domain(subject.domain, y, subject.roundoff)
    if beyond.any():
        return (
            subject,
            f"support (not used: {shorten(y[np.argmax(beyond)])} belongs to it, and not to {subject.domain})",
        )
    x = law.place(lattice(_SPREAD, len(law.axes), np.full(len(law.axes), 0.5)))
    x = x[in_domain(subject.domain, x, subject.roundoff)]
    for what, y in (("a sample is", points), ("the pdf is not 0 at", x)):
        outside = ~in_domain(support, y, subject.roundoff) & ~at_any_atom(subject, y)
        if y is x:
            outside[outside] = subject.density(y[outside]) > 0
        if outside.any():
            return subject, f"support (not used: {what} {shorten(y[np.argmax(outside)])}, outside it)"
    return replace(subject, domain=support), ""


def cube_map(subject: Subject) -> Callable[[np.ndarray], np.ndarray]:
    """Return the given inverse as a function of points that gives a clean array (n, k)."""
    inverse, k = subject.inverse, len(subject.domain.law(np.empty((0, *subject.domain.shape))).axes)
    assert inverse is not None

    def cube(x: np.ndarray) -> np.ndarray:
        u = np.asarray(call("inverse(x)", inverse, x))
        return numbers("inverse(x)", u[:, None] if k == 1 and u.ndim == 1 else u, (len(x), k))

    return cube


def why_not_inverse(subject: Subject, points: np.ndarray) -> str:
    """Return why a given inverse is not used, "" if it is: its derivative must be the pdf, and samples stay in the cube."""
    if subject.inverse is None:
        return ""
    if subject.domain.law(points).stepped:
        return "inverse (not used: single points have probability on this domain)"
    try:
        cube = cube_map(subject)
        with np.errstate(all="ignore"):
            u = cube(points)
            off = ~((u >= -_EDGE) & (u <= 1 + _EDGE)).all(axis=1)
            if off.any():
                at = int(np.argmax(off))
                return f"inverse (not used: {shorten(points[at])} goes to {shorten(u[at])}, outside the unit cube)"
            wrong = agrees(subject, cube, points)
    except FogproofError as error:
        return f"inverse (not used: {error})"
    return f"inverse (not used: {wrong})" if wrong else ""


def cut(subject: Subject, chart: Chart | None) -> tuple[Chart | None, str]:
    """Return the chart cut at the given breaks, or as it was and why they are not used."""
    if not subject.breaks:
        return chart, ""
    labels = tuple(axis.label for axis in chart.axes) if chart else ()
    strange = [label for label in subject.breaks if label not in labels]
    if strange or chart is None:
        known = ", ".join(labels) or "none"
        at = f"there is no coordinate {strange[0]!r} to cut; those of this domain are: {known}"
        return chart, f"breaks (not used: {at})"
    cut_up = chart.cut(subject.breaks)
    most = _MOST_PIECES[len(labels)]
    if cut_up.pieces > most:
        return chart, f"breaks (not used: they make {cut_up.pieces} cells, and quadrature is given {most} at most)"
    return cut_up, ""
