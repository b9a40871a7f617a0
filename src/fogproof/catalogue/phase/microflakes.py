"""SGGX microflakes: mirrors as a sampler with the oracle's density, diffuse flakes by the moments of their directions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.analytic import microflake_pdf
from fogproof.catalogue.cases import Altered, Case, Drawn, EstimatorCase, SamplerCase, Twin
from fogproof.catalogue.phase.directions import TILTED
from fogproof.contracts import Reference
from fogproof.estimators import MicroflakeDirections
from fogproof.scene import Microflakes

SOURCE = "Heitz, Dupuy, Crassin & Dachsbacher 2015"

AXIS = (0.6, 0.0, 0.8)
SHEET, FIBRE = Microflakes.along(AXIS, 0.4, "surface"), Microflakes.along(AXIS, 0.5, "fibre")
CLOTH = Microflakes(FIBRE.S, "diffuse")


def _density(flakes: Microflakes) -> Callable[[np.ndarray], Reference]:
    return lambda x: microflake_pdf(flakes, TILTED, x)


def _all_normals(flakes: Microflakes) -> Callable[[MicroflakeDirections, np.ndarray], np.ndarray]:
    """Normals as there are, not as they are seen: the cosine is taken about the axis of the sampler's own frame."""

    def sample(_sampler: MicroflakeDirections, u: np.ndarray) -> np.ndarray:
        radius, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
        p = np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=-1)
        m = p @ np.linalg.cholesky(flakes.S).T
        m /= np.linalg.norm(m, axis=1)[:, None]
        back = -np.asarray(TILTED)
        return 2 * (m @ back)[:, None] * m - back

    return sample


def _moments(flakes: Microflakes) -> Drawn:
    """Components of the directions, and their squares."""
    directions = MicroflakeDirections(flakes, TILTED)

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        x = directions.drawn(rng.random((n, directions.dimensions)))
        return np.concatenate([x, x * x], axis=1)

    return Drawn(draw)


def _integrals(flakes: Microflakes) -> Reference:
    """The same from the density, by Gauss-Legendre in the cosine and equal steps of the azimuth; the error from half as many."""
    coarse, fine = (_over_the_sphere(flakes, nodes) for nodes in (20, 40))
    error = np.abs(fine - coarse)
    return Reference(fine, error + 1e-10, "quadrature of microflake_pdf", SOURCE)


def _over_the_sphere(flakes: Microflakes, nodes: int) -> np.ndarray:
    z, weights = np.polynomial.legendre.leggauss(nodes)
    phi = (np.arange(2 * nodes) + 0.5) * np.pi / nodes
    s = np.sqrt(1 - z * z)[:, None]
    flat = np.stack([s * np.cos(phi), s * np.sin(phi), np.broadcast_to(z[:, None], (nodes, 2 * nodes))], axis=-1)
    x = flat.reshape(-1, 3)
    x = x / np.linalg.norm(x, axis=1)[:, None]
    mass = np.repeat(weights, 2 * nodes) * np.pi / nodes * microflake_pdf(flakes, TILTED, x).value
    moments: np.ndarray = mass @ np.concatenate([x, x * x], axis=1)
    return moments


def cases() -> list[Case]:
    """Return the cases of microflakes."""
    sheet = MicroflakeDirections(SHEET, TILTED)
    return [
        SamplerCase(
            name="directions/microflakes/sheet",
            title="Directions of mirroring SGGX flakes as on a surface, roughness 0.4",
            make=lambda: sheet,
            reference=_density(SHEET),
            oracle="microflake_pdf",
            source=SOURCE,
            twin=Twin(
                "normals are drawn as there are, not as they are seen", lambda: Altered(sheet, _all_normals(SHEET))
            ),
            samples=300_000,
        ),
        SamplerCase(
            name="directions/microflakes/fibre",
            title="Directions of mirroring SGGX flakes as on a fibre, roughness 0.5",
            make=lambda: MicroflakeDirections(FIBRE, TILTED),
            reference=_density(FIBRE),
            oracle="microflake_pdf",
            source=SOURCE,
            twin=Twin("the flakes of a surface for those of a fibre", lambda: sheet),
            samples=300_000,
        ),
        EstimatorCase(
            name="directions/microflakes/diffuse",
            title="Directions of diffuse SGGX flakes as on a fibre: means of components and squares",
            make=lambda: _moments(CLOTH),
            reference=lambda: _integrals(CLOTH),
            oracle="microflake_pdf",
            source=SOURCE,
            twin=Twin("the flakes are mirrors", lambda: _moments(FIBRE)),
            samples=500_000,
        ),
    ]
