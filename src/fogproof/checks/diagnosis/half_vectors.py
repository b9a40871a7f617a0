"""Reflection at a sampled half vector whose Jacobian is missing, towards a view that nobody has told."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fogproof.checks.diagnosis import planes
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_UNIT_LENGTH = 0.3  # relative error of a direction that cells tell
_POINTS = 512  # that tell the usual density of a claim
_STEP_OF_VIEW, _TRIES_OF_VIEW = 0.05, 60  # of the search for the likeliest one


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that directions reflected at a sampled half vector have the half vector's density.

    With h the half of wo and x, dh/dx = 1 / (4 h . wo), and 2 h . wo = |wo + x| (Walter et al. 2007, eq. 14). Where wo is unknown,
    in cells, samples over what the claim expects, to the power -2, are proportional to 1 + x . wo.
    """
    told = planes.ratios(setting)
    if told is None:
        return
    places, ratio = told
    level, *gradient = np.linalg.lstsq(np.column_stack([np.ones(len(places)), places]), ratio**-2.0, rcond=None)[0]
    length = float(np.linalg.norm(gradient))
    if not (level > 0 and abs(length / level - 1) < _UNIT_LENGTH):
        return
    wo = _likeliest_view(setting, np.asarray(gradient) / length)
    usual = float(np.median(setting.p(setting.claimed_points(_POINTS))))
    if setting.p(-wo[None])[0] >= usual:  # where h is at right angles to wo: any density may go to infinity there
        return
    to = ", ".join(f"{c:.3f}" for c in wo)
    words = f"the Jacobian 1/(4 h . wo) of a reflection at half vectors h is missing, with wo = ({to})"
    yield Hypothesis(
        "missing Jacobian", words, lambda s, _: lambda x: s.p(x) / np.sqrt(np.maximum(1 + x @ wo, 1e-9)), fitted=2
    )


def _likeliest_view(setting: Setting, wo: np.ndarray) -> np.ndarray:
    """Return the direction near wo that makes the samples likeliest as those of half vectors without their Jacobian."""
    from scipy.optimize import minimize

    points, across = setting.contrast.points, np.linalg.svd(wo[None])[2][1:]

    def view(v: np.ndarray) -> np.ndarray:
        moved = wo + v @ across
        return np.asarray(moved / np.linalg.norm(moved))

    def loss(v: np.ndarray) -> float:
        density = setting.values / np.sqrt(np.maximum(1 + points @ view(v), 1e-9))
        likelihood = setting.contrast.likelihood(density)
        return -likelihood if math.isfinite(likelihood) else 1e300

    simplex = [(0.0, 0.0), (_STEP_OF_VIEW, 0.0), (0.0, _STEP_OF_VIEW)]
    options = {"initial_simplex": simplex, "maxfev": _TRIES_OF_VIEW, "xatol": 1e-4, "fatol": 1e-2}
    return view(minimize(loss, np.zeros(2), method="Nelder-Mead", options=options).x)
