"""`check_estimator`: is the mean of an estimator its reference, and are variance, cost and standard errors what theory says?

Means are tested exactly where they can be, by Student's law where skewness allows it, and otherwise by tests that hold for every
law; where none of them can tell, or the variance may be infinite, the verdict is inconclusive and says so.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.escalation import EARLY, stages
from fogproof.checks.quantities import Quantity, quantities_of
from fogproof.checks.statistics.bets import Bets
from fogproof.checks.statistics.coverage import Coverage, coverage_test
from fogproof.checks.statistics.dependence import Succession, repeated_stretches, runs_test
from fogproof.checks.statistics.heavy import Tail
from fogproof.checks.statistics.means import Moments, mean_test, trusted
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.streams import batch_generator, batch_sizes, fresh_seed
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Outcome, Resolution, Verdict, jsonable
from fogproof.contracts import Draws, Reference
from fogproof.errors import SubjectError
from fogproof.validate import number

_TRACE = 12  # points of the running mean kept for the figure
_DECADES = (
    1,
    9,
    90,
    900,
    9000,
)  # realisations of the first calls: an estimator must not depend on how many it is asked for
_RUNS = 0.05  # share of alpha for the correlation of realisations
_SECOND = 0.1  # of a mean's share for a test that holds for every law, where Student's does not
_SUSPICIOUS = 0.005  # of one sample in the sum of squares: the tail is looked at


def check_estimator(
    draw: Callable[[np.random.Generator, int], Any],
    reference: Reference | float | Mapping[int, Reference | float],
    *,
    variance: Reference | float | None = None,
    cost: Reference | float | None = None,
    samples: int = 1_000_000,
    alpha: float = 1e-6,
    seed: int | None = None,
) -> Verdict:
    """Test that an estimator's expectation is the reference; every sub-check shares one false-alarm probability `alpha`.

    draw       `draw(rng, n)` -> (n,) or (n, channels) independent realisations, or `Draws`; where these hold standard errors,
               their squares must be right on average, and intervals of two of them must hold the reference
    reference  its expectation, () or (channels,): a number, or a `Reference` with an error bound that is counted; or
               {label: expectation} of the contributions of each `Draws.order` (scattering orders, or strategies)
    variance   the exact variance of one realisation, tested as the mean of (X - reference)^2; 0 declares that there is none
    cost       the exact expectation of `Draws.cost`
    samples    most realisations
    alpha      false-alarm probability of this call with everything in it
    seed       any whole number; None draws a fresh one, which the verdict states
    """
    started = time.perf_counter()
    number("alpha", alpha, "must lie in (0, 1)", 0, 1, open_ends=True)
    number("samples", samples, "must be at least 100", 100)
    seed = fresh_seed() if seed is None else seed
    source = _Source(draw, seed, samples, _channels_of(reference))
    record: _Record | None = None
    findings: list[Finding] = []
    looks = [look.samples for look in stages(samples, None, alpha, 1.0)]
    drawn = 0
    for draws, n in source.batches():
        if record is None:
            record = _Record.of(quantities_of(reference, variance, cost, draws.stderr is not None), draws)
        record = record.after(draws, n)
        drawn += n
        due = any(drawn - n < size <= drawn for size in looks)
        if record.bad or due or drawn == samples:
            findings = _judged(record, source, alpha, drawn == samples)
            if drawn < samples and _beyond_doubt(findings):
                break
    assert record is not None
    settings = {"channels": source.channels, "looks": looks}
    name = getattr(draw, "__qualname__", type(draw).__name__)
    reproduce = f"check_estimator({name}, ..., samples={samples}, alpha={alpha:g}, seed={seed})"
    cause = likely_cause(findings)
    return Verdict(tuple(findings), alpha, drawn, seed, time.perf_counter() - started, settings, cause, reproduce)


def _beyond_doubt(findings: list[Finding]) -> bool:
    """Return whether an early look may stop: at a failure without statistics, or a p-value far below any share of alpha."""
    rejected = [f for f in findings if f.outcome == "rejected"]
    return any(f.p_value is None or f.p_value <= EARLY * (f.alpha or 1.0) for f in rejected)


def _channels_of(reference: Reference | float | Mapping[int, Reference | float]) -> int:
    given = list(reference.values()) if isinstance(reference, Mapping) else [reference]
    references = [Reference.of("reference", one) for one in given]
    return max((np.broadcast(np.atleast_1d(r.value), r.error).size for r in references), default=1)


@dataclass(frozen=True)
class _Source:
    """An estimator and the streams it is drawn from: every batch can be drawn again alone."""

    draw: Callable[[np.random.Generator, int], Any]
    seed: int
    samples: int
    channels: int

    def batches(self) -> Iterator[tuple[Draws, int]]:
        """Yield all batches; the first is drawn in calls of 1, 9, 90, ... realisations."""
        for index, n in enumerate(batch_sizes(self.samples)):
            rng = batch_generator(self.seed, "draws", 0, index)
            sizes = [n] if index else _in_decades(n)
            parts = [self._call(rng, size) for size in sizes]
            yield _joined(parts), n

    def _call(self, rng: np.random.Generator, n: int) -> Draws:
        result = call("draw(rng, n)", self.draw, rng, n)
        draws = result if isinstance(result, Draws) else Draws(result)
        x = np.asarray(draws.value)
        if x.dtype.kind not in "iufb":
            raise SubjectError(f"draw must return numbers, got dtype {x.dtype}", "draw: value")
        wanted = {(n,), (n, 1)} if self.channels == 1 else {(n, self.channels)}
        if x.shape not in wanted:
            shape = f"({n},)" if self.channels == 1 else f"({n}, {self.channels})"
            raise SubjectError(f"draw must return an array of shape {shape}, got {x.shape}", "draw: value")
        for name, part in zip(Draws._fields[1:], draws[1:], strict=True):
            if part is not None and np.shape(part)[:1] != (n,):
                raise SubjectError(f"draw must return a {name} of shape ({n},), got {np.shape(part)}", f"draw: {name}")
        return draws._replace(value=x.reshape(n, self.channels).astype(np.float64))


def _in_decades(n: int) -> list[int]:
    sizes = [size for size in _DECADES if size <= n // 4]
    return [*sizes, n - sum(sizes)]


def _joined(parts: list[Draws]) -> Draws:
    if len(parts) == 1:
        return parts[0]

    def column(name: str) -> np.ndarray | None:
        found = [getattr(part, name) for part in parts]
        return None if found[0] is None else np.concatenate(found)

    value = np.concatenate([part.value for part in parts])
    return Draws(value, column("cost"), column("order"), column("stderr"))


@dataclass(frozen=True)
class _Record:
    """All that is remembered of an estimator's draws."""

    quantities: list[Quantity]
    moments: tuple[tuple[Moments, ...], ...]
    succession: Succession
    coverage: Coverage
    trace: list[tuple[int, list[float], list[float]]] = field(default_factory=list)
    n: int = 0
    bad: int = 0

    @staticmethod
    def of(quantities: list[Quantity], first: Draws) -> _Record:
        empty = tuple(tuple(Moments() for _ in q.value) for q in quantities)
        finite = first.value[:, 0][np.isfinite(first.value[:, 0])]
        # The middle of few values is one of them: what is larger must not be what is never drawn.
        middle = float(np.quantile(finite, 0.5, method="lower")) if len(finite) else 0.0
        if len(finite) and middle == finite.max():
            middle = float(np.nextafter(middle, -np.inf))
        return _Record(quantities, empty, Succession(middle), Coverage())

    def after(self, draws: Draws, n: int) -> _Record:
        bad = int(np.count_nonzero(~_usable(draws)))
        if bad or self.bad:
            return replace(self, n=self.n + n, bad=self.bad + bad)
        moments = tuple(
            tuple(
                old.merged(Moments.of(np.ascontiguousarray(x))) for old, x in zip(olds, q.numbers(draws).T, strict=True)
            )
            for q, olds in zip(self.quantities, self.moments, strict=True)
        )
        coverage = self.coverage
        if draws.stderr is not None:
            stderr = np.asarray(draws.stderr, dtype=float).reshape(n, -1)
            coverage = coverage.after(draws.value, stderr, self.quantities[0].value, self.quantities[0].error)
        means = moments[0]
        trace = [*self.trace, (self.n + n, [m.mean for m in means], [m.stderr for m in means])]
        succession = self.succession.after(draws.value[:, 0])
        return replace(self, moments=moments, coverage=coverage, succession=succession, trace=trace, n=self.n + n)

    def figure(self, channel: int) -> dict[str, Any]:
        """Return the data of a plot of the running mean, at counts that grow by about a constant factor."""
        picks = np.unique(np.geomspace(1, len(self.trace), _TRACE).astype(int)) - 1
        rows = [self.trace[i] for i in picks]
        columns = {
            "n": [r[0] for r in rows],
            "mean": [r[1][channel] for r in rows],
            "stderr": [r[2][channel] for r in rows],
        }
        mean = self.quantities[0]
        return jsonable({"kind": "mean", "reference": mean.value[channel], "error": mean.error[channel], **columns})


