"""Which hypothesis explains a misfit: as few samples as show it plainly tell which may, many tell whether it does."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from itertools import chain

import numpy as np

from fogproof.checks.diagnosis import caps, directions, holes, lines, numbers, parts, regions, triangles, turns
from fogproof.checks.diagnosis.contrast import Contrast, Fit, claimed
from fogproof.checks.diagnosis.fitting import TIE, Explained, judged, likeliest, nearest, sharpened
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting
from fogproof.checks.diagnosis.integrated import left_on_a_line
from fogproof.checks.diagnosis.shape import unexplained, unseen
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.domains import (
    Discrete,
    HalfLine,
    Interval,
    Product,
    RealLine,
    Rotations,
    Triangle,
    UnitHemisphere,
    UnitSphere,
)

SIZES = (1 << 14, 1 << 16, 1 << 18)  # samples: as few as show the misfit plainly
PLAIN = 1000.0  # chi-square that is plain
_SMALL = 1 << 20  # samples that tell a misfit which does not show in so many
_MISFIT = 4.0  # standard deviations of a chi-square that is no chance
_STANDS_OUT = 12.0  # of log-likelihood that a hypothesis gains over the claim
_CLEARLY = 3.0  # of log-likelihood that tells two hypotheses apart, and one from a law that is a little off anywhere
_NO_CHANCE = (
    6.0  # the same: a right law leaves some in one of a hundred settings, and three times less of each that is more
)
_ALL_BUT = 0.9995  # of the misfit: the rest is what the numbers in a hypothesis, estimated from samples, are off
_ALL = 0.995  # of the misfit: as a whole percentage, it is all
_SAME = 1e-3  # of log-likelihood: two hypotheses that are one density
_CLOSE = 12.0  # of log-likelihood that more samples may make up
_FITS = 0.98  # the same of a law that has nothing to do with the claim
_EXPLAINS = 0.95  # of what can be gained: a hypothesis that gains less is not told

_PLACES = {"skipped band", "missing tail", "skipped region"}  # that no sample reaches

_NUMBER = re.compile(r"[-+]?[0-9][-+0-9.e]*")


def explanation(subject: Subject, setting: Setting, base: Fit, samples: int, seed: int) -> tuple[str, str] | None:
    """Return the class of error and the words of the one hypothesis that explains a misfit, None if none does.

    No general correction of the claim must gain clearly more, and it must leave little to such. Where another gains as much, and
    takes no more numbers from the samples, the class is "shape"; the words name both. What the samples refuse in its turn is said
    to be near, and its class is "shape" too, except that a place without samples is one whatever the others are.
    """
    many, found = _candidates(subject, setting, base, samples, seed)
    if not found:
        return None
    best = found[0]
    loose = best.hypothesis.loose
    beyond = 0.0 if loose else left_on_a_line(subject, many.contrast, best.hypothesis.density(many, best.value))
    gain, share = explained_by(many, best, beyond)
    if not _convincing(many, best, gain, share):
        return None
    if share < _ALL_BUT and not loose and (beyond > 0 or refused(many, best.fit, best.density(many))):
        most = f"{math.floor(1000 * share) / 10:.1f}%"
        told = f"near to, but not: {best.words} (this explains {most} of the misfit, and what is left is no chance)"
        return best.cause if best.cause in _PLACES else "shape", told
    least = share * gain / (gain + unseen(many.contrast))
    most = f"{share:.0%}" if least > _ALL else f"at least {math.floor(100 * least)}%"  # what more samples may show
    return _beside_rivals(best, found[1:], f"{best.words} (this explains {most} of the misfit)")


def _convincing(setting: Setting, best: Explained, gain: float, share: float) -> bool:
    """Return whether a hypothesis gains clearly over the claim and over general corrections of it, and nearly all there is."""
    needed = _FITS if best.hypothesis.cause == "another law" else _EXPLAINS
    return gain >= max(_STANDS_OUT, unexplained(setting.contrast, setting.values) - _CLEARLY) and share >= needed


def _beside_rivals(best: Explained, others: list[Explained], told: str) -> tuple[str, str]:
    """Return the class of error and the words of the best hypothesis beside others that explain as much."""
    near = [each for each in others if each.cause != best.cause and each.score > best.score - _CLEARLY]
    if not near:
        return best.cause, told
    if all(abs(each.fit.likelihood - best.fit.likelihood) < _SAME for each in near):
        return best.cause, f"{told}; that is the same as: {'; '.join(_different(best, near))}"
    if best.numbers < min(each.numbers for each in near):  # of laws that fit alike, the one that needed no fitting
        return best.cause, f"{told}; more samples would tell it from: {'; or '.join(_different(best, near))}"
    return "shape", f"several hypotheses explain it alike: {'; or '.join([best.words, *_different(best, near)])}"


def _different(best: Explained, others: list[Explained]) -> list[str]:
    """Return the words of others than the best, of those that differ by numbers alone the first."""
    told = {_NUMBER.sub("", each.words): each.words for each in (*reversed(others), best)}
    return [words for words in dict.fromkeys(told.values()) if words != best.words][::-1]


def explained_by(setting: Setting, found: Explained, beyond: float = 0.0) -> tuple[float, float]:
    """Return the log-likelihood that a hypothesis gains over the claim, and which share that is of what could be gained.

    beyond  what more is known to be left

    Where samples lie at density 0, whatever fills that hole gains nearly all: the share is of what is gained beyond filling it.
    """
    contrast = setting.contrast
    gain = found.score - contrast.likelihood(setting.values)
    if gain <= 0:
        return gain, 0.0
    left = max(unexplained(contrast, found.density(setting)), beyond)
    told = gain if left == 0 else found.score - max(contrast.likelihood(s) for s in (setting.values, _filled(setting)))
    return gain, max(told, 0.0) / (max(told, 0.0) + left)


def _filled(setting: Setting) -> np.ndarray:
    """Return the claim with a rate of the known law where it is 0: as many samples as lie there."""
    n, (s, q) = len(setting.contrast.x), (setting.values, setting.contrast.q)
    hole = ~(s > 0)
    lie, known = np.count_nonzero(hole[:n]), np.count_nonzero(hole[n:])
    if lie == 0 or known == 0 or lie == n:
        return s
    scale = float(np.sum(s[n:] / q[n:])) / (n - lie)  # of the claim, a sample
    return np.where(hole, scale * lie / known * q, s)


def refused(setting: Setting, fit: Fit, s: np.ndarray) -> bool:
    """Return whether the samples differ by more than chance from a density with values s, in cells or by a general correction."""
    if fit.left > _MISFIT * math.sqrt(2 * fit.freedom):
        return True
    return unexplained(setting.contrast, s) > _NO_CHANCE


def _candidates(
    subject: Subject, setting: Setting, base: Fit, samples: int, seed: int
) -> tuple[Setting, list[Explained]]:
    """Return many samples and hypotheses fitted to them, the likeliest first."""
    if base.left < _MISFIT * math.sqrt(2 * base.freedom):
        # a small smooth misfit hides among many cells, and stands out against the hypothesis that it is
        many = setting if samples <= SIZES[-1] else setting_of(subject, min(_SMALL, samples), seed)
        tried = hypotheses(setting)
        found = nearest(setting, many, tried) if many else []
        if many:  # a place that no sample reaches is no neighbour of the claim; few known points lie there
            bounded = tried if many is setting else hypotheses(many)
            found += [judged(many, each, 0.0, 0.0, 0.0) for each in bounded if each.cause in _PLACES]
            found.sort(key=lambda each: each.score, reverse=True)
        if many and found and found[0].fit.likelihood - many.contrast.likelihood(many.values) > _STANDS_OUT:
            return many, found
    found = likeliest(setting, base, hypotheses(setting))
    found = [each for each in found if each.score > found[0].score - _CLOSE]
    n = len(setting.contrast.x)
    many = setting_of(subject, min(SIZES[-1], samples), seed) if n < min(SIZES[-1], samples) else setting
    if many is None or many is setting:
        return setting, found
    better = [sharpened(many, each) for each in found]
    told = {_NUMBER.sub("", each.hypothesis.words) for each in found if not each.hypothesis.trials}
    if told:  # by numbers that samples gave, perhaps: many give better ones
        again = hypotheses(many)
        for order, each in enumerate(again):
            if not each.trials and _NUMBER.sub("", each.words) in told:
                better.append(judged(many, each, 0.0, 0.0, -TIE * order / len(again)))
    return many, sorted(better, key=lambda each: each.score, reverse=True)


def setting_of(subject: Subject, n: int, seed: int) -> Setting | None:
    """Return what hypotheses may look at, with about n samples; None if too few of them are points of the continuous part."""
    contrast = Contrast.of(subject, n, batch_generator(seed, "diagnosis", 0, n))
    return None if contrast is None else Setting.of(subject.domain, claimed(subject), contrast)


def contrasted(subject: Subject, samples: int, seed: int) -> tuple[Setting, Fit] | None:
    """Return as few samples as show the misfit plainly, and how the claim itself explains them; None if there are too few."""
    setting: Setting | None = None
    least = 1 << 12 if subject.pilot is None else 0  # of samples that are there already, no more can be drawn
    for n in SIZES:
        setting = setting_of(subject, min(n, max(samples, least)), seed)
        if setting is None:
            return None
        base = setting.contrast.fit(setting.values)
        if base.left > PLAIN or n >= samples:
            break
    return None if setting is None else (setting, base)


def hypotheses(setting: Setting) -> list[Hypothesis]:
    """Return what may have happened on such a domain, and what may happen on any."""
    return [*of_domain(setting), *caps.hypotheses(setting), *holes.hypotheses(setting)]


def of_domain(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened on such a domain, the simplest first."""
    match setting.domain:
        case UnitSphere() | UnitHemisphere():
            return directions.hypotheses(setting)
        case Interval() | HalfLine() | RealLine():
            return lines.hypotheses(setting)
        case Discrete():
            return numbers.hypotheses(setting)
        case Rotations():
            return turns.hypotheses(setting)
        case Triangle() as triangle:
            return chain(triangles.hypotheses(triangle), regions.hypotheses(setting))
        case Product() as product:
            return parts.hypotheses(setting, product, of_domain)
    if setting.domain.shape == (3,) and np.allclose(np.sum(setting.contrast.x[:99] ** 2, axis=1), 1):
        return directions.hypotheses(setting)
    return regions.hypotheses(setting) if len(setting.domain.shape) == 1 else iter(())
