"""Lorenz-Mie directions, drawn from a table with weights, against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import phase_mean_cosine
from fogproof.catalogue.cases import Altered, Case, Drawn, EstimatorCase, Twin
from fogproof.catalogue.phase.directions import (
    TILTED,
    direction_case,
    rosenblatt,
)
from fogproof.contracts import Draw, Reference
from fogproof.estimators import Directions, phase_table
from fogproof.scene import (
    Mie,
)

DROPLET = Mie(1.2e-6, 550e-9, 1.333)
"""A water droplet of size parameter 6.9."""


def _unweighted(sampler: Directions, u: np.ndarray) -> Draw:
    return sampler.sample(u)._replace(weight=np.ones(len(u)))


def _moments(sphere: Mie) -> Drawn:
    """Weights of sampled directions, and weights times cosines: their means are 1 and g."""

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        directions = Directions(sphere).sample(rng.random((n, 2)))
        assert directions.weight is not None
        return np.stack([directions.weight, directions.weight * directions.x[:, 2]], axis=-1)

    return Drawn(draw)


def _one_and_g(sphere: Mie) -> Reference:
    g = phase_mean_cosine(sphere)
    return Reference(np.array([1.0, g.value]), np.array([0.0, g.error]), g.method, g.source)


def cases() -> list[Case]:
    """Return the cases of weighted directions."""
    mie = "Bohren & Huffman 1983"
    table = phase_table(DROPLET)
    return [
        direction_case(
            name="directions/lorenz-mie",
            title="Lorenz-Mie directions of a water droplet, from a table with weights",
            phase=table,
            mean=float(phase_mean_cosine(table).value),
            make=lambda: Directions(DROPLET, TILTED),
            twin=Twin(
                error="the weights are taken for 1",
                make=lambda: Altered(Directions(DROPLET, TILTED), _unweighted),
            ),
            source=mie,
            axis=TILTED,
            options={"albedo": 1.0, "cdf": rosenblatt(table, TILTED)},
            samples=300_000,
        ),
        EstimatorCase(
            name="directions/lorenz-mie/mean",
            title="Lorenz-Mie directions of a water droplet: mean weight and mean cosine",
            make=lambda: _moments(DROPLET),
            reference=lambda: _one_and_g(DROPLET),
            oracle="phase_mean_cosine",
            source=mie,
            twin=Twin("the diameter is taken for the radius", lambda: _moments(Mie(2.4e-6, 550e-9, 1.333))),
            samples=300_000,
            needs="miepython",
        ),
    ]
