"""Single questions put to a sampler: an independent reference, a given cdf, the other precision, the support of `eval`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fogproof.checks.density.lattice import lattice
from fogproof.checks.promises import at_any_atom, inside
from fogproof.checks.subject import Subject, call, in_domain
from fogproof.checks.verdict import Finding, Resolution
from fogproof.errors import SubjectError, shorten

_ASKED = 1024  # points at which the pdf is asked twice
_SAME = 1e-6  # relative: threads may add in another order
_SPREAD = 1 << 16  # points of the domain at which eval and pdf are held against each other
_CLEAR = 1e-6  # distance from the edge of a support, along coordinates from 0 to 1
_LOST = 1e-9  # share of the integral of eval that underflow may lose
_PRECISION_LOSS = 1e-3  # of probability: single precision may lose digits, but not the distribution


def reference_agreement(subject: Subject, points: np.ndarray) -> Finding:
    """pdf(x) must equal the independent reference at sampled points, up to the reference's error and rounding."""
    assert subject.reference is not None
    reference = subject.reference(points)
    p = subject.density(points)
    slack = reference.error + subject.rounding_spread(subject.density, points)
    return agreement("pdf against the reference", p, np.broadcast_to(reference.value, p.shape), slack, points)


def writing(subject: Subject, points: np.ndarray) -> tuple[Subject, list[Finding]]:
    """The pdf must leave its points as they are: return the subject, and a finding if it does not; its pdf gets copies then."""
    kept = points[:_ASKED].copy()
    subject.density(kept)
    if np.array_equal(kept, points[:_ASKED], equal_nan=True):
        return subject, []
    message, pdf = "pdf(x) writes into x, which belongs to its caller; copy it first", subject.pdf
    finding = Finding("function of its point", "rejected", message, cause="writes into its points")
    return replace(subject, pdf=lambda x: pdf(x.copy())), [finding]


def pdf_twice(subject: Subject, points: np.ndarray) -> list[Finding]:
    """The pdf must give the same points the same answer: one finding if it does not, none if it does."""
    points = points[:_ASKED]
    first, again = subject.density(points), subject.density(points)
    differ = ~(np.abs(first - again) <= _SAME * np.abs(first)) & (first != again) & ~(np.isnan(first) & np.isnan(again))
    if not differ.any():
        return []
    at = int(np.argmax(differ))
    message = f"pdf({shorten(points[at])}) is {first[at]:.9g}, and {again[at]:.9g} the second time"
    return [Finding("function of its point", "rejected", message, effect=float(np.mean(differ)), cause="hidden state")]


def support_of_eval(subject: Subject, pilot: np.ndarray) -> Finding:
    """Where `eval` is not 0 the pdf must not be 0: what is never drawn is missing from every estimate.

    Looked at are evenly spread points of the domain; points so near the edge of a support that rounding decides are passed over.
    """
    law = subject.domain.law(pilot)
    u = lattice(_SPREAD, len(law.axes), np.full(len(law.axes), 0.5))
    x = law.place(u)
    good = in_domain(subject.domain, x, subject.roundoff) & ~at_any_atom(subject, x)
    u, x = u[good], x[good]
    size = _sizes(subject, x) / law.density(x)
    lost = (size > 0) & (subject.density(x) == 0)
    for side in _CLEAR * np.concatenate([np.eye(len(law.axes)), -np.eye(len(law.axes))]):
        near = law.place(np.clip(u[lost] + side, 0.0, 1 - 2.0**-53))
        lost[lost] = (subject.density(near) == 0) & (_sizes(subject, near) > 0)
    total = float(size[np.isfinite(size)].sum())
    share = float(size[lost].sum()) / total if total > 0 else 0.0
    name, resolution = (
        "support of eval",
        Resolution("share of the domain where eval is lost", 4 / len(x) if len(x) else 1.0, 0.0),
    )
    if share > _LOST:
        at = int(np.flatnonzero(lost)[np.argmax(size[lost])])
        message = f"eval is {_sizes(subject, x[[at]])[0]:.6g} where the pdf is 0, at x = {shorten(x[at])}"
        message += f": about {share:.2g} of its integral is never sampled"
        return Finding(name, "rejected", message, effect=share, resolution=resolution, cause="lost contribution")
    message = f"the pdf is nowhere 0 where eval is not, at {len(x)} evenly spread points"
    return Finding(name, "not rejected", message, effect=share, resolution=resolution)


