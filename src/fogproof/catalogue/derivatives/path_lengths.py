"""How long light stays in a slab, a half space or a ball, and how often it scatters there."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import EstimatorCase
from fogproof.catalogue.derivatives.builders import altered, derivative_case
from fogproof.contracts import Draws
from fogproof.estimators.derivatives.ball_walks import BallPathLengths
from fogproof.estimators.derivatives.slab_walks import FinishedWalks, SlabPathLengths, SlabScatteringCounts, SlabWalk
from fogproof.scene import HenyeyGreenstein

SOURCE = "Feynman-Kac: absorption is the variable of a Laplace transform"
RATES = (0.0, 0.2, 1.0, 2.0)


class _Overshooting(SlabWalk):
    """The last flight counts as if it went on behind the boundary, a mean free path further."""

    def walk(self, rng: np.random.Generator, n: int) -> FinishedWalks:
        walks = super().walk(rng, n)
        return walks._replace(length=walks.length + rng.standard_exponential(n))


class _WrongSpeed(BallPathLengths):
    """Light in a medium of refractive index 1.33 that is timed as in vacuum."""

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        left, length = self.lengths(rng, n)
        return Draws(np.where(left[:, None], np.exp(-np.multiply.outer(length / 1.33, self.rates)), 0.0))


def _slab(quantity: str, **arguments: Any) -> Any:
    return lambda: analytic.path_length_transform(quantity, RATES, **arguments)


def cases() -> list[EstimatorCase]:
    """Return the cases of path lengths and counts of scatterings."""
    beam, lobe = (0.9, 2.0, 0.5, 0.6), HenyeyGreenstein(0.6)
    deep = (0.7, np.inf, 0.5)
    return [
        derivative_case(
            name="path-lengths/slab",
            title="Path lengths of what passes a slab",
            make=lambda: SlabPathLengths(SlabWalk(*beam), RATES, "transmitted"),
            reference=_slab("slab_transmittance", albedo=0.9, tau=2.0, mu0=0.5, phase=lobe),
            oracle="path_length_transform of slab_transmittance",
            error="the last flight counts beyond the boundary",
            twin=lambda: SlabPathLengths(_Overshooting(*beam), RATES, "transmitted"),
            source=SOURCE,
            options={"bounds": (0, 1)},
            samples=200_000,
        ),
        derivative_case(
            name="path-lengths/half-space",
            title="Path lengths of what a half space reflects",
            make=lambda: SlabPathLengths(SlabWalk(*deep), RATES),
            reference=_slab("half_space_reflectance", albedo=0.7, mu0=0.5),
            oracle="path_length_transform of half_space_reflectance",
            error="the first flight is not counted",
            twin=lambda: SlabPathLengths(_Late(*deep), RATES),
            source=SOURCE,
            options={"bounds": (0, 1)},
            samples=200_000,
        ),
        derivative_case(
            name="path-lengths/ball",
            title="Path lengths of what leaves a ball",
            make=lambda: BallPathLengths(0.8, 1.5, RATES),
            reference=_slab("ball_albedo", albedo=0.8, radius=1.5),
            oracle="path_length_transform of ball_albedo",
            error="timed with the speed of light in vacuum",
            twin=lambda: _WrongSpeed(0.8, 1.5, RATES),
            source=SOURCE,
            options={"bounds": (0, 1)},
            samples=200_000,
        ),
        derivative_case(
            name="path-lengths/scatterings",
            title="How often what passes a slab has scattered",
            make=lambda: SlabScatteringCounts(SlabWalk(0.9, 2.0, 0.5), 4, "transmitted"),
            reference=lambda: _counts(0.9, 4, tau=2.0, mu0=0.5),
            oracle="slab_transmittance_orders",
            error="the order is off by one",
            twin=lambda: altered(
                SlabScatteringCounts(SlabWalk(0.9, 2.0, 0.5), 4, "transmitted"), lambda value: np.roll(value, 1, axis=1)
            ),
            samples=200_000,
            source="Irvine 1964, the albedo is the variable of a generating function",
        ),
    ]


class _Late(SlabWalk):
    """The clock starts at the first collision."""

    def walk(self, rng: np.random.Generator, n: int) -> FinishedWalks:
        walks = super().walk(rng, n)
        return walks._replace(length=np.maximum(walks.length - rng.standard_exponential(n), 0.0))


def _counts(albedo: float, most: int, **arguments: Any) -> Any:
    orders = analytic.slab_transmittance_orders(count=most, **arguments)
    powers = albedo ** np.arange(most + 1.0)
    return type(orders)(
        orders.value * powers, orders.error * powers + 1e-15 * orders.value, orders.method, orders.source
    )
