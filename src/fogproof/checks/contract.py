"""What a sampler promises and needs no statistics to check: each function returns one finding that can only be right."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np

from fogproof.checks.cells import Cells, corners
from fogproof.checks.charts import Chart
from fogproof.checks.quadrature import integrate_boxes
from fogproof.checks.subject import Precision, Subject, call, in_domain, nudged, numbers, rounding_spread
from fogproof.checks.verdict import Finding, Outcome, Resolution
from fogproof.contracts import Draw
from fogproof.errors import shorten

BUDGET: dict[Precision, int] = {"float64": 1_500_000, "float32": 600_000}
"""Most evaluations of the pdf for one integral over the domain: in single precision, noise soon makes more of them useless."""

_FLOOR: dict[Precision, float] = {"float64": 2e-7, "float32": 2e-5}
"""An integral this close to its claim is never rejected: quadrature of a black box cannot promise more."""


def normalisation(subject: Subject, cells: Cells, rounding: float) -> Finding:
    """The pdf and the atoms must sum to 1, up to the bound on the integral and what `rounding` explains."""
    total = cells.total + sum(subject.atoms.values())
    slack = cells.total_error + rounding
    resolution = Resolution("error of the pdf's integral", slack, 0.0)
    what = "the pdf and its atoms sum to" if subject.atoms else "the pdf integrates to"
    message = f"{what} {total:.9g} +- {slack:.1g}"
    if not abs(total - 1) <= slack:
        known = np.isfinite(total)
        return Finding(
            "normalisation", "rejected" if known else "inconclusive", message, effect=total - 1, resolution=resolution
        )
    if slack > 1e-3:
        message += "; it is known too coarsely to tell: give a cdf, or a pdf without noise"
        return Finding("normalisation", "inconclusive", message, effect=total - 1, resolution=resolution)
    return Finding("normalisation", "not rejected", message, effect=total - 1, resolution=resolution)


def integral_slack(subject: Subject, pilot: np.ndarray) -> float:
    """Return how far rounding alone can move an integral of the pdf: the mean relative spread over the sampled points."""
    if subject.precision == "float64" or len(pilot) == 0:
        return _FLOOR[subject.precision]
    p = subject.density(pilot)
    ratio = rounding_spread(subject.density, pilot, subject.roundoff)[p > 0] / p[p > 0]
    return _FLOOR[subject.precision] + float(np.mean(ratio)) if len(ratio) else _FLOOR[subject.precision]


def integral(
    name: str, subject: Subject, chart: Chart, cells: Cells, rounding: float, weight: str, claimed: float
) -> Finding:
    """An integral over the domain must have the declared value: of x . axis times the pdf, or of `eval`."""

    def integrand(c: np.ndarray) -> np.ndarray:
        x = chart.to_point(c)
        if weight == "eval":
            assert subject.eval is not None
            return numbers("eval(x)", call("eval(x)", subject.eval, x), (len(x),)) * chart.jacobian(c)
        return subject.density(x) * chart.jacobian(c) * (x @ np.asarray(subject.axis))

    low, high = corners(tuple(np.append(e[:-1:4], e[-1]) for e in cells.edges))
    result = integrate_boxes(integrand, low, high, 0.25 * rounding, BUDGET[subject.precision])
    slack = result.total_error + rounding
    effect = result.total - claimed
    message = f"{name} of the pdf is {result.total:.9g} +- {slack:.1g}, declared {claimed:.9g}"
    outcome: Outcome = "not rejected" if abs(effect) <= slack else "rejected" if np.isfinite(effect) else "inconclusive"
    return Finding(name, outcome, message, effect=effect, resolution=Resolution(f"error of the {name}", slack, 0.0))


def edge_uniforms(subject: Subject) -> Finding:
    """Uniforms 0, the smallest denormal, 1/2 and the largest below 1 must give points of the domain with a sane density."""
    kind = np.float32 if subject.precision == "float32" else np.float64
    edges = np.array([0.0, np.finfo(kind).smallest_subnormal, 0.5, np.nextafter(kind(1), kind(0))], dtype=kind)
    assert subject.dimensions is not None
    u = np.array(list(itertools.product(edges, repeat=subject.dimensions)), dtype=kind)
    with np.errstate(all="ignore"):
        draw = subject.draw_at(u)
        bad = ~_inside(subject, draw)
        inside = draw.x[~bad & ~_at_any_atom(subject, draw.x)]
        sane = subject.density(inside) >= 0
    name = "edge uniforms"
    if bad.any():
        i = int(np.argmax(bad))
        return Finding(
            name, "rejected", f"u = {shorten(u[i])} gives x = {shorten(draw.x[i])}, outside {subject.domain}"
        )
    if not sane.all():
        i = int(np.argmin(sane))
        return Finding(name, "rejected", f"an edge uniform gives x = {shorten(inside[i])}, where the pdf is not >= 0")
    return Finding(
        name, "not rejected", f"all {len(u)} combinations of 0, denormal, 1/2 and 1 - ulp give points of the domain"
    )


def reference_agreement(subject: Subject, points: np.ndarray) -> Finding:
    """pdf(x) must equal the independent reference at sampled points, up to the reference's error and rounding."""
    assert subject.reference is not None
    reference = subject.reference(points)
    p = subject.density(points)
    slack = reference.error + rounding_spread(subject.density, points, subject.roundoff)
    return _agreement("pdf against the reference", p, np.broadcast_to(reference.value, p.shape), slack, points)