def _sizes(subject: Subject, x: np.ndarray) -> np.ndarray:
    """Return (n,) the largest size of eval(x) over its channels, 0 where it is no number."""
    assert subject.eval is not None
    values = np.abs(np.asarray(call("eval(x)", subject.eval, x), dtype=np.float64))
    if values.shape[:1] != (len(x),) or values.ndim > 2:
        raise SubjectError(f"eval(x) must return ({len(x)},) or one column a channel, got {values.shape}", "eval(x)")
    return np.nan_to_num(values if values.ndim == 1 else values.max(axis=1), nan=0.0, posinf=0.0)


def cdf_agreement(claimed: np.ndarray, right: np.ndarray, slack: np.ndarray, points: np.ndarray) -> Finding:
    """The increments (m,) of a given cdf must equal the integrals of the pdf over the same cells."""
    return agreement("cdf against the pdf", claimed, right, slack, points, "the cell that ends at")


def agreement(
    name: str,
    claimed: np.ndarray,
    right: np.ndarray,
    slack: np.ndarray,
    points: np.ndarray,
    at: str = "x =",
    sharp: float = 1e-6,
) -> Finding:
    """Return whether two arrays (m,) agree to within `slack`; ratios that differ by less than `sharp` are one constant."""
    gap = np.abs(claimed - right)
    worst = int(np.argmax(gap - slack))
    effect = float(np.max(gap / np.maximum(np.abs(right), 1e-300), initial=0.0))
    if not np.all(gap <= slack):
        message = f"{claimed[worst]:.9g} against {right[worst]:.9g}, at {at} {shorten(points[worst])}"
        ratio = (claimed / np.where(right == 0, np.nan, right))[right != 0]
        constant = len(ratio) > 0 and np.ptp(ratio) < sharp * abs(np.mean(ratio))
        cause = "normalisation" if constant else "wrong formula"
        return Finding(name, "rejected", message, effect=effect, cause=cause)
    return Finding(name, "not rejected", f"equal within rounding at {len(right)} places", effect=effect)


def precision_agreement(
    subject: Subject, u: np.ndarray, probability: Callable[[np.ndarray], list[tuple[np.ndarray, np.ndarray]]]
) -> Finding:
    """The same single-precision uniforms, given in double precision, must lead to about the same points.

    probability  points -> for each axis the cdf (m,), in which the difference is measured, and what rounding of the points
                 can change about it (m,)
    """
    name = "single against double precision"
    u = u.astype(np.float32)
    single, double = subject.draw_at(u), subject.draw_at(u.astype(np.float64))
    both = ~at_any_atom(subject, single.x) & ~at_any_atom(subject, double.x)
    both &= inside(subject, single) & inside(subject, double)
    gaps = []
    for (a, _), (b, blur) in zip(probability(single.x[both]), probability(double.x[both]), strict=True):
        gap = np.abs(a - b)
        gaps.append(np.maximum(np.minimum(gap, 1 - gap) - 2 * blur, 0))
    gap = np.max(gaps, axis=0, initial=0.0)
    lost = gap > _PRECISION_LOSS
    share = float(np.mean(lost)) if len(lost) else 0.0
    effect = float(np.median(gap)) if len(gap) else 0.0
    resolution = Resolution("loss of precision, in probability", _PRECISION_LOSS, 0.0)
    if share > 0.01:
        i = int(np.flatnonzero(lost)[0])
        message = f"{share:.1%} of the samples move by more than {_PRECISION_LOSS:g} of probability in single precision"
        message += (
            f", u = {shorten(u[both][i])} leads to {shorten(single.x[both][i])} and to {shorten(double.x[both][i])}"
        )
        return Finding(name, "rejected", message, effect=effect, resolution=resolution, cause="cancellation")
    message = f"the median sample moves by {effect:.1g} of probability, {share:.1%} by more than {_PRECISION_LOSS:g}"
    return Finding(name, "not rejected", message, effect=effect, resolution=resolution)
