"""One mean held to its reference: by the usual test, by what is declared, by a second look at all numbers where tails are heavy."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.escalation import EARLY
from fogproof.checks.quantities import CheckedQuantity
from fogproof.checks.statistics.bets import Bets
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.heavy import TailEstimate
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.light import light_tailed_p
from fogproof.checks.statistics.means import DOUBT, mean_test, trusted
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.unseen import unseen_size
from fogproof.checks.verdict import Finding, Outcome, Resolution
from fogproof.contracts import Draws

SECOND = 0.1  # of a mean's share for bets, which hold for every law
_SUSPICIOUS = 0.005  # of one sample in the sum of squares: the tail is looked at
_ABSURD = 100.0  # times all that was seen: an unseen event that would have to be larger is not waited for

Again = Callable[[], Iterable[tuple[Draws, list[int]]]]


@dataclass(frozen=True)
class MeanClaim:
    """One quantity in one channel, what was seen of it, and its share of alpha.

    further  how far off a number that was not met must be allowed to lie, where only two were and nothing is declared
    """

    quantity: CheckedQuantity
    channel: int
    name: str
    data: Moments
    samples: int
    share: float
    further: float = 0.0

    @property
    def value(self) -> float:
        """What the mean should be."""
        return float(self.quantity.value[self.channel])

    @property
    def error(self) -> float:
        """By how much it may differ from that."""
        return float(self.quantity.error[self.channel])

    @property
    def uncertain(self) -> float:
        """By how much the reference itself may be off."""
        own = self.quantity.own
        return self.error if own is None else float(own[self.channel])

    @property
    def known(self) -> Known:
        """What is declared; and where nothing is, that there are no negative values if only absurd ones could matter."""
        known = self.quantity.known_of(self.channel)
        undeclared = known == Known(light=known.light, told=known.told) and not self.quantity.signed
        if self.quantity.name.startswith("mean") and undeclared and self.data.low >= 0 and self._absurd(above=True):
            return replace(known, low=0.0, assumed=True)
        return known

    def _absurd(self, above: bool = False) -> bool:
        """Return whether an event unseen so far would have to be absurdly large to explain the mean; `above`: one too large."""
        effect = self.data.mean - self.value
        size = abs(unseen_size(self.data, effect, self.error, self.share))
        seen = max(abs(self.data.low), abs(self.data.high)) if above or self.data.m2 == 0 else self.data.largest
        return size > _ABSURD * max(seen, self.error) and (effect > 0 or not above)

    def exactly(self) -> Finding:
        """Judge an estimator that declares no variance: every single realisation must be the reference."""
        low, high, value = self.data.low, self.data.high, self.value
        gap = max(abs(low - value), abs(high - value))
        wrong = not gap <= self.error + 1e-12 * abs(value)
        message = f"every realisation must be {value:.15g}{_within(self.error)}; they lie in [{low:.15g}, {high:.15g}]"
        outcome: Outcome = "rejected" if wrong else "not rejected"
        return Finding(self.name, outcome, message, effect=gap, cause="bias" if wrong else "")

    def outside(self) -> list[Finding]:
        """Return the values that lie outside declared bounds, if there are any."""
        known = self.quantity.known_of(self.channel)
        if self.quantity.name != "mean":
            return []
        slack = 1e-12 * max(abs(self.data.low), abs(self.data.high))
        if self.data.low >= known.low - slack and self.data.high <= known.high + slack:
            return []
        message = (
            f"values lie in [{self.data.low:.9g}, {self.data.high:.9g}], declared are ({known.low:g}, {known.high:g})"
        )
        return [Finding(self.name.replace("mean", "bounds", 1), "rejected", message, cause="outside the domain")]

    def judged(self, again: Again, complete: bool) -> Finding:
        """Judge the mean; where the usual test may mislead, look at every number once more."""
        alpha, known = (1 - SECOND) * self.share, self.known
        cause = self.quantity.cause
        finding = mean_test(
            self.name,
            self.name,
            self.data,
            self.value,
            self.error,
            alpha,
            cause,
            known,
            self.uncertain,
            self.quantity.ways,
            self.further,
        )
        if finding.outcome == "inconclusive" and self.quantity.tame and self.data.m2 == 0 and self._absurd():
            side = "too large" if self.data.mean > self.value else "too small"
            message = finding.message.partition(". Declare")[0]
            return replace(finding, outcome="rejected", message=message, cause=cause, region=(side,))
        if self.quantity.name == "variance" and "too small" in finding.region and not self._may_fall_short(finding):
            message = f"{finding.message.partition(';')[0]}; rare values that were not seen may hold the rest"
            message += ": ask for more samples" + ("" if self.known.bounded else self.quantity.ways.of_values())
            return replace(finding, outcome="inconclusive", message=message, p_value=None, cause="", region=())
        if self._too_few(finding):
            message = f"{finding.message}; {self.data.n} are too few: the opposite of the reference would pass"
            return replace(finding, outcome="inconclusive", message=message, p_value=None)
        doubtful = not trusted(self.data, alpha, known) or self.data.largest_share > _SUSPICIOUS
        if doubtful and self.data.n > 1 and finding.outcome != "rejected" and "coarsely" not in finding.message:
            return self._second_look(finding, again, complete)
        return finding

    def _too_few(self, finding: Finding) -> bool:
        """Return whether a few values pass that tell nothing: scattered like this, the reference's opposite would pass too."""
        few = finding.outcome == "not rejected" and finding.p_value is not None and self.known.light
        if not few or self.quantity.name != "mean" or self.value == 0:
            return False
        gap = 2 * max(abs(self.value), self.data.deviation) - self.error
        return light_tailed_p(self.data.n, gap / max(self.data.stderr, math.ulp(0.0))) > self.share

    def _may_fall_short(self, finding: Finding) -> bool:
        """Return whether a variance that is too small is an error: it is none if rare values can hold what is missing."""
        return finding.distribution_free or self.known.light

    def _second_look(self, finding: Finding, again: Again, complete: bool) -> Finding:
        alpha, known = SECOND * self.share, self.known
        bets = Bets(self.value - self.error, self.value + self.error, known, self.samples, alpha)
        tail = TailEstimate(self.value)
        for draws, _ in again():
            x = np.ascontiguousarray(self.quantity.numbers(draws)[:, self.channel])
            bets, tail = bets.after(x) if bets.possible else bets, tail.after(x)
        start = finding.message.partition(";")[0]
        p = bets.p_value
        if p <= alpha:
            message = f"{start}; betting against it, which assumes no normal law"
            message += "" if known.two_sided else f", only {known.words()}"
            side = "too large" if self.data.mean > self.value else "too small"
            cause = self.quantity.cause
            return replace(
                finding,
                outcome="rejected",
                message=message,
                p_value=p,
                alpha=alpha,
                exact=False,
                cause=cause,
                region=(side,),
                distribution_free=True,
            )
        if tail.suspect() and not known.two_sided:
            index, spread = tail.index()
            message = f"{start}; infinite variance suspected, the tail has index {index:.2g} +- {spread:.1g}"
            message += " where 2 is the least: neither a pass nor a failure means anything"
            return replace(
                finding,
                outcome="inconclusive",
                message=message,
                p_value=None,
                exact=False,
                resolution=None,
                interval=None,
                cause="",
                region=(),
            )
        if finding.outcome == "inconclusive" and known.variance is not None and complete and p > DOUBT:
            message = f"{start}; rare values matter, so tested by Catoni's function and the exact variance"
            resolution = Resolution(f"bias of {finding.check}", bets.detectable(MISS) + self.error, MISS, self.value)
            return replace(
                finding, outcome="not rejected", message=message, p_value=p, alpha=alpha, resolution=resolution
            )
        return finding

    def beyond_doubt(self, finding: Finding) -> bool:
        """Return whether the finding rejects whatever more realisations would show.

        Its p-value is far below any share of alpha, and what was used holds for every law, or an unseen event would be absurd.
        """
        if finding.outcome != "rejected" or finding.p_value is None or finding.p_value > EARLY * self.share:
            return False
        return finding.distribution_free or self._absurd()


def _within(error: float) -> str:
    return f" +- {error:.2g}" if error else ""
