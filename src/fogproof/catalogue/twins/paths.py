"""Path tracing written out plainly for planted errors: each argument is a place where something can go wrong, and has.

All paths take a step at a time. With every argument as it should be this is a second path tracer, which shares no code with
the compiled one; a test holds it to the same references.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.estimators.airlight.shapes import through
from fogproof.estimators.phase.functions import phase_value, polar
from fogproof.scene import Medium, PhaseFunction, Ray
from fogproof.scene.lights import Environment, PointLight
from fogproof.scene.shapes import Shape

UNIFORM = 0.25 / np.pi


@dataclass(frozen=True, eq=False)
class LiteralPaths:
    """Radiance along one ray through a homogeneous medium, (n,) or (n, channels).

    medium, shape, ray, light  as in `PathTracer`; the light a point or a uniform sky, grey
    horizon     the sky shines from directions with a positive component along this vector; None: from everywhere
    looked_for  whether collisions look for the light
    met         whether light that scattered paths meet counts; with both, each by its share
    deepest     greatest scattering order
    roulette    scattering order from which on paths survive with the probability of their throughput, at most 0.9

    compensated   survivors of the roulette weigh more
    share_light   light that is looked for and met counts by shares, not twice
    one_more      paths end one scattering too late
    glow_again    a collision counts the emission of the medium on its way in and on its way out
    drawn         phase function whose directions are drawn in place of the medium's
    all_the_way   shadow rays are attenuated from the collision to the light, wherever the medium ends
    first_channel the density of a path is taken to be that of the first channel, whichever channel has decided
    spare         share of paths started beyond n; those are kept that finish first
    """

    medium: Medium
    shape: Shape
    ray: Ray
    light: Environment | PointLight | None = None
    horizon: tuple[float, float, float] | None = None
    looked_for: bool = False
    met: bool = True
    deepest: int = 10_000
    roulette: int = 10_000
    compensated: bool = True
    share_light: bool = True
    one_more: bool = False
    glow_again: bool = False
    drawn: PhaseFunction | None = None
    all_the_way: bool = False
    first_channel: bool = False
    spare: float = 0.0

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations."""
        started = n + int(self.spare * n)
        value, scatterings = self._follow(rng, started)
        if started > n:
            first = np.argsort(scatterings, kind="stable")[:n]
            value, scatterings = value[first], scatterings[first]
        return Draws(value[:, 0] if self.medium.channels is None else value, scatterings.astype(float))

    def _follow(self, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
        sigma, albedo = np.atleast_1d(self.medium.sigma_t), np.atleast_1d(self.medium.albedo)
        emission = np.atleast_1d(self.medium.emission)
        phase, channels = self.medium.phase, len(sigma)
        assert isinstance(phase, PhaseFunction)
        x, w = np.tile(self.ray.origin, (n, 1)), np.tile(self.ray.direction, (n, 1))
        value, scatterings = np.zeros((n, channels)), np.zeros(n, int)
        alive: np.ndarray = np.arange(n)
        hero: np.ndarray = rng.integers(channels, size=n)
        density = np.ones((n, channels))
        carried, meets = np.ones((n, channels)), np.ones(n)
        while len(alive):
            enter, leave = through(self.shape, x.T, w.T)
            start, stop = np.maximum(enter, 0.0), leave
            inside = stop > start
            t = start + rng.standard_exponential(len(alive)) / sigma[hero]
            hit = inside & (t < stop)
            with np.errstate(invalid="ignore"):
                flown = np.where(inside, np.minimum(t, stop) - start, 0.0)
            density *= np.exp(-(sigma - sigma[hero, None]) * flown[:, None])
            density *= np.where(hit[:, None], sigma / sigma[hero, None], 1.0)
            density /= density.max(axis=1, keepdims=True)

            gone = ~hit
            if isinstance(self.light, Environment):
                sky = self._sky(w[gone]) * meets[gone]
                value[alive[gone]] += (self._weight(density) * carried)[gone] * sky[:, None]
            x, w, alive, hero, density, carried = (
                part[hit] for part in (x + t[:, None] * w, w, alive, hero, density, carried)
            )
            value[alive] += self._weight(density) * carried * (1 - albedo) * emission * (2 if self.glow_again else 1)
            carried = carried * albedo
            scatterings[alive] += 1
            going = scatterings[alive] <= self.deepest + (1 if self.one_more else 0)
            scatterings[alive[~going]] -= 1
            x, w, alive, hero, density, carried = (part[going] for part in (x, w, alive, hero, density, carried))
            if self.looked_for and self.light is not None:
                value[alive] += self._weight(density) * carried * self._arriving(rng, phase, x, w)
            turned = _turn(rng, self.drawn or phase, w)
            drawn = phase_value(phase, np.clip(np.sum(w * turned, axis=1), -1, 1))
            meets = self._share_of_meeting(drawn)
            w = turned
            late = scatterings[alive] >= self.roulette
            survival = np.where(late, np.minimum((self._weight(density) * carried).max(axis=1), 0.9), 1.0)
            stays = rng.random(len(alive)) < survival
            if self.compensated:
                carried = carried / survival[:, None]
            x, w, alive, hero, density, carried, meets = (
                part[stays] for part in (x, w, alive, hero, density, carried, meets)
            )
        return value, scatterings

    def _weight(self, density: np.ndarray) -> np.ndarray:
        """Return the density of a path in each channel over that with which it was drawn, (k, channels)."""
        if self.first_channel:
            return density / density[:, :1]
        return density / density.mean(axis=1, keepdims=True)

    def _sky(self, w: np.ndarray) -> np.ndarray:
        assert isinstance(self.light, Environment)
        radiance = float(np.asarray(self.light.radiance))
        return np.full(len(w), radiance) if self.horizon is None else radiance * (w @ np.array(self.horizon) > 0)

    def _share_of_meeting(self, density: np.ndarray) -> np.ndarray:
        if not self.looked_for:
            return np.ones_like(density)
        if not self.met:
            return np.zeros_like(density)
        return density / (UNIFORM + density) if self.share_light else np.ones_like(density)

    def _arriving(self, rng: np.random.Generator, phase: PhaseFunction, x: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Return what looking for the light adds at points x (k, 3) to light that goes on along -w, (k, channels)."""
        if isinstance(self.light, PointLight):
            to_light = np.array(self.light.position) - x
            distance = np.linalg.norm(to_light, axis=1)
            u = to_light / distance[:, None]
            arriving = float(np.asarray(self.light.intensity)) / distance**2
        else:
            u = rng.standard_normal(x.shape)
            u /= np.linalg.norm(u, axis=1, keepdims=True)
            distance, arriving = np.full(len(x), np.inf), self._sky(u) / UNIFORM
        density = phase_value(phase, np.clip(np.sum(w * u, axis=1), -1, 1))
        _, leave = through(self.shape, x.T, u.T)
        way = distance if self.all_the_way else np.clip(leave, 0.0, distance)
        share = UNIFORM / (UNIFORM + density) if self.met and self.share_light else np.ones_like(density)
        transmittance = np.exp(-np.atleast_1d(self.medium.sigma_t) * way[:, None])
        return (density * arriving * share)[:, None] * transmittance


def _turn(rng: np.random.Generator, phase: PhaseFunction, w: np.ndarray) -> np.ndarray:
    """Return directions (k, 3) scattered from w by a phase function."""
    at = polar(phase, rng.random(len(w)))
    mu, sine = 0.5 * (at.coversine - at.versine), np.sqrt(at.versine * at.coversine)
    # A tangent from any vector that is not along w, and its companion.
    other = np.where(np.abs(w[:, :1]) < 0.6, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    t = np.cross(w, other)
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    phi = 2 * np.pi * rng.random(len(w))
    turned = mu[:, None] * w + sine[:, None] * (np.cos(phi)[:, None] * t + np.sin(phi)[:, None] * np.cross(w, t))
    return turned / np.linalg.norm(turned, axis=1, keepdims=True)
