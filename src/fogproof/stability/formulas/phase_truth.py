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
from fogproof.stability.exact import flint, inverted
from fogproof.stability.formula import Naive, Values


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


def pi4():
    return 4 * flint().arb.pi()


def hg_pdf(mu, g):
    return (1 - g * g) / (pi4() * (1 + g * g - 2 * g * mu) ** flint().arb(1.5))


def hg_cdf(mu, g):
    if g.is_zero():
        return (1 + mu) / 2
    return (1 - g * g) / (2 * g) * (1 / (1 + g * g - 2 * g * mu).sqrt() - 1 / (1 + g))


def hg_place(xi, g):
    return 2 * xi - 1 if g.is_zero() else (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * xi)) ** 2) / (2 * g)


def schlick_cdf(mu, k):
    return (1 + mu) / 2 if k.is_zero() else (1 - k * k) / (2 * k) * (1 / (1 - k * mu) - 1 / (1 + k))


def schlick_mean(k):
    return k if k.is_zero() else 1 / k + (1 - k * k) / (2 * k * k) * ((1 - k) / (1 + k)).log()


def power_pdf(n):
    return lambda mu: (1 + (n + 1) * ((1 + mu) / 2) ** n) / (2 * pi4())


def power_cdf(n):
    return lambda mu: ((1 + mu) / 2 + ((1 + mu) / 2) ** (n + 1)) / 2


def power_place(n):
    """Half of the uniforms are a place themselves, the other half the root of one."""

    def place(xi):
        v = 2 * xi - 1
        return -2 * v - 1 if v < 0 else 2 * v ** (flint().arb(1) / (n + 1)) - 1

    return place


def draine_pdf(mu, g, alpha):
    return (1 + alpha * mu * mu) / (1 + alpha * (1 + 2 * g * g) / 3) * hg_pdf(mu, g)


def draine_cdf(mu, g, alpha):
    norm = 1 + alpha * (1 + 2 * g * g) / 3
    if g.is_zero():
        return ((1 + mu) / 2 + alpha * (1 + mu**3) / 6) / norm
    c, D0, D = 1 + g * g, 1 + g, (1 + g * g - 2 * g * mu).sqrt()
    square = (1 - g * g) / (8 * g**3) * (c * c * (1 / D - 1 / D0) - 2 * c * (D0 - D) + (D0**3 - D**3) / 3)
    return (hg_cdf(mu, g) + alpha * square) / norm


def draine_place(xi, g, alpha):
    two_pi = 2 * flint().arb.pi()
    return inverted(lambda mu: draine_cdf(mu, g, alpha), lambda mu: two_pi * draine_pdf(mu, g, alpha), xi)


def draine_mean(g, alpha):
    return g * (1 + alpha * (3 + 2 * g * g) / 5) / (1 + alpha * (1 + 2 * g * g) / 3)


def cornette_shanks(function):
    return lambda *x, **given: function(*x, **given, alpha=flint().arb(1))


def two_lobes_place(xi, g, weight):
    """Lobes of mean cosine g and -1/4; the share of xi that chose one is drawn out again."""
    if xi < weight:
        return hg_place(xi / weight, g)
    return hg_place((xi - weight) / (1 - weight), flint().arb(-0.25))


def two_lobes(function):
    def mean(*x, g, weight, **named):
        return weight * function(*x, **named, g=g) + (1 - weight) * function(*x, **named, g=flint().arb(-0.25))

    return mean


def ff_constants(n, slope):
    nu, k = (3 - slope) / 2, 4 / (3 * (n - 1) ** 2)
    return nu, k, (1 - k**nu) / ((k - 1) * k**nu)


def ff_pdf(mu, n, slope):
    nu, k, last = ff_constants(n, slope)
    s = (1 - mu) / 2
    if s.is_zero():
        return flint().arb.pos_inf()
    d = k * s
    power = d**nu
    bracket = nu * (1 - d) - (1 - power) + (d * (1 - power) - nu * (1 - d)) / s
    return (bracket / ((1 - d) ** 2 * power) + last / 4 * (3 * mu * mu - 1)) / pi4()


def ff_beyond(mu, n, slope):
    """The share that scatters by less than the angle of mu."""
    nu, k, last = ff_constants(n, slope)
    s = (1 - mu) / 2
    if s.is_zero():
        return s
    d = k * s
    head = ((1 - d ** (nu + 1)) - (1 - d**nu) * s) / ((1 - d) * d**nu)
    return head + last / 8 * mu * (1 - mu * mu)


def ff_cdf(mu, n, slope):
    return 1 - ff_beyond(mu, n, slope)


def ff_place(xi, n, slope):
    two_pi = 2 * flint().arb.pi()
    return inverted(lambda mu: ff_cdf(mu, n, slope), lambda mu: two_pi * ff_pdf(mu, n, slope), xi)


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
