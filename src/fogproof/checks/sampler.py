"""`check_sampler`: does a sampler draw from the density it claims, and is that a density?

First what needs no statistics: normalisation by quadrature with an error bound, edge uniforms, domain, finite positive densities,
returned values against pdf(x), event labels, the mean cosine, an independent reference. Then statistics on counts, each test
seeing what the others miss, inside one false-alarm probability: Kolmogorov's distance, smooth components, chi-square, scans for
skipped and crowded bands, the ends of each axis, the dependence of axes and of successive samples, repeated points, and every
atom's exact law.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any

import numpy as np

from fogproof.checks.sampler_parts import SamplerCheck
from fogproof.checks.subject import Precision, Subject
from fogproof.checks.verdict import Verdict
from fogproof.contracts import Reference
from fogproof.domains import Domain


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
    pdf          `pdf(x)` -> (n,) density of the continuous part in the domain's measure (a probability on `Discrete`,
                 whose points come as integers; beside others in a `Product`, and without an end, as floats)
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
    """Return the check that `check_sampler` runs, for the same arguments, to be drawn in parts."""
    bound = signature(check_sampler).bind(*arguments, **options)
    bound.apply_defaults()
    given = bound.arguments | {name: dict(bound.arguments[name] or {}) for name in ("atoms", "events")}
    settings = {name: given.pop(name) for name in ("resolution", "samples", "alpha", "seed")}
    needed = ("sample", "pdf", "domain", "dimensions")
    parts = {name: value for name, value in given.items() if value is not None or name in needed}
    return SamplerCheck.of(Subject(**parts), **settings)
