"""Is an estimator right? Its mean, variance and scatter against the oracle, inside one false-alarm probability for the study."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fogproof.checks import Finding
from fogproof.checks.statistics.known import NOTHING, Known
from fogproof.checks.statistics.means import LEAST, mean_test
from fogproof.checks.statistics.moments import ORDINARY, Moments
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.statistics.two_values import two_valued
from fogproof.checks.verdict import Outcome
from fogproof.contracts import Reference
from fogproof.study.aggregate import Level, pooled
from fogproof.study.between_replicates import BetweenReplicates, Calls, between_replicates
from fogproof.study.cells import Cell
from fogproof.study.question import UNITS
from fogproof.study.replicate_means import as_calls_allow, judged_by_replicates
from fogproof.study.tails import heavy_tail, tail_of

Lack = Literal["", "samples", "law", "tail", "resolution", "calls", "range"]
EPS = float(np.finfo(float).eps)
ROUNDING = 1e-12
"""Relative difference to the reference that sums in another order may make."""
BY_BIAS = frozenset({"mean", "value", "random points"})
"""The checks that a bias fails."""
_THIRD = 3.0
"""The tail index below which there is no third moment: skewness then grows with the samples instead of wearing off."""


@dataclass(frozen=True)
class Judged:
    """What became of a cell.

    outcome  that of all findings, but for a variance that could not be tested: squares are more skewed than what is squared
    warning  about heavy tails, "" if there is none
    times_as_many  how many times as many realisations would decide about the mean, as far as can be foreseen; 1 if nothing is open
    calls    how the realisations of a call go together
    lacks    what an open judgement lacks: "samples", too few of whatever law; "law": samples for so skewed values; "tail": a third
             moment, as far as the largest values tell, so that no number of samples may be enough; "resolution": an
             error as large as the reference would not have been seen; "calls": calls, to tell whether their realisations are
             independent; "range": numbers that binary64 has powers of; "" else
    design_effect  how many times as much the mean varies as that of independent realisations, as far as calls are taken as such
    """

    outcome: Outcome
    findings: tuple[Finding, ...]
    warning: str
    times_as_many: float = 1.0
    calls: Calls = "independent"
    lacks: Lack = ""
    design_effect: float = 1.0

    @property
    def wrong(self) -> frozenset[str]:
        """The checks that rejected."""
        return frozenset(f.check for f in self.findings if f.outcome == "rejected")

    @property
    def doubted(self) -> bool:
        """Whether Sobol points show a bias that random ones do not."""
        return any(f.check == "Sobol points" for f in self.findings)

    @property
    def infinite(self) -> bool:
        """Whether the variance may be infinite: then no error that was measured says anything of the next."""
        return "infinite" in self.warning

    @property
    def rare(self) -> bool:
        """Whether values too rare to be met may hold more of mean and variance: then no time to an error has an upper end."""
        return self.infinite or self.lacks in ("samples", "law", "tail")


def tests_of(cell: Cell) -> int:
    """Return how many shares of the study's false-alarm probability a cell has."""
    if cell.method.axis != "samples":
        return 0
    return 1 if cell.points == "sobol" else 3


def out_of_range(cell: Cell, levels: Sequence[Level]) -> bool:
    """Return whether deviations are so large or small that binary64 does not hold their powers, which statistics needs."""
    if cell.method.axis != "samples" or not levels:
        return False
    rows = np.concatenate([level.rows for level in levels])
    rows = rows[rows[:, 0] > 0]
    ends = np.array([*rows[:, 5], *rows[:, 6], float(cell.reference.value)])
    spread = float(ends.max() / 2 - ends.min() / 2) * 2
    return not (spread == 0 or 1 / ORDINARY < spread < ORDINARY) or float(np.abs(ends).max()) > ORDINARY


