"""Integrals that are either right or wrong: of the density, of the cosine under it, of the function that weights are for."""

from __future__ import annotations

import numpy as np

from fogproof.checks.density.charts import Chart
from fogproof.checks.density.model import Density, Effort
from fogproof.checks.density.quadrature import Leaves, evaluate, refine
from fogproof.checks.subject import Precision, Subject, call
from fogproof.checks.verdict import Finding, Outcome, Resolution
from fogproof.errors import SubjectError

BUDGET: dict[Precision, int] = {"float64": 1_500_000, "float32": 300_000}
"""Most evaluations of the pdf for one integral over the domain: in single precision, noise soon makes more of them useless."""

FLOOR: dict[Precision, float] = {"float64": 2e-7, "float32": 2e-5}
"""An integral this close to its claim is never rejected: quadrature of a black box cannot promise more."""

_COARSE = 1e-3  # an integral known no better says nothing
_DOUBLE = 1e-8  # of a pdf: noise that leaves nothing of single precision's
_UNSEEN = 2.0**-32  # nudges of a quarter of 2^-30: single precision has steps of 2^-24
_JUMPING = 0.995  # quantile of the changes: some points in a hundred lie within a nudge of a step
_MEASURES = {
    2 * np.pi: "2 pi: a density of the cosine, or of area, where one of solid angle is claimed",
    1 / (2 * np.pi): "1/(2 pi): a density of solid angle taken for one of the cosine",
    4 * np.pi: "4 pi: the normalisation 1/(4 pi) is missing",
    1 / (4 * np.pi): "1/(4 pi): normalised twice",
    np.pi: "pi: the normalisation 1/pi is missing",
    1 / np.pi: "1/pi: normalised twice",
    2.0: "2: one half of the domain is counted twice",
    0.5: "1/2: one half of the domain is missing",
}


def effort(subject: Subject, pilot: np.ndarray) -> Effort:
    """Return how hard to integrate the subject's density: to a tenth of the error that is never rejected.

    A pdf that computes in double precision is integrated as one, whatever the samples are made of.
    """
    noise, precision = 8 * subject.roundoff, subject.precision
    if precision == "float32":
        noise = 8 * 2.0**-53 + pdf_noise(subject, pilot)
        precision = "float32" if noise > _DOUBLE else "float64"
    return Effort(0.1 * FLOOR[precision], BUDGET[precision], noise)


def pdf_noise(subject: Subject, pilot: np.ndarray) -> float:
    """Return the relative noise of a pdf that may compute in single precision.

    Points are moved both ways by far less than single precision sees: a pdf that computes in it jumps at some of them, by its
    whole rounding error; one that computes in double changes by as much one way as the other, however steep it is.
    """
    points = pilot[:2048]
    if len(points) == 0:
        return 0.0
    p = subject.density(points)
    good = np.isfinite(p) & (p > 0)
    if not good.any():
        return 0.0
    moved = [subject.density(x) / p[good] - 1 for x in subject.nudged(points[good], _UNSEEN)]
    bends = [np.abs(forth + back) for forth, back in zip(moved[::2], moved[1::2], strict=False)]
    if not bends:  # whole numbers are not moved
        return 0.0
    change = np.max(bends, axis=0)
    change = change[np.isfinite(change)]
    return float(np.quantile(change, _JUMPING)) if len(change) else 0.0