def cdf_agreement(mass: np.ndarray, cells: Cells, precision: Precision) -> Finding:
    """The increments of a given cdf must equal the integrals of the pdf over the same cells."""
    slack = cells.mass_error + _FLOOR[precision]
    return _agreement("cdf against the pdf", mass, cells.mass, slack, cells.edges[0][1:], "the cell that ends at")


def _agreement(
    name: str, claimed: np.ndarray, right: np.ndarray, slack: np.ndarray, points: np.ndarray, at: str = "x ="
) -> Finding:
    gap = np.abs(claimed - right)
    worst = int(np.argmax(gap - slack))
    effect = float(np.max(gap / np.maximum(np.abs(right), 1e-300), initial=0.0))
    if not np.all(gap <= slack):
        message = f"{claimed[worst]:.9g} against {right[worst]:.9g}, at {at} {shorten(points[worst])}"
        return Finding(name, "rejected", message, effect=effect)
    return Finding(name, "not rejected", f"equal within rounding at {len(right)} places", effect=effect)


def _at_any_atom(subject: Subject, x: np.ndarray) -> np.ndarray:
    hits = list(subject.at_atom(x).values())
    return np.any(hits, axis=0) if hits else np.zeros(len(x), dtype=bool)


def _inside(subject: Subject, draw: Draw) -> np.ndarray:
    """Return which samples are points of the domain or of a declared atom, or given up by the sampler itself."""
    inside = in_domain(subject.domain, draw.x, subject.roundoff)
    if subject.atoms:
        inside |= _at_any_atom(subject, draw.x)
    return inside if draw.valid is None else inside | ~draw.valid


