"""From findings to a cause: hypotheses about the samples are fitted, and the likeliest is told with what it leaves unexplained."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.diagnosis import directions, holes, lines, numbers, regions
from fogproof.checks.diagnosis.causes import likely_cause
from fogproof.checks.diagnosis.contrast import Contrast, Fit, claimed
from fogproof.checks.diagnosis.factors import named_factor
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.checks.verdict import Finding
from fogproof.domains import Discrete, HalfLine, Interval, RealLine, UnitHemisphere, UnitSphere

_STATISTICAL = {"shape", "skipped band", "missing tail", "missing patch", "sign convention", "correlation"}
_CONSTANT = {"normalisation", "wrong measure"}
_SYMPTOMS = {
    "wrong pdf returned",
    "wrong weight",
    "wrong formula",
    "edge of the uniforms",
}  # that a wrong law brings along
_SIZES = (1 << 14, 1 << 16, 1 << 18)  # samples: as few as show the misfit plainly
_PLAIN = 1000.0  # chi-square that is plain
_SCREENED = 1 << 12  # samples on which all hypotheses are tried first, with a few parameters each
_TRIED = 12  # of them that are fitted closer, on as many samples as show the misfit
_TELLING, _MOST = 200.0, 1 << 16  # chi-square of the misfit on those samples, and most of them
_KEPT = 3  # of those that are fitted on all samples
_STANDS_OUT = 25.0  # of likelihood that a hypothesis gains, where cells alone do not show the misfit
_CHANCE = 5.0  # standard errors that chance makes
_EXPLAINS = 0.9  # of the misfit: a hypothesis that explains less is not told


@dataclass(frozen=True)
class Explained:
    """A fitted hypothesis, its parameter with a standard error, how it fits, and the share of the misfit that it explains."""

    hypothesis: Hypothesis
    value: float
    error: float
    fit: Fit
    share: float

    @property
    def words(self) -> str:
        """The explanation as a sentence."""
        return f"{self.hypothesis.said(self.value, self.error)} (this explains {self.share:.0%} of the misfit)"


def diagnosed(subject: Subject, findings: Sequence[Finding], samples: int, seed: int) -> tuple[str, str]:
    """Return the likely cause of a rejection, and in words what explains the misfit; both "" if nothing was rejected.

    samples  how many samples the verdict is of: not many more are drawn to explain it
    """
    cause = likely_cause(findings)
    statistical = any(f.outcome == "rejected" and f.p_value is not None and f.cause in _STATISTICAL for f in findings)
    if cause == "negative pdf":
        return cause, _exponential(subject, samples, seed)
    if cause in _CONSTANT | _STATISTICAL or (cause in _SYMPTOMS and statistical):
        integral = next((f for f in findings if f.check == "normalisation" and f.outcome == "rejected"), None)
        try:
            with np.errstate(all="ignore"):
                if cause in _CONSTANT and integral is not None:
                    return _constant(subject, integral, cause, samples, seed)
                best = _explained(subject, samples, seed)
        except (
            Exception
        ):  # the user's density is asked at points that no sampler gave: a verdict is worth more than its cause
            return cause, ""
        if best is not None:
            return best.hypothesis.caused(best.value, best.error), best.words
    return cause, ""


def _exponential(subject: Subject, samples: int, seed: int) -> str:
    """Return in words that a pdf is the logarithm of one, if its exponential integrates to 1; "" if it does not."""
    try:
        with np.errstate(all="ignore"):
            contrast = Contrast.of(subject, min(_SIZES[0], samples), batch_generator(seed, "diagnosis", 0, _SIZES[0]))
            if contrast is None:
                return ""
            ratio = np.exp(subject.density(contrast.z)) / contrast.q[len(contrast.x) :]
    except Exception:  # as above
        return ""
    integral, error = float(ratio.mean()), float(ratio.std()) / math.sqrt(len(ratio))
    if not abs(integral - 1) < _CHANCE * error + 1e-3:
        return ""
    return f"exp(pdf) integrates to {integral:.4f} +- {error:.1g}: it is the logarithm of a pdf"


def _setting(subject: Subject, n: int, seed: int) -> Setting | None:
    contrast = Contrast.of(subject, n, batch_generator(seed, "diagnosis", 0, n))
    return None if contrast is None else Setting(subject.domain, contrast.law, claimed(subject), contrast)


def _explained(subject: Subject, samples: int, seed: int) -> Explained | None:
    setting: Setting | None = None
    least = 1 << 12 if subject.pilot is None else 0  # of samples that are there already, no more can be drawn
    for n in _SIZES:
        setting = _setting(subject, min(n, max(samples, least)), seed)
        if setting is None:
            return None
        base = setting.contrast.fit(setting.p(setting.contrast.points))
        if base.left > _PLAIN or n >= samples:
            break
    if setting is None:
        return None
    best = _best(setting, base, [*_of_domain(setting), *holes.hypotheses(setting)])
    if best is None or best.share < _EXPLAINS:
        return None
    # A small smooth misfit hides among many cells, and stands out against the hypothesis that it is.
    if base.left < 4 * math.sqrt(2 * base.freedom) and best.fit.likelihood - base.likelihood < _STANDS_OUT:
        return None
    large = _setting(subject, min(_SIZES[-1], samples), seed) if best.hypothesis.trials else None
    return best if large is None else _sharpened(large, best)


def _of_domain(setting: Setting) -> Iterator[Hypothesis]:
    match setting.domain:
        case UnitSphere() | UnitHemisphere():
            return directions.hypotheses(setting)
        case Interval() | HalfLine() | RealLine():
            return lines.hypotheses(setting)
        case Discrete():
            return numbers.hypotheses(setting)
    if setting.domain.shape == (3,) and np.allclose(np.sum(setting.contrast.x[:99] ** 2, axis=1), 1):
        return directions.hypotheses(setting)
    return regions.hypotheses(setting) if len(setting.domain.shape) == 1 else iter(())


def _best(setting: Setting, base: Fit, hypotheses: list[Hypothesis]) -> Explained | None:
    """Return the hypothesis of the greatest likelihood, parameters paid for by Schwarz's criterion; earlier ones win ties."""
    n = len(setting.contrast.x)
    small = replace(setting, contrast=setting.contrast.part(_SCREENED))
    middle = replace(
        setting, contrast=setting.contrast.part(min(max(int(_TELLING * n / max(base.left, 1.0)), _SCREENED), _MOST))
    )
    tried = []
    for order, hypothesis in enumerate(hypotheses):
        values = hypothesis.trials or (0.0,)
        scores = [_likelihood(small, hypothesis, value) for value in values]
        at = int(np.argmax(scores))
        score, value, low, high = scores[at], values[at], values[max(at - 1, 0)], values[min(at + 1, len(values) - 1)]
        if hypothesis.trials:
            value, score = max((value, score), _fitted(small, hypothesis, low, high, 8), key=lambda one: one[1])
        tried.append((score, -order, hypothesis, value, 0.5 * (high - low)))
    tried.sort(key=lambda one: one[:2], reverse=True)
    closer = []
    for score, order, hypothesis, value, room in tried[:_TRIED]:
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
        fit = setting.contrast.fit(hypothesis.density(setting, value)(setting.contrast.points))
        share = 1 - max(fit.left - 2 * math.sqrt(2 * fit.freedom), 0.0) / max(base.left, 1.0)
        score = fit.likelihood - hypothesis.price(n)
        found.append((score + 1.5 * order / len(hypotheses), order, Explained(hypothesis, value, error, fit, share)))
    return max(found, key=lambda one: one[:2])[2] if found else None


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


