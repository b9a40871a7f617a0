"""Evidence for what checks found in phase functions: SGGX in a transposed frame, and without a density straight ahead."""

from __future__ import annotations

import numpy as np

from fogproof.adapters.mitsuba import MitsubaPhase
from fogproof.catalogue.mitsuba.phases import sggx, sggx_plugin

SEED = 20


def sphere(mu_points: int = 400, phi_points: int = 400, low: float = -1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return directions and weights of a product rule, Gauss-Legendre in mu on [low, 1], midpoints in phi."""
    mu, weight = np.polynomial.legendre.leggauss(mu_points)
    mu, weight = low + (mu + 1) * (1 - low) / 2, weight * (1 - low) / 2
    phi = (np.arange(phi_points) + 0.5) * 2 * np.pi / phi_points
    sine = np.sqrt(1 - mu[:, None] ** 2)
    x = np.stack(np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), mu[:, None]), -1).reshape(-1, 3)
    return x, np.repeat(weight, phi_points) * 2 * np.pi / phi_points


def uniforms(n: int, k: int) -> np.ndarray:
    """Return (n, k) single-precision uniforms."""
    return np.random.default_rng(SEED).random((n, k), dtype=np.float32)


def frame_of_sggx() -> str:
    """Compare the mean sampled direction with that of the paper's density."""
    flake, axis = (1.0, 0.6, 0.3, 0.2, 0.1, -0.15), (2 / 7, -3 / 7, 6 / 7)
    x, weight = sphere()
    density = sggx(flake, axis)(x + 1e-12).value
    exact = (weight * density) @ x
    drawn = MitsubaPhase(sggx_plugin(flake), axis).sample(uniforms(1_000_000, 3)).x
    z = (drawn.mean(0) - exact) / (drawn.std(0) / 1000)
    pdf = MitsubaPhase(sggx_plugin(flake), axis).pdf(x)
    return (
        f"The density of Heitz et al. (2015), written anew, integrates to {weight @ density:.5f} and agrees with `eval_pdf` to"
        f" {np.max(np.abs(pdf / density - 1)):.1g}. Its mean direction is {vector(exact)}; that of 10^6 samples is"
        f" {vector(drawn.mean(0))}, off by {vector(z, 0)} standard errors."
    )


def ahead_of_sggx() -> str:
    """Ask for the density exactly straight ahead."""
    phase = MitsubaPhase(sggx_plugin((1.0, 1.0, 0.1, 0.0, 0.0, 0.0)))
    ahead, beside = phase.pdf(np.array([[0.0, 0.0, 1.0], [1e-3, 0.0, 1.0]]))
    return (
        f"`eval_pdf` is {ahead:g} at wo = -wi and {beside:.4g} at an angle of 0.001; `sample` returns such directions."
    )


def vector(x: np.ndarray, digits: int = 4) -> str:
    """Return a vector in words."""
    return f"({', '.join(f'{float(c):.{digits}f}' for c in x)})"
