"""`check_sampler`: does a sampler draw from the density it claims, and is that a density?

First what needs no statistics: normalisation by quadrature with an error bound, edge uniforms, domain, finite positive densities,
returned values against pdf(x), event labels, the mean cosine, an independent reference. Then statistics on counts, each test
seeing what the others miss, inside one false-alarm probability: Kolmogorov's distance, smooth components, chi-square, scans for
skipped and crowded bands, the ends of each axis, the dependence of axes and of successive samples, repeated points, and every
atom's exact law.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from inspect import signature
from itertools import pairwise
from typing import Any

import numpy as np

from fogproof.checks.declared import declared, unchecked
from fogproof.checks.diagnosis import diagnosed, likely_cause
from fogproof.checks.escalation import EARLY, Stage, doubtful, judged, stages, total_weight
from fogproof.checks.figures import bins_figure, z_map_figure
from fogproof.checks.prepared import Prepared
from fogproof.checks.preparing import prepare
from fogproof.checks.statistics.cells import blocks
from fogproof.checks.streams import batch_generator, batch_sizes
from fogproof.checks.subject import Precision, Subject
from fogproof.checks.suite import tests_of
from fogproof.checks.tally import Tally
from fogproof.checks.verdict import Finding, Verdict
from fogproof.contracts import Reference
from fogproof.doing import doing
from fogproof.domains import Domain

_PATIENCE = 60.0  # seconds


def check_sampler(
    sample: Callable[..., Any],
    pdf: Callable[[np.ndarray], Any],
    domain: Domain,
    *,
    dimensions: int | None,
    atoms: Mapping[Any, float] | None = None,
    cdf: Callable[[np.ndarray], Any] | None = None,
    eval: Callable[[np.ndarray], Any] | None = None,
    axis: tuple[float, float, float] | None = None,
    mean_cosine: float | None = None,
    albedo: float | tuple[float, ...] | None = None,
    reference: Callable[[np.ndarray], Reference] | None = None,
    precision: Precision = "float64",
    events: Mapping[int, float] | None = None,
    uniform_bits: int | None = None,
    quasi_random: bool = False,
    breaks: Mapping[str, Any] | None = None,
    support: Domain | None = None,
    inverse: Callable[[np.ndarray], Any] | None = None,
    resolution: float | None = None,
    samples: int = 1_000_000,
    alpha: float = 1e-6,
    seed: int | None = None,
) -> Verdict:
    """Test a sampler against the density it claims; every sub-check shares one false-alarm probability `alpha`.

    sample       `sample(u)` with u (n, dimensions) in [0, 1) -> points or `Draw`; `sample(rng, n)` if `dimensions` is None
    pdf          `pdf(x)` -> (n,) density of the continuous part in the domain's measure (a probability on `Discrete`)
    domain       where the points live, see `fogproof.domains`
    atoms        {point: probability}; a point may be inf, and is a tuple where points are several numbers
    cdf          `cdf(x)` -> (n,) P(X <= x), atoms included; on two dimensions the Rosenblatt map or any
                 bijection x -> u onto the unit square under which samples are uniform, such as the sampler's inverse: (n, 2)
    eval         `eval(x)` -> (n,) or (n, channels), the function that weights are for: a weight must be eval(x) / pdf(x)
    axis         unit vector; `mean_cosine` is the declared mean of x . axis on the sphere
    albedo       the integral of `eval` over the domain, one number or one a channel; without `eval`, the mean weight
    reference    x -> `Reference`: what pdf(x) should be, from an independent source
    precision    "float32" if the sampler computes in single precision: uniforms and tolerances follow
    events       {label: probability} of every event label that `Draw.event` may have
    uniform_bits how many bits the uniforms inside the sampler have, if fewer than the precision's own: repeats and gaps follow
    quasi_random True if the points of one call are stratified or a low-discrepancy sequence: only their distribution is tested
    breaks       {coordinate: where the pdf may jump}, such as the edges of a table's cells: {"x": edges}; coordinates are called
                 x and y on the plane, mu and phi on the sphere, r and phi on the disk
    support      the part of the domain outside which the pdf is 0, itself a domain: `Triangle(...)` in `UnitSquare()`
    inverse      x -> u (n, k), any bijection from the domain, of k coordinates, onto the unit cube under which samples are uniform
    resolution   Kolmogorov distance to detect: the first look is sized for it, and a sampler that is clearly right stops there
    samples      most samples to draw
    alpha        false-alarm probability of this call with everything in it
    seed         any whole number; None draws a fresh one, which the verdict states

    `breaks`, `support` and `inverse` are hints: they make a check sharper where a pdf jumps, and change no verdict if they are
    wrong. A hint that the pdf contradicts is not used, and the verdict says so in `unchecked`.
    """
    check = sampler_check(
        sample,
        pdf,
        domain,
        dimensions=dimensions,
        atoms=atoms,
        cdf=cdf,
        eval=eval,
        axis=axis,
        mean_cosine=mean_cosine,
        albedo=albedo,
        reference=reference,
        precision=precision,
        events=events,
        uniform_bits=uniform_bits,
        quasi_random=quasi_random,
        breaks=breaks,
        support=support,
        inverse=inverse,
        resolution=resolution,
        samples=samples,
        alpha=alpha,
        seed=seed,
    )
    return check.run()


def sampler_check(*arguments: Any, **options: Any) -> SamplerCheck:
    """Return the check that `check_sampler` runs, for the same arguments."""
    bound = signature(check_sampler).bind(*arguments, **options)
    bound.apply_defaults()
    given = bound.arguments | {name: dict(bound.arguments[name] or {}) for name in ("atoms", "events")}
    settings = {name: given.pop(name) for name in ("resolution", "samples", "alpha", "seed")}
    needed = ("sample", "pdf", "domain", "dimensions")
    parts = {name: value for name, value in given.items() if value is not None or name in needed}
    return SamplerCheck.of(Subject(**parts), **settings)


@dataclass(frozen=True)
class SamplerCheck:
    """A check in parts: batches drawn anywhere and in any number of sittings, judged once they are together.

    Two of the same subject and seed have the same cells, so tallies of theirs merge; a tally is written and read with
    `Tally.to_dict` and `read`.
    """

    prepared: Prepared
    looks: tuple[Stage, ...]
    alpha: float
    seed: int
    started: float

    @staticmethod
    def of(subject: Subject, resolution: float | None, samples: int, alpha: float, seed: int | None) -> SamplerCheck:
        """Validate the arguments, those of `check_sampler`, and ask all questions that need no samples."""
        started = time.perf_counter()
        subject, samples, seed = declared(subject, resolution, samples, alpha, seed)
        doing("questions that need no samples")
        with np.errstate(all="ignore"):  # what is infinite or undefined is found, not warned of
            prepared = prepare(subject, samples, seed)
        weight = total_weight(tests_of(prepared, prepared.counter.empty()))
        return SamplerCheck(prepared, stages(samples, resolution, alpha, weight), alpha, seed, started)

    @cached_property
    def sizes(self) -> list[int]:
        """The sizes of all batches: every look comes at the end of one."""
        ends = [look.samples for look in self.looks]
        return [size for start, end in pairwise([0, *ends]) for size in batch_sizes(end - start)]

    @property
    def batches(self) -> int:
        """How many batches make up the largest number of samples."""
        return len(self.sizes)

    def tally(self, batches: Iterable[int]) -> Tally:
        """Draw and count the given batches, increasing numbers below `batches`."""
        tally = self.prepared.counter.empty()
        with np.errstate(all="ignore"):
            for index in batches:
                doing(f"sample {sum(self.sizes[:index])} of {self.prepared.samples} at most")
                draw = self.prepared.subject.draw(batch_generator(self.seed, "samples", 1, index), self.sizes[index])
                tally = tally.merged(self.prepared.counter.tally(draw, index))
        return tally

    def read(self, state: dict[str, Any]) -> Tally:
        """Return the tally that `Tally.to_dict` wrote."""
        return Tally.from_dict(state, self.prepared.counter.empty().watch)

    def verdict(self, tally: Tally) -> Verdict:
        """Judge a tally: with all batches by the whole of alpha, with fewer only what is beyond doubt."""
        whole = tally.drawn == self.prepared.samples
        look = self.looks[-1] if whole else Stage(tally.drawn, EARLY, final=False)
        findings = self._judged(tally, look)
        if not whole and all(f.outcome != "rejected" for f in findings):
            message = f"{len(tally.batches)} of {self.batches} batches are drawn"
            findings.append(Finding("all batches", "inconclusive", message))
        return explained(self.prepared.subject, self._verdict(findings, tally))

    def run(self) -> Verdict:
        """Draw and judge, look by look, until something is rejected or nothing is doubtful, and look for the cause."""
        return explained(self.prepared.subject, self.unexplained())

    def unexplained(self) -> Verdict:
        """Return the same with no other word of its cause than the findings'."""
        tally, findings = self.prepared.counter.empty(), []
        for look in self.looks:
            enough = int(np.searchsorted(np.cumsum(self.sizes), look.samples)) + 1
            tally = tally.merged(self.tally(range(len(tally.batches), enough)))
            findings = self._judged(tally, look)
            rejected = any(f.outcome == "rejected" for f in findings)
            if rejected or (look.final and not doubtful(findings, self.alpha * look.share)):
                break
        return self._verdict(findings, tally)

    def _judged(self, tally: Tally, look: Stage) -> list[Finding]:
        with np.errstate(all="ignore"):
            return judge(self.prepared.refined(tally), tally, self.alpha * look.share, look.final)

    def _verdict(self, findings: list[Finding], tally: Tally) -> Verdict:
        subject = self.prepared.subject
        settings = {
            "domain": repr(subject.domain),
            "dimensions": subject.dimensions,
            "precision": subject.precision,
            "tests": sum(f.alpha is not None for f in findings),
            "looks": [look.samples for look in self.looks],
        }
        reproduce = (
            f"check_sampler(sample, pdf, {subject.domain!r}, dimensions={subject.dimensions}{_options(subject)},"
            f" samples={self.prepared.samples}, alpha={self.alpha!r}, seed={self.seed})"
        )
        seconds = time.perf_counter() - self.started
        pilot = self.prepared.pilot
        return Verdict(
            tuple(findings),
            self.alpha,
            tally.drawn,
            self.seed,
            seconds,
            settings,
            likely_cause(findings),
            reproduce,
            unchecked=(
                *unchecked(subject, pilot.channels, bool(pilot.labels)),
                *self.prepared.unheld(tally),
                *self.prepared.disbelieved,
            ),
        )


