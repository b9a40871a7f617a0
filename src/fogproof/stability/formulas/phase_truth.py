"""Phase functions by their textbook formulas, a `PhaseTruth` each: all that `phase` asks of them comes from there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof.scene.phase import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    FournierForand,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Murky,
    PhaseFunction,
    Rayleigh,
    Schlick,
)
from fogproof.stability.axes import decades, symmetric
from fogproof.stability.formula import Naive, Values
from fogproof.stability.formulas.phase_laws import (
    cornette_shanks,
    draine_cdf,
    draine_mean,
    draine_pdf,
    draine_place,
    ff_cdf,
    ff_pdf,
    ff_place,
    hg_cdf,
    hg_pdf,
    hg_place,
    pi4,
    power_cdf,
    power_pdf,
    power_place,
    schlick_cdf,
    schlick_mean,
    two_lobes,
    two_lobes_place,
)


@dataclass(frozen=True)
class PhaseTruth:
    """One kind of phase function.

    make        its parameters by name -> the phase function of the scene
    parameters  their hard values, at most one of them; `fixed` the others
    pdf, cdf    truths at (mu, parameters); 1/sr, probability that the cosine is at most mu
    place       truth of the cosine that xi maps to, (xi, parameters)
    mean        truth of the mean cosine; None where the formula is too long to be another one
    printed     naive forms of what is drawn and of the density, by "cosine", "pdf", "cdf", "mean"
    loose       bounds that differ from the usual ones, by what they bound, each with a reason beside it
    """

    name: str
    make: Callable[..., PhaseFunction]
    pdf: Callable[..., Any]
    cdf: Callable[..., Any]
    place: Callable[..., Any]
    mean: Callable[..., Any] | None = None
    parameters: dict[str, Values] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)
    printed: dict[str, tuple[Naive, ...]] = field(default_factory=dict)
    loose: dict[str, float] = field(default_factory=dict)
    size: float = 1.0


SEED = "the lecture, sampling the phase function"


def printed_hg(xi, g):
    return (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * xi)) ** 2) / (2 * g)


def printed_hg_pdf(mu, g):
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5)


def printed_hg_cdf(mu, g):
    return (1 - g * g) / (2 * g) * (1 / np.sqrt(1 + g * g - 2 * g * mu) - 1 / (1 + g))


def printed_schlick_versine(xi, k):
    return 1 - (2 * xi + k - 1) / (2 * k * xi - k + 1)


def printed_schlick_mean(k):
    return 1 / k + (1 - k * k) / (2 * k * k) * np.log((1 - k) / (1 + k))


PHASES = [
    PhaseTruth("isotropic", lambda: Isotropic(), lambda mu: 1 / pi4(), lambda mu: (1 + mu) / 2, lambda xi: 2 * xi - 1),
    PhaseTruth(
        "rayleigh",
        lambda: Rayleigh(),
        lambda mu: 3 * (1 + mu * mu) / (4 * pi4()),
        lambda mu: (4 + 3 * mu + mu**3) / 8,
        lambda xi: 2 * ((4 * xi - 2).asinh() / 3).sinh(),
        loose={
            "cosine": 12.0,
            "pdf_drawn": 12.0,
        },  # of the cubic's root the absolute error is bounded, which is 2 ulps of 2
    ),
    PhaseTruth("hazy", lambda: Hazy(), power_pdf(8), power_cdf(8), power_place(8)),
    PhaseTruth(
        "murky",
        lambda: Murky(),
        power_pdf(32),
        power_cdf(32),
        power_place(32),
        loose={"pdf_drawn": 14.0},  # five squarings, each of which doubles what was off before
    ),
    PhaseTruth(
        "henyey_greenstein",
        lambda g: HenyeyGreenstein(g),
        hg_pdf,
        hg_cdf,
        hg_place,
        mean=lambda g: g,
        loose={"cosine": 8.0},  # 1 + mu less 1
        parameters={"g": symmetric(1e-12)},
        printed={
            "cosine": (Naive("the inverse divided by 2 g", SEED, printed_hg),),
            "versine": (Naive("1 - mu", "renderers, in the sine of the angle", lambda xi, g: 1 - printed_hg(xi, g)),),
            "pdf": (Naive("1 + g^2 - 2 g mu to the power 3/2", "the lecture and every renderer", printed_hg_pdf),),
            "cdf": (Naive("difference of roots over 2 g", "Henyey-Greenstein's integral as printed", printed_hg_cdf),),
        },
    ),
    PhaseTruth(
        "schlick",
        lambda k: Schlick(k),
        lambda mu, k: (1 - k * k) / (pi4() * (1 - k * mu) ** 2),
        schlick_cdf,
        lambda xi, k: (2 * xi + k - 1) / (2 * k * xi - k + 1),
        mean=schlick_mean,
        loose={"cosine": 8.0},  # 1 + mu less 1
        parameters={"k": symmetric(1e-15)},
        printed={
            "versine": (Naive("1 - mu", "renderers, in the sine of the angle", printed_schlick_versine),),
            "mean": (Naive("1/k + (1 - k^2)/(2 k^2) log", "the integral as printed", printed_schlick_mean),),
        },
    ),
    PhaseTruth(
        "cornette_shanks",
        lambda g: CornetteShanks(g),
        cornette_shanks(draine_pdf),
        cornette_shanks(draine_cdf),
        cornette_shanks(draine_place),
        mean=cornette_shanks(draine_mean),
        parameters={"g": symmetric(1e-6, 1e-20)},
        size=0.5,
    ),
    PhaseTruth(
        "draine",
        lambda g, alpha: Draine(g, alpha),
        draine_pdf,
        draine_cdf,
        draine_place,
        mean=draine_mean,
        parameters={"alpha": decades(1e-9, 1e3)},
        fixed={"g": 0.75},
        size=0.5,
    ),
    PhaseTruth(
        "double_henyey_greenstein",
        lambda g, weight: DoubleHenyeyGreenstein(g, -0.25, weight),
        two_lobes(hg_pdf),
        two_lobes(hg_cdf),
        two_lobes_place,
        parameters={"g": symmetric(1e-12)},
        fixed={"weight": 0.75},
    ),
    PhaseTruth(
        "fournier_forand",
        lambda n, slope: FournierForand(n, slope),
        ff_pdf,
        ff_cdf,
        ff_place,
        parameters={"n": decades(1.01, 1.3)},
        loose={"coversine": 10.0},  # Newton's method ends where a step is 1e-15 of the logarithm
        fixed={"slope": 3.5},
        size=0.34,
    ),
]
