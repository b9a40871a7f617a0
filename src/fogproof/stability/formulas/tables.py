"""Phase functions without a closed form: Lorenz-Mie by its series, tables by their pieces."""

from __future__ import annotations

from typing import Any

from fogproof import analytic
from fogproof.estimators import Cosines
from fogproof.estimators.phase import functions
from fogproof.scene.phase import Mie, Tabulated
from fogproof.stability.axes import cosines, decades, uniforms
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import BOTH, Formula, HardRegion

# --- Lorenz-Mie -----------------------------------------------------------------------------------------------------------------

WAVELENGTH, INDEX = 5e-7, 1.33
DIAMETERS = decades(1e-3 * WAVELENGTH / 3.14, 1e3 * WAVELENGTH / 3.15)
"""Size parameters from 1e-3 to 1000."""


def riccati(z, count):
    """z j_n(z) for n = 0 ... count, downwards from the two last, which are Bessel's functions of half orders."""
    arb = flint().arb
    root = (arb.pi() * z / 2).sqrt()
    found = [root * z.bessel_j(arb(n) + arb(0.5)) for n in (count, count - 1)]
    for n in range(count - 1, 0, -1):
        found.append((2 * n + 1) / z * found[-1] - found[-2])
    return found[::-1]


def second(z, count):
    """-z y_n(z) for n = 0 ... count, upwards."""
    found = [z.cos(), z.cos() / z + z.sin()]
    for n in range(1, count):
        found.append((2 * n + 1) / z * found[-1] - found[-2])
    return found


def coefficients(x, m, count):
    """a_n and b_n (Bohren & Huffman 1983, eq. 4.88), for a sphere that does not absorb."""
    acb = flint().acb
    inside, outside, singular = riccati(m * x, count), riccati(x, count), second(x, count)
    a: list[Any] = []
    b: list[Any] = []
    for n in range(1, count + 1):
        slope_in = inside[n - 1] - n / (m * x) * inside[n]
        slope_out = outside[n - 1] - n / x * outside[n]
        slope_singular = singular[n - 1] - n / x * singular[n]
        for found, p, q in ((a, m, 1), (b, 1, m)):
            real = p * inside[n] * slope_out - q * outside[n] * slope_in
            imaginary = p * inside[n] * slope_singular - q * singular[n] * slope_in
            found.append(acb(real) / acb(real, -imaginary))
    return a, b


KNOWN: dict[tuple[str, int], tuple[list[Any], list[Any]]] = {}
"""The coefficients of the last sphere: many angles share them."""


def series(diameter):
    x = flint().arb.pi() * diameter / flint().arb(WAVELENGTH)
    size = float(x.mid())
    key = repr(size), flint().ctx.prec
    if key not in KNOWN:
        KNOWN.clear()
        KNOWN[key] = coefficients(x, flint().arb(INDEX), int(size + 20 * size ** (1 / 3)) + 60)
    return KNOWN[key]


def true_mie(mu, diameter):
    acb, arb = flint().acb, flint().arb
    a, b = series(diameter)
    s1, s2, norm = acb(0), acb(0), arb(0)
    before, now = arb(0), arb(1)  # pi_(n - 1) and pi_n
    for n in range(1, len(a) + 1):
        tau = n * mu * now - (n + 1) * before
        share = arb(2 * n + 1) / (n * (n + 1))
        s1 += share * (a[n - 1] * now + b[n - 1] * tau)
        s2 += share * (a[n - 1] * tau + b[n - 1] * now)
        norm += (2 * n + 1) * (abs(a[n - 1]) ** 2 + abs(b[n - 1]) ** 2)
        before, now = now, ((2 * n + 1) * mu * now - (n + 1) * before) / n
    return (abs(s1) ** 2 + abs(s2) ** 2) / (4 * arb.pi() * norm)


@each("diameter")
def mie(mu, diameter):
    return analytic.phase_pdf(Mie(diameter, WAVELENGTH, INDEX), mu)


@each("diameter")
def mie_value(mu, diameter):
    return functions.phase_value(Mie(diameter, WAVELENGTH, INDEX), mu)


# --- tables ---------------------------------------------------------------------------------------------------------------------

