"""Does a mean equal its reference? A test that knows where it does not hold.

Data of two values (hit or miss) get the exact binomial test (`two_values`). Anything else gets Student's t, whose far tail is wrong
by the factor exp(|skewness| z^3 / (3 sqrt n)) to leading order (Edgeworth's expansion of the studentised mean, Hall 1987): the
p-value is multiplied by that factor, and where it is large, or one sample dominates the variance, or the sample varies less than
declared, the verdict is inconclusive. What is declared (`Known`) is tested beside it, whatever the law, and what events that were
not met may bring within declared bounds is allowed for.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.extremes import detectable, extremes_p
from fogproof.checks.statistics.interval import effect_interval
from fogproof.checks.statistics.known import NOTHING, NOTHING_MORE, Declarable, Known
from fogproof.checks.statistics.light import light_tailed_p, light_tailed_reach
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.power import student_reach
from fogproof.checks.statistics.tails import normal_quantile, student_two_sided
from fogproof.checks.statistics.two_values import two_valued, two_values_test
from fogproof.checks.statistics.unseen import SHARE, allowances, unseen
from fogproof.checks.verdict import Finding, Outcome, Resolution

LARGEST_CORRECTION = 1.0  # of the exponent |skewness| z^3 / (3 sqrt n); beyond it the expansion is not trusted
LARGEST_SHARE = 0.05  # of one sample in the sum of squares; beyond it the variance itself may be infinite
_ROUNDING = 16 * 2.0**-53  # relative: of values, and of their sum
_UNDERFLOW = sys.float_info.min  # an error below it is what rounding leaves of an exact 0
LEAST = 100  # samples, below which none but declared facts tells anything
_SHORT = 4.0  # standard deviations by which a sample's variance may fall short of the declared one
DOUBT = 0.01
"""A p-value below this that holds for every law, where the usual test could not be used, is no pass yet."""
DISTRIBUTION_FREE = 0.1  # share of alpha for declared facts, which hold whatever the law


def mean_test(
    name: str,
    what: str,
    data: Moments,
    reference: float,
    error: float,
    alpha: float,
    cause: str = "bias",
    known: Known = NOTHING,
    uncertain: float | None = None,
    ways: Declarable = NOTHING_MORE,
    further: float = 0.0,
) -> Finding:
    """Test that the expectation behind `data` lies within `error` of `reference`.

    uncertain  the part of the error by which the reference itself may be off, all of it unless given; the rest is tolerated
    ways       what the caller could declare, for messages
    further    how far off values that were not met may lie at least, where only two were and nothing is declared
    """
    uncertain = error if uncertain is None else uncertain
    if data.n == 0:
        return Finding(name, "inconclusive", f"{what}: there are no data", alpha=alpha)
    share = alpha if known == replace(NOTHING, light=known.light, told=known.told) else (1 - DISTRIBUTION_FREE) * alpha
    if data.low == data.high:
        finding = _constant(name, what, data, reference, error, share, known, ways)
    elif two_valued(data):
        finding = two_values_test(name, what, data, reference, error, share, known, further)
        if finding.outcome == "inconclusive":
            more = "" if known.two_sided else ways.of_values()
            finding = replace(finding, message=f"{finding.message}: ask for more {ways.more}{more}")
    else:
        finding = _student(name, what, data, reference, error, share, known, ways)
    if share < alpha and finding.outcome != "rejected":
        finding = _lawless(finding, what, data, reference, error, alpha - share, known)
    elif share < alpha and finding.p_value is not None:
        p = extremes_p(data, reference - error, reference + error, known)
        if p <= alpha - share:
            finding = replace(finding, p_value=max(p, finding.p_value), exact=False, distribution_free=True)
    if finding.outcome == "not rejected" and uncertain > max(abs(reference), data.stderr, _UNDERFLOW):
        coarse = f"the reference is known too coarsely, to within {uncertain:.2g}, to tell it from nothing{_FINER}"
        message = f"{finding.message}; {coarse}"
        finding = replace(finding, outcome="inconclusive", message=message, p_value=None, resolution=None)
    effect = data.mean - reference
    interval = effect_interval(data, reference, known, two_valued(data))
    rejected = finding.outcome == "rejected"
    if rejected and finding.p_value is not None and known.variance is None and not known.bounded:
        finding = replace(finding, message=finding.message + unseen(data, effect, error, alpha, known))
    return replace(finding, interval=interval, cause=cause if rejected else "", region=_side(effect, rejected))


_FINER = ": give a smaller error, or say by tolerance=(relative, absolute) how much does not matter"


def _side(effect: float, rejected: bool) -> tuple[str, ...]:
    return (("too large" if effect > 0 else "too small"),) if rejected else ()


def trusted(data: Moments, alpha: float, known: Known = NOTHING) -> bool:
    """Return whether the usual test may be used at alpha: skewed values need many samples, and rare ones must be among them."""
    if short_of_variance(data, known):
        return False
    if two_valued(data) or data.m2 == 0:
        return True
    if data.n < LEAST:
        return False
    growth = abs(data.skewness) / (3 * math.sqrt(data.n)) * normal_quantile(alpha / 2) ** 3
    return growth <= LARGEST_CORRECTION and data.largest_share <= LARGEST_SHARE


def short_of_variance(data: Moments, known: Known) -> bool:
    """Return whether the sample varies less than declared: something that matters has not been seen yet."""
    if known.deviation is None or data.n < 2:
        return False
    square = data.m2 / data.n
    spread = math.sqrt(max(data.m4 / data.n - square * square, 0.0) / data.n)
    return square + _SHORT * spread < (known.deviation / data.scale) ** 2 * (1 - 1e-9)


def _constant(
    name: str,
    what: str,
    data: Moments,
    reference: float,
    error: float,
    alpha: float,
    known: Known,
    ways: Declarable,
) -> Finding:
    gap = abs(data.mean - reference)
    if gap <= error + 1e-12 * abs(reference):
        message = f"{what}: all {data.n} samples equal the reference {reference:.12g}"
        return Finding(name, "not rejected", message, None, alpha, effect=gap)
    message = f"{what}: all {data.n} samples are {data.mean:.12g} and the reference is {reference:.12g}"
    if not known.two_sided:
        message += "; an event too rare to be seen looks the same as a bias"
        message += unseen(data, data.mean - reference, error, alpha, known) + ways.of_a_constant()
    return Finding(name, "inconclusive", message, None, alpha, effect=data.mean - reference)


def _student(
    name: str,
    what: str,
    data: Moments,
    reference: float,
    error: float,
    alpha: float,
    known: Known,
    ways: Declarable,
) -> Finding:
    rounding = _ROUNDING * max(abs(data.mean), abs(reference))
    down, up = allowances(data, known, alpha)
    gap = max(abs(data.mean - reference) - error - rounding - (down if data.mean > reference else up), 0.0)
    stderr = max(data.stderr, math.ulp(0.0))  # of denormal numbers it may vanish
    z = gap / stderr
    needed = normal_quantile(alpha / 2)
    growth = abs(data.skewness) / (3 * math.sqrt(data.n))
    effect = data.mean - reference
    message = f"{what} {data.mean:.7g} +- {data.stderr:.2g}, reference {reference:.7g}"
    if math.isfinite(effect / stderr):
        message += f" (z = {effect / stderr:+.2f})"
    light = known.light and data.n > 1 and not short_of_variance(data, known)
    if not (light or trusted(data, alpha, known)):
        message += _why_not(data, alpha, known, growth * needed**3, effect, error, ways)
        return Finding(name, "inconclusive", message, None, alpha, False, z, effect)
    p = light_tailed_p(data.n, z) if light else _corrected(student_two_sided(data.n - 1, z), growth, z, needed)
    p = _with_unseen(p, down + up)
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    exact = down == up == 0 and not light and growth * needed**3 < 0.3 and error < 0.01 * data.stderr
    reach = light_tailed_reach(data.n, alpha) * data.stderr if light else student_reach(data, alpha)
    reach += error + rounding + max(down, up)  # which are no bias, and hide one
    resolution = Resolution(f"bias of {what}", reach, MISS, reference) if math.isfinite(reach) else None
    if light:
        message += f", its tails {'taken' if known.told else 'declared'} to be light"
    return Finding(name, outcome, message, p, alpha, exact, z, effect, resolution)


def _why_not(
    data: Moments, alpha: float, known: Known, exponent: float, effect: float, error: float, ways: Declarable
) -> str:
    if short_of_variance(data, known):
        return f"; the sample varies by {data.deviation:.3g}, less than the declared {known.deviation:.3g}: rare values are missing"
    declare = "" if known.two_sided else ways.of_values()
    declare += unseen(data, effect, error, alpha, known)
    if data.n < LEAST:
        return f"; {data.n} are too few to know their law: ask for {LEAST} at least{declare}"
    enough = max(math.ceil(data.n * max(exponent / LARGEST_CORRECTION, 1) ** 2), 4 * data.n)
    largest = f"the largest sample has {data.largest_share:.1%} of the variance"
    why = f"too skewed for a test at alpha = {alpha:.1g} (skewness {data.skewness:.3g}, {largest})"
    if exponent <= LARGEST_CORRECTION:
        why = f"too few for so wide a tail ({largest})"
    return f"; {why}: ask for about {enough} {ways.more}{declare}"


def _lawless(
    finding: Finding, what: str, data: Moments, reference: float, error: float, alpha: float, known: Known
) -> Finding:
    """Return the finding after the tests that hold for every law have had their say."""
    p = extremes_p(data, reference - error, reference + error, known)
    effect = data.mean - reference
    if p <= alpha:
        message = f"{finding.message.partition(';')[0]}; decided by {known.words()}, whatever the law"
        return replace(
            finding,
            outcome="rejected",
            message=message,
            p_value=p,
            alpha=alpha,
            exact=False,
            effect=effect,
            distribution_free=True,
        )
    if finding.outcome == "inconclusive" and known.two_sided and p <= DOUBT:
        message = f"{finding.message.partition(';')[0]}; {known.words()} leave that a probability of {p:.2g}: ask for more samples"
        return replace(finding, message=message)
    if finding.outcome == "inconclusive" and known.bounded:
        reach = detectable(data.n, known, alpha, MISS) + error
        message = f"{finding.message.partition(';')[0]}; within {known.words()} chance explains it"
        resolution = Resolution(f"bias of {what}", reach, MISS, reference)
        return replace(finding, outcome="not rejected", message=message, p_value=p, alpha=alpha, resolution=resolution)
    return finding


def _corrected(p_normal: float, growth: float, z: float, needed: float) -> float:
    """Return the corrected p-value; the correction stops growing where the expansion stops being one."""
    limit = max(needed, (LARGEST_CORRECTION / growth) ** (1 / 3)) if growth > 0 else math.inf
    return min(1.0, p_normal * math.exp((growth ** (1 / 3) * min(z, limit)) ** 3))  # z alone may be as large as 1e300


def _with_unseen(p: float, allowed: float) -> float:
    """Return the p-value with the share of alpha for events that are likelier than was allowed for."""
    return min(1.0, p / (1 - SHARE)) if allowed > 0 else p
