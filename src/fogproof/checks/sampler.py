"""`check_sampler`: does a sampler draw from the density it claims, and is that a density?

First what needs no statistics: normalisation by quadrature with an error bound, edge uniforms, domain, finite positive densities,
returned values against pdf(x), the mean cosine, an independent reference. Then statistics on counts: Kolmogorov's distance on each
axis, a coarse and a fine chi-square, and the exact binomial law of every atom, inside one false-alarm probability.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, get_args

import numpy as np

from fogproof.checks.cells import Cells, cells_by_quadrature, masses_from_cdf, pilot_edges, unit_square_cells
from fogproof.checks.charts import Chart, chart_of
from fogproof.checks.contract import (
    BUDGET,
    Watch,
    cdf_agreement,
    edge_uniforms,
    integral,
    integral_slack,
    normalisation,
    reference_agreement,
)
from fogproof.checks.goodness import MISS, binomial, chi_square, kolmogorov
from fogproof.checks.streams import batch_generator, batch_sizes, fresh_seed
from fogproof.checks.subject import Precision, Subject, call, in_domain, numbers
from fogproof.checks.verdict import Finding, Verdict, jsonable
from fogproof.contracts import Reference
from fogproof.domains import Discrete, Domain, HalfLine, Interval, RealLine
from fogproof.errors import InvalidValueError
from fogproof.validate import number

_PILOT = 1 << 14  # samples that set the edges of cells; they are not counted in them
_MOST_DIMENSIONS_AT_EDGES = 4  # 4^dimensions combinations of edge uniforms are tried


def check_sampler(
    sample: Callable[..., Any],
    pdf: Callable[[np.ndarray], Any],
    domain: Domain,
    *,
    dimensions: int | None,
    atoms: Mapping[float, float] | None = None,
    cdf: Callable[[np.ndarray], Any] | None = None,
    eval: Callable[[np.ndarray], Any] | None = None,
    axis: tuple[float, float, float] | None = None,
    mean_cosine: float | None = None,
    albedo: float | None = None,
    reference: Callable[[np.ndarray], Reference] | None = None,
    breaks: Sequence[float] = (),
    precision: Precision = "float64",
    resolution: float | None = None,
    samples: int = 1_000_000,
    alpha: float = 1e-6,
    seed: int | None = None,
) -> Verdict:
    """Test a sampler against the density it claims; every sub-check shares one false-alarm probability `alpha`.

    sample       `sample(u)` with u (n, dimensions) in [0, 1) -> points or `Draw`; `sample(rng, n)` if `dimensions` is None
    pdf          `pdf(x)` -> (n,) density of the continuous part in the domain's measure (a probability on `Discrete`)
    domain       where the points live, see `fogproof.domains`
    atoms        {point: probability} of a one-dimensional domain; a point may be inf
    cdf          `cdf(x)` -> (n,) P(X <= x), atoms included; on two dimensions the Rosenblatt map, (n, 2) in [0, 1]^2
    eval         the function that weights are for: a returned weight must be eval(x) / pdf(x)
    axis         unit vector; `mean_cosine` is the declared mean of x . axis on the sphere
    albedo       the integral of `eval` over the domain
    reference    x -> `Reference`: what pdf(x) should be, from an independent source
    breaks       points of a one-dimensional domain where the density jumps: quadrature has to be told, it may miss a jump
    precision    "float32" if the sampler computes in single precision: uniforms and tolerances follow
    resolution   Kolmogorov distance to detect: fewer samples than `samples` are drawn where they suffice for it
    samples      most samples to draw
    alpha        false-alarm probability of this call with everything in it
    seed         any whole number; None draws a fresh one, which the verdict states
    """
    started = time.perf_counter()
    atoms = dict(atoms or {})
    subject = Subject(
        sample, pdf, domain, dimensions, atoms, cdf, eval, axis, mean_cosine, albedo, reference, precision
    )
    _validate(subject, samples, alpha, resolution, breaks)
    seed = fresh_seed() if seed is None else seed
    tests = (3 if _is_line(domain) else 5) + len(atoms)
    share = alpha / tests
    if resolution is not None:
        samples = min(samples, _samples_for(resolution, share))

    pilot = _pilot(subject, seed)
    rounding = integral_slack(subject, pilot)
    findings: list[Finding] = []
    if dimensions is not None and dimensions <= _MOST_DIMENSIONS_AT_EDGES:
        findings.append(edge_uniforms(subject))
    if isinstance(domain, Discrete):
        coordinates, cells = _discrete(subject)
        edges_shown = cells.edges
        findings.append(normalisation(subject, cells, rounding))
    else:
        chart, coordinates, cells, chart_cells, more = _continuous(subject, pilot, samples, rounding, breaks)
        findings += more
        edges_shown = cells.edges if len(cells.edges) > 1 else (_shown(chart, cells.edges[0]),)
        if axis is not None and mean_cosine is not None:
            findings.append(integral("mean cosine", subject, chart, chart_cells, rounding, "pdf", mean_cosine))
        if eval is not None and albedo is not None:
            findings.append(integral("albedo", subject, chart, chart_cells, rounding, "eval", albedo))
    if reference is not None and len(pilot):
        findings.append(reference_agreement(subject, pilot))

    watch = Watch(subject)
    counts = np.zeros(cells.mass.shape)
    hits = dict.fromkeys(atoms, 0)
    for index, n in enumerate(batch_sizes(samples)):
        draw = subject.draw(batch_generator(seed, "samples", 1, index), n)
        good = watch.look(draw)
        counts += cells.count(coordinates(draw.x[good]))
        for point, at in subject.at_atom(draw.x).items():
            hits[point] += int(np.count_nonzero(at))
    findings += watch.findings()
    findings += _goodness(cells, counts, hits, atoms, samples, share)
    findings[-1 - len(atoms)] = replace(findings[-1 - len(atoms)], figure=_figure(cells, counts, samples, edges_shown))
    settings = {"domain": repr(domain), "dimensions": dimensions, "precision": precision, "tests": tests}
    return Verdict(tuple(findings), alpha, samples, seed, time.perf_counter() - started, settings)


def _is_line(domain: Domain) -> bool:
    return isinstance(domain, (Interval, HalfLine, RealLine, Discrete))


def _validate(subject: Subject, samples: int, alpha: float, resolution: float | None, breaks: Sequence[float]) -> None:
    if not isinstance(subject.domain, get_args(Domain)):
        known = ", ".join(kind.__name__ for kind in get_args(Domain))
        raise InvalidValueError("domain", f"must be one of {known}", subject.domain)
    if subject.dimensions is not None and not (isinstance(subject.dimensions, int) and subject.dimensions >= 1):
        raise InvalidValueError("dimensions", "must be a whole number >= 1, or None", subject.dimensions)
    if subject.precision not in get_args(Precision):
        raise InvalidValueError("precision", "must be 'float64' or 'float32'", subject.precision)
    number("alpha", alpha, "must lie in (0, 1)", 0, 1, open_ends=True)
    number("samples", samples, "must be at least 100", 100)
    if resolution is not None:
        number("resolution", resolution, "must lie in (0, 1)", 0, 1, open_ends=True)
    for name, given in (("atoms", subject.atoms), ("breaks", breaks)):
        if len(given) and not isinstance(subject.domain, (Interval, HalfLine, RealLine)):
            raise InvalidValueError(name, "need a domain of one dimension", subject.domain)
    for point, probability in subject.atoms.items():
        number(f"atoms[{point!r}]", probability, "must be a probability in [0, 1]", 0, 1)
    if (subject.mean_cosine is None) != (subject.axis is None) and subject.mean_cosine is not None:
        raise InvalidValueError("axis", "must be given with mean_cosine", subject.axis)


def _samples_for(resolution: float, alpha: float) -> int:
    """Return how many samples detect a Kolmogorov distance `resolution` but for a probability `MISS`."""
    wanted = (math.sqrt(math.log(2 / alpha)) + math.sqrt(math.log(1 / MISS))) ** 2 / (2 * resolution**2)
    return max(1000, math.ceil(wanted))


def _pilot(subject: Subject, seed: int) -> np.ndarray:
    """Draw the pilot; return its good points of the continuous part."""
    draw = subject.draw(batch_generator(seed, "samples", 0, 0), _PILOT)
    good = in_domain(subject.domain, draw.x, subject.roundoff)
    for at in subject.at_atom(draw.x).values():
        good &= ~at
    if draw.valid is not None:
        good &= draw.valid
    return draw.x[good]


def _discrete(subject: Subject) -> tuple[Callable[[np.ndarray], np.ndarray], Cells]:
    assert isinstance(subject.domain, Discrete)
    n = subject.domain.n
    mass = subject.density(np.arange(n, dtype=np.float64))
    error = np.full(n, 4 * subject.roundoff) * mass
    cells = Cells(
        (np.arange(n + 1) - 0.5,), ("x",), mass, error, float(mass.sum()), float(error.sum()), n, complete=True
    )
    return (lambda x: x[:, None]), cells


def _continuous(
    subject: Subject, pilot: np.ndarray, samples: int, rounding: float, breaks: Sequence[float]
) -> tuple[Chart, Callable[[np.ndarray], np.ndarray], Cells, Cells, list[Finding]]:
    """Return the chart, the map from points to cell coordinates, the cells, and the findings about pdf and cdf alone.

    The cells come twice: those that samples are counted in, and those of the chart, over which functions are integrated.
    """
    chart = chart_of(subject.domain, pilot, subject.axis)
    jumps = chart.from_point(np.array(breaks, dtype=float)) if len(breaks) else np.empty((0, len(chart.low)))
    edges = pilot_edges(chart, chart.from_point(pilot), samples, jumps)

    def chart_density(c: np.ndarray) -> np.ndarray:
        return subject.density(chart.to_point(c)) * chart.jacobian(c)

    with np.errstate(all="ignore"):  # an infinite or undefined density is found, not warned of
        tolerance, budget = 0.1 * rounding, BUDGET[subject.precision]
        chart_cells = cells = cells_by_quadrature(chart_density, edges, chart.labels, tolerance, budget)
    findings = [normalisation(subject, cells, rounding)]
    coordinates = chart.from_point
    if subject.cdf is not None and len(edges) == 1:
        mass = _line_masses(subject, chart, edges[0])
        findings.append(cdf_agreement(mass, cells, subject.precision))
        error = np.full_like(mass, 8 * subject.roundoff)
        cells = Cells(edges, cells.labels, mass, error, cells.total, cells.total_error, cells.evaluations)
    elif subject.cdf is not None:
        rosenblatt = subject.cdf
        cells = unit_square_cells(cells)

        def coordinates(x: np.ndarray) -> np.ndarray:
            return numbers("cdf(x)", call("cdf(x)", rosenblatt, x), (len(x), 2))

    return chart, coordinates, cells, chart_cells, findings


def _line_masses(subject: Subject, chart: Chart, edges: np.ndarray) -> np.ndarray:
    assert subject.cdf is not None
    with np.errstate(divide="ignore", invalid="ignore"):
        points = chart.to_point(edges[:, None])
    ends = {HalfLine: (None, 1.0), RealLine: (0.0, 1.0)}.get(type(subject.domain), (None, None))
    values = np.empty(len(points))
    inner = slice(0 if ends[0] is None else 1, None if ends[1] is None else -1)
    values[inner] = numbers("cdf(x)", call("cdf(x)", subject.cdf, points[inner]), (len(points[inner]),))
    if ends[0] is not None:
        values[0], points[0] = ends[0], -np.inf
    if ends[1] is not None:
        values[-1], points[-1] = ends[1], np.inf
    return masses_from_cdf(values, points, subject.atoms)


def _shown(chart: Chart, edges: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return chart.to_point(edges[:, None])


def _figure(cells: Cells, counts: np.ndarray, n: int, edges: tuple[np.ndarray, ...]) -> dict[str, Any]:
    """Return the data of a plot: shares of at most 64 bins of a line, or the z-scores of a plane's cells."""
    if counts.ndim == 1:
        step = -(-counts.size // 64)
        starts = np.arange(0, counts.size, step)
        shares = {"expected": np.add.reduceat(cells.mass, starts), "observed": np.add.reduceat(counts, starts) / n}
        return jsonable({"kind": "bins", "label": "x", "edges": np.append(edges[0][starts], edges[0][-1]), **shares})
    sigma = np.sqrt(np.maximum(n * cells.mass, 1.0))
    z = np.round((counts - n * cells.mass) / sigma, 2)
    return jsonable({"kind": "z-map", "labels": cells.labels, "edges": edges, "z": z})


def _goodness(
    cells: Cells, counts: np.ndarray, hits: dict[float, int], atoms: Mapping[float, float], n: int, alpha: float
) -> list[Finding]:
    """Compare counts with masses: axis by axis, coarse and fine, and each atom with its probability."""
    findings = []
    if counts.ndim == 1:
        extra = np.array(list(atoms.values()))
        observed = np.append(counts, np.array(list(hits.values()), dtype=float))
        mass, error = np.append(cells.mass, extra), np.append(cells.mass_error, 4e-16 * extra)
        group = np.append(np.arange(counts.size) * 16 // counts.size, 16 + np.arange(len(extra)))
        findings.append(kolmogorov("distribution", "x", counts, cells.mass, cells.mass_error, n, alpha, cells.gap))
        o, m, e = (np.bincount(group, values) for values in (observed, mass, error))
        findings.append(chi_square("chi-square, coarse", o, m, e, n, alpha))
        findings.append(chi_square("chi-square, fine", observed, mass, error, n, alpha))
    else:
        for axis, label in enumerate(cells.labels):
            o, m, e = (values.sum(axis=1 - axis) for values in (counts, cells.mass, cells.mass_error))
            findings.append(kolmogorov(f"distribution of {label}", label, o, m, e, n, alpha, float(m.max())))
            findings.append(chi_square(f"chi-square in {label}", o, m, e, n, alpha))
        findings.append(chi_square("chi-square, joint", counts, cells.mass, cells.mass_error, n, alpha))
    for point, probability in atoms.items():
        slack = 1e-15 * probability
        what = f"probability of the atom at {point:g}"
        findings.append(binomial("atom", what, hits[point], n, probability - slack, probability + slack, alpha))
    return findings
