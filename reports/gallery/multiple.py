"""What many scatterings, hot gas and long distances look like: snow, fire, an aerial view, each rendered beside the oracle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.analytic import (
    ambient_fog,
    emitted_radiance,
    rayleigh_scattering_coefficient,
    slab_reflectance,
)
from fogproof.estimators import AnalogFog, PathTracer
from fogproof.reports.charts.colours import EXPECTED, FOURTH, INK, OBSERVED, PAPER, THIRD
from fogproof.scene import Medium, Ray, Rayleigh
from fogproof.scene.lights import Environment
from fogproof.scene.shapes import Ball, Slab

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_RGB = np.array([610e-9, 550e-9, 465e-9])
"""Wavelengths that stand for red, green and blue [m]."""
_PLANCK, _LIGHT, _BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23


@dataclass(frozen=True)
class Snow:
    """Reflectance of a slab over its thickness, for albedos from soot to snow."""

    rng: np.random.Generator
    samples: int = 4000

    def draw(self, figure: Figure) -> str:
        """Draw the oracle's curves, and the path tracer's means with two standard errors."""
        axes = figure.subplots()
        figure.subplots_adjust(left=0.13, right=0.78, bottom=0.17, top=0.96)
        tau, cosine = np.geomspace(0.1, 100, 60), 0.8
        ray = Ray((0, 0, 3), (0.6, 0, -0.8))
        off = 0.0
        for albedo, colour in ((1.0, OBSERVED), (0.999, THIRD), (0.9, FOURTH), (0.5, EXPECTED)):
            exact = slab_reflectance(albedo, tau, cosine).value
            axes.plot(tau, exact, color=colour)
            axes.annotate(f"albedo {albedo:g}", (tau[-1], exact[-1]), (6, -4), textcoords="offset points", color=INK)
            for depth in (0.25, 1.0, 4.0, 16.0, 64.0):
                tracer = PathTracer(
                    Medium(depth * (1 - albedo), depth * albedo), Slab((0, 0, 0), (0, 0, 1), 1.0), ray, Environment(1.0)
                )
                values = np.asarray(tracer.draw(self.rng, self.samples).value)
                # The sky shines from below as well: what comes through that way is not the slab's reflectance.
                below = slab_through(albedo, depth, cosine)
                mean, error = float(values.mean()) - below, 2 * float(values.std()) / np.sqrt(self.samples)
                axes.errorbar(depth, mean, error, fmt="o", color=colour, markersize=4)
                off = max(off, abs(mean - float(slab_reflectance(albedo, depth, cosine).value)))
        axes.set(xscale="log", xlabel="optical thickness", ylabel="reflectance", ylim=(0, 1.02))
        return (
            f"Why snow is white and soot is black: the share of light that a layer throws back after any number of "
            f"scatterings, by the oracle (curves) and by path tracing (marks, {self.samples} paths each, two standard "
            f"errors); the largest difference is {off:.2g}."
        )


def slab_through(albedo: float, tau: float, cosine: float) -> float:
    """Return what a slab lets through of a uniform sky below it, seen from above."""
    from fogproof.analytic import slab_transmittance

    return float(slab_transmittance(albedo, tau, cosine).value)


@dataclass(frozen=True)
class Fire:
    """A ball of hot soot, which glows as a black body does behind its own thickness; path-traced, with the oracle's row."""

    rng: np.random.Generator
    samples: int = 64
    pixels: int = 40

    def draw(self, figure: Figure) -> str:
        """Draw the picture, and the red light of its middle row against the oracle's."""
        places = (np.arange(self.pixels) + 0.5) / self.pixels * 2.4 - 1.2
        kelvin = 1900.0
        glow = _planck(kelvin) / _planck(kelvin).max()
        picture = np.zeros((self.pixels, self.pixels, 3))
        ball = Ball((0, 0, 0), 1.0)
        for channel in range(3):
            medium = Medium(1.5, 0.0, emission=float(glow[channel]))
            for row, y in enumerate(places):
                for column, x in enumerate(places):
                    if x * x + y * y < 1:
                        tracer = PathTracer(medium, ball, Ray((x, y, -3), (0, 0, 1)))
                        picture[row, column, channel] = np.mean(tracer.draw(self.rng, self.samples).value)
        left, right = figure.subplots(1, 2)
        figure.subplots_adjust(left=0.03, right=0.97, bottom=0.17, top=0.95, wspace=0.3)
        left.imshow(np.clip(picture, 0, 1) ** (1 / 2.2), interpolation="nearest")
        left.set(xticks=[], yticks=[])
        left.grid(False)
        chords = 2 * np.sqrt(np.maximum(1 - places**2, 0))
        rays = Ray(np.zeros((len(chords), 3)), (0, 0, 1), chords)
        for channel, colour in ((0, EXPECTED), (1, THIRD), (2, OBSERVED)):
            exact = emitted_radiance(Medium(1.5, 0.0, emission=float(glow[channel])), rays).value
            right.plot(places, picture[self.pixels // 2, :, channel], color=colour, linewidth=1)
            right.plot(places[::3], exact[::3], "o", color=colour, markersize=4)
        right.set(xlabel="across the middle [m]", ylabel="radiance, relative")
        return (
            f"Fire: a ball of soot at {kelvin:.0f} K whose optical thickness is 3 in the middle, path-traced with "
            f"{self.samples} paths a pixel and channel. Right: its middle row in red, green and blue (lines) and the "
            f"oracle's values (marks)."
        )


@dataclass(frozen=True)
class AerialView:
    """Dark ridges at growing distances: air lays its own blue over them."""

    rng: np.random.Generator
    samples: int = 20_000

    def draw(self, figure: Figure) -> str:
        """Draw a ridge for each distance, its left half by the oracle, its right half by Monte Carlo."""
        axes = figure.subplots()
        figure.subplots_adjust(left=0.02, right=0.98, bottom=0.05, top=0.97)
        # A molecule as in the sky's picture; ten times as much air as there is makes the effect fit a picture.
        beta = 10 * rayleigh_scattering_coefficient(2.6e-10, 1.5, 2.547e25, _RGB).value
        sky, rock = np.array([0.75, 0.85, 1.0]), np.array([0.06, 0.08, 0.05])
        x = np.linspace(0, 1, 400)
        off, kilometres = 0.0, (160, 80, 40, 20, 10, 5)
        axes.set_facecolor(tuple((sky**0.45).tolist()))
        for number, distance in enumerate(kilometres):
            ray = Ray((0, 0, 0), (0, 0, 1), 1e3 * distance)
            exact, drawn = np.empty(3), np.empty(3)
            for channel in range(3):
                air = Medium(0.0, float(beta[channel]), Rayleigh())
                exact[channel] = float(ambient_fog(air, ray, sky[channel], rock[channel]).value)
                fog = AnalogFog(air, ray, float(sky[channel]), float(rock[channel]))
                drawn[channel] = float(np.mean(fog.draw(self.rng, self.samples).value))
            off = max(off, float(np.abs(exact - drawn).max()))
            height = 0.86 - 0.13 * number + 0.05 * np.sin(7 * x + 2.1 * number) + 0.02 * np.sin(23 * x + 5 * number)
            for half, colour in ((x <= 0.5, exact), (x >= 0.5, drawn)):
                axes.fill_between(x[half], 0, height[half], color=tuple(np.clip(colour, 0, 1) ** 0.45), linewidth=0)
            axes.text(
                0.015, float(height[6]) - 0.075, f"{distance} km", color=PAPER if distance <= 20 else INK, fontsize=9
            )
        axes.set(xlim=(0, 1), ylim=(0, 1), xticks=[], yticks=[])
        axes.grid(False)
        return (
            f"An aerial view: ridges of dark rock behind 5 to 160 km of clear air, ten times as dense as ours. Left by "
            f"the oracle, right from {self.samples} free paths a ridge and channel; the two differ by {off:.2g} at "
            f"most."
        )


def _planck(kelvin: float) -> np.ndarray:
    """Return the radiance of a black body at red, green and blue, in any unit (Planck 1900)."""
    exponent = _PLANCK * _LIGHT / (_RGB * _BOLTZMANN * kelvin)
    spectrum: np.ndarray = _RGB**-5.0 / np.expm1(exponent)
    return spectrum
