"""Smooth tests (Neyman 1937): a few orthogonal components, in which errors of parameters and formulas concentrate.

A test on thousands of cells spreads its attention; one on the first Legendre polynomials of the probability-integral transform
comes close to the best test there is for any smooth error. Products of them for two axes see how the axes depend on each other.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fogproof.checks.density.curve import legendre
from fogproof.checks.density.grid import GridPlane, Marginal
from fogproof.checks.statistics.cells import EXPLAINED, HIDDEN, MISS, nothing_counted
from fogproof.checks.statistics.tails import chi_square_above, chi_square_detected
from fogproof.checks.verdict import Finding, Resolution

COMPONENTS = 4
_PRODUCTS = 3  # polynomials of each axis whose products are used
_SHOWN = 0.1  # of the mean square of a combination of polynomials, that cells must leave
_NEGLIGIBLE = 0.02  # standard deviations
_COARSE = 1 / 32  # probability of a cell
_FAR = 1e-4  # p-values below it are corrected for skewness


def smooth(name: str, marginal: Marginal, counts: np.ndarray, alpha: float) -> Finding:
    """Test the first four Legendre components of a marginal's counts (m,): chi-square with four degrees of freedom.

    A component is the sum over samples of the normalised polynomial's mean over the sample's cell: its expectation is exactly 0.
    """
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    mass = np.maximum(marginal.mass, 1e-300)
    steps = np.diff(_integrals(marginal.cdf), axis=1) / mass  # (components, m) means over the cells
    z = np.einsum("km,m->k", steps, counts.astype(float)) / math.sqrt(n)
    doubt = marginal.error + marginal.blur
    slack = math.sqrt(n) * np.sum(np.abs(np.diff(steps, axis=1)) * doubt[1:-1], axis=1)
    shown, left = _shown(mass, steps)
    functions = "polynomials" if shown == len(z) else "combinations of polynomials, those that the cells show"
    what = f"part of a misfit in {marginal.label} along {shown} {functions}"
    finding = _judged(name, z, slack, n, alpha, what, left=left)
    if not shown:  # the cells are no finer than that
        finding = replace(finding, resolution=None)
    if (
        float(np.max(marginal.mass)) > _COARSE
    ):  # coarse cells hide a part of each component: the law is no larger than chi-square
        finding = replace(finding, exact=False)
    if finding.outcome == "rejected" and np.argmax(np.abs(z)) == 0:
        up = (z[0] > 0) == (marginal.shown[-1] > marginal.shown[0])
        return finding.located(f"samples lean towards {'large' if up else 'small'} {marginal.label}")
    return finding


def cross(name: str, labels: tuple[str, str], plane: GridPlane, counts: np.ndarray, alpha: float) -> Finding:
    """Test products of the first three Legendre polynomials of two axes on the coarse counts (32, 32): nine components."""
    n = int(counts.sum())
    if n == 0:
        return nothing_counted(name, alpha)
    bases, left = [], []
    for axis in (0, 1):
        share = plane.mass.sum(axis=1 - axis)
        edges = np.concatenate([[0.0], np.cumsum(share)])
        bases.append(legendre(edges[1:] + edges[:-1] - 1, _PRODUCTS)[1:])
        left.append(_shown(share, np.diff(_integrals(edges), axis=1)[:_PRODUCTS] / np.maximum(share, 1e-300))[1])
    products = np.einsum("ai,bj->abij", *bases).reshape(_PRODUCTS**2, -1)
    mass = plane.mass.ravel()
    products = products - (products @ mass)[:, None]
    values, vectors = np.linalg.eigh((products * mass) @ products.T)
    white = (vectors / np.sqrt(np.maximum(values, 1e-12))).T @ products
    z = white @ counts.ravel() / math.sqrt(n)
    slack = math.sqrt(n) * (np.abs(white) @ plane.error.ravel() + _moved(plane, white))
    what = f"part of a dependence of {labels[0]} and {labels[1]} along {len(z)} products of polynomials"
    return _judged(name, z, slack, n, alpha, what, "correlation", math.prod(left))


def _shown(mass: np.ndarray, steps: np.ndarray) -> tuple[int, float]:
    """Return along how many combinations of polynomials cells show a misfit, and what they leave of its mean square at least.

    steps  (k, m) means of the polynomials over the cells of probability mass (m,)

    A misfit along an eigenvector of the means of their products moves the components by the root of the eigenvalue times its size.
    """
    values = np.linalg.eigvalsh((steps * mass) @ steps.T)
    shown = values[values >= _SHOWN]
    return len(shown), float(shown.min(initial=1.0))


def _moved(plane: GridPlane, white: np.ndarray) -> np.ndarray:
    """Return (q,) how far rounding may move the means of functions (q, cells) on the coarse plane."""
    size = len(plane.mass)
    step, f = plane.size // size, white.reshape(len(white), size, size)
    around = np.abs(f - np.roll(f, 1, axis=2)).sum(axis=2)
    down = np.abs(np.diff(f, axis=1)) @ plane.shares[1].reshape(size, step).sum(axis=1)
    return np.asarray(around @ plane.across.reshape(size, step).sum(axis=1) + down @ plane.along[::step][1:-1])


def _judged(
    name: str,
    z: np.ndarray,
    slack: np.ndarray,
    n: int,
    alpha: float,
    kind: str,
    cause: str = "shape",
    left: float = 1.0,
) -> Finding:
    """Return what the sum of squares of components z (k,) tells; `left` is what cells leave of a misfit's mean square."""
    statistic = float(np.sum(np.maximum(np.abs(z) - slack, 0) ** 2))
    p = chi_square_above(len(z), statistic)
    if p < _FAR:
        p = min(_FAR, p * _skewed(statistic, n))
    rejected = p <= alpha
    largest = int(np.argmax(np.abs(z)))
    message = f"chi-square = {statistic:.4g} on {len(z)} components, the largest is number {largest + 1}"
    hides = float(np.linalg.norm(slack)) / math.sqrt(n)
    hidden = statistic == 0 and hides > HIDDEN
    message += EXPLAINED if hidden else ""
    nominal = alpha if alpha >= _FAR else alpha / _skewed(chi_square_detected(len(z), alpha, 0.5) + len(z), n)
    seen = (math.sqrt(chi_square_detected(len(z), nominal, MISS) / n) + hides) / math.sqrt(left)
    return Finding(
        name,
        "rejected" if rejected else "inconclusive" if hidden else "not rejected",
        message,
        p,
        alpha,
        bool(np.all(slack < _NEGLIGIBLE)) and n >= 1000,
        statistic,
        math.sqrt(max(statistic - len(z), 0.0) / (n * left)),
        Resolution(f"{kind} (root mean square of the ratio of densities less 1)", seen, MISS),
        cause=cause if rejected else "",
    )


def _skewed(statistic: float, n: int) -> float:
    """Return by how much a p-value far in the tail may be too small: the skewness of a component, at most 1, shows there."""
    return math.exp(min(statistic**1.5 / (6 * math.sqrt(n)), 1.0))


def _integrals(u: np.ndarray) -> np.ndarray:
    """Return (components, len(u)) integrals from 0 to u of the normalised shifted Legendre polynomials."""
    p = legendre(2 * u - 1, COMPONENTS + 1)
    k = np.arange(1, COMPONENTS + 1)[:, None]
    return 0.5 * (p[2:] - p[:-2]) / np.sqrt(2 * k + 1)
