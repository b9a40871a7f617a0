"""The slab that scatters isotropically under a uniform sky, from its modes; smooth dielectric boundaries included.

What a sky of radiance 1 on the lit side shows at cosine mu on that side is, by reciprocity, the share of a beam of that cosine
that is reflected; on the dark side, the share that passes. Radiance inside a refractive index n counts as L/n^2, which
refraction leaves unchanged. Every mode is held at the side from where it decays (`mode_integrals`), so that what passes a deep
slab is a sum of positive terms, not what two solutions of about 1 leave.
Source: Chandrasekhar 1960, Radiative Transfer, chapters 3 and 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.multiple.fresnel import inside_cosine, reflectivity, transmissivity
from fogproof.analytic.multiple.isotropic_modes import isotropic_modes
from fogproof.analytic.multiple.mode_integrals import collected, z_coth, z_csch
from fogproof.analytic.multiple.slab_modes import Modes
from fogproof.analytic.multiple.slab_nodes import Nodes

FAINT = 1e-30
"""Albedo below which everything scattered is proportional to it."""

THIN = 1e-300
"""Thickness below which everything scattered or absorbed is proportional to it."""

MANY = 0.5
"""Albedo from which on the mode of the smallest k is taken out of what is absorbed."""


class Slabs(NamedTuple):
    """Solutions for pairs of albedo and thickness (b,): sources lit (b, m) u_j(y) + dark (b, m) v_j(y) at modes of k (b, m).

    They are for an albedo of at least FAINT and a thickness tau of at least THIN; scattered (absorbed) light is less by the
    factor fewer (thinner), (b,).
    """

    albedo: np.ndarray
    tau: np.ndarray
    fewer: np.ndarray
    thinner: np.ndarray
    refraction: float
    modes: Modes
    crosses: np.ndarray
    lit: np.ndarray
    dark: np.ndarray


class View(NamedTuple):
    """Directions: cosines inside and outside, and which slab each looks at, (v,) each."""

    slab: np.ndarray
    inside: np.ndarray
    outside: np.ndarray


def view_from(slab: np.ndarray, outside: np.ndarray, index: float) -> View:
    """Return the directions with cosines outside (v,) at slabs (v,)."""
    return View(slab, inside_cosine(index, outside), outside)


def solve_slabs(albedo: np.ndarray, tau: np.ndarray, nodes: Nodes, index: float) -> Slabs:
    """Return the sources in slabs of albedo (b,) and thickness (b,), lit by a sky of radiance 1 on one side."""
    c, thinner = np.maximum(albedo, FAINT), tau / np.maximum(tau, THIN)
    fewer, tau = albedo / c * thinner, np.maximum(tau, THIN)
    albedos, which = np.unique(c, return_inverse=True)
    modes = isotropic_modes(albedos, 1 - albedos, nodes.mu, nodes.w)
    modes = modes._replace(k=modes.k[which], p=modes.p[which], q=modes.q[which])
    crosses = transmissivity(index, nodes.mu, nodes.outside)
    k, thick = modes.k[:, None, :], tau[:, None, None]
    z = k * thick
    # What enters, with u or v = 1 and its slope: (crosses p f + (1 + mirror) q f')/2, of which `crosses` is asked at the lit side.
    p, q = crosses[:, None] * modes.p / 2, (2 - crosses)[:, None] * modes.q / 2
    # The amplitudes of u are in units of the thickness where that is small, so that no slope overflows.
    unit = np.minimum(thick, 1.0)
    slope_lit, slope_dark = z_coth(z) * (unit / thick), z_csch(z) * (unit / thick)
    into_dark = p + q * k
    scale = 1 / np.max(np.abs(into_dark), axis=1, keepdims=True)
    dark_of_lit = np.linalg.solve(into_dark * scale, q) * np.swapaxes(scale, 1, 2) * slope_dark
    system = p * unit + q * slope_lit + ((p - q * k) * np.exp(-z)) @ dark_of_lit
    scale = 1 / np.max(np.abs(system), axis=1, keepdims=True)
    asked = np.broadcast_to(crosses[:, None], (*system.shape[:2], 1))
    lit = np.linalg.solve(system * scale, asked) * np.swapaxes(scale, 1, 2)
    dark = dark_of_lit @ lit
    lit = lit * unit
    return Slabs(albedo, tau, fewer, thinner, index, modes, crosses, lit[..., 0] / 2, dark[..., 0] / 2)


def reflected(slabs: Slabs, view: View) -> np.ndarray:
    """Return what is seen on the lit side, (v,)."""
    lit, dark = _collected(slabs, view)
    ray, crosses = _ray(slabs, view)
    mirror = _mirror(slabs, view)
    through = ray * mirror
    return mirror + crosses * (lit + through * (dark + ray * crosses)) / _echo(slabs, view)


def scattered_through(slabs: Slabs, view: View) -> np.ndarray:
    """Return what is seen on the dark side and has been scattered, (v,)."""
    lit, dark = _collected(slabs, view)
    ray, crosses = _ray(slabs, view)
    return crosses * (dark + ray * _mirror(slabs, view) * lit) / _echo(slabs, view)


def unscattered(slabs: Slabs, view: View) -> np.ndarray:
    """Return what is seen on the dark side straight through, (v,)."""
    ray, crosses = _ray(slabs, view)
    return crosses * crosses * ray / _echo(slabs, view)


def absorbed(slabs: Slabs, view: View) -> np.ndarray:
    """Return what a slab emits that glows with radiance 1 in cold surroundings, (v,): what is absorbed of a beam.

    That the radiance is 1 where the sky is 1 everywhere leaves for it 1 - (even modes); from an albedo of 1/2 on the mode of the
    smallest k is taken out of both, which leaves k^2 times something, however close to 1 the albedo is.
    """
    ray, crosses = _ray(slabs, view)
    modes, thick = slabs.modes, slabs.tau[:, None]
    k1 = modes.k[:, -1:]
    half = np.where(k1 * thick < 1e-8, thick / 2, np.tanh(k1 * thick / 2) / np.where(k1 > 0, k1, 1.0))
    many = slabs.albedo[:, None] >= MANY
    node_crosses = slabs.crosses
    z = modes.k * thick
    slope = modes.k * np.tanh(z / 2)
    system = node_crosses[:, None] * modes.p / 2 + (2 - node_crosses)[:, None] * modes.q / 2 * slope[:, None, :]
    without = _part(k1, modes.mu) * (node_crosses * modes.mu + (2 - node_crosses) * half)
    asked = np.where(many, without, node_crosses)
    scale = 1 / np.max(np.abs(system), axis=1)
    amplitude = np.linalg.solve(system * scale[:, None, :], asked[..., None])[..., 0] * scale / 2
    # cosh(k (y - tau/2))/cosh(k tau/2) = v + (1 - exp(-k tau)) u.
    slab = view.slab
    parts = collected(modes.k[slab], slabs.tau[slab, None], view.inside[:, None])
    gained = np.sum(amplitude[slab] * (parts.v_lit - np.expm1(-z[slab]) * parts.u_lit), axis=1)
    s = slabs.tau[slab] / view.inside
    t, k1 = half[slab, 0], k1[slab, 0]
    taken = _part(k1, view.inside) * (t * (1 + ray) + view.inside * np.expm1(-s)) + gained
    glow = np.where(many[slab, 0], k1 * k1 * taken, -np.expm1(-s) - gained)
    return slabs.thinner[slab] * crosses * glow / (ray * crosses - np.expm1(-s))


def _part(k: np.ndarray, mu: np.ndarray) -> np.ndarray:
    return mu / np.where(k * mu < 1, (1 - k * mu) * (1 + k * mu), 1.0)


def _collected(slabs: Slabs, view: View) -> tuple[np.ndarray, np.ndarray]:
    """Return what rays gain along the slab on their way to the lit and to the dark side, (v,) each."""
    slab = view.slab
    parts = collected(slabs.modes.k[slab], slabs.tau[slab, None], view.inside[:, None])
    lit, dark = slabs.lit[slab], slabs.dark[slab]
    to_lit = np.sum(lit * parts.u_lit + dark * parts.v_lit, axis=1)
    to_dark = np.sum(lit * parts.u_dark + dark * parts.v_dark, axis=1)
    return slabs.fewer[slab] * to_lit, slabs.fewer[slab] * to_dark


def _ray(slabs: Slabs, view: View) -> tuple[np.ndarray, np.ndarray]:
    return np.exp(-slabs.tau[view.slab] / view.inside), transmissivity(slabs.refraction, view.inside, view.outside)


def _mirror(slabs: Slabs, view: View) -> np.ndarray:
    return reflectivity(slabs.refraction, view.inside, view.outside)


def _echo(slabs: Slabs, view: View) -> np.ndarray:
    """Return 1 - (ray mirror)^2, which does not cancel where both are nearly 1."""
    ray, crosses = _ray(slabs, view)
    faded = -np.expm1(-slabs.tau[view.slab] / view.inside)
    return (faded + ray * crosses) * (1 + ray * _mirror(slabs, view))
