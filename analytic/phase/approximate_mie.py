"""Water droplets by a Henyey-Greenstein and a Draine lobe, whose four parameters are functions of the diameter in micrometres.

The formulas have six digits: what is meant by them here is their value in double precision, and of the mixture with those numbers
every error is counted. The four ranges of the diameter do not join: at 0.1, 1.5 and 5 micrometres the function jumps.
Source: Jendersie & d'Eon 2023, An approximate Mie scattering function for fog and cloud rendering, SIGGRAPH Talks 47.
"""

from __future__ import annotations

from fractions import Fraction
from math import cos, exp, log, sin, tan

from fogproof.scene.phase import ApproximateMie, Draine, HenyeyGreenstein, PhaseFunction


def lobes(diameter: float) -> tuple[float, float, float, float]:
    """Return g of Henyey-Greenstein, g and alpha of Draine, and Draine's weight, for a diameter in micrometres."""
    d = diameter
    if d >= 5:
        return (
            exp(-0.0990567 / (d - 1.67154)),
            exp(-2.20679 / (d + 3.91029) - 0.428934),
            exp(3.62489 - 8.29288 / (d + 5.52825)),
            exp(-0.599085 / (d - 0.641583) - 0.665888),
        )
    if d <= 0.1:
        return 13.8 * d**2, 1.1456 * d * sin(9.29044 * d), 250.0, 0.252977 - 312.983 * d**4.3
    L = log(d)
    if d < 1.5:
        inner = cos((L - 0.238604) * (L + 1.00667) / (0.507522 - 0.15677 * L))
        return (
            0.862 - 0.143 * L**2,
            0.379685 * cos(1.19692 * inner + 1.37932 * L + 0.0625835) + 0.344213,
            250.0,
            0.146209 * cos(3.38707 * L + 2.11193) + 0.316072 + 0.0778917 * L,
        )
    return (
        0.0604931 * log(L) + 0.940256,
        0.500411 - 0.081287 / (-2 * L + tan(L) + 1.27551),
        7.30354 * L + 6.31675,
        0.026914 * (L - cos(5.68947 * (log(L) - 0.0292149))) + 0.376475,
    )


def parts(phase: ApproximateMie) -> list[tuple[Fraction, PhaseFunction]]:
    """Return the two lobes with their weights."""
    g, g_draine, alpha, weight = lobes(phase.diameter * 1e6)
    share = Fraction(weight)
    return [(1 - share, HenyeyGreenstein(g)), (share, Draine(g_draine, alpha))]
