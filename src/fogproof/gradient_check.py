"""`check_gradient`: is the mean of an estimator of a derivative the derivative of what the oracle says?

A derivative goes wrong in ways of its own: a term that is not differentiated, a sign, the derivative by another parameter. These
are tried on what was found, and the one that agrees is told.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof import analytic
from fogproof.checks import Finding, Verdict, check_estimator
from fogproof.contracts import Reference
from fogproof.errors import FogproofError, InvalidValueError

OTHERS = ("sigma_t", "sigma_a", "sigma_s", "albedo")
"""Parameters of a homogeneous medium that are taken for each other."""

NARROW = 0.5
"""An interval tells a hypothesis from the derivative if it is at most this share of their distance wide."""


def check_gradient(
    draw: Callable[[np.random.Generator, int], Any] | Any,
    quantity: Reference | float | str | Callable[..., Reference],
    wrt: str | Sequence[str] | None = None,
    arguments: Mapping[str, Any] | None = None,
    **options: Any,
) -> Verdict:
    """Test that an estimator's expectation is a derivative; the false-alarm probability is that of `check_estimator`.

    draw       as in `check_estimator`: (rng, n) -> (n,), or (n, parameters) where several are asked for; or the realisations
    quantity   the derivative itself, a number or a `Reference`; or a quantity of the oracle or its name, to be differentiated
    wrt        the parameter, as in `analytic.gradient`, or several, one a channel
    arguments  of the quantity
    options    further arguments of `check_estimator`. Derivatives have heavy tails: where a rare event decides, the verdict
               is inconclusive and says what would tell, `bounds=`, `variance=` or `tails="light"`

    >>> from fogproof.scene import Medium, Ray
    >>> fog = {"medium": Medium(0.5, 0.5), "ray": Ray((0, 0, 0), (0, 0, 1), 2.0)}
    >>> passes = lambda rng, n: np.where(rng.standard_exponential(n) > 2, -2.0, 0.0)
    >>> check_gradient(passes, "transmittance", "medium.sigma_t", fog, samples=10_000).outcome
    'not rejected'
    >>> verdict = check_gradient(lambda rng, n: -passes(rng, n), "transmittance", "medium.sigma_t", fog, samples=10_000)
    >>> verdict.diagnosis
    'the estimates average to the derivative with its sign flipped'
    """
    if isinstance(quantity, str) or (callable(quantity) and not isinstance(quantity, Reference)):
        names = [wrt] if isinstance(wrt, str) else list(wrt or ())
        if not names:
            raise InvalidValueError("wrt", "must name the parameter", wrt, 'for example wrt="medium.sigma_t"')
        reference = _stacked([analytic.gradient(quantity, name, **arguments or {}) for name in names], wrt)
        hypotheses = list(_hypotheses(quantity, names, arguments or {}, reference))
    elif wrt is None and arguments is None:
        reference = Reference.of("quantity", quantity)
        hypotheses = list(_of_any(reference))
    else:
        raise InvalidValueError(
            "quantity", "must be a quantity of the oracle or its name where wrt= is given", quantity
        )
    verdict = check_estimator(draw, reference, **options)
    reproduce = verdict.reproduce.replace("check_estimator", "check_gradient")
    if verdict.outcome != "rejected":
        return replace(verdict, reproduce=reproduce)
    told = _explanations(verdict.findings, reference, hypotheses)
    return replace(verdict, reproduce=reproduce, diagnosis="; ".join(told) or verdict.diagnosis)


Hypothesis = tuple[str, np.ndarray]
"""What the estimates may average to instead, in words and as values of the reference's shape."""


def _of_any(reference: Reference) -> Iterator[Hypothesis]:
    yield "the derivative with its sign flipped", -reference.value
    yield "0: they do not depend on the parameter", np.zeros_like(reference.value)
    yield "half the derivative", reference.value / 2
    yield "twice the derivative", reference.value * 2


def _hypotheses(
    quantity: str | Callable[..., Reference], names: list[str], arguments: Mapping[str, Any], reference: Reference
) -> Iterator[Hypothesis]:
    yield from _of_any(reference)
    function = getattr(analytic, quantity) if isinstance(quantity, str) else quantity
    whole = np.asarray(function(**arguments).value)
    behind = whole[..., None] if reference.value.ndim > whole.ndim else whole
    yield "the quantity itself", np.broadcast_to(behind, reference.value.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        yield "the derivative of the quantity's logarithm", reference.value / behind
    for other in OTHERS:
        others = [re.sub(r"(sigma_[tas]|albedo)$", other, name) for name in names]
        if others == names:
            continue
        try:
            found = [analytic.gradient(quantity, name, **arguments) for name in others]
        except FogproofError:
            continue  # this medium has no such parameter
        yield f"the derivative by {other}", _stacked(found, names if len(names) > 1 else names[0]).value


def _stacked(found: list[Reference], wrt: Any) -> Reference:
    """Return one reference, with a channel a parameter if several were asked for."""
    if len(found) == 1 and isinstance(wrt, str):
        return found[0]
    value, error = (np.stack([getattr(slope, what) for slope in found], axis=-1) for what in ("value", "error"))
    return Reference(value, error, found[0].method, found[0].source)


def _explanations(findings: Sequence[Finding], reference: Reference, hypotheses: Sequence[Hypothesis]) -> Iterator[str]:
    """Yield the hypothesis that lies in the interval of each wrong mean, where the interval is narrow enough to tell."""
    truth = np.atleast_1d(reference.value).ravel()
    for finding in findings:
        channel = re.fullmatch(r"mean(?: of channel (\d+))?", finding.check)
        if finding.outcome != "rejected" or channel is None or finding.interval is None:
            continue
        index = int(channel[1] or 0)
        low, high = finding.interval.low, finding.interval.high
        wide = high - low
        named = []
        for words, values in hypotheses:
            apart = float(np.ravel(values)[index]) - truth[index]
            if low - wide / 2 <= apart <= high + wide / 2 and wide <= NARROW * abs(apart):
                named.append(words)
        if named:
            where = f" (channel {index})" if truth.size > 1 else ""
            yield f"the estimates average to {' or '.join(named)}{where}"