def judge(cell: Cell, levels: Sequence[Level], variance: Reference | None, alpha: float) -> Judged:
    """Judge what was drawn of a cell; every test has the false-alarm probability alpha."""
    value, error = float(cell.reference.value), float(cell.reference.error)
    bad = sum(level.bad for level in levels)
    findings: list[Finding] = []
    warning, times_as_many = "", 1.0
    between = BetweenReplicates("independent")
    lacks: Lack = ""
    if bad:
        findings.append(
            Finding("finite values", "rejected", f"{bad} realisations are not finite", cause="not a number")
        )
    elif not any(len(level.rows) for level in levels):
        findings.append(Finding("mean", "inconclusive", "nothing has been drawn"))
    elif out_of_range(cell, levels):
        findings.append(_out_of_range(cell, value))
        lacks = "range"
    elif cell.method.axis != "samples":
        findings.append(_exact(cell, levels, value, error))
    elif cell.points == "sobol":
        findings.append(_by_replicates(levels[-1], value, error, alpha))
    else:
        data = pooled(np.concatenate([level.rows for level in levels]))
        known = _known(cell, variance, data.low == data.high)
        between = between_replicates(levels, alpha)
        mean = mean_test("mean", "mean", data, value, error, alpha, known=known)
        mean = as_calls_allow(mean, between, _by_replicates(levels[-1], value, error, alpha))
        # Right calls are in doubt once in a hundred cells: that alone leaves none open.
        coarse = _coarse(mean, value) if between.calls != "doubtful" else None
        findings.append(coarse or mean)
        if data.low < known.low or data.high > known.high:
            told = f"realisations reach from {data.low:.6g} to {data.high:.6g}, declared are {known.low:g} to {known.high:g}"
            findings.append(Finding("bounds", "rejected", told, cause="contract"))
        findings += _against_theory(levels, variance, alpha, known, value, error, between)
        findings += [between.finding] if between.finding else []
        warning = heavy_tail(levels, data, value)
        if warning and variance is None and "infinite" in warning:
            findings[0] = replace(findings[0], outcome="inconclusive", message=f"{findings[0].message}; {warning}")
        elif coarse:
            lacks, times_as_many = "resolution", _finer(mean, value)
        elif between.calls == "doubtful" and "inconclusive" in (mean.outcome, findings[-1].outcome):
            lacks, times_as_many = "calls", 4.0
        elif mean.outcome == "inconclusive":
            lacks, times_as_many = "samples" if data.n < LEAST else "law", _wanted(data, alpha)
            index, unsure = tail_of(levels, data, value).outermost()
            if lacks == "law" and index + unsure < _THIRD:
                lacks, times_as_many = "tail", 1.0
    if not all(level.complete for level in levels) or len(levels) < len(cell.counts):
        findings.append(Finding("completeness", "inconclusive", "batches are missing"))
    outcomes = [f.outcome for f in findings if f.outcome == "rejected" or f.check != "variance"]
    outcome: Outcome = next((o for o in ("rejected", "inconclusive") if o in outcomes), "not rejected")
    return Judged(outcome, tuple(findings), warning, times_as_many, between.calls, lacks, between.design_effect)


def _known(cell: Cell, variance: Reference | None, alike: bool) -> Known:
    """Return what is known of the law: where the values have bounds, a mean is judged however skewed they are.

    Realisations that are all alike are judged without bounds too, where their variance is exactly 0.
    """
    bounds = cell.method.bounds(cell.scene)
    known = variance is not None and np.isfinite(variance.value)
    most = float(variance.value) + float(variance.error) if variance is not None and known else None
    if bounds is None:
        return Known(variance=0.0) if most == 0 and alike else NOTHING
    return Known(variance=most, low=float(bounds[0]), high=float(bounds[1]))


def _wanted(data: Moments, alpha: float) -> float:
    """Return how many times as many realisations make the correction for skewness small enough; it falls with their root."""
    exponent = abs(data.skewness) / (3 * math.sqrt(max(data.n, 1))) * normal_quantile(alpha / 2) ** 3
    return max(LEAST / data.n, exponent**2) if data.n < LEAST else max(4.0, exponent**2)


def _coarse(mean: Finding, value: float) -> Finding | None:
    """Return a mean that was not rejected as an open one where an error as large as the reference would not have been seen."""
    if mean.outcome != "not rejected" or mean.resolution is None or not 0 < abs(value) < mean.resolution.value:
        return None
    message = f"{mean.message}; an error as large as the reference itself would not have been seen"
    return replace(mean, outcome="inconclusive", message=message, p_value=None)


def _finer(mean: Finding, value: float) -> float:
    """Return how many times as many realisations see an error as large as the reference: resolutions fall with their root."""
    assert mean.resolution is not None
    return max(2.0, (mean.resolution.value / abs(value)) ** 2)


def _out_of_range(cell: Cell, value: float) -> Finding:
    rule = f"differ by less than {1 / ORDINARY:.1g}, or reach {ORDINARY:.1g}: their powers leave binary64"
    units = "; choose other units" if UNITS[cell.scene.quantity] != "1" else ""
    return Finding("range", "inconclusive", f"realisations about {value:.3g} {rule}{units}")


