"""Volumetric path tracing of many colours at once: the same paths as in `kernel_paths`, followed as one channel would.

Which channel decides is drawn for each path. The path's density in every channel is kept, and what it gathers counts in each
channel by its own density over the mean of all (balance heuristic: Wilkie et al. 2014, "Hero wavelength spectral sampling").
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.estimators.kernels.compiling import inlined, kernel
from fogproof.estimators.kernels.path_data import DARK, MIRROR, SKY, Lamp, Plan, Region, Wall
from fogproof.estimators.kernels.paths import UNIFORM, shared, towards
from fogproof.estimators.kernels.regions import crossing, reach, wall_normal
from fogproof.estimators.kernels.scattering import diffuse, phase_density, reflected, scattered
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
    medium: Any,
    bound: Any,
    region: Region,
    lobe: Any,
    lamp: Lamp,
    wall: Wall,
    plan: Plan,
    albedo: np.ndarray,
    emission: np.ndarray,
    colour: np.ndarray,
    origin: np.ndarray,
    direction: np.ndarray,
    value: np.ndarray,
    cost: np.ndarray,
    scatterings: np.ndarray,
    cut: np.ndarray,
) -> tuple[float, float, float]:
    """Follow one path for each row of the results; no refraction here.

    lamp, wall, plan  as in `trace`, the light of strength 1; plan's albedo, emission, eta and ambient are not used
    albedo, emission  (channels,) of the medium
    colour            (channels,) strength of the light
    value             (n, channels) results: radiance
    others as in `trace`
    """
    channels = value.shape[1]
    density, carried, through, ones = np.empty(channels), np.empty(channels), np.empty(channels), np.ones(channels)
    glow = (1.0 - albedo) * emission
    for i in range(len(value)):
        j = i if len(origin) > 1 else 0
        x, y, z = origin[j, 0], origin[j, 1], origin[j, 2]
        dx, dy, dz = direction[j, 0], direction[j, 1], direction[j, 2]
        hero = int(rng.random() * channels)
        met, order, lookups, events, on_wall = 1.0, 0, 0, 0, False
        cut[i] = 0.0
        for c in range(channels):
            value[i, c] = 0.0
            density[c] = carried[c] = 1.0
        while True:
            end = reach(wall, x, y, z, dx, dy, dz, on_wall)
            enter, leave = crossing(region, x, y, z, dx, dy, dz)
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
                    gather(value[i], density, carried, colour, ones, met)
                break
            events += 1
            if events > plan.events:
                for c in range(channels):
                    cut[i] = max(cut[i], channels * carried[c])
                break
            nx, ny, nz = 0.0, 0.0, 0.0
            if hit:
                x, y, z = x + t * dx, y + t * dy, z + t * dz
                gather(value[i], density, carried, glow, ones, 1.0)
                if order >= plan.deepest:
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
                nx, ny, nz = wall_normal(wall, x, y, z)
                if dx * nx + dy * ny + dz * nz > 0.0:
                    nx, ny, nz = -nx, -ny, -nz
                if wall.finish == MIRROR:
                    dx, dy, dz = reflected(dx, dy, dz, nx, ny, nz)
                    met = 1.0
                    continue
            if plan.look and lamp.kind != DARK:
                wx, wy, wz, distance, arriving = towards(rng, lamp, x, y, z)
                along_n, along_d = wx * nx + wy * ny + wz * nz, wx * dx + wy * dy + wz * dz
                p = phase_density(lobe, x, y, z, along_d) if hit else max(0.0, along_n) / np.pi
                if p > 0.0 and reach(wall, x, y, z, wx, wy, wz, on_wall) >= distance:
                    enter, leave = crossing(region, x, y, z, wx, wy, wz)
                    start, stop = max(enter, 0.0), min(leave, distance)
                    for c in range(channels):
                        through[c] = 1.0
                    if stop > start:
                        at = (x + start * wx, y + start * wy, z + start * wz, wx, wy, wz)
                        light = shine_in_colour(rng, medium, bound, at, stop - start, through)
                        lookups += light.lookups
                        if not np.isnan(light.limit):
                            return light.sigma, light.limit, start
                    gather(value[i], density, carried, colour, through, p * arriving * shared(lamp, plan, p))
            if hit:
                ox, oy, oz = dx, dy, dz
                dx, dy, dz = scattered(rng, lobe, x, y, z, dx, dy, dz)
                p = phase_density(lobe, x, y, z, dx * ox + dy * oy + dz * oz)
            else:
                dx, dy, dz = diffuse(rng, nx, ny, nz)
                p = (dx * nx + dy * ny + dz * nz) / np.pi
            met = 1.0
            if plan.look:
                met = p / (UNIFORM + p) if plan.meet else 0.0
            total, most = 0.0, 0.0
            for c in range(channels):
                total += density[c]
                most = max(most, density[c] * carried[c])
            most *= channels / total
            if most == 0.0:
                break
            if order >= plan.roulette:
                survival = min(most, plan.survival)
                if rng.random() >= survival:
                    break
                for c in range(channels):
                    carried[c] /= survival
        cost[i], scatterings[i] = lookups, order
    return np.nan, np.nan, np.nan
