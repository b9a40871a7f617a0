"""Visible normals of an anisotropic surface with its two roughnesses swapped, seen from a view that nobody has told."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_POINTS = 512
_FEWEST = 128  # of them that are seen together with a mirror image
_SAME, _TOLD = 1e-4, 1e-2  # what is left of the equations for the view, and what tells it from any other
_LEAST = 1e-9  # of a cosine
_MIRRORS = np.array([[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]])


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that roughnesses along x and y are swapped, of a claim max(h . wo, 0) D(h) with D even in x and in y.

    Heitz (2018). With the roughnesses swapped, D(x, y, z) is D(y, x, z), and the cosine stays.
    """
    wo = _view(setting)
    if wo is not None:
        to = ", ".join(f"{c:.3f}" for c in wo)
        words = f"these samples fit the pdf with the roughnesses along x and y swapped, of normals visible from ({to})"
        yield Hypothesis("swapped axes", words, lambda s, _: _swapped(s, wo))


def _view(setting: Setting) -> np.ndarray | None:
    """Return wo (3,), None if the claim is no such law: p(h) / p(h') is h . wo / h' . wo at mirror images h' of h."""
    h = setting.claimed_points(_POINTS)
    rows = []
    for mirror in _MIRRORS:
        p, other = setting.p(h), setting.p(h * mirror)
        both = (p > 0) & (other > 0)
        p, other, x = p[both, None], other[both, None], h[both]
        rows.append((other * x - p * x * mirror) / np.maximum(p, other))
    equations = np.concatenate(rows)
    if len(equations) < _FEWEST:
        return None
    _, lengths, axes = np.linalg.svd(equations, full_matrices=False)
    wo = axes[2] * np.sign(axes[2, 2])
    if np.abs(equations @ wo).max() > _SAME or lengths[1] < _TOLD * lengths[0]:
        return None
    return wo if np.hypot(wo[0], wo[1]) > _SAME else None  # along z, axes are swapped


def _swapped(setting: Setting, wo: np.ndarray) -> Density:
    side = np.where(wo < 0, -1.0, 1.0)

    def density(h: np.ndarray) -> np.ndarray:
        turned = np.abs(h[:, [1, 0, 2]]) * side  # the mirror image that is seen best
        return np.maximum(h @ wo, 0.0) * setting.p(turned) / np.maximum(turned @ wo, _LEAST)

    return density
