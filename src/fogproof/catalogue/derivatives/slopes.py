"""Derivatives of transmittance, single scattering and slabs by score functions and by attached sampling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import Drawn, EstimatorCase
from fogproof.catalogue.derivatives.builders import altered, derivative_case, slopes
from fogproof.contracts import Draws
from fogproof.estimators.derivatives.airlight import AirlightSlopes
from fogproof.estimators.derivatives.slab_walks import SlabSlopes, SlabWalk
from fogproof.estimators.derivatives.transmittance import FreePathScore, RatioTrackingSlopes
from fogproof.scene import HenyeyGreenstein, Medium, PiecewiseConstantMedium, PointLight, Ray

SCORE = "score function: Glynn 1990, Likelihood ratio gradient estimation"
ATTACHED = "Nimier-David, Speierer, Ruiz & Jakob 2020, Radiative backpropagation; Novak et al. 2014, ratio tracking"

RAY = Ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 2.0)
LAMP = PointLight((1.0, 1.0, 0.5), 3.0)
FOG = Medium(0.3, 0.5, HenyeyGreenstein(0.4))
LAYERS = (0.5, 2.0, 0.25)
BEAM = SlabWalk(0.8, 1.5, 0.6, 0.5)
COEFFICIENTS = ("medium.sigma_a", "medium.sigma_s", "medium.phase.g")


@dataclass(frozen=True, eq=False)
class _Forgetful(AirlightSlopes):
    """Airlight whose derivatives lack a part: "density", "phase" or "shadow"."""

    without: str = ""

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        whole = np.asarray(super().draw(np.random.default_rng(state := rng.integers(2**63)), n).value)
        value, score, toward, _ = self.pieces(np.random.default_rng(state), n)
        part = {"density": score, "shadow": -toward}.get(self.without, np.zeros(n))
        missing = (value * part)[:, None] * np.array([1.0, 1.0, 0.0])
        return Draws(whole * [1.0, 1.0, 0.0] if self.without == "phase" else whole - missing)


def _with_the_factor_itself(subject: RatioTrackingSlopes) -> Drawn:
    """The product keeps the factor whose derivative it multiplies."""

    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = subject.draw(rng, n)
        factor = 1 - np.asarray(subject.sigma_t) / subject.majorant
        return draws._replace(value=np.asarray(draws.value) * factor)

    return Drawn(draw)


def _layers() -> dict[str, Any]:
    medium = PiecewiseConstantMedium((0.0, 0.5, 1.5, 2.0), LAYERS)
    return {"medium": medium, "ray": RAY}


def _slab(quantity: str) -> Any:
    arguments = {"albedo": 0.8, "tau": 1.5, "mu0": 0.6, "phase": HenyeyGreenstein(0.5)}
    return slopes(quantity, "albedo", "tau", "phase.g", **arguments)


def cases() -> list[EstimatorCase]:
    """Return the cases of derivatives."""
    airlight = {"medium": FOG, "ray": RAY, "light": LAMP}
    return [
        derivative_case(
            name="derivatives/transmittance/free-path",
            title="dT/d sigma_t by the score of free paths",
            make=lambda: FreePathScore(0.8, 2.0),
            reference=lambda: analytic.gradient("transmittance", "medium.sigma_t", medium=Medium(0.3, 0.5), ray=RAY),
            oracle="gradient of transmittance",
            error="the sign of the score",
            twin=lambda: altered(FreePathScore(0.8, 2.0), np.negative),
            source=SCORE,
        ),
        derivative_case(
            name="derivatives/transmittance/ratio-tracking",
            title="dT/d sigma_t of each layer by ratio tracking, attached",
            make=lambda: RatioTrackingSlopes(LAYERS, (0.5, 1.0, 0.5), 2.5),
            reference=lambda: analytic.gradient("transmittance", "medium.sigma_t", **_layers()),
            oracle="gradient of transmittance",
            error="a null collision's own factor stays in the product",
            twin=lambda: _with_the_factor_itself(RatioTrackingSlopes(LAYERS, (0.5, 1.0, 0.5), 2.5)),
            source=ATTACHED,
        ),
        derivative_case(
            name="derivatives/airlight/free-path",
            title="Airlight by sigma_a, sigma_s and g, distances from free paths",
            make=lambda: AirlightSlopes(FOG, RAY, LAMP),
            reference=lambda: slopes("single_scattering", *COEFFICIENTS, **airlight),
            oracle="gradient of single_scattering",
            error="the derivative of the distance's density is forgotten",
            twin=lambda: _Forgetful(FOG, RAY, LAMP, without="density"),
            source=SCORE,
        ),
        derivative_case(
            name="derivatives/airlight/phase-function",
            title="Airlight by sigma_a, sigma_s and g: the phase function's weight is attached",
            make=lambda: AirlightSlopes(FOG, RAY, LAMP, "uniform"),
            reference=lambda: slopes("single_scattering", *COEFFICIENTS, **airlight),
            oracle="gradient of single_scattering",
            error="the phase function's weight is detached",
            twin=lambda: _Forgetful(FOG, RAY, LAMP, "uniform", without="phase"),
            source=ATTACHED,
        ),
        derivative_case(
            name="derivatives/airlight/shadow-rays",
            title="Airlight by sigma_a, sigma_s and g: the way to the lamp is attached",
            make=lambda: AirlightSlopes(FOG, RAY, LAMP, "uniform"),
            reference=lambda: slopes("single_scattering", *COEFFICIENTS, **airlight),
            oracle="gradient of single_scattering",
            error="the transmittance of shadow rays is detached",
            twin=lambda: _Forgetful(FOG, RAY, LAMP, "uniform", without="shadow"),
            source=ATTACHED,
        ),
        derivative_case(
            name="derivatives/slab/reflectance",
            title="What a slab reflects, by albedo, thickness and g",
            make=lambda: SlabSlopes(BEAM),
            reference=lambda: _slab("slab_reflectance"),
            oracle="gradient of slab_reflectance",
            error="n albedo^n instead of n albedo^(n - 1)",
            twin=lambda: altered(SlabSlopes(BEAM), lambda value: value * [0.8, 1.0, 1.0]),
            samples=200_000,
            source=SCORE,
        ),
        derivative_case(
            name="derivatives/slab/transmittance",
            title="What a slab transmits, by albedo, thickness and g",
            make=lambda: SlabSlopes(BEAM, "transmitted"),
            reference=lambda: _slab("slab_transmittance"),
            oracle="gradient of slab_transmittance",
            error="the flight that leaves has no score",
            twin=lambda: SlabSlopes(_Unscored(0.8, 1.5, 0.6, 0.5), "transmitted"),
            samples=200_000,
            source=SCORE,
        ),
    ]


class _Unscored(SlabWalk):
    """FinishedWalks that do not count the flight out of the slab."""

    def walk(self, rng: np.random.Generator, n: int) -> Any:
        walks = super().walk(rng, n)
        return walks._replace(length=walks.length - np.where(walks.side == 1, 0.5 * walks.length, 0.0))
