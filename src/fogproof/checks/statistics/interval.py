"""Where the true effect lies, but for a small probability."""

from __future__ import annotations

import math

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import binomial_interval
from fogproof.checks.verdict import EffectInterval


def effect_interval(data: Moments, reference: float, known: Known, two_valued: bool) -> EffectInterval | None:
    """Return where the mean less the reference lies; None where nothing that was seen or declared tells.

    Of two values that of Clopper & Pearson (1934); of equal ones what declared bounds leave: a law between them that has another
    value more often than MISS^(1/n) allows would have shown it. Of any others Student's.
    """
    if data.n < 2:
        return None
    if data.low == data.high:
        if known.variance == 0:
            return EffectInterval(data.mean - reference, data.mean - reference, 1 - MISS)
        if not known.bounded:
            return None
        rare = -math.expm1(math.log(MISS) / data.n)
        low, high = ((end - data.mean) * rare + data.mean - reference for end in (known.low, known.high))
    elif two_valued:
        assert data.values is not None
        (bottom, _), (top, count) = sorted(data.values.items())
        low, high = (bottom + (top - bottom) * end - reference for end in binomial_interval(count, data.n, MISS))
    else:
        from scipy.special import stdtrit

        reach = -float(stdtrit(data.n - 1, 0.5 * MISS)) * data.stderr
        if not math.isfinite(reach):
            return None
        low, high = data.mean - reference - reach, data.mean - reference + reach
    return EffectInterval(low, high, 1 - MISS)