def _usable(draws: Draws) -> np.ndarray:
    """Return (n,) which realisations are finite in everything they report; a standard error is not negative either."""
    good = np.isfinite(draws.value).all(axis=1)
    for part, least in ((draws.cost, -np.inf), (draws.stderr, 0.0)):
        if part is not None:
            columns = np.asarray(part, dtype=np.float64).reshape(len(good), -1)
            good &= (np.isfinite(columns) & (columns >= least)).all(axis=1)
    return good


def _judged(record: _Record, source: _Source, alpha: float, complete: bool) -> list[Finding]:
    """Return all findings; the statistical ones share alpha. Only once all is drawn are doubtful means looked at again."""
    if record.bad:
        message = f"{record.bad} of {record.n} realisations are not finite, in value, cost or standard error"
        return [Finding("finite values", "rejected", message, effect=record.bad / record.n, cause="bias")]
    findings = [Finding("finite values", "not rejected", f"all {record.n} realisations are finite")]
    claims = [(q, c) for q in record.quantities for c in range(len(q.value))]
    covered = record.coverage.n > 0
    share = (1 - _RUNS) * alpha / (len(claims) + covered)
    fixed = _without_variance(record.quantities)
    for (quantity, channel), data in zip(claims, (m for row in record.moments for m in row), strict=True):
        name = f"{quantity.name} of channel {channel}" if len(quantity.value) > 1 else quantity.name
        if quantity.name == "variance" and channel in fixed:
            continue
        value, error = float(quantity.value[channel]), float(quantity.error[channel])
        if quantity.name == "mean" and channel in fixed:
            finding = _zero_variance(name, data, value, error)
        else:
            finding = mean_test(name, name, data, value, error, (1 - _SECOND) * share, quantity.cause)
            if complete and _doubtful(data, finding, share):
                finding = _second_look(finding, quantity, channel, data, source, _SECOND * share)
        if quantity is record.quantities[0]:
            finding = replace(finding, figure=record.figure(channel))
        findings.append(finding)
    if covered:
        findings.append(coverage_test("coverage of standard errors", record.coverage, source.channels, share))
    if not fixed:
        findings.append(runs_test("correlation of realisations", record.succession, _RUNS * alpha))
        stretches = repeated_stretches("repeated realisations", record.succession)
        findings += [] if stretches is None else [stretches]
    return findings


