"""Directions of tabulated phase functions and of mixtures against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.phase.directions import (
    NESTED,
    TABLE,
    TILTED,
    about_z,
    case_of_directions,
)
from fogproof.estimators import Directions
from fogproof.scene import (
    Mixture,
    Tabulated,
)


def _unweighted_component(sampler: Directions, x: np.ndarray) -> np.ndarray:
    assert isinstance(sampler.phase, Mixture)
    first, weight = sampler.phase.components[0], sampler.phase.weights[0]
    return sampler.pdf(x) + (1 - weight) * Directions(first, sampler.axis).pdf(x)


def _nodes_of_table(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """Cosines at the nodes of the table only, each with the density there as its weight."""
    cosines, values = np.array(TABLE.cosines), np.array(TABLE.values)
    chosen = np.searchsorted(np.cumsum(values) / values.sum(), u[:, 0], side="right")
    return about_z(cosines[chosen], u[:, 1])


def _next_cell(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """The table's cell is found one too high; its place in the cell is right."""
    cosines = np.array(TABLE.cosines)
    mu = sampler.sample(u).x @ np.asarray(sampler.axis)
    i = np.clip(np.searchsorted(cosines, mu, side="right") - 1, 0, len(cosines) - 2)
    j = np.minimum(i + 1, len(cosines) - 2)
    place = (mu - cosines[i]) / (cosines[i + 1] - cosines[i])
    return about_z(np.clip(cosines[j] + place * (cosines[j + 1] - cosines[j]), -1, 1), u[:, 1])


def _mirrored(table: Tabulated) -> Tabulated:
    return Tabulated(tuple(-c for c in reversed(table.cosines)), tuple(reversed(table.values)))


def cases() -> list[Case]:
    """Return the cases of tables and mixtures."""
    table_source = "piecewise linear in the cosine"
    return [
        case_of_directions(
            name="tabulated",
            title="Tabulated phase function",
            phase=TABLE,
            source=table_source,
            error="cosines at the nodes of the table only",
            sample=_nodes_of_table,
        ),
        case_of_directions(
            name="tabulated/cells",
            title="Tabulated phase function",
            phase=TABLE,
            source=table_source,
            error="the index of the cell is one too high",
            sample=_next_cell,
        ),
        case_of_directions(
            name="tabulated/tilted",
            title="Tabulated phase function",
            phase=TABLE,
            source=table_source,
            error="the table is mirrored, in sampler and density alike",
            twin=lambda: Directions(_mirrored(TABLE), TILTED),
            axis=TILTED,
        ),
        case_of_directions(
            name="mixture",
            title="Mixture of a mixture, Murky and Rayleigh",
            phase=NESTED,
            source="sum of weighted densities",
            error="a component's density is not multiplied by its probability",
            pdf=_unweighted_component,
            axis=TILTED,
        ),
    ]
