"""Lorenz-Mie scattering by spheres of many sizes: a haze of absorbing dust, and small droplets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.analytic import phase_mean_cosine
from fogproof.catalogue.cases import Case, Drawn, EstimatorCase, SamplerCase, Twin
from fogproof.catalogue.phase.directions import POLE, TILTED, Axis, oracle_pdf
from fogproof.estimators import Directions
from fogproof.scene import PhaseFunction, PolydisperseMie

SOURCE = "Hansen & Travis 1974; Bohren & Huffman 1983"

DUST = PolydisperseMie("log-normal", 0.4e-6, 0.2, 550e-9, 1.5 + 0.01j)
DROPLETS = PolydisperseMie("gamma", 1e-6, 0.1, 550e-9, 1.333)


def _case(name: str, title: str, phase: PhaseFunction, axis: Axis, error: str, wrong: PhaseFunction) -> SamplerCase:
    return SamplerCase(
        name=f"directions/polydisperse-mie/{name}",
        title=title,
        make=lambda: Directions(phase, axis),
        reference=oracle_pdf(phase, axis),
        oracle="phase_pdf",
        source=SOURCE,
        twin=Twin(error, lambda: Directions(wrong, axis)),
        options={"axis": axis},
        samples=300_000,
        needs="miepython",
    )


def _cosines(phase: PhaseFunction) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        return Directions(phase).sample(rng.random((n, 2))).x[:, 2]

    return Drawn(draw)


def cases() -> list[Case]:
    """Return the cases of this phase function."""
    radius = replace(DUST, effective_diameter=2 * DUST.effective_diameter)
    return [
        _case(
            name="dust",
            title="Lorenz-Mie directions of absorbing dust, log-normal sizes",
            phase=DUST,
            axis=TILTED,
            error="the imaginary part of the refractive index is forgotten",
            wrong=replace(DUST, refractive_index=1.5),
        ),
        _case(
            name="droplets",
            title="Lorenz-Mie directions of droplets, gamma distributed sizes",
            phase=DROPLETS,
            axis=POLE,
            error="the effective variance is taken for its square root",
            wrong=replace(DROPLETS, effective_variance=DROPLETS.effective_variance**2),
        ),
        EstimatorCase(
            name="directions/polydisperse-mie/mean",
            title="Lorenz-Mie directions of absorbing dust: mean cosine",
            make=lambda: _cosines(DUST),
            reference=lambda: phase_mean_cosine(DUST),
            oracle="phase_mean_cosine",
            source=SOURCE,
            twin=Twin("the effective diameter is taken for the effective radius", lambda: _cosines(radius)),
            samples=300_000,
            needs="miepython",
        ),
    ]