def _without_variance(quantities: list[Quantity]) -> set[int]:
    """Return the channels that declare no variance."""
    variance = next((q.value for q in quantities if q.name == "variance"), np.empty(0))
    return {channel for channel, v in enumerate(variance) if v == 0}


def _zero_variance(name: str, data: Moments, value: float, error: float) -> Finding:
    """Judge an estimator that declares no variance: every single realisation must be the reference."""
    gap = max(abs(data.low - value), abs(data.high - value))
    wrong = not gap <= error + 1e-12 * abs(value)
    message = f"every realisation must be {value:.15g}; they lie in [{data.low:.15g}, {data.high:.15g}]"
    outcome: Outcome = "rejected" if wrong else "not rejected"
    return Finding(name, outcome, message, effect=gap, cause="bias" if wrong else "")


def _doubtful(data: Moments, finding: Finding, share: float) -> bool:
    """Return whether Student's test may mislead: its data are skewed, or may have no variance."""
    if data.values is not None or data.m2 == 0:
        return False
    return not trusted(data, (1 - _SECOND) * share) or data.largest_share > _SUSPICIOUS


def _second_look(
    finding: Finding, quantity: Quantity, channel: int, data: Moments, source: _Source, alpha: float
) -> Finding:
    """Draw everything once more, for the tail and for tests that hold for every law."""
    value, error = float(quantity.value[channel]), float(quantity.error[channel])
    spread = None if quantity.variance is None else float(quantity.variance[channel])
    bets, tail = Bets(value - error, value + error, spread, data.n, alpha), Tail(value)
    for draws, _ in source.batches():
        x = np.ascontiguousarray(quantity.numbers(draws)[:, channel])
        bets, tail = bets.after(x), tail.after(x)
    p = bets.p_value
    index, spread_of_index = tail.index()
    heavy = tail.suspect() and spread is None
    if p <= alpha:
        message = f"{finding.message.partition(';')[0]}; betting against it, which assumes no normal law"
        message += "" if bets.two_sided else ", only that the values are not negative"
        return replace(
            finding, outcome="rejected", message=message, p_value=p, alpha=alpha, exact=False, cause=quantity.cause
        )
    if heavy:
        message = f"{finding.message.partition(';')[0]}; infinite variance suspected, the tail has index"
        message += (
            f" {index:.2g} +- {spread_of_index:.1g} where 2 is the least: neither a pass nor a failure means anything"
        )
        return replace(finding, outcome="inconclusive", message=message, p_value=None, exact=False, cause="", region=())
    if finding.outcome == "inconclusive" and bets.two_sided:
        found = bets.detectable(normal_quantile(0.01))
        message = f"{finding.message.partition(';')[0]}; skewed, so tested by Catoni's function and the exact variance"
        resolution = Resolution(f"bias of {finding.check}", found, 0.01)
        return replace(finding, outcome="not rejected", message=message, p_value=p, alpha=alpha, resolution=resolution)
    return finding
