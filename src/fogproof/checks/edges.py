"""What a sampler does with extreme uniforms: 0, the smallest denormal, 1/2 and the largest number below 1.

In up to four dimensions all their combinations are tried; in more, one axis at a time beside ordinary uniforms, and corners. The
answers must keep every promise that ordinary samples keep; a density of 0 is allowed at the very edge of its support alone, and at
an isolated zero inside it.
"""

from __future__ import annotations

import itertools

import numpy as np

from fogproof.checks import unit_lengths
from fogproof.checks.promises import Watch, at_any_atom, inside
from fogproof.checks.subject import Subject, in_domain
from fogproof.checks.verdict import Finding
from fogproof.contracts import Draw
from fogproof.domains import Discrete
from fogproof.errors import SubjectError, shorten

_NAME, _CAUSE = "edge uniforms", "edge of the uniforms"
_ALL_COMBINATIONS = 4  # dimensions up to which all are tried
_CORNERS = 64  # tried beyond
_INWARDS = 2.0**-20  # from an edge, or from 1/2 either way: what the sampler does there is no edge case
_APPROACH = {"float64": ((500, 1000), (26, 52)), "float32": ((48, 96), (12, 24))}  # uniforms 2^-k that come near 0
_CLOSER = (0.98, 0.75)  # times as far from the limit as before: what jumps at the edge stays where it is
_HALVINGS = 64  # of the way to where the density is positive
_UNDERFLOW = {"float64": 1e-290, "float32": 1e-36}  # densities a step from those that no number holds
_TOWARDS = (2.0**-8, 2.0**-16, 2.0**-24, 2.0**-32)  # of the way to that point, where the support must have begun


def edge_uniforms(subject: Subject, labels: dict[float | None, int]) -> Finding:
    """Return what is found at the edges; `labels` are the usual event labels of each place."""
    u, tried = _edges(subject)
    try:
        with np.errstate(all="ignore"):
            draw = subject.draw_at(u.copy())
            watch = Watch(subject, labels)
            watch.look(draw)
            holes = _holes(subject, u, draw) if "positive pdf" in watch.broken else np.empty(0, dtype=int)
    except SubjectError as error:
        return Finding(_NAME, "rejected", f"with {tried}, {error}", cause=_CAUSE)
    for name in ("positive pdf", "infinite pdf", unit_lengths.NAME):
        watch.broken.pop(name, None)
    for name, (_, example) in watch.broken.items():
        return Finding(
            _NAME, "rejected", f"with {tried}, {name}: {example}{_which(subject, u, draw, name)}", cause=_CAUSE
        )
    if len(holes):
        i = int(holes[0])
        message = (
            f"u = {shorten(u[i])} gives x = {shorten(draw.x[i])}, where the pdf is {subject.density(draw.x[[i]])[0]:g}"
        )
        return Finding(_NAME, "rejected", f"{message} and not at the edge of its support", cause=_CAUSE)
    return Finding(_NAME, "not rejected", f"all promises are kept with {tried}")


def no_edge_uniforms() -> Finding:
    """Return the word that is due where a sampler draws its own uniforms."""
    message = (
        "not tried: with dimensions=None the sampler draws its own; give sample(u) to have 0 and 1 - ulp put to it"
    )
    return Finding(_NAME, "not rejected", message)


def _edges(subject: Subject) -> tuple[np.ndarray, str]:
    """Return (m, dimensions) uniforms, and in words what they are."""
    kind = np.float32 if subject.precision == "float32" else np.float64
    edges = np.array([0.0, np.finfo(kind).smallest_subnormal, 0.5, np.nextafter(kind(1), kind(0))], dtype=kind)
    d = subject.dimensions
    assert d is not None
    if d <= _ALL_COMBINATIONS:
        u = np.array(list(itertools.product(edges, repeat=d)), dtype=kind)
        return u, f"all {len(u)} combinations of 0, denormal, 1/2 and 1 - ulp"
    rng = np.random.default_rng(d)
    rows = [np.full((1, d), edge) for edge in edges]
    rows.append(edges[[0, -1]][rng.integers(0, 2, (_CORNERS, d))])
    for axis in range(d):
        row = rng.random((len(edges), d), dtype=kind)
        row[:, axis] = edges
        rows.append(row)
    return np.concatenate(rows).astype(
        kind
    ), f"0, denormal, 1/2 and 1 - ulp on each of {d} axes and at {_CORNERS} corners"