def normalisation(
    subject: Subject, total: float, error: float, rounding: float, hidden: float, given_up: float, unseen: float
) -> Finding:
    """The pdf and the atoms must sum to 1, up to the bound on the integral and what rounding explains.

    hidden    mass that features like those found may still hold unseen: a misfit of that size is inconclusive
    given_up  share of samples that the sampler gives up: they may be what is missing from the integral
    unseen    share of the domain below which a feature may have met no look at all
    """
    total += sum(subject.atoms.values())
    slack = error + FLOOR[subject.precision] + rounding
    misfit = total - 1
    where = f", outside features that fill less than {unseen:.1g} of the domain," if unseen else ""
    resolution = Resolution(f"error of the pdf's integral{where}", slack + hidden, 0.0)
    what = "the pdf and its atoms sum to" if subject.atoms else "the pdf integrates to"
    message = f"{what} {total:.9g} +- {slack:.1g}"
    outcome: Outcome = "not rejected"
    cause = ""
    if not np.isfinite(total) or (abs(misfit) <= slack and slack > _COARSE):
        outcome = "inconclusive"
        message += "; it is known too coarsely to tell: give a cdf, or a pdf without noise"
    elif slack < abs(misfit) <= slack + hidden:
        outcome = "inconclusive"
        message += f"; features as narrow as those found may hide up to {hidden:.1g} more: draw more samples"
    elif given_up and misfit < -slack:
        message += f"; {given_up:.3g} of the samples are given up: the pdf counts every sample, its integral is that of success"
    elif abs(misfit) <= slack and given_up:
        message += f"; {given_up:.3g} of the samples are given up: the pdf is that of the valid ones"
    elif abs(misfit) > slack:
        outcome, cause = "rejected", "normalisation"
        for ratio, words in _MEASURES.items():
            if abs(total / ratio - 1) < 1e-4 + slack:
                cause, message = "wrong measure", f"{message}, close to {words}"
    return Finding("normalisation", outcome, message, effect=misfit, resolution=resolution, cause=cause)


def mean_cosine(
    subject: Subject, chart: Chart, density: Density, leaves: Leaves, work: Effort, rounding: float
) -> Finding:
    """The mean of x . axis under the pdf must be the declared one: forward means forward."""
    assert subject.mean_cosine is not None

    def integrand(c: np.ndarray) -> np.ndarray:
        return density(c) * (chart.to_point(c) @ np.asarray(subject.axis))

    finding = _integral(
        "mean cosine", "sign convention", integrand, leaves, work, subject, subject.mean_cosine, rounding
    )
    if finding.outcome == "rejected" and finding.effect is not None:
        mean = finding.effect + subject.mean_cosine
        if abs(mean + subject.mean_cosine) > 1e-3 * abs(subject.mean_cosine) + 1e-6:
            return finding.because("wrong mean cosine")
    return finding


def albedo(subject: Subject, chart: Chart, leaves: Leaves, work: Effort, rounding: float) -> list[Finding]:
    """The integral of `eval` over the domain must be the declared albedo, channel by channel."""
    assert subject.eval is not None
    assert subject.albedo is not None
    claimed = np.atleast_1d(np.asarray(subject.albedo, dtype=float))
    findings = []
    for channel, value in enumerate(claimed):

        def integrand(c: np.ndarray, channel: int = channel) -> np.ndarray:
            x = chart.to_point(c)
            assert subject.eval is not None
            f = np.asarray(call("eval(x)", subject.eval, x), dtype=np.float64)
            if f.shape not in ((len(x),), (len(x), len(claimed))):
                raise SubjectError(f"eval(x) must return ({len(x)},) or one column a channel, got {f.shape}", "eval(x)")
            return (f if f.ndim == 1 else f[:, channel]) * chart.jacobian(c)

        name = "albedo" if len(claimed) == 1 else f"albedo of channel {channel}"
        findings.append(_integral(name, "wrong weight", integrand, leaves, work, subject, float(value), rounding))
    return findings


def _integral(
    name: str,
    cause: str,
    integrand: Density,
    leaves: Leaves,
    work: Effort,
    subject: Subject,
    claimed: float,
    rounding: float,
) -> Finding:
    found = evaluate(integrand, leaves.low, leaves.high)
    found = refine(integrand, found, work.tolerance, work.budget, work.noise)
    slack = found.total_error + (FLOOR[subject.precision] + rounding) * max(1.0, abs(claimed))
    effect = found.total - claimed
    message = f"{name} of the pdf is {found.total:.9g} +- {slack:.1g}, declared {claimed:.9g}"
    outcome: Outcome = "not rejected" if abs(effect) <= slack else "rejected" if np.isfinite(effect) else "inconclusive"
    resolution = Resolution(f"error of the {name}", slack, 0.0)
    return Finding(
        name, outcome, message, effect=effect, resolution=resolution, cause=cause if outcome == "rejected" else ""
    )
