"""Radiance that leaves a slab lit by a uniform sky, from its modes; smooth dielectric boundaries included.

The slab lies under a sky of radiance 1 on one side and nothing on the other. What is seen at cosine mu on the lit side
is, by reciprocity, the share of a beam of that cosine that is reflected; on the dark side, the share that passes.
Radiance inside a refractive index n counts as L / n^2, which refraction leaves unchanged.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.multiple.fresnel import fresnel_inside, inside_cosine
from fogproof.analytic.multiple.slab_modes import PARITIES, Modes, Parity, amplitudes, quadrature, scattered, unit_rule

GRAZING = 1e-100
"""Smallest cosine told from 0: what is seen there changes like mu ln(mu)."""


class Leaving(NamedTuple):
    """Radiance at the asked cosines (v,), and the averages over a diffuse sky."""

    reflected: np.ndarray
    transmitted: np.ndarray
    diffuse_reflected: np.ndarray
    diffuse_transmitted: np.ndarray


class Nodes(NamedTuple):
    """Cosines inside the medium, their weights, and their weights in an average over a diffuse sky, (n,) each."""

    mu: np.ndarray
    w: np.ndarray
    sky: np.ndarray


def nodes_inside(smallest: float, n: int, index: float) -> Nodes:
    """Return nodes on (0, 1) for cosines >= `smallest`, see `quadrature`.

    The critical angle of a refractive index > 1 is an edge of the panels; above it the nodes are those of a rule in the
    cosine outside, in which the Fresnel equations are analytic.
    """
    if index == 1:
        mu, w = quadrature(smallest, n)
        return Nodes(mu, w, 2 * w * mu)
    mu, w = quadrature(smallest, n, float(inside_cosine(index, np.array(0.0))))
    outside, v = unit_rule(2 * n)
    above = inside_cosine(index, outside)
    return Nodes(
        np.concatenate([mu, above]),
        np.concatenate([w, v * outside / (index * index * above)]),
        np.concatenate([np.zeros_like(mu), 2 * v * outside]),
    )


def leaving_slab(modes: Modes | None, nodes: Nodes, tau: float, mu0: np.ndarray, index: float) -> Leaving:
    """Return what leaves a slab of optical thickness tau at cosines mu0 (v,) outside it.

    modes  of the medium at the nodes; None if it does not scatter
    """
    mu = np.concatenate([inside_cosine(index, np.maximum(mu0, GRAZING)), nodes.mu])
    even, odd = (_at_surface(modes, tau, mu, parity, index) for parity in PARITIES)
    surface = fresnel_inside(index, mu)
    reflected, transmitted = surface + (1 - surface) * (even + odd), (1 - surface) * (even - odd)
    v = len(mu0)
    return Leaving(reflected[:v], transmitted[:v], nodes.sky @ reflected[v:], nodes.sky @ transmitted[v:])


def _at_surface(modes: Modes | None, tau: float, mu: np.ndarray, parity: Parity, index: float) -> np.ndarray:
    """Return the radiance that reaches the lit surface from within at cosines mu inside, half of the sky on either side.

    With odd parity the other half is negative.
    """
    through = np.exp(-tau / mu) * (1 if parity == "even" else -1)
    surface = fresnel_inside(index, mu)
    gained = np.zeros_like(mu)
    if modes is not None:
        mirror = fresnel_inside(index, modes.mu)
        amplitude = amplitudes(modes, tau / 2, parity, (1 - mirror) / 2, mirror)
        gained = scattered(modes, tau / 2, parity, amplitude, mu)
    return (through * (1 - surface) / 2 + gained) / (1 - through * surface)