def explained(subject: Subject, verdict: Verdict) -> Verdict:
    """Return a verdict with the cause that explains its rejection; the search takes no longer than the check, or a minute."""
    patience = max(verdict.seconds, _PATIENCE)
    cause, diagnosis = diagnosed(subject, verdict.findings, verdict.samples, verdict.seed, patience)
    return replace(verdict, cause=cause, diagnosis=diagnosis)


def judge(prepared: Prepared, tally: Tally, alpha: float, final: bool = True) -> list[Finding]:
    """Return all findings about the samples so far; the statistical ones share alpha."""
    findings = [prepared.normalisation(tally), *prepared.findings, *tally.watch.findings()]
    statistical = judged(tests_of(prepared, tally), alpha, final)
    return findings + _illustrated(prepared, tally, statistical)


def _illustrated(prepared: Prepared, tally: Tally, findings: list[Finding]) -> list[Finding]:
    """Return the findings with a figure on the first, and on every rejected one that counts cells."""
    if not prepared.counted:
        return findings
    marginals, plane = prepared.grid.marginals, prepared.grid.plane
    if plane is None or tally.plane is None:
        figure = bins_figure(marginals[0], tally.fine[0])
    else:
        figure = z_map_figure((marginals[0], marginals[1]), plane, blocks(tally.plane, len(plane.mass)))
    shown = []
    for index, finding in enumerate(findings):
        wanted = index == 0 or finding.outcome == "rejected"
        shown.append(replace(finding, figure=figure) if wanted else finding)
    return shown


def _options(subject: Subject) -> str:
    """Return what else was declared, as arguments of a call; functions go by the names of their arguments."""
    functions = [
        f", {name}={name}" for name in ("cdf", "eval", "reference", "inverse") if getattr(subject, name) is not None
    ]
    names = ("atoms", "axis", "mean_cosine", "albedo", "events", "uniform_bits", "quasi_random", "breaks", "support")
    values = [f", {name}={_plain(getattr(subject, name))!r}" for name in names if getattr(subject, name)]
    precision = [f", precision={subject.precision!r}"] if subject.precision != "float64" else []
    return "".join(functions + values + precision)


def _plain(value: Any) -> Any:
    """Return a declared value without NumPy in it: the line that repeats a verdict needs no import of it."""
    if isinstance(value, Mapping):
        return {_plain(key): _plain(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
