"""What the cases of multiple scattering share: scenes, exact values, and how a case is made."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.catalogue.twins.paths import LiteralPaths
from fogproof.contracts import Draws, Estimator, Reference
from fogproof.scene import Medium, Ray
from fogproof.scene.lights import DirectionalLight, Environment
from fogproof.scene.shapes import Ball, Box, Slab
from fogproof.scene.surfaces import Plane, Surface

UP = (0.0, 0.0, 1.0)


SLAB = Slab((0.0, 0.0, 0.0), UP, 1.0)


BALL = Ball((0.0, 0.0, 0.0), 1.0)


BOX = Box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))


BELOW = Plane((0.0, 0.0, -2.0), UP)


BLACK = Surface(BELOW)


SKY = Environment(1.0)


VIEW, SUN = 0.5, 0.8
"""Cosines to the normal of the camera ray and of the sun."""


ABOVE = Ray((0.0, 0.0, 3.0), (np.sqrt(1 - VIEW * VIEW), 0.0, -VIEW))


ASIDE = Ray((0.3, 0.0, 3.0), (0.0, 0.0, -1.0))


SUNLIGHT = DirectionalLight((np.sqrt(1 - SUN * SUN), 0.0, -SUN), 1.0)


FOG = Medium(0.1, 0.9)


TRACING = "Kajiya & Von Herzen 1984; volume rendering equation, one-sample estimator"


NEXT_EVENT = "next-event estimation: Coleman 1968; balance heuristic: Veach & Guibas 1995"


def paths_case(
    name: str,
    title: str,
    make: Callable[[], Estimator],
    reference: Callable[[], Reference],
    oracle: str,
    error: str,
    twin: Callable[[], Any],
    **more: Any,
) -> EstimatorCase:
    """Return a case; `more` are further fields of `EstimatorCase`."""
    return EstimatorCase(
        name=f"paths/{name}",
        title=title,
        make=make,
        reference=reference,
        oracle=oracle,
        twin=Twin(error, twin),
        **{"source": TRACING, "samples": 500_000, **more},
    )


def scaled(estimator: Any, factor: Any) -> Drawn:
    """The subject times a factor, or with its columns weighted."""

    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = estimator.draw(rng, n)
        return draws._replace(value=np.asarray(draws.value) * factor)

    return Drawn(draw)


def combined(method: str, formula: Callable[..., float], *parts: Reference) -> Reference:
    """A smooth formula of references; its error from moving each of them by its own, to first order and a little more."""
    values = [float(part.value) for part in parts]
    value = formula(*values)
    error = 0.0
    for i, part in enumerate(parts):
        moved = list(values)
        moved[i] += float(part.error)
        error += abs(formula(*moved) - value)
    return Reference(np.asarray(value), np.asarray(2 * error + 1e-15), method, parts[0].source)


def times(reference: Reference, factor: Any) -> Reference:
    """Return a reference times a factor that is exact."""
    factor = np.asarray(factor, dtype=float)
    error = reference.error * factor + 1e-15 * np.abs(reference.value * factor)
    return Reference(reference.value * factor, error, reference.method, reference.source)


def literal(**more: Any) -> LiteralPaths:
    """The plain tracer above a slab under half a sky."""
    return LiteralPaths(**{"medium": FOG, "shape": SLAB, "ray": ABOVE, "light": SKY, "horizon": UP, **more})
