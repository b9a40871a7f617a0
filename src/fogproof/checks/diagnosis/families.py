"""Laws of numbers with another parameter of their own: Student's degrees of freedom, the shape of a gamma law."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting
from fogproof.domains import HalfLine

_POINTS = 512  # that tell whose law a claim is
_LEFT = 1e-8  # share of the variance of its logarithm that is left then
_FACTORS = (0.15, 0.4, 0.6, 0.8, 0.95, 1.05, 1.25, 1.6, 2.5, 8.0)
_MOST = 1e3  # degrees of freedom, or shape: beyond, a law is the normal one


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield the law that the claim is one of, with another parameter."""
    x = setting.claimed_points(_POINTS)
    p = setting.p(x)
    if not np.all((p > 0) & np.isfinite(p)) or np.ptp(x) == 0:
        return
    if isinstance(setting.domain, HalfLine):
        yield from _gamma(x - setting.domain.a, np.log(p), setting.domain.a)
    else:
        yield from _student(x, np.log(p))


def _gamma(x: np.ndarray, logarithm: np.ndarray, origin: float) -> Iterator[Hypothesis]:
    """Yield another shape k of a density x^(k - 1) exp(-x / scale): a chi-square law has half as many degrees of freedom."""
    if not np.all(x > 0):
        return
    columns = np.column_stack([np.ones(len(x)), np.log(x), x / x.mean()])
    found = np.linalg.lstsq(columns, logarithm, rcond=None)[0]
    shape = float(found[1]) + 1
    if _follows(columns @ found, logarithm) and 0 < shape < _MOST:
        yield Hypothesis(
            "another parameter",
            f"these samples fit the gamma law with the shape {{value}}, half the degrees of freedom of a chi-square law; "
            f"the pdf's is {shape:.4g}",
            lambda s, k: lambda x: s.p(x) * np.maximum(x - origin, 1e-300) ** (k - shape),
            tuple(shape * f for f in _FACTORS),
            null=shape,
        )


def _student(x: np.ndarray, logarithm: np.ndarray) -> Iterator[Hypothesis]:
    """Yield another number of degrees of freedom of Student's law (1908), its middle and its scale as they are."""
    from scipy.optimize import least_squares

    low, middle, high = np.quantile(x, [0.25, 0.5, 0.75])
    unit = max(high - low, 1e-300)

    def law(v: np.ndarray) -> np.ndarray:
        freedom, scale = np.exp(v[:2])
        return np.asarray(
            v[3] - 0.5 * (freedom + 1) * np.log1p(((x - middle) / unit - v[2]) ** 2 / (freedom * scale**2))
        )

    start = np.array([1.0, -0.5, 0.0, float(logarithm.max())])
    found = least_squares(lambda v: law(v) - logarithm, start, max_nfev=100).x
    freedom, scale, center = float(np.exp(found[0])), unit * float(np.exp(found[1])), middle + unit * float(found[2])
    if _follows(law(found), logarithm) and freedom < _MOST:
        yield Hypothesis(
            "another parameter",
            f"these samples fit Student's law with {{value}} degrees of freedom; the pdf's are {freedom:.4g}",
            lambda s, nu: lambda x: (1 + ((x - center) / scale) ** 2 / nu) ** (-0.5 * (nu + 1)),
            tuple(freedom * f for f in _FACTORS),
            null=freedom,
        )


def _follows(law: np.ndarray, logarithm: np.ndarray) -> bool:
    return float(np.var(logarithm - law)) <= _LEFT * float(np.var(logarithm))
