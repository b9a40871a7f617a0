"""The phase functions that everybody uses: the samples follow one of them, or the claim is one with another parameter."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_ALONG = 0.03  # from a coordinate axis: such a lobe is meant to be about it
_CHANCE = 5.0  # standard errors of a mean direction
_LINEAR = 1e-6  # share of the variance of a logarithm that a line leaves
_CONSTANT = 0.02  # deviation of the logarithm of a ratio of two lobes that are one
_TOP, _EDGE = 0.9, 0.02  # share of a claim that lies below its top, and beyond its skirts
_SKIRTS = 0.1  # of the greatest density of a lobe
_TOGETHER = 0.5  # mean length of the directions at the top of a lobe
_FALLS = 0.7  # rank correlation of a lobe's density with the cosine to its top
_LEAN = 0.03  # mean length of directions that have a direction


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield the phase functions that everybody uses, about the mean direction of the claim, or z if it has none."""
    mean = setting.claimed_mean()
    length = float(np.linalg.norm(mean))
    axis = mean / length if length > _LEAN else np.array([0.0, 0.0, 1.0])
    off = float(np.linalg.norm(axis - np.rint(axis)))
    chance = _CHANCE / (length * math.sqrt(len(setting.contrast.x))) if length > _LEAN else 0.0
    if off < _ALONG or (off < chance and _known(setting, np.rint(axis))):
        axis = np.rint(axis)
    own = f"; the pdf's mean cosine is {length:.4g}" if length > _LEAN else ""

    def about(f: Callable[[np.ndarray, float], np.ndarray], null: float | None) -> Callable[[Setting, float], Density]:
        if null is None:
            return lambda s, value: lambda x: f(x @ axis, value)
        return lambda s, value: lambda x: s.p(x) * f(x @ axis, value) / f(x @ axis, null)  # whatever else the claim has

    g = (-0.95, -0.8, -0.6, -0.3, 0.05, 0.3, 0.6, 0.8, 0.9, 0.97)
    kappas = (0.5, 2.0, 8.0, 32.0, 128.0, 1000.0)
    kappa = _kappa(setting, axis)
    near = () if kappa is None else (0.9 * kappa, 1.1 * kappa)
    for law, f, trials, null in (
        ("Henyey-Greenstein with g", henyey_greenstein, g, _own(setting, axis, henyey_greenstein)),
        ("Schlick's phase function with k", schlick, g, _own(setting, axis, schlick)),
        ("a von Mises-Fisher lobe with kappa", _fisher, tuple(sorted({*kappas, *near})), kappa),
    ):
        yield Hypothesis(
            "another law" if null is None else "another parameter",
            f"these samples fit {law} = {{value}}" + (own if null is None else f"; the pdf's is {null:.4g}"),
            about(f, null),
            trials,
            fitted=null is None,  # which law
            null=null,
        )
    yield Hypothesis(
        "another law", "these samples fit Rayleigh's phase function", about(lambda mu, _: 1 + mu * mu, None)
    )


def powers(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that a lobe of any law is broader or narrower: a power of the cosine, or an exponential, stays one."""
    if _lobe(setting):
        yield Hypothesis(
            "another parameter",
            "these samples fit the pdf raised to the power {value}, as of a broader or a narrower lobe",
            lambda s, a: lambda x: np.maximum(s.p(x), 0.0) ** a,
            (0.3, 0.6, 0.8, 0.95, 1.05, 1.25, 1.7, 3.0),
            null=1.0,
            power=True,
        )


def _known(setting: Setting, axis: np.ndarray) -> bool:
    """Return whether the claim is a phase function that everybody uses, about an axis."""
    laws = henyey_greenstein, schlick
    return _kappa(setting, axis) is not None or any(_own(setting, axis, f) is not None for f in laws)


def _lobe(setting: Setting) -> bool:
    """Return whether the claim falls from one direction on, down to little where it ends: a lobe, and no lit piece of a plane."""
    x = setting.claimed_points(512)
    p, n = setting.p(x), len(setting.contrast.x)
    ends = bool(np.any(setting.values[n:] <= 0))
    if ends and np.quantile(p, _EDGE) > _SKIRTS * p.max():
        return False
    top = x[p >= np.quantile(p, _TOP)].mean(axis=0)
    if np.linalg.norm(top) < _TOGETHER:
        return False
    rank, place = (np.argsort(np.argsort(v)) for v in (p, x @ top))
    return bool(np.corrcoef(rank, place)[0, 1] > _FALLS)


def _fisher(mu: np.ndarray, kappa: float | np.ndarray) -> np.ndarray:
    return np.exp(kappa * (mu - 1))


def _kappa(setting: Setting, axis: np.ndarray) -> float | None:
    """Return the parameter of a claim that is a von Mises-Fisher lobe itself, None if it is none: its logarithm is linear."""
    x = setting.claimed_points(512)
    p = setting.p(x)
    if not np.all(p > 0):
        return None
    versine = 0.5 * np.sum((x - axis) ** 2, axis=1)
    scale = float(versine.mean())
    slope, level = np.polyfit(versine / scale, np.log(p), 1)
    left, kappa = np.log(p) - level - slope * versine / scale, -float(slope) / scale
    return kappa if kappa > _LEAN and np.var(left) < _LINEAR * np.var(np.log(p)) else None


def henyey_greenstein(mu: np.ndarray, g: float | np.ndarray) -> np.ndarray:
    """Return the law of Henyey & Greenstein (1941), up to a constant factor that does not depend on mu."""
    return np.asarray((1 - g * g) / np.maximum(1 + g * g - 2 * g * mu, 1e-12) ** 1.5)


def schlick(mu: np.ndarray, k: float | np.ndarray) -> np.ndarray:
    """Return the law of Schlick (1993)."""
    return np.asarray((1 - k * k) / np.maximum(1 - k * mu, 1e-9) ** 2)


def _own(setting: Setting, axis: np.ndarray, f: Callable[[Any, Any], np.ndarray]) -> float | None:
    """Return the parameter of a claim that is such a lobe itself, None if it is none: its ratio to one as wide is a constant."""
    x = setting.claimed_points(512)
    p, mu = setting.p(x), x @ axis
    if not np.all(p > 0):
        return None
    ends = np.argmax(mu), np.argmin(mu)
    target = np.log(p[ends[0]] / p[ends[1]])
    best, room = 0.0, 0.999
    for _ in range(3):
        values = np.linspace(max(best - room, -0.999), min(best + room, 0.999), 401)
        own = np.log(f(mu[ends[0]], values) / f(mu[ends[1]], values))
        best, room = float(values[int(np.argmin(np.abs(own - target)))]), 0.01 * room
    return best if np.std(np.log(p) - np.log(f(mu, best))) < _CONSTANT else None