def inherited(judged: Judged, twin: Judged) -> Judged:
    """Return the judgement of Sobol points with that of random ones: where these are not right, those cannot be."""
    if twin.outcome == "not rejected" or judged.outcome == "rejected":
        return judged
    finding = Finding("random points", twin.outcome, f"with random points the estimator is {twin.outcome}")
    if twin.wrong and not twin.wrong & BY_BIAS:  # for something else than a bias, which has its own name
        first = next(f for f in twin.findings if f.outcome == "rejected")
        finding = Finding(first.check, "rejected", f"with random points: {first.message}", cause=first.cause)
    findings = (*judged.findings, finding)
    return replace(judged, outcome=twin.outcome, findings=findings, times_as_many=twin.times_as_many, lacks=twin.lacks)


def doubted(judged: Judged, twin: Judged) -> Judged:
    """Return the judgement of random points with that of Sobol points: each scrambled one is uniform, and their mean the same."""
    if judged.outcome == "rejected" or "mean" not in twin.wrong:
        return judged
    finding = Finding(
        "Sobol points", "inconclusive", "with Sobol points, whose mean is the same, the estimator is rejected"
    )
    return replace(judged, outcome="inconclusive", findings=(*judged.findings, finding))


def resolution_of(value: float, error: float, terms: int = 1) -> float:
    """Return the error below which nobody can tell what is not random, a sum of so many terms, from the reference."""
    return error + (ROUNDING + terms * EPS) * abs(value)


def _exact(cell: Cell, levels: Sequence[Level], value: float, error: float) -> Finding:
    """Judge an estimator that is not random: each value must be the reference, however many steps were made."""
    offs = [(float(np.abs(level.rows[:, 5:7] - value).max()), level.count) for level in levels if len(level.rows)]
    worst, count = max(offs)
    wrong = any(not off <= resolution_of(value, error, terms) for off, terms in offs)
    if cell.method.axis == "steps":
        best, at = min(offs)
        message = f"off by {worst:.3g} with {count} steps, by {best:.3g} with {at}"
    else:
        message = f"off by {worst:.3g} from {value:.9g}"
    outcome: Outcome = "rejected" if wrong else "not rejected"
    return Finding("value", outcome, message, effect=worst, cause="bias" if wrong else "")


def _of_squares(known: Known, value: float) -> Known:
    """Return what is known of the squares of deviations from the value."""
    furthest = max(known.high - value, value - known.low)
    return Known(low=0.0, high=furthest * furthest, told="" if known.bounded else "that no square is negative")


def _against_theory(
    levels: Sequence[Level],
    variance: Reference | None,
    alpha: float,
    known: Known,
    value: float,
    value_error: float,
    between: BetweenReplicates,
) -> list[Finding]:
    """Return what the exact variance says of the spread of realisations about the reference, which may be off itself."""
    if variance is None or not np.isfinite(variance.value):
        return []
    squares = pooled(np.stack([level.squares for level in levels]))
    exact = float(variance.value)
    # (X - r)^2 has expectation V + (mean - r)^2, and rounding moves the root of V by what it moves X by (Minkowski).
    off = resolution_of(value, value_error)
    error = float(variance.error) + off * (off + 2 * math.sqrt(max(exact, 0.0)))
    what = "mean squared deviation"
    of_squares, doubt = _of_squares(known, value), float(variance.error)
    found = mean_test("variance", what, squares, exact, error, alpha, "wrong variance", of_squares, uncertain=doubt)
    if "too small" in found.region and two_valued(squares) and not found.distribution_free and not known.bounded:
        message = f"{found.message.partition(';')[0]}; rare values that were not seen may hold the rest"
        found = replace(found, outcome="inconclusive", message=message, p_value=None, cause="", region=())
    rows, count = levels[-1].rows, levels[-1].count
    means = rows[:, 2] / count + (rows[:, 1] - value) ** 2
    own = judged_by_replicates(what, means, exact, error, alpha, cause="wrong variance", name="variance")
    return [as_calls_allow(found, between, own)]


def _by_replicates(level: Level, value: float, error: float, alpha: float) -> Finding:
    """Judge the mean by that of whole replicates at the largest count.

    With random points the same function of uniforms is judged by many more independent values, and `inherited` counts that in.
    """
    step = float(np.ptp(level.rows[:, 5:7])) / level.count
    return judged_by_replicates("mean", level.rows[:, 1], value, resolution_of(value, error), alpha, step=step)
