"""Layers against the slab that they are pieces of; black bodies and truncated moments in many digits."""

from __future__ import annotations

import mpmath as mp
import numpy as np

from fogproof import analytic
from fogproof.contracts import Reference
from fogproof.scene import HenyeyGreenstein, Isotropic, Rayleigh, SlabLayer
from hard.case import Kind, albedo, anisotropy, number

PLANCK, LIGHT, BOLTZMANN = mp.mpf("6.62607015e-34"), 299792458, mp.mpf("1.380649e-23")
FLUXES = {
    "reflectance": (analytic.layered_reflectance, analytic.slab_reflectance),
    "transmittance": (analytic.layered_transmittance, analytic.slab_transmittance),
    "emission": (analytic.layered_emission, analytic.slab_emissivity),
}
DIRECTIONAL = {
    "brdf": (analytic.layered_brdf, analytic.slab_brdf),
    "btdf": (analytic.layered_btdf, analytic.slab_btdf),
}


def _cut(rng, c, tau, phase):
    """Return up to four layers whose thicknesses add up to about tau, and their sum as it is in doubles."""
    shares = rng.dirichlet(np.ones(rng.integers(1, 5)))
    layers = tuple(SlabLayer(float(tau * share), c, phase, 1.0) for share in shares)
    return layers, float(sum(mp.mpf(one.tau) for one in layers))


def fluxes(name):
    """A slab cut into layers: the modes of the whole against the sum of the pieces."""

    def draw(rng):
        c, mu0 = albedo(rng), number(rng, 1e-2, 1)
        phase = rng.choice([Isotropic(), Rayleigh(), HenyeyGreenstein(float(rng.uniform(-0.8, 0.8)))])
        layers, tau = _cut(rng, c, number(rng, 1e-3, 1e3), phase)
        pieces, whole = FLUXES[name]
        known = whole(c, tau, mu0, phase)
        # The sum of the thicknesses is rounded: that moves a flux by less than eps times tau/mu0 of itself.
        doubt = float(known.error) + 4e-16 * max(tau / mu0, 1) * abs(float(known.value))
        return lambda: pieces(layers, mu0), mp.mpf(float(known.value)), doubt, f"{layers} {mu0}"

    return draw


def directions(name):
    """The same at one angle."""

    def draw(rng):
        c, (mu0, mu), azimuth = albedo(rng), rng.uniform(0.1, 1, 2), float(rng.uniform(0, np.pi))
        layers, tau = _cut(rng, c, number(rng, 1e-1, 1e1), Isotropic())
        pieces, whole = DIRECTIONAL[name]
        known = whole(c, tau, float(mu0), float(mu))
        doubt = float(known.error) + 1e-14 * abs(float(known.value))
        return lambda: pieces(layers, float(mu0), float(mu), azimuth), mp.mpf(float(known.value)), doubt, f"{layers}"

    return draw


def black_bodies(rng):
    """From the far infrared, where exp(x) - 1 cancels, to where nothing is left."""
    T, length = number(rng, 1e-2, 1e8), number(rng, 1e-12, 1e60)
    with mp.workdps(60):
        x = PLANCK * LIGHT / (mp.mpf(length) * BOLTZMANN * mp.mpf(T))
        truth = 2 * PLANCK * LIGHT**2 / mp.mpf(length) ** 5 / mp.expm1(x) / 10**9
    return lambda: analytic.black_body_radiance(T, length), truth, 0, f"{T} {length}"


def truncated(rng):
    """Moments g^l of Henyey and Greenstein, less those that go straight on."""
    g, count = anisotropy(rng), int(rng.integers(1, 40))
    at = int(rng.integers(count))
    with mp.workdps(60):
        f = mp.mpf(g) ** count
        truth = (mp.mpf(g) ** at - f) / (1 - f)

    def one():
        known = analytic.delta_m_moments(HenyeyGreenstein(g), count)
        return Reference(known.value[at], known.error[at])

    return one, truth, 0, f"{g} {count} {at}"


KINDS = (
    {f"layered_{name}": Kind(fluxes(name), 0.1) for name in FLUXES}
    | {f"layered_{name}": Kind(directions(name), 0.01) for name in DIRECTIONAL}
    | {"black_body_radiance": Kind(black_bodies, 12), "delta_m_moments": Kind(truncated, 3)}
)
