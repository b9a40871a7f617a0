"""Pictures of phase functions: the oracle's curve, and behind it what the samplers draw."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fogproof.analytic import phase_cdf, phase_pdf
from fogproof.estimators import Directions
from fogproof.reports.charts.colours import EXPECTED, INK, OBSERVED, THIRD
from fogproof.scene import HenyeyGreenstein, Isotropic, Mie, PhaseFunction, Rayleigh, Schlick

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LINES: list[dict[str, Any]] = [
    {"color": OBSERVED, "linestyle": "-"},
    {"color": EXPECTED, "linestyle": "--"},
    {"color": THIRD, "linestyle": "-."},
    {"color": INK, "linestyle": ":"},
]


@dataclass(frozen=True)
class PolarPanel:
    """Phase functions as the radius over the scattering angle; light travels to the right before it scatters."""

    def draw(self, figure: Figure) -> str:
        """Draw four kinds, the radius proportional to the density."""
        axes: Any = figure.add_axes((0.04, 0.13, 0.55, 0.72), projection="polar")
        theta = np.linspace(-np.pi, np.pi, 721)
        kinds: dict[str, PhaseFunction] = {
            "isotropic": Isotropic(),
            "Rayleigh": Rayleigh(),
            "HG, g = -0.3": HenyeyGreenstein(-0.3),
            "HG, g = 0.5": HenyeyGreenstein(0.5),
        }
        for (name, phase), look in zip(kinds.items(), _LINES, strict=True):
            axes.plot(theta, phase_pdf(phase, np.cos(theta)).value, label=name, **look)
        axes.set_rlabel_position(112)
        axes.set_rticks([0.1, 0.2, 0.3])
        axes.set_xticks(np.radians(np.arange(0, 360, 45)))
        figure.text(0.97, 0.9, "phase function [1/sr]\nover the scattering angle", ha="right", va="top", fontsize=10)
        figure.legend(loc="center right", fontsize=10, borderaxespad=0.3, handlelength=2.4)
        return (
            "Phase functions in polar form, the angle between the directions before and after scattering: isotropic, "
            "Rayleigh (forward and backward alike) and Henyey-Greenstein backward and forward."
        )


@dataclass(frozen=True)
class LinearPanel:
    """Henyey-Greenstein over the cosine: the curve is the oracle's, the shares are sampled."""

    rng: np.random.Generator
    samples: int = 100_000

    def draw(self, figure: Figure) -> str:
        """Draw three g, logarithmic, with 40 bins of sampled directions behind each curve."""
        axes = figure.add_axes((0.14, 0.16, 0.83, 0.80))
        mu, edges = np.linspace(-1, 1, 400), np.linspace(-1, 1, 41)
        worst = 0.0
        for g, look in zip((-0.5, 0.0, 0.8), _LINES, strict=False):
            phase = HenyeyGreenstein(g)
            drawn = Directions(phase).sample(self.rng.random((self.samples, 2))).x[:, 2]
            share = np.histogram(drawn, edges)[0] / self.samples
            expected = np.diff(phase_cdf(phase, edges).value)
            worst = max(worst, float(np.abs(share - expected).max()))
            density = share / (2 * np.pi * np.diff(edges))
            axes.stairs(density, edges, fill=True, color=look["color"], alpha=0.25, baseline=1e-3)
            axes.plot(mu, phase_pdf(phase, mu).value, label=f"g = {g:g}", **look)
        axes.set(yscale="log", xlabel="forward cosine mu", ylabel="phase function [1/sr]", ylim=(4e-3, 5))
        axes.legend(loc="upper left")
        return (
            f"Henyey-Greenstein over the forward cosine: lines by the oracle, areas from {self.samples} sampled directions "
            f"each; the shares of the bins differ from their probabilities by at most {worst:.2g}."
        )


@dataclass(frozen=True)
class Approximation:
    """Henyey-Greenstein and the rational function that stands in for it."""

    def draw(self, figure: Figure) -> str:
        """Draw both over the scattering angle for three g."""
        axes = figure.add_axes((0.14, 0.16, 0.83, 0.80))
        degrees = np.linspace(0, 180, 361)
        mu = np.cos(np.radians(degrees))
        worst = 0.0
        for g, look in zip((-0.5, 0.0, 0.8), _LINES, strict=False):
            exact, stand_in = (phase_pdf(phase, mu).value for phase in (HenyeyGreenstein(g), Schlick.from_g(g)))
            worst = max(worst, float(np.abs(stand_in / exact - 1).max()))
            axes.plot(degrees, exact, color=look["color"], label=f"Henyey-Greenstein, g = {g:g}")
            axes.plot(
                degrees, stand_in, color=look["color"], linestyle=":", label=f"Schlick, k = {Schlick.from_g(g).k:.3g}"
            )
        axes.set(yscale="log", xlabel="scattering angle [degrees]", ylabel="phase function [1/sr]", ylim=(1e-3, 100))
        axes.set_xticks(range(0, 181, 30))
        axes.legend(loc="upper right", fontsize=9, ncols=2)
        return (
            "Henyey-Greenstein (lines) and Schlick's rational function with k = 1.55 g - 0.55 g^3 (dots) over the "
            f"scattering angle; the largest relative difference is {worst:.0%}."
        )


@dataclass(frozen=True)
class SphereSizes:
    """Lorenz-Mie scattering by water droplets of three sizes, green light."""

    def draw(self, figure: Figure) -> str:
        """Draw three diameters over the scattering angle, logarithmic."""
        axes = figure.add_axes((0.17, 0.16, 0.80, 0.80))
        degrees = 180 * np.linspace(0, 1, 1401) ** 1.5
        mu = np.cos(np.radians(degrees))
        sizes = (1e-6, 10e-6, 100e-6)
        for diameter, look in list(zip(sizes, _LINES, strict=False))[::-1]:
            value = phase_pdf(Mie(diameter, 550e-9, 1.333), mu).value
            axes.plot(degrees, value, linewidth=1.2, label=f"{diameter * 1e6:g} µm", color=look["color"])
        axes.set(yscale="log", xlabel="scattering angle [degrees]", ylabel="phase function [1/sr]")
        axes.set_xticks(range(0, 181, 30))
        axes.legend(loc="upper right", title="diameter")
        return (
            "Lorenz-Mie phase functions of water spheres (index 1.333, wavelength 550 nm) of 1, 10 and 100 µm diameter: "
            "the larger the sphere, the narrower the forward peak and the finer the rings; the rainbow stands near 138 degrees."
        )
