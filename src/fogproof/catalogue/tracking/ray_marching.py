"""Ray marching: it is biased, so what is checked is that the bias is as large, and falls as fast, as theory says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.analytic import optical_thickness
from fogproof.catalogue.cases import Case, Drawn, EstimatorCase, Twin
from fogproof.catalogue.tracking.scenes import LAYERS, RIEMANN, UP, distance_case
from fogproof.contracts import Reference
from fogproof.estimators import MarchedFreePath, MarchedTransmittance, RayMarch
from fogproof.scene import AnyMedium, ExponentialMedium


@dataclass(frozen=True, eq=False)
class _ObservedOrder:
    """log2 of how much the error of the optical depth shrinks when the steps are halved, along `UP`."""

    medium: AnyMedium
    steps: int
    rule: Any

    def draw(self, rng: np.random.Generator, n: int) -> np.ndarray:
        truth = float(optical_thickness(self.medium, UP).value)
        off = [
            float(RayMarch(self.medium, UP, 2.0 / steps, self.rule).depths[-1, 0]) - truth
            for steps in (self.steps, 2 * self.steps)
        ]
        return np.full(n, np.log2(off[0] / off[1]))


def _bias(k: float, h: float, rule: str) -> float:
    """Return the relative error of the sum over exp(k t): a geometric series, with midpoints or right ends."""
    x = k * h
    return float(x / 2 / np.sinh(x / 2) - 1 if rule == "midpoint" else x / -np.expm1(-x) - 1)


def cases() -> list[Case]:
    """Return the cases of ray marching: it is biased, so the bias is what is checked, and its order."""
    k, steps = 0.9, 16
    medium = ExponentialMedium(0.8, (0.0, 0.0, k))

    def biased(rule: str) -> Reference:
        tau = optical_thickness(medium, UP)
        value = np.exp(-tau.value * (1 + _bias(k, 2.0 / steps, rule)))
        return Reference(value, 1e-13 * value, "geometric series", RIEMANN)

    def order(rule: str) -> Reference:
        value = np.log2(_bias(k, 2.0 / steps, rule) / _bias(k, 1.0 / steps, rule))
        return Reference(np.asarray(value), np.asarray(1e-9), "geometric series", RIEMANN)

    def one_more(rng: np.random.Generator, n: int) -> np.ndarray:
        march = RayMarch(medium, UP, 2.0 / steps, "right")
        return np.full(n, np.exp(-march.depths[-1, 0] - march.sigma[-1, 0] * 2.0 / steps))

    def case(
        rule: Any, what: str, title: str, make: Any, reference: Any, error: str, twin: Callable[[], Any]
    ) -> EstimatorCase:
        return EstimatorCase(
            name=f"tracking/march/{rule}/{what}",
            title=title,
            make=make,
            reference=lambda: reference(rule),
            variance=lambda: 0.0,
            oracle="optical_thickness",
            source=RIEMANN,
            twin=Twin(error, twin),
            samples=1000,
        )

    def shifted(u: np.ndarray) -> np.ndarray:
        return np.minimum(MarchedFreePath(LAYERS, UP, 0.25).sample(u).x + 0.25, 2.0)

    def marched(rule: Any) -> Callable[[], Any]:
        return lambda: MarchedTransmittance(medium, UP, 2.0 / steps, rule)

    def observed(rule: Any) -> Callable[[], Any]:
        return lambda: _ObservedOrder(medium, steps, rule)

    return [
        case(
            "midpoint",
            "bias",
            "Ray marching, midpoints, 16 steps: T is 0.24 % too high, as theory says",
            marched("midpoint"),
            biased,
            "right ends instead of midpoints",
            marched("right"),
        ),
        case(
            "right",
            "bias",
            "Ray marching, right ends, 16 steps: T is 23 % too low, as theory says",
            marched("right"),
            biased,
            "a sum of 17 terms, k = 0 … 16",
            lambda: Drawn(one_more),
        ),
        case(
            "midpoint",
            "order",
            "Ray marching, midpoints: the bias is of order step^2",
            observed("midpoint"),
            order,
            "right ends: of order step",
            observed("right"),
        ),
        case(
            "right",
            "order",
            "Ray marching, right ends: the bias is of order step",
            observed("right"),
            order,
            "midpoints: of order step^2",
            observed("midpoint"),
        ),
        distance_case(
            "march/free-path",
            "Free path by ray marching, with steps that are the medium's layers: no bias",
            lambda: MarchedFreePath(LAYERS, UP, 0.25),
            LAYERS,
            UP,
            "Kulla & Fajardo 2012",
            "the table is read one step too high",
            shifted,
        ),
    ]