@dataclass
class Watch:
    """Looks at every sample of every batch; keeps one example of each kind of broken promise, and how often it happened."""

    subject: Subject
    broken: dict[str, tuple[int, str]] = field(default_factory=dict)
    seen: dict[str, int] = field(default_factory=dict)

    def look(self, draw: Draw) -> np.ndarray:
        """Check one batch; return (n,) which samples are good points of the continuous part."""
        subject, x = self.subject, draw.x
        inside = _inside(subject, draw)
        self._note("domain", ~inside, lambda i: f"x = {shorten(x[i])} is not a point of {subject.domain}", len(x))
        atom = _at_any_atom(subject, x)
        good = inside & ~atom if draw.valid is None else inside & ~atom & draw.valid
        at = np.flatnonzero(good)
        p = subject.density(x[at])
        zero = ~(np.isfinite(p) & (p > 0))
        if zero.any():  # a point on the very edge of the support may fall out of it by rounding
            near = [subject.density(y) for y in nudged(x[at[zero]], subject.roundoff)]
            zero[zero] = ~np.any([np.isfinite(q) & (q > 0) for q in near], axis=0)
        self._note("positive pdf", zero, lambda i: f"pdf is {p[i]:g} at the sampled x = {shorten(x[at[i]])}", len(at))
        if draw.pdf is not None:
            self._returned(draw.pdf, x, at, p)
        if draw.weight is not None and subject.eval is not None:
            self._weights(draw.weight, x, at)
        return good

    def _returned(self, returned: np.ndarray, x: np.ndarray, at: np.ndarray, p: np.ndarray) -> None:
        subject = self.subject
        differ = ~(np.abs(returned[at] - p) <= 64 * subject.roundoff * np.abs(p))
        if differ.any():
            slack = rounding_spread(subject.density, x[at[differ]], subject.roundoff)
            differ[differ] = ~(np.abs(returned[at[differ]] - p[differ]) <= slack)
        tell = lambda i: f"sample returned {returned[at[i]]:.9g}, pdf(x) is {p[i]:.9g} at x = {shorten(x[at[i]])}"  # noqa: E731
        self._note("returned pdf", differ, tell, len(at))
        for point, hits in subject.at_atom(x).items():
            wrong = ~(np.abs(returned[hits] - subject.atoms[point]) <= 1e7 * subject.roundoff * subject.atoms[point])
            values = returned[hits]
            self._note(
                "returned probability",
                wrong,
                lambda i, v=values, q=point: (
                    f"sample returned {v[i]:.9g} at the atom {q:g}, declared {subject.atoms[q]:.9g}"
                ),
                len(wrong),
            )

    def _weights(self, weight: np.ndarray, x: np.ndarray, at: np.ndarray) -> None:
        subject = self.subject

        def right(y: np.ndarray) -> np.ndarray:
            assert subject.eval is not None
            value = np.asarray(call("eval(x)", subject.eval, y), dtype=np.float64)
            p = subject.density(y)
            return value / (p if value.ndim == 1 else p[:, None])

        w, got = right(x[at]), weight[at]
        differ = ~(np.abs(got - w) <= 64 * subject.roundoff * np.abs(w))
        rows = np.flatnonzero(differ if differ.ndim == 1 else differ.any(axis=1))
        wrong = np.zeros(len(at), dtype=bool)
        if len(rows):
            slack = rounding_spread(right, x[at[rows]], subject.roundoff)
            off = ~(np.abs(got[rows] - w[rows]) <= slack)
            wrong[rows] = off if off.ndim == 1 else off.any(axis=1)
        tell = lambda i: f"weight {shorten(got[i])}, eval/pdf is {shorten(w[i])} at x = {shorten(x[at[i]])}"  # noqa: E731
        self._note("weight", wrong, tell, len(at))

    def _note(self, name: str, bad: np.ndarray, tell: object, n: int) -> None:
        self.seen[name] = self.seen.get(name, 0) + n
        count = int(np.count_nonzero(bad))
        if count:
            assert callable(tell)
            before, example = self.broken.get(name, (0, ""))
            self.broken[name] = (before + count, example or tell(int(np.argmax(bad))))

    def findings(self) -> list[Finding]:
        """Return one finding for each promise that was looked at."""
        found = []
        for name, n in self.seen.items():
            if name in self.broken:
                count, example = self.broken[name]
                found.append(Finding(name, "rejected", f"{count} of {n} samples: {example}", effect=count / n))
            else:
                found.append(Finding(name, "not rejected", f"kept by all {n} samples"))
        return found
