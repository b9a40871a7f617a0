"""A subject made ready to be sampled: its claim integrated, cells laid out, and what needs no samples already found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fogproof.checks.call_sizes import Points
from fogproof.checks.claim import Claim, blind
from fogproof.checks.counter import Counter
from fogproof.checks.density.features import emptiest
from fogproof.checks.density.grid import Grid
from fogproof.checks.density.grid_of_density import refilled
from fogproof.checks.density.model import looked_at, looked_at_plane
from fogproof.checks.normalisation import FLOOR, normalisation
from fogproof.checks.pilot import Pilot
from fogproof.checks.statistics.repeats import KEPT, expected_repeats
from fogproof.checks.subject import Subject
from fogproof.checks.tally import Tally
from fogproof.checks.verdict import Finding
from fogproof.domains import Discrete, UnitHemisphere, UnitSphere


@dataclass(frozen=True)
class Prepared:
    """All that does not depend on the tested samples.

    claim     the density integrated by quadrature, None where there is no chart to do it on
    findings  of deterministic checks, but for the normalisation, which the samples may still refine
    counted   whether the probabilities of the cells are known: from quadrature, a table, or a given cdf
    calls     points of small calls of a sampler that draws its own uniforms, None of any other
    disbelieved  hints that the pdf contradicts, and how
    """

    subject: Subject
    samples: int
    pilot: Pilot
    claim: Claim | None
    counter: Counter
    findings: tuple[Finding, ...]
    counted: bool
    calls: Points | None = None
    seed: int = 0
    disbelieved: tuple[str, ...] = ()

    @property
    def grid(self) -> Grid:
        """The cells that samples are counted in."""
        return self.counter.grid

    @cached_property
    def integral(self) -> tuple[float, float] | None:
        """The integral of the pdf and a bound on its error; None where it is not known, and the labels judge it."""
        if self.claim is not None:
            return None if self.claim.doubt else (self.claim.leaves.total, self.claim.leaves.total_error)
        if not (self.counted and isinstance(self.subject.domain, Discrete)):
            return None
        mass = self.subject.density(np.arange(self.grid.marginals[0].mass.size, dtype=np.float64))
        return float(mass.sum()), 4 * self.subject.roundoff * float(np.sum(np.abs(mass)))

    @cached_property
    def first_call(self) -> np.ndarray:
        """The pilot's counts, (k, 32): those of a call like any other."""
        return self.counter.coarse_at(self.pilot.points)

    def convention(self, tally: Tally) -> tuple[float | None, int]:
        """Return the probability of the continuous part, None where it is not known, and among how many samples.

        A sampler may give samples up. Then either the pdf is that of the valid ones, or it counts every sample and its integral is
        the probability of success: which of the two is told by the integral.
        """
        valid = tally.drawn - tally.given_up
        if self.integral is None:
            return None, tally.drawn
        if not tally.given_up:
            return 1 - sum(self.subject.atoms.values()), valid
        total, error = self.integral
        slack = error + FLOOR[self.subject.precision] + (self.claim.rounding if self.claim else 0.0)
        whole = abs(total + sum(self.subject.atoms.values()) - 1) <= slack
        return (1 - sum(self.subject.atoms.values()), valid) if whole else (total, tally.drawn)

    def unheld(self, tally: Tally) -> tuple[str, ...]:
        """Return in words that the share of samples given up is held to nothing: neither the pdf nor the mean weight tells it."""
        told = self.integral is not None and self.convention(tally)[1] == tally.drawn
        if not tally.given_up or told or (tally.weights and self.subject.albedo is not None):
            return ()
        known = "the pdf is" if self.integral is not None else "no integral is known; the pdf may be"
        return (
            f"that {tally.given_up / tally.drawn:.3g} of the samples are given up: {known} that of the valid ones alone",
        )

    def normalisation(self, tally: Tally) -> Finding:
        """Return the finding on the integral of the pdf."""
        if self.integral is None:
            why = "there is no quadrature on this domain" if self.claim is None else self.claim.doubt
            return Finding("normalisation", "not rejected", f"{why}: the labels of samples and known points judge it")
        rounding = self.claim.rounding if self.claim else 0.0
        hidden = 16 / tally.drawn if self.claim and self.claim.found else 0.0
        share = tally.given_up / max(tally.drawn, 1)
        unseen = blind(len(self.claim.chart.axes)) if self.claim else 0.0
        finding = normalisation(self.subject, *self.integral, rounding, hidden, share, unseen)
        agreed = any(f.check == "cdf against the pdf" and f.outcome == "not rejected" for f in self.findings)
        if finding.outcome == "inconclusive" and agreed:
            message = (
                f"{finding.message.partition(';')[0]}, and agrees with the given cdf wherever it can be integrated"
            )
            return replace(finding, outcome="not rejected", message=message)
        return finding

    def expected_repeats(self, n: int) -> float:
        """Return about how many repeated points a right sampler may show among n."""
        points = self.pilot.points[:2048]
        if len(points) == 0:
            return 0.0
        pole = 0.0
        if self.claim is not None and isinstance(self.subject.domain, (UnitSphere, UnitHemisphere)):
            marginal = self.claim.grid.marginals[0]
            near = 4 * self.subject.roundoff * (marginal.edges[-1] - marginal.edges[0])
            low, high = marginal.at(np.array([marginal.edges[0] + near, marginal.edges[-1] - near]))
            pole = float(low + (1 - high))
        p = self.subject.density(points)
        return expected_repeats(
            min(n, KEPT),
            self.subject.domain,
            self.subject.precision,
            points,
            np.where(np.isfinite(p), p, 0.0),
            pole,
            self.subject.uniform_bits,
        )

    def refined(self, tally: Tally) -> Prepared:
        """Return the same with the density integrated anew where the samples showed something unknown."""
        claim = self.claim
        if claim is None or claim.doubt or self.counter.ranges is None:
            return self
        strange = claim.chart.coordinates(tally.strange) if len(tally.strange) else np.empty((0, len(claim.chart.axes)))
        if len(claim.chart.axes) == 1:
            probes = emptiest(claim.chart.axes[0], claim.grid.marginals[0], tally.fine[0])
            points = np.sort(np.concatenate([strange[:, 0], probes]))
            leaves = looked_at(claim.density, claim.leaves, points, claim.work)
        else:
            leaves = looked_at_plane(claim.density, claim.leaves, strange, claim.work)
        if leaves is claim.leaves:
            return self
        grid = refilled(claim.grid, claim.chart, leaves, self.samples)
        counted = grid if self.subject.cdf is None else self.grid
        claim = replace(claim, leaves=leaves, grid=grid, found=True)
        return replace(self, claim=claim, counter=replace(self.counter, grid=counted))
