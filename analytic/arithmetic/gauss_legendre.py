"""Gauss-Legendre rules on [0, 1], every number right to its last digit.

Nodes (1 + x_k)/2 and weights w_k/2 come from 300-bit ball arithmetic: `flint.arb.legendre_p_root(n, k, weight=True)` with
`flint.ctx.prec = 300`, rounded once; the upper half of each rule is the mirror image of the lower. The eigenvalue method of
`numpy.polynomial.legendre.leggauss` is off in the last digits, which costs integrals a factor 10 of their accuracy: the
rules of any size take one more step of Newton from there, in twice the precision.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from fogproof.analytic.arithmetic.double_double import Pair, add, divide, negative, pair, times

Rule = tuple[np.ndarray, np.ndarray]


def _mirrored(lower: list[tuple[float, float]]) -> Rule:
    x, w = (np.array(column) for column in zip(*lower, strict=True))
    return np.concatenate([x, 1 - x[::-1]]), np.concatenate([w, w[::-1]])


RULES: dict[int, Rule] = {
    12: _mirrored(
        [
            (0.009219682876640375, 0.023587668193255914),
            (0.04794137181476257, 0.05346966299765921),
            (0.11504866290284765, 0.08003916427167311),
            (0.2063410228566913, 0.10158371336153296),
            (0.3160842505009099, 0.1167462682691774),
            (0.43738329574426554, 0.12457352290670139),
        ]
    ),
    16: _mirrored(
        [
            (0.005299532504175033, 0.013576229705877048),
            (0.02771248846338371, 0.031126761969323947),
            (0.06718439880608412, 0.04757925584124639),
            (0.12229779582249849, 0.06231448562776694),
            (0.19106187779867811, 0.07479799440828837),
            (0.2709916111713863, 0.08457825969750127),
            (0.35919822461037054, 0.09130170752246179),
            (0.4524937450811813, 0.09472530522753425),
        ]
    ),
    20: _mirrored(
        [
            (0.0034357004074525377, 0.008807003569576059),
            (0.018014036361043106, 0.02030071490019347),
            (0.04388278587433705, 0.031336024167054534),
            (0.0804415140888906, 0.04163837078835238),
            (0.1268340467699246, 0.05096505990862022),
            (0.1819731596367425, 0.059097265980759206),
            (0.24456649902458646, 0.06584431922458832),
            (0.3131469556422902, 0.07104805465919102),
            (0.38610707442917747, 0.07458649323630187),
            (0.46173673943325133, 0.07637669356536292),
        ]
    ),
    28: _mirrored(
        [
            (0.001778751213022775, 0.0045621412965472586),
            (0.009348417314563623, 0.01056605629638563),
            (0.022870359685530903, 0.01645071389115219),
            (0.04218348680393396, 0.022136467379502114),
            (0.06705373871280247, 0.027553672837858374),
            (0.09717931454141042, 0.0326364619834998),
            (0.1321945609931841, 0.03732310711728439),
            (0.17167445298056752, 0.041556708614450606),
            (0.21513976409429914, 0.04528587219651642),
            (0.2620628875224409, 0.04846532899896496),
            (0.31187424195546065, 0.05105648378903038),
            (0.363969186182411, 0.05302788296142321),
            (0.41771535893330963, 0.05435559612914707),
            (0.47246035505798284, 0.0550235065082376),
        ]
    ),
}
"""Number of nodes -> nodes in (0, 1) and weights that sum to 1: sum(weights * f(nodes)) = int_0^1 f."""

NODES, WEIGHTS = RULES[28]


@cache
def unit_rule(n: int) -> Rule:
    """Return the Gauss-Legendre rule of n nodes on (0, 1): every number right to 1 eps, relative."""
    x = np.polynomial.legendre.leggauss(n)[0]
    at = pair(x)
    before, value = pair(np.ones(n)), at
    for m in range(1, n):
        higher = add(times(times(pair(2 * m + 1.0), at), value), negative(times(pair(float(m)), before)))
        before, value = value, divide(higher, pair(m + 1.0))
    # With 1 - x^2 = (1 - x)(1 + x): P_n' = n (P_(n-1) - x P_n)/(1 - x^2), and likewise for P_(n-1).
    room = times(add(pair(1.0), negative(at)), add(pair(1.0), at))
    slope = divide(times(pair(float(n)), add(before, negative(times(at, value)))), room)
    step = negative(divide(value, slope))
    root = add(at, step)
    # At the root P_(n-1) = P_(n-1)(x) + step P_(n-1)', and n (x P_(n-1) - P_n) = (1 - x^2) P_(n-1)'.
    there = add(before, divide(times(step, times(pair(float(n)), add(times(at, before), negative(value)))), room))
    room = times(add(pair(1.0), negative(root)), add(pair(1.0), root))
    weight = divide(room, times(times(pair(float(n)), there), times(pair(float(n)), there)))
    return _rounded(times(add(pair(1.0), root), pair(0.5))), _rounded(weight)


def _rounded(x: Pair) -> np.ndarray:
    return x[0] + x[1]
