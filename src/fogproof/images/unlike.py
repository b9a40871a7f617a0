"""Is one of several renders unlike all others? Where whole renders scatter, their scatter hides the one that causes it."""

from __future__ import annotations

import numpy as np

from fogproof.checks.statistics.tails import student_two_sided
from fogproof.checks.verdict import Finding
from fogproof.images.picture import RenderedImage

_LEAST = 4  # renders: of fewer, nobody can say which one is unlike the others


def one_unlike(picture: RenderedImage, alpha: float) -> Finding | None:
    """Return what is to be said of a render whose mean is far from those of all others; None if there is none.

    The mean less that of the others, over their scatter, has Student's law with n - 2 degrees of freedom (Ellenberg 1973, the
    deleted residual), the largest of n at most n times its tail. Rare bright pixels may explain it: it rejects nothing.
    """
    means = np.nanmean(picture.renders, axis=(1, 2, 3), where=np.isfinite(picture.renders))
    n = len(means)
    if n < _LEAST or not np.isfinite(means).all():
        return None
    others = (means.sum() - means) / (n - 1)
    scatter = np.array([np.std(np.delete(means, i), ddof=1) for i in range(n)]) * np.sqrt(1 + 1 / (n - 1))
    z = np.abs(means - others) / np.maximum(scatter, 1e-12 * np.abs(others))
    worst = int(np.argmax(z))
    p = min(1.0, n * student_two_sided(n - 2, float(z[worst])))
    if p > alpha or others[worst] == 0:
        return None
    ratio = means[worst] / others[worst]
    name = picture.paths[worst] if len(picture.paths) == n else f"render {worst + 1}"
    spread = scatter[worst] / abs(others[worst])
    message = f"{name} is {ratio:.4g} times as bright as the other {n - 1}, which differ by {spread:.1e}"
    message += ": a render of something else, or rare bright pixels; leave it out, or give more samples a pixel"
    return Finding("one render unlike the others", "inconclusive", message, p, alpha, effect=float(ratio - 1))
