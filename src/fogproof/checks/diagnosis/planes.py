"""Directions to a plane: area taken for solid angle, and points of a cube that are normalised.

Seen from its origin, a unit area of a plane at unit distance, of normal n, fills the solid angle (x . n)^3: a cosine over a
squared distance, which is 1 / (x . n)^2 (Pharr, Jakob & Humphreys 2023, section 6.2).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_PER_CELL = 8  # samples in a cell, seen and expected, that tell a density
_LEAN = 0.03  # mean length of directions that have a direction
_ALONG = 0.03  # from z: such a mean is meant to be z
_GRAZING = 0.05  # cosine to a plane's normal: a piece of a plane ends before
_EDGE = 1e-6  # least density of a claim over its greatest: the cosine of a piece of a plane takes no power of it lower
_POWERS = {
    3: "the cosine over the squared distance is missing",
    2: "the squared distance is missing, or the cosine is in the place of its reciprocal",
    1: "the cosine is missing, or one power of the distance",
    -1: "the cosine is once too often, or one power of the distance",
    -3: "the squared distance over the cosine is once too often",
}


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that points of a cube, or of one plane, are normalised as if that kept areas.

    Planes across z and across the mean direction of the claim take no parameter. Other normals are not known: in cells, samples
    over what the claim expects, to the power -1/k, are a linear function of x where x . n is missing k times; its gradient is n.
    """
    x = setting.contrast.x
    if len(np.unique(3 * (x.max(axis=1) == np.abs(x).max(axis=1)) + np.abs(x).argmax(axis=1))) > 3:
        yield Hypothesis(
            "normalised cube",
            "these samples are points of a cube, normalised without rejection",
            lambda s, _: lambda x: s.p(x) / np.abs(x).max(axis=1) ** 3,
        )
    for normal in _expected(setting):
        if within(setting, normal):
            yield from (_seen(k, normal, 0) for k in _POWERS)
    told = ratios(setting)
    if told is None:
        return
    places, ratio = told
    for k in _POWERS:
        gradient = np.linalg.lstsq(places, ratio ** (-1 / k), rcond=None)[0]
        normal = gradient / max(float(np.linalg.norm(gradient)), 1e-300)
        if within(setting, normal):
            yield _seen(k, normal, 2)


def within(setting: Setting, normal: np.ndarray) -> bool:
    """Return whether samples and claim are directions to a piece of a plane with such a normal, which nowhere grazes it.

    Such a piece has an edge. A lobe has none, though its skirts may be less than the least number.
    """
    n, cosine = len(setting.contrast.x), setting.contrast.points @ normal
    claim = setting.values[n:]
    if np.any(cosine[:n] <= _GRAZING) or np.any(claim[cosine[n:] <= _GRAZING] > 0):
        return False
    return bool(np.min(claim, where=claim > 0, initial=np.inf) > _EDGE * claim.max())


def _expected(setting: Setting) -> Iterator[np.ndarray]:
    """Yield the normals (3,) that a plane is likely to have."""
    z, mean = np.array([0.0, 0.0, 1.0]), setting.claimed_mean()
    yield from (z, -z)
    length = float(np.linalg.norm(mean))
    if length > _LEAN and np.linalg.norm(mean[:2]) > _ALONG * length:
        yield mean / length


def _seen(k: int, normal: np.ndarray, fitted: int) -> Hypothesis:
    """Return the hypothesis that the cosine to a plane's normal is missing k times, told by so many fitted numbers."""
    to = ", ".join(f"{c:.3f}" for c in normal)
    if k == max(_POWERS):
        words = f"these samples are even on the area of a plane of normal ({to}) where the pdf means solid angle"
    elif k == min(_POWERS):
        words = f"these samples are spread by solid angle where the pdf is one of the area of a plane of normal ({to})"
    else:
        words = f"these samples lie in a plane of normal ({to})"
    return Hypothesis(
        "missing Jacobian",
        f"{words}: {_POWERS[k]}",
        lambda s, _: lambda x: s.p(x) / np.maximum(x @ normal, 1e-9) ** k,
        fitted=fitted,
    )


def ratios(setting: Setting) -> tuple[np.ndarray, np.ndarray] | None:
    """Return where cells are, (m, 3), and how many samples they have over what the claim expects, (m,); None of too few cells."""
    contrast = setting.contrast
    n, cells = len(contrast.x), int(contrast.cell.max()) + 1
    weight = setting.values[n:] / contrast.q[n:]
    seen = np.bincount(contrast.cell[:n], minlength=cells)
    expected = np.bincount(contrast.cell[n:], weight, cells) * n / max(float(weight.sum()), 1e-300)
    full = (seen >= _PER_CELL) & (expected >= _PER_CELL)
    if np.count_nonzero(full) < 2 * _PER_CELL:
        return None
    middle = np.stack(
        [np.bincount(contrast.cell[n:], weight * contrast.z[:, axis], cells) for axis in range(3)], axis=1
    )
    places = middle[full] / np.bincount(contrast.cell[n:], weight, cells)[full, None]
    return places, seen[full] / expected[full]
