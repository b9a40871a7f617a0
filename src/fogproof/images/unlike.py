"""Is one of several renders unlike all others? Where whole renders scatter, their scatter hides the one that causes it."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.statistics.tails import student_two_sided
from fogproof.checks.verdict import Finding
from fogproof.images.dependence import dependence
from fogproof.images.picture import RenderedImage
from fogproof.images.residuals import Residuals

_LEAST = 4  # renders: of fewer, nobody can say which one is unlike the others
_PLAIN = 20.0  # standard deviations of its pixels' own noise


def one_unlike(picture: RenderedImage, found: Residuals, alpha: float) -> Finding | None:
    """Return what is to be said of a render whose mean is far from those of all others; None if there is none.

    The mean less that of the others, over their scatter, has Student's law with n - 2 degrees of freedom (Ellenberg 1973, the
    deleted residual), the largest of n at most n times its tail. Or it lies beyond all that its pixels' noise explains, and the
    others do not. Rare bright pixels, or a seed that few have, may explain it: it rejects nothing.
    """
    renders = picture.renders
    means = np.nanmean(renders, axis=(1, 2, 3), where=np.isfinite(renders))
    n = len(means)
    if n < _LEAST or not np.isfinite(means).all():
        return None
    others = (means.sum() - means) / (n - 1)
    scatter = np.array([np.std(np.delete(means, i), ddof=1) for i in range(n)]) * math.sqrt(1 + 1 / (n - 1))
    z = np.abs(means - others) / np.maximum(scatter, 1e-12 * np.abs(others))
    worst = int(np.argmax(z))
    p = min(1.0, n * student_two_sided(n - 2, float(z[worst])))
    if others[worst] == 0 or (p > alpha and not _alone(renders, worst, found)):
        return None
    ratio = means[worst] / others[worst]
    name = picture.paths[worst] if len(picture.paths) == n else f"render {worst + 1}"
    spread = scatter[worst] / abs(others[worst])
    message = f"{name} is {ratio:.4g} times as bright as the other {n - 1}, which differ by {spread:.1e}"
    message += ": a render of something else, or rare bright pixels; leave it out, or give more samples a pixel"
    return Finding("one render unlike the others", "inconclusive", message, p, alpha, effect=float(ratio - 1))


def _alone(renders: np.ndarray, place: int, found: Residuals) -> bool:
    """Return whether all renders but this one scatter as their pixels do, and this one lies far outside of that."""
    rest = np.delete(renders, place, axis=0)
    if dependence(rest, found).kind == "shared":
        return False
    noise = renders[place] - rest.mean(axis=0)
    noise = np.where(np.isfinite(noise), noise, 0.0) / (np.abs(found.reference) + 1e-300)
    own = np.std(rest, axis=0, ddof=1) / (np.abs(found.reference) + 1e-300)
    total = float(np.sum(own * own)) * (1 + 1 / len(rest))
    return abs(float(np.sum(noise))) > _PLAIN * math.sqrt(total)
