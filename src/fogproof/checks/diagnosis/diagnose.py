"""From findings to a cause: hypotheses about the samples are fitted, and the likeliest is told with what it leaves unexplained."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from fogproof.checks.diagnosis import directions, holes, lines, numbers, parts, regions
from fogproof.checks.diagnosis.causes import likely_cause
from fogproof.checks.diagnosis.contrast import Contrast, Fit, claimed
from fogproof.checks.diagnosis.factors import named_factor
from fogproof.checks.diagnosis.fitting import Explained, likeliest, nearest, sharpened
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting
from fogproof.checks.diagnosis.patience import OutOfTimeError, limited
from fogproof.checks.diagnosis.points import single_points
from fogproof.checks.statistics.repeats import KEPT
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.checks.verdict import Finding
from fogproof.domains import Discrete, HalfLine, Interval, Product, RealLine, UnitHemisphere, UnitSphere
from fogproof.errors import shorten

_PLACES = {"skipped band", "missing tail", "missing patch"}  # told by one place alone: only if that explains the misfit
_STATISTICAL = {"shape", "skipped band", "missing tail", "missing patch", "sign convention", "correlation"}
_CONSTANT = {"normalisation", "wrong measure"}
_MOVES = {"sign convention", "swapped axes", "wrong scale", "shifted", "wrong power", "missing Jacobian"}
_ANYTHING = {"mixture", "uniform law", "another law"}  # laws that a hole in the pdf makes likelier
_ZERO = {"claimed hole"}  # as of a law that lies elsewhere, or only of one place
_SYMPTOMS = {
    "wrong pdf returned",
    "wrong weight",
    "wrong formula",
    "edge of the uniforms",
}  # that a wrong law brings along
_SIZES = (1 << 14, 1 << 16, 1 << 18)  # samples: as few as show the misfit plainly
_SMALL = 1 << 20  # samples that tell a misfit which does not show in so many
_PLAIN = 1000.0  # chi-square that is plain
_STANDS_OUT = 12.0  # of likelihood that a hypothesis gains, where cells alone do not show the misfit
_MISFIT = 4.0  # standard deviations of a chi-square that is no chance
_LOOKED = 1 << 14  # samples among which single points are looked for
_NOTHING = 1e-6  # an integral
_CHANCE = 5.0  # standard errors that chance makes
_FITS = 0.98  # the same of a law that has nothing to do with the claim
_EXPLAINS = 0.9  # of the misfit: a hypothesis that explains less is not told


def diagnosed(
    subject: Subject, findings: Sequence[Finding], samples: int, seed: int, seconds: float = math.inf
) -> tuple[str, str]:
    """Return the likely cause of a rejection, and in words what explains the misfit; both "" if nothing was rejected.

    samples  how many samples the verdict is of: not many more are drawn to explain it
    seconds  after which the subject is asked no more; the cause is then what the findings say
    """
    subject = limited(subject, seconds)
    cause = likely_cause(findings)
    statistical = any(f.outcome == "rejected" and f.p_value is not None and f.cause in _STATISTICAL for f in findings)
    if cause == "negative pdf":
        return cause, _exponential(subject, samples, seed)
    if cause in {"atom"} | _CONSTANT | _STATISTICAL or (cause in _SYMPTOMS | _ZERO and statistical):
        try:
            with np.errstate(all="ignore"):
                named, words = ("", "") if cause in _CONSTANT else single_points(subject, samples, seed)
                if named != "clamped" and cause == "atom" and statistical:
                    other = _searched(subject, "shape", findings, samples, seed)
                    if other[1] and other[0] in _MOVES:  # and rounding gathers samples where it takes them
                        return other
                if named == "clamped" or cause == "atom":
                    return named or cause, words
                return _searched(subject, cause, findings, samples, seed)
        except OutOfTimeError:
            return cause, f"the search for what explains it was ended after {seconds:.0f} s"
        except (
            Exception
        ):  # the user's density is asked at points that no sampler gave: a verdict is worth more than its cause
            return cause, ""
    return cause, ""


def _searched(
    subject: Subject,
    cause: str,
    findings: Sequence[Finding],
    samples: int,
    seed: int,
) -> tuple[str, str]:
    """Return the cause, and in words what explains the misfit, by the hypotheses that belong to a first guess at the cause."""
    rejected = {f.check: f for f in findings if f.outcome == "rejected"}
    integral = rejected.get("normalisation")
    if cause in _CONSTANT:
        point = _undeclared_atom(subject, integral, rejected.get("repeated points"), samples, seed)
        if point:
            return "atom", point
        if integral is not None and _off_by_atoms(integral, findings, samples):
            return "wrong probability of an atom", rejected["atom"].message
        if integral is not None:
            return _constant(subject, integral, cause, samples, seed)
    found = _contrasted(subject, samples, seed)
    if found is None:
        return cause, ""
    setting, base = found
    if cause in _CONSTANT and not base.left > _MISFIT * math.sqrt(2 * base.freedom):
        return cause, _factor(base)
    by_labels = any(f.check == "normalisation" and f.resolution is None for f in findings)
    if cause == "shape" and by_labels and base.left < _MISFIT * math.sqrt(2 * base.freedom) and _factor(base):
        return "normalisation", _factor(base)
    best = _explained(subject, setting, base, samples, seed)
    if best is not None and not (cause in _ZERO and best.hypothesis.cause in _ANYTHING):
        return best.hypothesis.caused(best.value, best.error), best.words
    return "shape" if cause in _PLACES and base.left > _PLAIN else cause, ""


def _undeclared_atom(
    subject: Subject, integral: Finding | None, repeats: Finding | None, samples: int, seed: int
) -> str:
    """Return in words that a point which comes again has the probability that the integral lacks, "" if there is no such point."""
    if integral is None or repeats is None or integral.effect is None or repeats.effect is None:
        return ""
    lacking, share, n = -integral.effect, repeats.effect, min(samples, KEPT)
    if abs(lacking - share) > _CHANCE * math.sqrt(share * (1 - share) / n) + 2 / n + 1e-3:
        return ""
    x = subject.draw(batch_generator(seed, "diagnosis", 1, 0), min(samples, _LOOKED)).x
    points, counts = np.unique(x, axis=0, return_counts=True)
    if 1 - lacking < _NOTHING:
        return f"all samples are one of few points, {len(points)} among {len(x)}: such a law has no density"
    often = points[np.argmax(counts)]
    words = f"samples come back to single points, such as {shorten(often)}, with the probability {lacking:.4g} that the pdf lacks"
    return f"{words}: declare them, atoms={{point: probability}}"


def _off_by_atoms(integral: Finding, findings: Sequence[Finding], samples: int) -> bool:
    """Return whether what the atoms' probabilities are off by is what the sum of pdf and atoms is off by."""
    atoms = [f for f in findings if f.check == "atom"]
    if integral.effect is None or not any(f.outcome == "rejected" for f in atoms):
        return False
    return abs(integral.effect + sum(f.effect or 0.0 for f in atoms)) < _CHANCE * math.sqrt(len(atoms) / samples)