def _which(subject: Subject, u: np.ndarray, draw: Draw, name: str) -> str:
    bad = np.flatnonzero(~inside(subject, draw)) if name == "domain" else np.empty(0)
    return f", from u = {shorten(u[bad[0]])}" if len(bad) else ""


def _holes(subject: Subject, u: np.ndarray, draw: Draw) -> np.ndarray:
    """Return which answers have a density of 0 (or none) that does not begin right beside them."""
    good = inside(subject, draw) & ~at_any_atom(subject, draw.x)
    if draw.valid is not None:
        good &= draw.valid
    p = np.full(len(u), np.nan)
    p[good] = subject.density(draw.x[good])
    bad = np.flatnonzero(good & ~(p > 0))
    if isinstance(subject.domain, Discrete) or not len(bad):
        return bad
    at, x = u[bad], draw.x[bad]
    return bad[
        np.isnan(p[bad]) | ~(_begins(subject, at, x) | _approached(subject, at, x) | _underflows(subject, at, x))
    ]


def _underflows(subject: Subject, u: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return (n,) whether x is an end of a line towards which the density falls until numbers cannot hold it: no hole ends so."""
    if x.ndim > 1:
        return np.zeros(len(x), dtype=bool)
    half = np.full((len(x), 1), 0.5)
    near = subject.draw_at(np.clip(u, _INWARDS, 1 - _INWARDS).astype(u.dtype)).x
    at_end = np.isin(subject.domain.law(near).coordinates(x, half)[:, 0], (0.0, 1.0))
    outer, inner = x.copy(), near.copy()
    for _ in range(_HALVINGS):
        middle = outer + 0.5 * (inner - outer)
        positive = subject.density(middle) > 0
        outer, inner = np.where(positive, outer, middle), np.where(positive, middle, inner)
    last = subject.density(inner)
    return at_end & (last > 0) & (last < _UNDERFLOW[subject.precision])


def _begins(subject: Subject, u: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return (n,) whether the support begins at x, on the way to what ordinary uniforms beside u give.

    The way is straight in the coordinates of a known law, or in space: coordinates turn round at their poles.
    """
    begun, half = np.zeros(len(x), dtype=bool), np.full((len(x), 1), 0.5)
    for side in (_INWARDS, -_INWARDS):
        beside = np.clip(u + side * (u == 0.5), _INWARDS, 1 - _INWARDS)
        near = subject.draw_at(beside.astype(u.dtype)).x
        law = subject.domain.law(near)
        begin, end = law.coordinates(x, half), law.coordinates(near, half)
        for share in _TOWARDS:
            begun |= subject.density(law.place(np.minimum(begin + share * (end - begin), 1 - 2.0**-53))) > 0
            straight = x + share * (near - x)
            on = np.flatnonzero(~begun & in_domain(subject.domain, straight, subject.roundoff))
            begun[on] = subject.density(straight[on]) > 0
    return begun


def _approached(subject: Subject, u: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return (n,) whether x is the limit of samples of positive density, as the uniforms that are 0 go to 0.

    The smallest uniforms tell it best; a sampler that computes 1 - u takes them for 0, and coarser ones must tell it.

    Where a density falls to 0 to every order it underflows long before its edge, so no walk along x tells where it begins.
    """
    half = np.full((len(x), 1), 0.5)
    approached, same = np.zeros(len(x), dtype=bool), np.ones(len(x), dtype=bool)
    for exponents, closer in zip(_APPROACH[subject.precision], _CLOSER, strict=True):
        far, near = (subject.draw_at(np.maximum(u, 2.0**-k).astype(u.dtype)).x for k in exponents)
        law = subject.domain.law(near)
        end = law.coordinates(x, half)
        gap, before = (np.abs(law.coordinates(y, half) - end).max(axis=1) for y in (near, far))
        positive = (subject.density(far) > 0) & (subject.density(near) > 0)
        approached |= same & positive & (gap <= closer * before)
        same &= gap == 0
    return approached
