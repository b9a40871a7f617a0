"""Which of many hypotheses explains the samples best: tried on a few of them, fitted on more, judged on all."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fogproof.checks.diagnosis.contrast import Fit
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting
from fogproof.doing import doing

_SCREENED = 1 << 12  # samples on which all hypotheses are tried first, with a few parameters each
_TRIED = 12  # of them that are fitted closer, on as many samples as show the misfit
_TELLING, _MOST = 200.0, 1 << 16  # chi-square of the misfit on those samples, and most of them
_FALLEN, _DOUBLED = 0.3, 16  # of log-likelihood beside its maximum; times at most that an error is doubled
TIE = 1.5  # of log-likelihood: the simplest hypothesis may have so much less than the last one
_APART = 3.0  # standard errors between a parameter and the claim's
_NEAR = 0.1  # of the way from the null to the nearest trial: a first step
_TELLING_NUMBERS = math.log(10)  # what it costs to choose among so many
_KEPT = 3  # of those that are fitted on all samples


@dataclass(frozen=True)
class Explained:
    """A fitted hypothesis, its parameter with a standard error, how it fits, and what it gains.

    score   log-likelihood less the price of the parameters, and a little for the simpler hypothesis
    simple  that little
    """

    hypothesis: Hypothesis
    value: float
    error: float
    fit: Fit
    score: float
    simple: float

    @property
    def words(self) -> str:
        """The explanation as a sentence."""
        return self.hypothesis.said(self.value, self.error)

    @property
    def cause(self) -> str:
        """The class of error."""
        return self.hypothesis.caused(self.value, self.error)

    @property
    def numbers(self) -> int:
        """How many numbers were taken from the samples; what is better known by a name is none."""
        free = self.hypothesis.trials and not self.hypothesis.named(self.value, self.error)
        return self.hypothesis.fitted + bool(free)

    def density(self, setting: Setting) -> np.ndarray:
        """Return the density that the samples would have, at all points."""
        return self.hypothesis.density(setting, self.value)(setting.contrast.points)


def likeliest(setting: Setting, base: Fit, hypotheses: list[Hypothesis]) -> list[Explained]:
    """Return hypotheses of the greatest likelihood, parameters paid for by Schwarz's criterion; earlier ones win ties."""
    n = len(setting.contrast.x)
    small = setting.part(_SCREENED)
    middle = setting.part(min(max(int(_TELLING * n / max(base.left, 1.0)), _SCREENED), _MOST))
    tried = []
    for order, hypothesis in enumerate(hypotheses):
        doing(f"looking for the cause: is it that {hypothesis.words.replace('{value}', '...')}?")
        values = hypothesis.trials or (0.0,)
        try:
            scores = [_likelihood(small, hypothesis, value) for value in values]
        except Exception:  # the user's density may refuse points that no sampler gave
            continue
        at = int(np.argmax(scores))
        score, value, low, high = scores[at], values[at], values[max(at - 1, 0)], values[min(at + 1, len(values) - 1)]
        if hypothesis.trials:
            value, score = max((value, score), _fitted(small, hypothesis, low, high, 8), key=lambda one: one[1])
        tried.append((score, -order, hypothesis, value, 0.5 * (high - low)))
    tried.sort(key=lambda one: one[:2], reverse=True)
    closer = []
    for score, order, hypothesis, value, room in tried[:_TRIED]:
        doing(f"looking closer: is it that {hypothesis.words.replace('{value}', f'{value:.4g}')}?")
        if hypothesis.trials:
            value, score = _fitted(middle, hypothesis, value - room, value + room, 12)
        else:
            score = _likelihood(middle, hypothesis, value)
        closer.append((score - hypothesis.price(len(middle.contrast.x)), order, hypothesis, value, 0.3 * room))
    closer.sort(key=lambda one: one[:2], reverse=True)
    found = []
    for _, order, hypothesis, value, room in closer[:_KEPT]:
        error = 0.0
        if hypothesis.trials:
            error = _error(middle, hypothesis, value, room)
            value, error = _polished(setting, hypothesis, value, error)
            if hypothesis.null is not None and abs(value - hypothesis.null) < _APART * error:
                continue  # nothing tells it from the claim
        found.append(judged(setting, hypothesis, value, error, TIE * order / len(hypotheses)))
    return sorted(found, key=lambda one: one.score, reverse=True)


def judged(setting: Setting, hypothesis: Hypothesis, value: float, error: float, simple: float) -> Explained:
    """Return how a hypothesis with a parameter explains the samples; `simple` is added to its score."""
    fit = setting.contrast.fit(hypothesis.density(setting, value)(setting.contrast.points))
    score = fit.likelihood - hypothesis.price(len(setting.contrast.x)) + simple
    if hypothesis.trials and hypothesis.named(value, error):  # one of few numbers, and none that was fitted
        score += max(0.5 * math.log(len(setting.contrast.x)) - _TELLING_NUMBERS, 0.0)
    return Explained(hypothesis, value, error, fit, score, simple)