def _factor(base: Fit) -> str:
    """Return in words the constant factor that is all that is wrong with the pdf."""
    if not (base.constant > 0 and abs(math.log(base.constant)) > _CHANCE * base.doubt):
        return ""
    factor = 1 / base.constant
    words = f"the samples fit the pdf but for a constant factor {factor:.4g} +- {base.doubt * factor:.1g}"
    name = named_factor(factor, base.doubt * factor)
    return f"{words}, that is {name}" if name else words


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


def _contrasted(subject: Subject, samples: int, seed: int) -> tuple[Setting, Fit] | None:
    """Return as few samples as show the misfit plainly, and how the claim itself explains them; None if there are too few."""
    setting: Setting | None = None
    least = 1 << 12 if subject.pilot is None else 0  # of samples that are there already, no more can be drawn
    for n in _SIZES:
        setting = _setting(subject, min(n, max(samples, least)), seed)
        if setting is None:
            return None
        base = setting.contrast.fit(setting.p(setting.contrast.points))
        if base.left > _PLAIN or n >= samples:
            break
    return None if setting is None else (setting, base)


def _explained(subject: Subject, setting: Setting, base: Fit, samples: int, seed: int) -> Explained | None:
    """Return the hypothesis that explains the misfit, None if none does."""
    chance = _MISFIT * math.sqrt(2 * base.freedom)
    if (
        base.left < chance
    ):  # a small smooth misfit hides among many cells, and stands out against the hypothesis that it is
        small = _small(subject, setting, samples, seed)
        if small is not None:
            return small
    best = likeliest(setting, base, [*_of_domain(setting), *holes.hypotheses(setting)])
    if best is None:
        return None
    gain = best.fit.likelihood - base.likelihood
    if base.left < chance and gain < _STANDS_OUT:
        return None
    if best.share < _needed(best.hypothesis) and not (best.fit.left < chance and gain > _STANDS_OUT):
        return None
    large = _setting(subject, min(_SIZES[-1], samples), seed) if best.hypothesis.trials else None
    return best if large is None else sharpened(large, best)


