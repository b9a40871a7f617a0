"""Phase functions: what samplers draw, the density they claim, and the oracle's density, distribution, quantile and mean."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from fogproof import analytic
from fogproof.estimators import Cosines
from fogproof.estimators.phase import functions
from fogproof.stability.axes import cosines, uniforms
from fogproof.stability.forms import each
from fogproof.stability.formula import BOTH, Formula, HardRegion
from fogproof.stability.formulas.phase_truth import PHASES, PhaseTruth

USUAL = 6.0
"""Bound on what a sampler returns, where a phase function has no other."""


def region(lobe: PhaseTruth, **first) -> tuple[HardRegion, ...]:
    """Return the grid of a first argument and the lobe's own."""
    return (HardRegion("whole range", first | lobe.parameters, lobe.fixed),)


def drawn(lobe: PhaseTruth, which: str):
    """Return what the sampler gives besides the cosine: 1 - mu, 1 + mu, or the density."""
    names = (*lobe.parameters, *lobe.fixed)

    def take(xi, **parameters):
        return getattr(functions.polar(lobe.make(**parameters), xi), which)

    return each(*names)(take) if names else take


def ours(lobe: PhaseTruth, function):
    """Return a function of a phase function and one array, as one of arrays alone."""
    names = (*lobe.parameters, *lobe.fixed)

    def take(**arguments):
        parameters = {name: arguments.pop(name) for name in names}
        return function(lobe.make(**parameters), next(iter(arguments.values())))

    return each(*names)(take) if names else take


def formulas_of_estimators(lobe: PhaseTruth) -> Iterator[Formula]:
    """Yield what estimators draw and evaluate of one phase function."""
    what, loose = lobe.name.replace("_", " "), lobe.loose
    naive = lobe.printed.get
    yield Formula(
        f"phase/{lobe.name}/cosine",
        f"Cosine drawn from the {what} function",
        "estimators.Cosines",
        ours(lobe, lambda phase, xi: Cosines(phase).sample(xi[:, None]).x),
        lobe.place,
        region(lobe, xi=uniforms),
        loose.get("cosine", USUAL),
        naive("cosine", ()),
        BOTH,
    )
    for which, sign, end in (("versine", -1, "forward"), ("coversine", 1, "backward")):
        yield Formula(
            f"phase/{lobe.name}/{which}",
            f"1 {'-' if sign < 0 else '+'} the cosine drawn, relative at the {end} pole",
            "estimators.Directions",
            drawn(lobe, which),
            lambda xi, sign=sign, **p: 1 + sign * lobe.place(xi, **p),
            region(lobe, xi=uniforms),
            loose.get(which, USUAL),
            naive(which, ()),
            precisions=BOTH,
        )
    yield Formula(
        f"phase/{lobe.name}/pdf_drawn",
        f"Density beside a direction drawn from the {what} function",
        "estimators.Directions",
        drawn(lobe, "pdf"),
        lambda xi, **p: lobe.pdf(lobe.place(xi, **p), **p),
        region(lobe, xi=uniforms),
        loose.get("pdf_drawn", USUAL),
        precisions=BOTH,
    )
    yield Formula(
        f"phase/{lobe.name}/value",
        f"The {what} function as estimators evaluate it",
        "estimators.phase_value",
        ours(lobe, functions.phase_value),
        lobe.pdf,
        region(lobe, mu=cosines),
        loose.get("value", 3.0),
        naive("pdf", ()),
    )


def formulas_of_the_oracle(lobe: PhaseTruth) -> Iterator[Formula]:
    """Yield what the oracle answers of one phase function."""
    what, naive = lobe.name.replace("_", " "), lobe.printed.get
    for name, function, truth, first in (
        ("pdf", analytic.phase_pdf, lobe.pdf, {"mu": cosines}),
        ("cdf", analytic.phase_cdf, lobe.cdf, {"mu": cosines}),
        ("quantile", analytic.phase_quantile, lobe.place, {"xi": uniforms}),
    ):
        if name == "quantile" and lobe.name in MIXED:
            continue
        yield Formula(
            f"phase/{lobe.name}/oracle_{name}",
            f"The oracle's {name} of the {what} function",
            f"analytic.phase_{name}",
            ours(lobe, function),
            truth,
            region(lobe, **first),
            naive=naive(name, ()) if name == "cdf" else (),
        )
    if lobe.mean is not None:
        yield Formula(
            f"phase/{lobe.name}/oracle_mean",
            f"The oracle's mean cosine of the {what} function",
            "analytic.phase_mean_cosine",
            each(*lobe.parameters, *lobe.fixed)(lambda **p: analytic.phase_mean_cosine(lobe.make(**p))),
            lobe.mean,
            region(lobe),
            naive=naive("mean", ()),
        )


MIXED = ("hazy", "murky", "double_henyey_greenstein")
"""Sums of two, of which a sampler chooses one first: what it draws is not the quantile."""

FORMULAS = [
    replace(formula, size=lobe.size)
    for lobe in PHASES
    for formula in (*formulas_of_estimators(lobe), *formulas_of_the_oracle(lobe))
]
