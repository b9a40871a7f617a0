"""A picture of error against work: how soon each way to the airlight of a ray comes near the oracle's value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.analytic import single_scattering
from fogproof.estimators import Airlight, MarchedAirlight
from fogproof.estimators.airlight.placing import Placing
from fogproof.reports.charts.colours import EXPECTED, OBSERVED, THIRD
from fogproof.scene import Medium, PointLight, Ray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_LEAST = 1e-4  # relative error that is shown


@dataclass(frozen=True)
class ErrorAgainstWork:
    """Root-mean-square errors of estimators and of marching, over the places of the ray that they look at.

    Work is counted, not timed: at each place the phase function, the light and two transmittances are asked for once.
    """

    rng: np.random.Generator
    places: int = 4096
    repeats: int = 64

    def draw(self, figure: Figure) -> str:
        """Draw relative errors, logarithmic, of a ray 12 m long that passes a light at 5 cm."""
        axes = figure.add_axes((0.16, 0.16, 0.52, 0.80))
        medium, light = Medium(0.02, 0.18), PointLight((0.05, 0.0, 6.0), 10.0)
        ray = Ray([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 12.0)
        exact = float(single_scattering(medium, ray, light).value)
        counts = 2 ** np.arange(0, int(np.log2(self.places)) + 1, 2)
        errors: dict[str, tuple[list[float], str]] = {}
        placings: tuple[tuple[Placing, str], ...] = (("free-path", THIRD), ("equiangular", OBSERVED))
        for placing, colour in placings:
            estimator = Airlight(medium, ray, light, placing=placing)
            drawn = estimator.draw(self.rng, self.repeats * self.places).value.reshape(self.repeats, self.places)
            errors[placing] = [_rms(drawn[:, :n].mean(axis=1) / exact - 1) for n in counts], colour
        marched = [MarchedAirlight(medium, ray, light, int(n)).draw(self.rng, 1).value[0] / exact - 1 for n in counts]
        errors["midpoint marching"] = np.abs(marched).tolist(), EXPECTED
        for name, (values, colour) in errors.items():
            axes.loglog(counts, values, "o--" if "marching" in name else "o-", color=colour, markersize=4)
            last = max(k for k, value in enumerate(values) if value > _LEAST)
            side, at = ("left", 7) if last == len(counts) - 1 else ("right", -7)
            axes.annotate(
                name, (counts[last], values[last]), (at, -4), textcoords="offset points", ha=side, fontsize=10
            )
        axes.set(xlabel="places looked at", ylabel="relative error", ylim=(_LEAST, 100))
        axes.set_yticks(10.0 ** np.arange(-4, 3))
        ratio = (errors["free-path"][0][-1] / errors["equiangular"][0][-1]) ** 2
        return (
            "Light scattered once into a ray of 12 m that passes a light at 5 cm: relative error over the number of places "
            f"looked at, from {self.repeats} runs each. For the same error free-path samples need about "
            f"{float(f'{ratio:.1g}'):,.0f} times as many places as equiangular ones; marching falls faster once its steps are "
            "shorter than 5 cm."
        )


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(errors**2)))