def _small(subject: Subject, setting: Setting, samples: int, seed: int) -> Explained | None:
    """Return the hypothesis that a misfit hardly seen in the cells is, None if none stands out."""
    large = setting if samples <= _SIZES[-1] else _setting(subject, min(_SMALL, samples), seed)
    if large is None:
        return None
    base = large.contrast.fit(large.p(large.contrast.points))
    best = nearest(setting, large, base, [*_of_domain(setting), *holes.hypotheses(setting)])
    if best is None or best.fit.left > _MISFIT * math.sqrt(2 * best.fit.freedom):
        return None
    return best if best.fit.likelihood - base.likelihood > _STANDS_OUT else None


def _needed(hypothesis: Hypothesis) -> float:
    """Return the share of the misfit that a hypothesis must explain: another law is nothing like the claim, and easily nearer."""
    return _FITS if hypothesis.cause == "another law" else _EXPLAINS


def _of_domain(setting: Setting) -> Iterator[Hypothesis]:
    match setting.domain:
        case UnitSphere() | UnitHemisphere():
            return directions.hypotheses(setting)
        case Interval() | HalfLine() | RealLine():
            return lines.hypotheses(setting)
        case Discrete():
            return numbers.hypotheses(setting)
        case Product() as product:
            return parts.hypotheses(setting, product, _of_domain)
    if setting.domain.shape == (3,) and np.allclose(np.sum(setting.contrast.x[:99] ** 2, axis=1), 1):
        return directions.hypotheses(setting)
    return regions.hypotheses(setting) if len(setting.domain.shape) == 1 else iter(())


def _constant(subject: Subject, integral: Finding, cause: str, samples: int, seed: int) -> tuple[str, str]:
    """Return what a wrong integral of the pdf comes from: a constant that can be named, or a pdf where nothing is sampled."""
    setting = _setting(subject, min(_SIZES[0], samples), seed)
    if setting is None or integral.effect is None:
        return cause, ""
    base = setting.contrast.fit(setting.p(setting.contrast.points))
    if base.left > _MISFIT * math.sqrt(2 * base.freedom):
        best = likeliest(setting, base, list(holes.hypotheses(setting))[:-1])
        if best is not None and best.share > 0.8 and abs(best.fit.constant - 1) < 0.1:
            return "pdf outside the support", f"the pdf is right where samples are, and not 0 elsewhere: {best.words}"
        best = likeliest(setting, base, list(_of_domain(setting)))
        if best is None or best.share < _needed(best.hypothesis):
            return cause, ""
        return cause if cause == "wrong measure" else best.hypothesis.caused(best.value, best.error), best.words
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
