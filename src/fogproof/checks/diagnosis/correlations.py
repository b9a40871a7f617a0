"""What goes wrong with coordinates that depend on each other linearly: another correlation, a Cholesky factor transposed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from itertools import combinations

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_MOST = 4  # coordinates
_POINTS = 2048
_QUADRATIC = 1e-6  # share of the variance of a logarithm that a quadratic form leaves
_APART = 0.03  # correlation that points of the known law tell from none
_TRIALS = (-0.9, -0.6, -0.3, -0.05, 0.05, 0.3, 0.6, 0.9)


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what a linear map may have made of points (n, k) of all space, k at least 2."""
    told = _moments(setting)
    if told is None:
        return
    mean, covariance = told
    k = len(mean)
    deviation = np.sqrt(np.diag(covariance))
    root = np.linalg.cholesky(covariance)
    correlation = covariance / np.outer(deviation, deviation)
    if np.abs(correlation - np.eye(k)).max() > _APART:
        words = "these samples fit the pdf with the Cholesky factor of its covariance transposed"
        yield Hypothesis("transposed matrix", words, partial(_moved, mean, root @ np.linalg.inv(root.T)))
    for i, j in combinations(range(k), 2):
        own = float(correlation[i, j])
        trials = sorted({round(math.tanh(math.atanh(own) + step), 4) for step in _TRIALS})
        yield Hypothesis(
            "correlation",
            f"these samples fit the pdf with a correlation {{value}} of the columns {i} and {j}; the pdf's is {own:.4g}",
            partial(_correlated, mean, covariance, (i, j)),
            tuple(trials),
            null=own,
        )


def _moments(setting: Setting) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the mean (k,) and the covariance (k, k) of the claim, exactly of a normal law; None if it has none to be used."""
    z, n = setting.contrast.z, len(setting.contrast.x)
    if z.ndim != 2 or not 2 <= z.shape[1] <= _MOST:
        return None
    weight = setting.values[n:] / setting.contrast.q[n:]
    weight = weight / max(float(weight.sum()), 1e-300)
    mean = weight @ z
    covariance = (weight[:, None] * (z - mean)).T @ (z - mean)
    normal = _of_normal_law(setting, mean, np.sqrt(np.maximum(np.diag(covariance), 0.0)))
    mean, covariance = normal or (mean, covariance)
    good = np.all(np.isfinite(covariance)) and np.linalg.eigvalsh(covariance)[0] > 1e-9 * np.trace(covariance)
    return (mean, covariance) if good else None


def _of_normal_law(setting: Setting, near: np.ndarray, unit: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return mean and covariance of a claim whose logarithm is a quadratic form, None of any other."""
    x = setting.claimed_points(_POINTS)
    p = setting.p(x)
    if not (np.all(unit > 0) and np.all((p > 0) & np.isfinite(p))):
        return None
    y, k = (x - near) / unit, len(near)
    pairs = [(i, j) for i in range(k) for j in range(i, k)]
    columns = np.column_stack([np.ones(len(y)), y, *(y[:, i] * y[:, j] for i, j in pairs)])
    logarithm = np.log(p)
    found = np.linalg.lstsq(columns, logarithm, rcond=None)[0]
    if not float(np.var(logarithm - columns @ found)) <= _QUADRATIC * float(np.var(logarithm)):
        return None
    precision = np.zeros((k, k))
    for (i, j), value in zip(pairs, found[k + 1 :].tolist(), strict=True):
        precision[i, j] -= value
        precision[j, i] -= value
    covariance = np.linalg.inv(precision)
    return near + unit * (covariance @ found[1 : k + 1]), covariance * np.outer(unit, unit)


def _correlated(
    mean: np.ndarray, covariance: np.ndarray, pair: tuple[int, int], setting: Setting, value: float
) -> Density:
    """Return the claim with another correlation of two of its columns, their deviations as they are."""
    other, (i, j) = covariance.copy(), pair
    other[i, j] = other[j, i] = float(np.clip(value, -0.9999, 0.9999)) * math.sqrt(covariance[i, i] * covariance[j, j])
    roots = np.linalg.cholesky(covariance), np.linalg.cholesky(other)
    return _moved(mean, roots[0] @ np.linalg.inv(roots[1]), setting, value)


def _moved(mean: np.ndarray, back: np.ndarray, setting: Setting, _: float) -> Density:
    """Return the density of points whose images under x -> mean + back (x - mean) have the claimed one."""
    return lambda x: setting.p(mean + (x - mean) @ back.T)