def nearest(middle: Setting, setting: Setting, hypotheses: list[Hypothesis]) -> list[Explained]:
    """Return the likeliest hypotheses with a parameter close to what makes each the claim: a misfit that hardly shows is no other.

    middle  fewer samples, on which all are tried
    """
    at_null = _null_likelihood(middle)
    tried = []
    for order, hypothesis in enumerate(hypotheses):
        if hypothesis.null is None:
            continue
        step = _NEAR * min(abs(value - hypothesis.null) for value in hypothesis.trials)
        try:
            value, error, gain = _parabola(middle, hypothesis, hypothesis.null, step, at_null)
        except Exception:  # the user's density may refuse points that no sampler gave
            continue
        tried.append((gain - hypothesis.price(len(middle.contrast.x)), -order, hypothesis, value, error))
    found = []
    for _, order, hypothesis, value, error in sorted(tried, key=lambda one: one[:2], reverse=True)[:_KEPT]:
        value, error, _ = _parabola(setting, hypothesis, value, error, _likelihood(setting, hypothesis, value))
        found.append(judged(setting, hypothesis, value, error, TIE * order / len(hypotheses)))
    return sorted(found, key=lambda one: one.score, reverse=True)


def _null_likelihood(setting: Setting) -> float:
    return setting.contrast.likelihood(setting.values)


def _parabola(
    setting: Setting, hypothesis: Hypothesis, null: float, step: float, at: float
) -> tuple[float, float, float]:
    """Return the parameter, its standard error and the gain of likelihood, by a parabola about a value of likelihood `at`."""
    value, error, gain = null, step, 0.0
    for _ in range(3):
        below, above = (_likelihood(setting, hypothesis, null + d) for d in (-step, step))
        curvature = (2 * at - below - above) / step**2
        if not (curvature > 0 and math.isfinite(curvature)):
            return value, error, gain
        error = 1 / math.sqrt(curvature)
        slope = (above - below) / (2 * step)
        value, gain = null + slope / curvature, 0.5 * slope**2 / curvature
        if 0.3 * step < error < 10 * step:
            break
        step = error
    return value, error, gain


def _likelihood(setting: Setting, hypothesis: Hypothesis, value: float) -> float:
    points = setting.contrast.points
    likelihood = setting.contrast.likelihood(hypothesis.density(setting, value)(points))
    return likelihood if math.isfinite(likelihood) else -math.inf


def _fitted(setting: Setting, hypothesis: Hypothesis, low: float, high: float, tries: int) -> tuple[float, float]:
    """Return the likeliest parameter between two values, and its likelihood."""
    from scipy.optimize import minimize_scalar

    def loss(value: float) -> float:
        likelihood = _likelihood(setting, hypothesis, value)
        return -likelihood if math.isfinite(likelihood) else 1e300

    if hypothesis.trials[0] > 0:
        low = max(low, 0.5 * hypothesis.trials[0])
    options = {"xatol": 1e-6 * (high - low), "maxiter": tries}
    found = minimize_scalar(loss, bounds=(low, high), method="bounded", options=options)
    return float(found.x), -float(found.fun)


def _error(setting: Setting, hypothesis: Hypothesis, value: float, room: float) -> float:
    """Return the standard error of a fitted parameter, from the curvature of the likelihood."""
    step, error = 1e-3 * room, room
    for _ in range(3):
        below, at, above = (_likelihood(setting, hypothesis, value + d) for d in (-step, 0.0, step))
        curvature = (2 * at - below - above) / step**2
        error = 1 / math.sqrt(curvature) if curvature > 0 else room
        step = min(max(error, 1e-6 * room), 0.3 * room)
    return error


def sharpened(setting: Setting, found: Explained) -> Explained:
    """Return the same hypothesis judged on more samples, with its parameter fitted to them."""
    value, error = found.value, found.error
    if found.hypothesis.trials:
        value, error = _polished(setting, found.hypothesis, value, error)
    return judged(setting, found.hypothesis, value, error, found.simple)


def _polished(setting: Setting, hypothesis: Hypothesis, value: float, error: float) -> tuple[float, float]:
    """Return a parameter and its standard error on more samples than it was fitted to, by parabolas through the likelihood.

    Where the support of the density moves with it, the likelihood has steps: what makes it less likely is not taken.
    """
    best = -math.inf
    kept = value, error
    for _ in range(3):
        below, at, above = (_likelihood(setting, hypothesis, value + step) for step in (-error, 0.0, error))
        if at < best:
            break
        best, kept = at, (value, error)
        curvature = (2 * at - below - above) / error**2
        if not (curvature > 0 and math.isfinite(curvature)):
            break
        value += float(np.clip((above - below) / (2 * error * curvature), -3 * error, 3 * error))
        error = 1 / math.sqrt(curvature)
    return kept[0], _reach(setting, hypothesis, *kept)


def _reach(setting: Setting, hypothesis: Hypothesis, value: float, error: float) -> float:
    """Return an error, doubled until the likelihood falls on both sides as it does at a standard error, by 1/2 or nearly."""
    at = _likelihood(setting, hypothesis, value)
    for _ in range(_DOUBLED):
        if max(_likelihood(setting, hypothesis, value + step) for step in (-error, error)) <= at - _FALLEN:
            break
        error *= 2
    return error
