"""Directions inside a slab, whose boundaries may refract."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.multiple.fresnel import inside_cosine
from fogproof.analytic.multiple.slab_modes import quadrature


class Nodes(NamedTuple):
    """Cosines inside the medium, their weights, the cosines outside, and the weights of a diffuse sky's average, (n,) each."""

    mu: np.ndarray
    w: np.ndarray
    outside: np.ndarray
    sky: np.ndarray


def nodes_inside(tau: float, mu0: float, n: int, index: float, thickest: float = 1.0) -> Nodes:
    """Return nodes on (0, 1) for slabs from tau to `thickest`, seen at cosines of at least mu0; see `quadrature`.

    The critical angle of a refractive index > 1 is an edge of the panels; above it the nodes are those of a rule in the
    cosine outside, in which the Fresnel equations are analytic. Light caught below it scatters again however thin the
    slab is, and needs all nodes.
    """
    if index == 1:
        mu, w = quadrature(min(tau, 10 * mu0), n, weight=thickest)
        return Nodes(mu, w, mu, 2 * w * mu)
    mu, w = quadrature(tau, n, float(inside_cosine(index, 0.0)))
    outside, v = quadrature(float(mu[-1]), n)
    above = inside_cosine(index, outside)
    return Nodes(
        np.concatenate([mu, above]),
        np.concatenate([w, v * outside / (index * index * above)]),
        np.concatenate([np.zeros_like(mu), outside]),
        np.concatenate([np.zeros_like(mu), 2 * v * outside]),
    )
