"""Why the sky is blue and the sunset red: colours of light that Rayleigh scattering adds or takes away."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.analytic import (
    ambient_fog,
    rayleigh_scattering_coefficient,
    transmittance,
)
from fogproof.estimators import AnalogFog, AnalogTransmittance
from fogproof.reports.charts.colours import INK
from fogproof.scene import Medium, Ray, Rayleigh

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WAVELENGTH = np.arange(400, 701, 20)
_AIR = 8e3
"""Height of an atmosphere as dense as at the ground all the way up [m]."""


@dataclass(frozen=True)
class SkyAndSunset:
    """Scattered light of the sky and transmitted light of the sun along four lengths of air."""

    rng: np.random.Generator
    samples: int = 20_000

    def draw(self, figure: Figure) -> str:
        """Draw swatches: above by the oracle, below by Monte Carlo, with Delta E 2000 between them."""
        beta = _scattering()
        lengths = _AIR * np.array([1.0, 5.0, 15.0, 38.0])
        rows: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {"sky": [], "sun": []}
        for length in lengths:
            rows["sky"].append(self._pair(beta, length, sky=True))
            rows["sun"].append(self._pair(beta, length, sky=False))
        differences = []
        for row, (name, pairs) in enumerate(rows.items()):
            for column, (exact, estimate) in enumerate(pairs):
                axes = figure.add_axes((0.13 + 0.217 * column, 0.60 - 0.47 * row, 0.197, 0.29))
                (upper, lower), difference = _colours(exact, estimate)
                differences.append(difference)
                axes.imshow(np.stack([[upper], [lower]]), aspect="auto", interpolation="nearest")
                axes.set(xticks=[], yticks=[0, 1], yticklabels=["oracle", "estimate"] if column == 0 else ["", ""])
                axes.tick_params(length=0, labelsize=8)
                axes.grid(False)
                axes.set_title(f"{name}, {lengths[column] / 1e3:.0f} km", fontsize=9, color=INK)
                axes.set_xlabel(f"ΔE = {difference:.2f}", fontsize=9)
        return (
            "Colours of the sky (light scattered along the path) and of the sun (light left after it) through 8 to 304 km of "
            "air, each as bright as a screen can show: the upper half by the oracle, the lower half from "
            f"{self.samples} free paths a wavelength; Delta E 2000 is at most {max(differences):.2f}."
        )

    def _pair(self, beta: np.ndarray, length: float, sky: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return the spectrum by the oracle and its estimate, relative to the light that comes in."""
        ray = Ray([0, 0, 0], [0, 0, 1], length)
        if not sky:
            medium = Medium(0.0, tuple(beta.tolist()), Rayleigh())
            drawn = [AnalogTransmittance(b, length).draw(self.rng, self.samples).value.mean() for b in beta]
            return transmittance(medium, ray).value, np.array(drawn)
        air = [Medium(0.0, b, Rayleigh()) for b in beta]
        exact = [float(ambient_fog(medium, ray, 1.0, 0.0).value) for medium in air]
        drawn = [AnalogFog(medium, ray, 1.0, 0.0).draw(self.rng, self.samples).value.mean() for medium in air]
        return np.array(exact), np.array(drawn)


def _scattering() -> np.ndarray:
    """Return the scattering coefficient of air at the ground for each wavelength [1/m].

    A small sphere of index eta stands for a molecule. N of them a cubic metre make the refractivity n - 1 of air when
    (2/3)(n - 1) = (4 pi/3) N (d/2)^3 (eta^2 - 1)/(eta^2 + 2), which is the law of Lorentz and Lorenz for n near 1.
    """
    density, refractivity, eta = 2.547e25, 2.78e-4, 1.5
    clausius = (eta**2 - 1) / (eta**2 + 2)
    diameter = 2 * (refractivity / (2 * np.pi * density * clausius)) ** (1 / 3)
    return rayleigh_scattering_coefficient(diameter, eta, density, _WAVELENGTH * 1e-9).value


def _colours(exact: np.ndarray, estimate: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray], float]:
    """Return both spectra under daylight D65 as sRGB, scaled alike to full brightness, and their Delta E 2000."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # optional parts of the library that are not installed
        import colour

        shape = colour.SpectralShape(400, 700, 20)
        light = colour.SDS_ILLUMINANTS["D65"].copy().align(shape)
        observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
        white = light.values @ observer.values
        xyz = [(light.values * spectrum) @ observer.values for spectrum in (exact, estimate)]
        scale = 1 / max(float(np.max(colour.XYZ_to_sRGB(value, apply_cctf_encoding=False))) for value in xyz)
        shown = [np.clip(colour.XYZ_to_sRGB(value * scale), 0, 1) for value in xyz]
        lab = [colour.XYZ_to_Lab(value * scale, colour.XYZ_to_xy(white)) for value in xyz]
        return (shown[0], shown[1]), float(colour.delta_E(*lab, method="CIE 2000"))
