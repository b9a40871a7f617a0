"""`check_estimator`: is the mean of an estimator its reference, and are variance and cost what theory says?"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fogproof.checks.means import Moments, mean_test
from fogproof.checks.streams import batch_generator, batch_sizes, fresh_seed
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Verdict, jsonable
from fogproof.contracts import Draws, Reference
from fogproof.errors import SubjectError
from fogproof.validate import number

_TRACE = 12  # points of the running mean kept for the figure


def check_estimator(
    draw: Callable[[np.random.Generator, int], Any],
    reference: Reference,
    *,
    variance: Reference | float | None = None,
    cost: Reference | float | None = None,
    samples: int = 1_000_000,
    alpha: float = 1e-6,
    seed: int | None = None,
) -> Verdict:
    """Test that an estimator's expectation is the reference; every sub-check shares one false-alarm probability `alpha`.

    draw       `draw(rng, n)` -> (n,) or (n, channels) independent realisations, or `Draws`
    reference  its expectation, () or (channels,), with an error bound that is counted
    variance   the exact variance of one realisation, tested as the mean of (X - reference)^2; 0 declares that there is none
    cost       the exact expectation of `Draws.cost`
    samples    how many realisations
    alpha      false-alarm probability of this call with everything in it
    seed       any whole number; None draws a fresh one, which the verdict states
    """
    started = time.perf_counter()
    number("alpha", alpha, "must lie in (0, 1)", 0, 1, open_ends=True)
    number("samples", samples, "must be at least 100", 100)
    seed = fresh_seed() if seed is None else seed
    value, error = (np.atleast_1d(np.asarray(part, dtype=float)) for part in (reference.value, reference.error))
    value, error = np.broadcast_arrays(value, error)
    tally = _Tally(value, variance is not None)
    for index, n in enumerate(batch_sizes(samples)):
        result = call("draw(rng, n)", draw, batch_generator(seed, "draws", 0, index), n)
        tally.add(result if isinstance(result, Draws) else Draws(result), n)

    if tally.bad:
        message = f"{tally.bad} of {samples} realisations are not finite"
        findings = [Finding("finite values", "rejected", message, effect=tally.bad / samples)]
        return Verdict(tuple(findings), alpha, samples, seed, time.perf_counter() - started)
    findings = [Finding("finite values", "not rejected", f"all {samples} realisations are finite")]
    channels = len(value)
    share = alpha / (channels * (1 + (variance is not None)) + (cost is not None))
    variance_value, variance_error = _exact(variance, channels)
    for c in range(channels):
        label = f" of channel {c}" if channels > 1 else ""
        zero = variance is not None and variance_value[c] == 0
        finding = _zero_variance(label, tally.values[c], value[c], error[c]) if zero else None
        finding = finding or mean_test(f"mean{label}", f"mean{label}", tally.values[c], value[c], error[c], share)
        findings.append(replace(finding, figure=tally.figure(c, value[c], error[c])))
        if variance is not None and not zero:
            # (X - r)^2 has expectation V + (mean - r)^2, and |mean - r| <= error.
            slack = variance_error[c] + error[c] ** 2
            name = f"variance{label}"
            findings.append(mean_test(name, name, tally.squares[c], variance_value[c], slack, share))
    if cost is not None:
        cost_value, cost_error = _exact(cost, 1)
        if tally.costs.n != samples:
            raise SubjectError("draw must return Draws with a cost when a reference cost is given", "draw: cost")
        findings.append(mean_test("cost", "cost", tally.costs, cost_value[0], cost_error[0], share))
    return Verdict(tuple(findings), alpha, samples, seed, time.perf_counter() - started, {"channels": channels})


def _exact(reference: Reference | float | None, channels: int) -> tuple[np.ndarray, np.ndarray]:
    if isinstance(reference, Reference):
        value, error = reference.value, reference.error
    else:
        value, error = np.asarray(0.0 if reference is None else reference), np.asarray(0.0)
    return np.broadcast_to(value, (channels,)), np.broadcast_to(error, (channels,))


def _zero_variance(label: str, data: Moments, value: float, error: float) -> Finding:
    """Judge an estimator that declares no variance: every single realisation must be the reference."""
    gap = max(abs(data.low - value), abs(data.high - value))
    wrong = not gap <= error + 1e-12 * abs(value)
    message = f"every realisation{label} must be {value:.15g}; they lie in [{data.low:.15g}, {data.high:.15g}]"
    return Finding(f"mean{label}", "rejected" if wrong else "not rejected", message, effect=gap)


@dataclass
class _Tally:
    """Moments of everything an estimator returns, merged in the order of the batches."""

    reference: np.ndarray
    with_squares: bool
    values: list[Moments] = field(default_factory=list)
    squares: list[Moments] = field(default_factory=list)
    costs: Moments = field(default_factory=Moments)
    trace: list[tuple[int, list[float], list[float]]] = field(default_factory=list)
    bad: int = 0

    def add(self, draws: Draws, n: int) -> None:
        x = np.asarray(draws.value)
        if x.dtype.kind not in "iufb":
            raise SubjectError(f"draw must return numbers, got dtype {x.dtype}", "draw: value")
        channels = len(self.reference)
        if x.shape not in ({(n,), (n, 1)} if channels == 1 else {(n, channels)}):
            wanted = f"({n},)" if channels == 1 else f"({n}, {channels})"
            raise SubjectError(f"draw must return an array of shape {wanted}, got {x.shape}", "draw: value")
        x = x.reshape(n, channels).astype(np.float64)
        self.bad += int(np.count_nonzero(~np.isfinite(x).all(axis=1)))
        if self.bad:
            return
        self.values = _merged(self.values, x)
        if self.with_squares:
            self.squares = _merged(self.squares, (x - self.reference) ** 2)
        if draws.cost is not None:
            self.costs = self.costs.merged(Moments.of(np.asarray(draws.cost, dtype=np.float64)))
        self.trace.append((self.values[0].n, [m.mean for m in self.values], [m.stderr for m in self.values]))

    def figure(self, channel: int, reference: float, error: float) -> dict[str, Any]:
        """Return the data of a plot of the running mean, at counts that grow by about a constant factor."""
        picks = np.unique(np.geomspace(1, len(self.trace), _TRACE).astype(int)) - 1
        rows = [self.trace[i] for i in picks]
        columns = {
            "n": [r[0] for r in rows],
            "mean": [r[1][channel] for r in rows],
            "stderr": [r[2][channel] for r in rows],
        }
        return jsonable({"kind": "mean", "reference": reference, "error": error, **columns})


def _merged(old: list[Moments], x: np.ndarray) -> list[Moments]:
    new = [Moments.of(column) for column in x.T]
    return [a.merged(b) for a, b in zip(old, new, strict=True)] if old else new
