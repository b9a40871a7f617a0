"""Gauss-Legendre rule of 16 nodes on [0, 1], with the running integral up to each node.

Nodes and weights come from 300-bit ball arithmetic, `flint.arb.legendre_p_root(16, k, weight=True)`, rounded once.
"""

from __future__ import annotations

import numpy as np

_RULE = np.array(
    [
        (0.005299532504175033, 0.013576229705877048),
        (0.02771248846338371, 0.031126761969323947),
        (0.06718439880608412, 0.04757925584124639),
        (0.12229779582249849, 0.06231448562776694),
        (0.19106187779867811, 0.07479799440828837),
        (0.2709916111713863, 0.08457825969750127),
        (0.35919822461037054, 0.09130170752246179),
        (0.4524937450811813, 0.09472530522753425),
        (0.5475062549188188, 0.09472530522753425),
        (0.6408017753896295, 0.09130170752246179),
        (0.7290083888286137, 0.08457825969750127),
        (0.8089381222013219, 0.07479799440828837),
        (0.8777022041775016, 0.06231448562776694),
        (0.9328156011939158, 0.04757925584124639),
        (0.9722875115366163, 0.031126761969323947),
        (0.994700467495825, 0.013576229705877048),
    ]
)
NODES, WEIGHTS = (np.ascontiguousarray(column) for column in _RULE.T)
"""Nodes in (0, 1) and weights that sum to 1, both (16,)."""


def _running() -> np.ndarray:
    """Return the matrix of integrals from 0 to node i of the Lagrange polynomial of node j.

    From l_j(x) = sum_k (2k + 1) w_j P_k(x_j) P_k(x) on [0, 1] and int P_k = (P_{k+1} - P_{k-1})/(2 (2k + 1)).
    """
    x, n = 2 * NODES - 1, len(NODES)
    P = [np.ones(n), x]
    for k in range(1, n):
        P.append(((2 * k + 1) * x * P[k] - k * P[k - 1]) / (k + 1))
    matrix = np.outer(P[1] + 1, WEIGHTS)
    for k in range(1, n):
        matrix += np.outer(P[k + 1] - P[k - 1], WEIGHTS * P[k])
    return matrix / 2


RUNNING = _running()
"""(16, 16): RUNNING @ f(NODES) is the integral of f from 0 to each node."""
