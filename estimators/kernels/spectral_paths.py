"""Volumetric path tracing of many colours at once: the same paths as in `kernels.paths`, followed as one channel would.

Which channel decides is drawn for each path. The path's density in every channel is kept, and what it gathers counts in each
channel by its own density over the mean of all (balance heuristic: Wilkie et al. 2014, "Hero wavelength spectral sampling").
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.compiling import inlined, kernel
from fogproof.estimators.kernels.composites import at_collision
from fogproof.estimators.kernels.events import facing_normal, new_direction, next_event, only_scattering
from fogproof.estimators.kernels.path_data import DARK, MIRROR, SKY, Colours, PathRows, PathScene
from fogproof.estimators.kernels.regions import crossing, reach
from fogproof.estimators.kernels.scattering import reflected
from fogproof.estimators.kernels.spectral_flights import fly_in_colour, shine_in_colour


@inlined
def gather(
    value: np.ndarray,
    density: np.ndarray,
    carried: np.ndarray,
    colour: np.ndarray,
    through: np.ndarray,
    weight: float,
) -> None:
    """Add light of a colour, seen through a transmittance, to every channel by its share of the path."""
    total = 0.0
    for c in range(len(value)):
        total += density[c]
    for c in range(len(value)):
        value[c] += len(value) * density[c] / total * carried[c] * colour[c] * through[c] * weight


@kernel
def trace_in_colour(
    rng: np.random.Generator,
    scene: PathScene,
    colours: Colours,
    origin: np.ndarray,
    direction: np.ndarray,
    rows: PathRows,
) -> tuple[float, float, float]:
    """Follow one path for each row; no refraction here.

    scene  as in `trace`, the light of strength 1; the albedo, emission, eta and ambient of its rules are not used

    The others are as in `trace`; the columns of the rows are channels.
    """
    medium, bound, lamp, wall, rules = scene.medium, scene.bound, scene.lamp, scene.wall, scene.rules
    value = rows.value
    channels = value.shape[1]
    density, carried, through, ones = np.empty(channels), np.empty(channels), np.empty(channels), np.ones(channels)
    albedo, glow = np.empty(channels), np.empty(channels)
    known = np.any(colours.albedo > 0.0)  # 0: albedo and emission are looked up
    nothing_beyond = only_scattering(scene, np.any(colours.emission > 0.0) or not known)
    for i in range(len(value)):
        j = i if len(origin) > 1 else 0
        x, y, z = origin[j, 0], origin[j, 1], origin[j, 2]
        dx, dy, dz = direction[j, 0], direction[j, 1], direction[j, 2]
        hero = int(rng.random() * channels)  # the channel that decides; any of them may, with equal probability
        met, order, lookups, events, on_wall = 1.0, 0, 0, 0, False
        rows.cut[i] = 0.0
        for c in range(channels):
            value[i, c] = 0.0
            density[c] = carried[c] = 1.0
        while True:
            end = reach(wall, x, y, z, dx, dy, dz, on_wall)
            enter, leave = crossing(scene.region, x, y, z, dx, dy, dz)
            start, stop = max(enter, 0.0), min(leave, end)
            hit, t = False, 0.0
            if stop > start:
                at = (x + start * dx, y + start * dy, z + start * dz, dx, dy, dz)
                flight = fly_in_colour(rng, medium, bound, hero, at, stop - start, density)
                lookups += flight.lookups
                if not np.isnan(flight.limit):
                    return flight.sigma, flight.limit, start + flight.t
                hit, t = flight.hit, start + flight.t
            if not hit and end == np.inf:
                if lamp.kind == SKY:
                    gather(value[i], density, carried, colours.light, ones, met)
                break
            events += 1
            if events > rules.events:
                for c in range(channels):
                    rows.cut[i] = max(rows.cut[i], channels * carried[c])
                break
            nx, ny, nz = 0.0, 0.0, 0.0
            if hit:
                x, y, z = x + t * dx, y + t * dy, z + t * dz
                for c in range(channels):
                    albedo[c], glow[c] = at_collision(medium, c, colours.albedo[c], colours.emission[c], x, y, z)
                gather(value[i], density, carried, glow, ones, 1.0)
                if order >= rules.deepest:
                    break
                order += 1
                on_wall = False
                for c in range(channels):
                    carried[c] *= albedo[c]
            else:
                x, y, z = x + end * dx, y + end * dy, z + end * dz
                gather(value[i], density, carried, ones, ones, wall.radiance)
                if wall.albedo == 0.0:
                    break
                on_wall = True
                for c in range(channels):
                    carried[c] *= wall.albedo
                nx, ny, nz = facing_normal(wall, x, y, z, dx, dy, dz)
                if wall.finish == MIRROR:
                    dx, dy, dz = reflected(dx, dy, dz, nx, ny, nz)
                    met = 1.0
                    continue
            if rules.look and lamp.kind != DARK:
                wx, wy, wz, start, stop, weight, arriving = next_event(rng, scene, x, y, z, dx, dy, dz, nx, ny, nz, hit)
                if weight > 0.0:
                    for c in range(channels):
                        through[c] = 1.0
                    if stop > start:
                        at = (x + start * wx, y + start * wy, z + start * wz, wx, wy, wz)
                        light = shine_in_colour(rng, medium, bound, at, stop - start, through)
                        lookups += light.lookups
                        if not np.isnan(light.limit):
                            return light.sigma, light.limit, start
                    gather(value[i], density, carried, colours.light, through, weight * arriving)
            if order >= rules.deepest and nothing_beyond:
                break
            dx, dy, dz, met = new_direction(rng, scene, x, y, z, dx, dy, dz, nx, ny, nz, hit)
            # What the brightest channel would still weigh decides about roulette: no other weighs more.
            total, most = 0.0, 0.0
            for c in range(channels):
                total += density[c]
                most = max(most, density[c] * carried[c])
            most *= channels / total
            if most == 0.0:
                break
            if order >= rules.roulette:
                survival = min(most, rules.survival)
                if rng.random() >= survival:
                    break
                for c in range(channels):
                    carried[c] /= survival
        rows.cost[i], rows.scatterings[i] = lookups, order
    return np.nan, np.nan, np.nan
