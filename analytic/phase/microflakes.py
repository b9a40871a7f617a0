"""SGGX microflakes: the phase function between two directions.

With the back direction i = -w_in, the outgoing one o, and v = i + o along the flake that mirrors one into the other,

    specular  f = det(S)^(3/2) |v|^4 / (4 pi sigma(i) (v . adj(S) v)^2),    sigma(i)^2 = i . S i,

eq. 17 of the paper without an inverse or a normalised vector. For diffuse flakes the unit vectors p = M^-1 m/|M^-1 m|, with
M = S^(1/2), make the distribution of visible normals the cosine about a = M i, so that with b = M o

    diffuse   f = 1/(pi^2 |a|) int max(a . p, 0) max(b . p, 0)/|M p| dp.

The integrand lives on a lune; in the angles about a x b it is analytic there, and Gauss-Legendre rules converge exponentially.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import quantity
from fogproof.contracts import Reference
from fogproof.scene.arrays import PointArray
from fogproof.scene.phase import Microflakes
from fogproof.validate import points, unit_vectors

SOURCE = "Heitz, Dupuy, Crassin & Dachsbacher 2015, The SGGX microflake distribution, eqs. 17 and 19"

NODES = (8, 16, 24, 40, 72, 120, 180)
ENOUGH = 1e-11
"""Relative change of the last doubling with which refinement ends."""

BLOCK = 1 << 20
"""Places at a time."""

Pair = tuple[np.ndarray, np.ndarray]


@quantity(
    unit="1/sr",
    convention="w_in and w_out both point along the propagation; normalised over w_out. Times sigma(w_in) it is reciprocal",
    source=SOURCE,
    example={
        "flakes": {"S": [[1, 0, 0], [0, 1, 0], [0, 0, 0.04]], "reflection": "specular"},
        "w_in": [0, 0, 1],
        "w_out": [[0, 0.6, 0.8], [0, 0, -1]],
    },
)
def microflake_pdf(flakes: Microflakes, w_in: PointArray, w_out: PointArray) -> Reference:
    """Return the phase function f(w_in -> w_out) of SGGX microflakes [1/sr].

    flakes  their matrix S and whether they are mirrors or diffuse
    w_in    (..., 3) unit vectors along which light arrives
    w_out   (..., 3) unit vectors along which it leaves, broadcast against w_in

    Mirrors straight ahead reflect by flakes seen edge-on, all of which would do: there the value is 0, and the error as large as
    any of them. Error: rounding, for diffuse flakes also the change that the last doubling of the nodes made.
    """
    w_in, w_out = (unit_vectors(name, points(name, w)) for name, w in (("w_in", w_in), ("w_out", w_out)))
    i, o = np.broadcast_arrays(-w_in, w_out)
    formula, method = (
        (_specular, "closed form") if flakes.reflection == "specular" else (_diffuse, "Gauss-Legendre on a lune")
    )
    S = flakes.S / np.abs(flakes.S).max()  # its size does not matter
    value, error = formula(S, i.reshape(-1, 3), o.reshape(-1, 3))
    return Reference(value.reshape(i.shape[:-1]), error.reshape(i.shape[:-1]), method, SOURCE)


def _specular(S: np.ndarray, i: np.ndarray, o: np.ndarray) -> Pair:
    adjugate, determinant = _adjugate(S)
    v = i + o
    length2 = np.sum(v * v, axis=1)
    bent = np.einsum("ni,ij,nj->n", v, adjugate, v)
    area = np.sqrt(np.einsum("ni,ij,nj->n", i, S, i))
    eigenvalues = np.linalg.eigvalsh(S)
    most = determinant**1.5 / (4 * np.pi * area * (eigenvalues[0] * eigenvalues[1]) ** 2)
    there = length2 > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        value = np.where(there, determinant**1.5 * length2**2 / (4 * np.pi * area * bent**2), 0.0)
        # A sum of two unit vectors is off by eps, a share eps/|v| of its direction; forms lose their condition.
        condition = eigenvalues[-1] / eigenvalues[0]
        loss = EPS * (16 + 24 * condition * (1 + 1 / np.sqrt(length2)))
        return value, np.where(there, np.minimum(loss * value, most), most)


def _adjugate(S: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the adjugate and the determinant of a symmetric matrix."""
    rows = [np.cross(S[1], S[2]), np.cross(S[2], S[0]), np.cross(S[0], S[1])]
    return np.stack(rows, axis=1), float(S[0] @ rows[0])


def _diffuse(S: np.ndarray, i: np.ndarray, o: np.ndarray) -> Pair:
    eigenvalues, axes = np.linalg.eigh(S)
    M = (axes * np.sqrt(eigenvalues)) @ axes.T
    a, b = i @ M, o @ M
    across = np.cross(a, b)
    turn = np.arctan2(np.linalg.norm(across, axis=1), np.sum(a * b, axis=1))
    e1 = a / np.linalg.norm(a, axis=1)[:, None]
    pole = _unit_across(e1, across)
    e2 = np.cross(pole, e1)
    size = np.linalg.norm(b, axis=1) / np.pi**2
    value, error = np.zeros((2, len(i)))
    left = np.arange(len(i))
    for level, nodes in enumerate(NODES):
        step = max(1, BLOCK // nodes**2)
        found = np.empty(len(left))
        for start in range(0, len(left), step):
            some = left[start : start + step]
            found[start : start + step] = size[some] * _lune(M, e1[some], e2[some], pole[some], turn[some], nodes)
        off = np.inf if level == 0 else np.abs(found - value[left])
        value[left], error[left] = found, off + 256 * EPS * found
        left = left[error[left] > (ENOUGH + 256 * EPS) * found]
        if not len(left):
            break
    return value, error


def _lune(M: np.ndarray, e1: np.ndarray, e2: np.ndarray, pole: np.ndarray, turn: np.ndarray, nodes: int) -> np.ndarray:
    """Return int s^3 cos(phi) cos(phi - turn)/|M p| dtheta dphi over turn - pi/2 < phi < pi/2, s = sin(theta), (n,)."""
    y, weights = np.polynomial.legendre.leggauss(nodes)
    theta, dtheta = np.pi / 2 * (y + 1), np.pi / 2 * weights
    middle, half = turn / 2, (np.pi - turn) / 2
    phi = middle[:, None] + half[:, None] * y
    flat = np.cos(phi)[..., None] * e1[:, None] + np.sin(phi)[..., None] * e2[:, None]
    p = np.sin(theta)[:, None] * flat[:, :, None] + np.cos(theta)[:, None] * pole[:, None, None]
    inverse = (np.sin(theta) ** 3 * dtheta) / np.linalg.norm(p @ M, axis=-1)
    lobes = np.cos(phi) * np.cos(phi - turn[:, None]) * weights * half[:, None]
    total: np.ndarray = np.einsum("nk,nkt->n", lobes, inverse)
    return total


def _unit_across(e1: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Return unit vectors at right angles to e1, along `across` where that has a direction."""
    any_of_them = np.cross(e1, np.eye(3)[np.argmin(np.abs(e1), axis=1)])
    length = np.linalg.norm(across, axis=1)[:, None]
    chosen = np.where(length > 1e-12 * np.linalg.norm(across + e1, axis=1)[:, None], across, any_of_them)
    chosen = chosen - np.sum(chosen * e1, axis=1)[:, None] * e1
    unit: np.ndarray = chosen / np.linalg.norm(chosen, axis=1)[:, None]
    return unit