NODES = (-1.0, -0.5, 0.25, 0.875, 1.0)
HEIGHTS = (3.0, 0.0, 1e-9, 2.0, 1e3)
"""A peak of half a degree, a cell that begins at 0, and one that is nearly empty."""


def table():
    return Tabulated.normalised(NODES, HEIGHTS)


def whole():
    """Half the integral over the cosine, and the shares of the cells."""
    arb = flint().arb
    parts = [
        (arb(NODES[i + 1]) - arb(NODES[i])) * (arb(HEIGHTS[i]) + arb(HEIGHTS[i + 1])) / 2 for i in range(len(NODES) - 1)
    ]
    return sum(parts, arb(0)), parts


def true_table(mu):
    arb = flint().arb
    i = max((i for i in range(len(NODES) - 1) if mu >= NODES[i]), default=0)
    low, high = arb(NODES[i]), arb(NODES[i + 1])
    value = arb(HEIGHTS[i]) + (arb(HEIGHTS[i + 1]) - arb(HEIGHTS[i])) * (mu - low) / (high - low)
    return value / (2 * arb.pi() * whole()[0])


def true_table_cdf(mu):
    arb = flint().arb
    total, parts = whole()
    i = max((i for i in range(len(NODES) - 1) if mu >= NODES[i]), default=0)
    low, high = arb(NODES[i]), arb(NODES[i + 1])
    slope = (arb(HEIGHTS[i + 1]) - arb(HEIGHTS[i])) / (high - low)
    inside = (mu - low) * (arb(HEIGHTS[i]) + slope * (mu - low) / 2)
    return (sum(parts[:i], arb(0)) + inside) / total


def true_table_place(xi):
    """The root of a quadratic in the cell that holds xi."""
    arb = flint().arb
    total, parts = whole()
    left, i = xi * total, 0
    while i < len(parts) - 1 and left >= parts[i]:
        left, i = left - parts[i], i + 1
    low, high = arb(NODES[i]), arb(NODES[i + 1])
    start, slope = arb(HEIGHTS[i]), (arb(HEIGHTS[i + 1]) - arb(HEIGHTS[i])) / (high - low)
    return low + ((start * start + 2 * slope * left).sqrt() - start) / slope


MU, XI = (HardRegion("whole range", {"mu": cosines}),), (HardRegion("whole range", {"xi": uniforms}),)

FORMULAS = [
    Formula(
        "phase/mie/oracle_pdf",
        "The oracle's Lorenz-Mie function of a drop of water",
        "analytic.phase_pdf",
        mie,
        true_mie,
        (HardRegion("size parameters 1e-3 to 1000", {"diameter": DIAMETERS, "mu": cosines}),),
        size=0.2,
        condition=False,
    ),
    Formula(
        "phase/tabulated/cosine",
        "Cosine drawn from a table",
        "estimators.Cosines",
        lambda xi: Cosines(table()).sample(xi[:, None]).x,
        true_table_place,
        XI,
        bound=3.0,
        precisions=BOTH,
    ),
    Formula(
        "phase/tabulated/pdf_drawn",
        "Density beside a direction drawn from a table",
        "estimators.Directions",
        lambda xi: functions.polar(table(), xi).pdf,
        lambda xi: true_table(true_table_place(xi)),
        XI,
        bound=4.0,
        precisions=BOTH,
    ),
    Formula(
        "phase/tabulated/value",
        "A table as estimators evaluate it",
        "estimators.phase_value",
        lambda mu: functions.phase_value(table(), mu),
        true_table,
        MU,
        bound=3.0,
    ),
    Formula(
        "phase/tabulated/oracle_pdf",
        "The oracle's density of a table",
        "analytic.phase_pdf",
        lambda mu: analytic.phase_pdf(table(), mu),
        true_table,
        MU,
    ),
    Formula(
        "phase/tabulated/oracle_cdf",
        "The oracle's distribution of a table",
        "analytic.phase_cdf",
        lambda mu: analytic.phase_cdf(table(), mu),
        true_table_cdf,
        MU,
    ),
    Formula(
        "phase/tabulated/oracle_quantile",
        "The oracle's quantile of a table",
        "analytic.phase_quantile",
        lambda xi: analytic.phase_quantile(table(), xi),
        true_table_place,
        XI,
    ),
]