def _sharpened(setting: Setting, found: Explained) -> Explained:
    """Return the same hypothesis with its parameter fitted to more samples."""
    value, error = _polished(setting, found.hypothesis, found.value, found.error)
    return replace(found, value=value, error=error)


def _polished(setting: Setting, hypothesis: Hypothesis, value: float, error: float) -> tuple[float, float]:
    """Return a parameter and its standard error on more samples than it was fitted to, by parabolas through the likelihood."""
    for _ in range(2):
        below, at, above = (_likelihood(setting, hypothesis, value + step) for step in (-error, 0.0, error))
        curvature = (2 * at - below - above) / error**2
        if not (curvature > 0 and math.isfinite(curvature)):
            break
        value += float(np.clip((above - below) / (2 * error * curvature), -3 * error, 3 * error))
        error = 1 / math.sqrt(curvature)
    return value, error


def _constant(subject: Subject, integral: Finding, cause: str, samples: int, seed: int) -> tuple[str, str]:
    """Return what a wrong integral of the pdf comes from: a constant that can be named, or a pdf where nothing is sampled."""
    setting = _setting(subject, min(_SIZES[0], samples), seed)
    if setting is None or integral.effect is None:
        return cause, ""
    base = setting.contrast.fit(setting.p(setting.contrast.points))
    if base.left > 4 * math.sqrt(2 * base.freedom):
        best = _best(setting, base, list(holes.hypotheses(setting))[:-1])
        if best is not None and best.share > 0.8 and abs(best.fit.constant - 1) < 0.1:
            return "pdf outside the support", f"the pdf is right where samples are, and not 0 elsewhere: {best.words}"
        return cause, ""
    error = integral.resolution.value if integral.resolution else 0.0
    more = {
        "the measure of the domain": subject.domain.measure,
        "1/(the measure of the domain)": 1 / subject.domain.measure,
    }
    if subject.albedo is not None and np.ndim(subject.albedo) == 0:
        albedo = float(np.asarray(subject.albedo))
        more |= {"the albedo": albedo, "1/albedo": 1 / albedo if albedo else math.inf}
    more = {name: value for name, value in more.items() if math.isfinite(value)}
    factor = integral.effect + 1
    name = named_factor(factor, error, more)
    words = f"the samples fit the pdf but for a constant factor {factor:.6g}"
    return cause, f"{words}, that is {name}" if set(name) & set("piabth") else words
