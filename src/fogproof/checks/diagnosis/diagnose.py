"""From findings to a cause: hypotheses about the samples are fitted, and the likeliest is told with what it leaves unexplained."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fogproof.checks.diagnosis import holes
from fogproof.checks.diagnosis.branches import chosen_wrongly
from fogproof.checks.diagnosis.causes import likely_cause
from fogproof.checks.diagnosis.contrast import Contrast, Fit
from fogproof.checks.diagnosis.explaining import (
    PLAIN,
    SIZES,
    contrasted,
    explained_by,
    explanation,
    refused,
    setting_of,
)
from fogproof.checks.diagnosis.factors import differs_in_one_place, named_factor, scaled, scaled_or_lost
from fogproof.checks.diagnosis.fitting import likeliest
from fogproof.checks.diagnosis.flats import in_a_plane
from fogproof.checks.diagnosis.hypothesis import Setting
from fogproof.checks.diagnosis.patience import OutOfTimeError, limited
from fogproof.checks.diagnosis.periods import repeated
from fogproof.checks.diagnosis.points import few_values, single_points
from fogproof.checks.diagnosis.together import dependent
from fogproof.checks.map_density import NAME as MAP
from fogproof.checks.statistics.repeats import KEPT
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.checks.verdict import Finding
from fogproof.domains import Product
from fogproof.domains.law import whole_columns
from fogproof.errors import shorten

_PLACES = {"skipped band", "missing tail", "missing patch"}  # told by one place alone: only if that explains the misfit
_STATISTICAL = {"shape", "skipped band", "missing tail", "missing patch", "sign convention", "correlation"}
_CONSTANT = {"normalisation", "wrong measure"}
_ANYTHING = {"mixture", "uniform law", "another law"}  # laws that a hole in the pdf makes likelier
_SHARES = {"lost samples"}  # that have a share of their own
_ZERO = {"claimed hole"}  # as of a law that lies elsewhere, or only of one place
_SYMPTOMS = {
    "wrong pdf returned",
    "wrong weight",
    "wrong formula",
    "edge of the uniforms",
}  # that a wrong law brings along
_COARSE = "coarse numbers"  # as values that come again seem
_MOSTLY = 0.5  # of the samples at single points: a law without them is not what went wrong
_RIGHT = 0.8  # of a misfit that a place beyond the samples explains
_MISFIT = 4.0  # standard deviations of a chi-square that is no chance
_LOOKED = 1 << 14  # samples among which single points are looked for
_NOTHING = 1e-6  # an integral
_CHANCE = 5.0  # standard errors that chance makes


def diagnosed(
    subject: Subject, findings: Sequence[Finding], samples: int, seed: int, seconds: float = math.inf
) -> tuple[str, str]:
    """Return the likely cause of a rejection, and in words what explains the misfit; both "" if nothing was rejected.

    samples  how many samples the verdict is of: not many more are drawn to explain it
    seconds  after which the subject is asked no more; the cause is then what the findings say
    """
    subject = limited(subject, seconds)
    cause = likely_cause(findings)
    rejected = [f for f in findings if f.outcome == "rejected"]
    statistical = any(f.p_value is not None and f.cause in _STATISTICAL for f in rejected)
    if {f.check for f in rejected} == {MAP}:  # samples do not show it: they cannot tell its cause
        known = any(f.check == "normalisation" and f.resolution is not None for f in findings)
        return cause if known or cause == "shape" else "normalisation", ""
    if cause == "negative pdf":
        return cause, _exponential(subject, samples, seed)
    if cause == "repeated samples":
        return cause, repeated(subject, samples, seed)
    if cause in _SHARES and not statistical:
        return scaled_or_lost(findings)
    if cause in {"atom", _COARSE} | _CONSTANT | _STATISTICAL or (cause in _SYMPTOMS | _ZERO | _SHARES and statistical):
        try:
            with np.errstate(all="ignore"):
                named, words = _explained(subject, cause, findings, samples, seed)
        except OutOfTimeError:
            return cause, f"the search for what explains it was ended after {seconds:.0f} s"
        except (
            Exception
        ):  # the user's density is asked at points that no sampler gave: a verdict is worth more than its cause
            return cause, ""
        if named != "edge of the uniforms" and any(f.cause == "edge of the uniforms" for f in rejected):
            words = f"{words}; " * bool(words) + "the edge uniforms fail as well, see there"
        return named, words
    return cause, ""


def _explained(subject: Subject, cause: str, findings: Sequence[Finding], samples: int, seed: int) -> tuple[str, str]:
    """Return the cause and the words; what accounts for a share of the samples does not explain a law that is wrong beside it."""
    setting = setting_of(subject, min(SIZES[0], samples), seed)
    flat = in_a_plane(setting, subject.roundoff) if setting else ("", "")
    if flat[0]:  # two opposite azimuths lie in a plane: that they are two says more, but not than two equations do
        few = _few_values(subject, samples, seed) if flat[1].count(" = ") == 1 else ""
        return (_COARSE, few) if few else flat
    named, words, rest = ("", "", subject) if cause in _CONSTANT else single_points(subject, samples, seed)
    often = 0.0 if all(whole_columns(subject.domain)) else sum(rest.atoms.values()) - sum(subject.atoms.values())
    few = _few_values(subject, samples, seed) if cause in {_COARSE} | _STATISTICAL else ""
    if few and subject.domain.shape and named != "clamped":
        return _COARSE, few
    if named == "clamped" or (named == "atom" and often > _MOSTLY):  # with what lies beyond: all of its misfit
        return named, words
    if named == "sheet" and not few and (told := _beside_a_sheet(rest, words, findings, samples, seed)):
        return told
    if few or cause == _COARSE:
        return _COARSE, few
    again = any(f.check == "repeated points" and f.outcome == "rejected" for f in findings)
    if cause != "atom" and cause not in _SHARES and not (named == "atom" and again):
        return _searched(subject, cause, findings, samples, seed)
    own = cause if cause in _SHARES else named or cause
    beside = contrasted(rest, samples, seed)
    if beside is None or beside[1].left < _MISFIT * math.sqrt(2 * beside[1].freedom):
        return scaled_or_lost(findings) if cause in _SHARES and not words else (own, words)
    other, why = _searched(rest, "shape", findings, samples, seed)
    if cause in _SHARES:
        return other, f"{why}; " * bool(why) + "and the share of samples that are given up is another one"
    if not why and (few := few_values(beside[0].contrast, rest)):
        return "coarse numbers", few
    if not why and not words:  # of one coordinate alone: no point comes again, and nothing else explains it
        return own, ""
    why = why or "the law is another one between single points too"
    return other, f"{why}; besides, {words}" if words else why


def _few_values(subject: Subject, samples: int, seed: int) -> str:
    n = min(samples, SIZES[0])
    contrast = Contrast.of(subject, n, batch_generator(seed, "diagnosis", 0, n))
    return few_values(contrast, subject) if contrast else ""


def _beside_a_sheet(
    rest: Subject, words: str, findings: Sequence[Finding], samples: int, seed: int
) -> tuple[str, str] | None:
    """Return that one coordinate is a constant too often, and what is with the other samples; None if there are too few of them."""
    shown = contrasted(rest, samples, seed)
    if shown is None:
        return None
    if shown[1].left <= _MISFIT * math.sqrt(2 * shown[1].freedom):
        return "atom", f"{words}; the other samples fit the pdf"
    other, why = _searched(rest, "shape", findings, samples, seed)
    return (
        (other, f"{words}; of the others, {why}") if why else ("atom", f"{words}; the others do not fit the pdf either")
    )


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
            shaped = {name for name, f in rejected.items() if f.p_value is not None and f.cause in _STATISTICAL}
            return _constant(subject, integral, cause, shaped, samples, seed)
    shown = contrasted(subject, samples, seed)
    if shown is None:
        return cause, ""
    setting, base = shown
    fits = not base.left > _MISFIT * math.sqrt(2 * base.freedom)
    if cause in _CONSTANT and fits:
        return cause, scaled(base)
    by_labels = any(f.check == "normalisation" and f.resolution is None for f in findings)
    crowded = by_labels and fits and bool(scaled(base)) and not _integrates_to(setting, base)
    if cause == "shape" and by_labels and fits and scaled(base) and not crowded:
        return "normalisation", scaled(base)
    named, words = chosen_wrongly(subject, setting.contrast.x, seed) if not fits or crowded else ("", "")
    if named:
        return named, words
    found = explanation(subject, setting, base, samples, seed)
    if found is not None and not (cause in _ZERO and found[0] in _ANYTHING):
        return found
    if (
        isinstance(subject.domain, Product)
        and (not fits or crowded)
        and (told := dependent(subject, subject.domain, samples, seed))
    ):
        return "correlation", told
    bulk = any(f.p_value is not None and f.cause in _STATISTICAL - _PLACES for f in rejected.values())
    return "shape" if cause in _PLACES and (bulk or base.left > PLAIN) else cause, ""


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


def _integrates_to(setting: Setting, base: Fit) -> bool:
    """Return whether the pdf has the integral, told by the known points alone, that the constant factor of a fit asks for.

    Samples that lie closer together than cells can tell, on a curve, seem to ask for a factor too.
    """
    ratio = setting.values[len(setting.contrast.x) :] / setting.contrast.q[len(setting.contrast.x) :]
    error = float(ratio.std()) / math.sqrt(len(ratio))
    return abs(float(ratio.mean()) * base.constant - 1) < _CHANCE * math.hypot(error * base.constant, base.doubt)


def _exponential(subject: Subject, samples: int, seed: int) -> str:
    """Return in words that a pdf is the logarithm of one, if its exponential integrates to 1; "" if it does not."""
    try:
        with np.errstate(all="ignore"):
            contrast = Contrast.of(subject, min(SIZES[0], samples), batch_generator(seed, "diagnosis", 0, SIZES[0]))
            if contrast is None:
                return ""
            ratio = np.exp(subject.density(contrast.z)) / contrast.q[len(contrast.x) :]
    except Exception:  # as above
        return ""
    integral, error = float(ratio.mean()), float(ratio.std()) / math.sqrt(len(ratio))
    if not abs(integral - 1) < _CHANCE * error + 1e-3:
        return ""
    return f"exp(pdf) integrates to {integral:.4f} +- {error:.1g}: it is the logarithm of a pdf"


def _constant(
    subject: Subject, integral: Finding, cause: str, shaped: set[str], samples: int, seed: int
) -> tuple[str, str]:
    """Return what a wrong integral of the pdf comes from: a constant that can be named, or a pdf where nothing is sampled.

    shaped  tests that reject the shape of the pdf: no constant factor changes that, but for labels, which take the pdf as it is
    """
    setting = setting_of(subject, min(samples, SIZES[-1 if shaped else 0]), seed)
    if setting is None or integral.effect is None:
        return cause, ""
    base = setting.contrast.fit(setting.values)
    factor = integral.effect + 1
    plain = base.left > _MISFIT * math.sqrt(2 * base.freedom)
    if plain:
        found = likeliest(setting, base, list(holes.hypotheses(setting))[:-1])
        if found and explained_by(setting, found[0])[1] > _RIGHT and abs(found[0].fit.constant - 1) < 0.1:
            return (
                "pdf outside the support",
                f"the pdf is right where samples are, and not 0 elsewhere: {found[0].words}",
            )
    if plain or shaped:
        told = explanation(subject, setting, base, samples, seed)
        if told is not None:
            return cause if cause == "wrong measure" else told[0], told[1]
        if refused(setting, base, setting.values) or not all(name.startswith("labels") for name in shaped):
            return cause, f"the pdf integrates to {factor:.6g}, and divided by that it still does not fit the samples"
    error = integral.resolution.value if integral.resolution else 0.0
    more = {
        "the measure of the domain": subject.domain.measure,
        "1/(the measure of the domain)": 1 / subject.domain.measure,
    }
    if subject.albedo is not None and np.ndim(subject.albedo) == 0:
        albedo = float(np.asarray(subject.albedo))
        more |= {"the albedo": albedo, "1/albedo": 1 / albedo if albedo else math.inf}
    more = {name: value for name, value in more.items() if math.isfinite(value)}
    name = named_factor(factor, error, more)
    words = f"the samples fit the pdf but for a constant factor {factor:.6g}"
    if set(name) & set("piabth"):
        return cause, f"{words}, that is {name}"
    return cause, words + differs_in_one_place(factor, samples)
