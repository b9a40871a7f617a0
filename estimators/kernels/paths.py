"""Volumetric path tracing of grey light: the one-sample estimator of the volume rendering equation, path by path.

At each step a distance is drawn, in proportion to transmittance: a collision at t has the density sigma_t T(t), whatever lies
beyond the medium the probability T(z), so that T / p is 1 / sigma_t there and 1 here. Then a direction is drawn from the
phase function or off a surface. Light is gathered by looking for it at collisions and reflections (next-event estimation), by
meeting it on the way, or by both with the balance heuristic.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.estimators.kernels.compiling import inlined, kernel
from fogproof.estimators.kernels.flights import fly, shine
from fogproof.estimators.kernels.path_data import DARK, MIRROR, PARALLEL, POINT, SKY, Lamp, Plan, Region, Wall
from fogproof.estimators.kernels.regions import crossing, outward, reach, wall_normal
from fogproof.estimators.kernels.scattering import (
    diffuse,
    fresnel,
    phase_density,
    reflected,
    refracted,
    scattered,
    uniform_direction,
)

UNIFORM = 0.25 / np.pi
"""Density of the direction in which a uniform sky is looked for [1/sr]."""


@inlined
def towards(rng: np.random.Generator, lamp: Lamp, x: float, y: float, z: float) -> tuple[float, ...]:
    """Return a direction to the light, its distance, and what arrives from there in vacuum over the density [W/m^2]."""
    if lamp.kind == POINT:
        dx, dy, dz = lamp.x - x, lamp.y - y, lamp.z - z
        square = dx * dx + dy * dy + dz * dz
        scale = 1.0 / np.sqrt(square)
        return dx * scale, dy * scale, dz * scale, square * scale, lamp.strength * scale * scale
    if lamp.kind == PARALLEL:
        return -lamp.x, -lamp.y, -lamp.z, np.inf, lamp.strength
    dx, dy, dz = uniform_direction(rng)
    return dx, dy, dz, np.inf, lamp.strength / UNIFORM


@inlined
def shared(lamp: Lamp, plan: Plan, density: float) -> float:
    """Return the share of looking for the light in a direction that the path itself draws with a density [1/sr]."""
    return UNIFORM / (UNIFORM + density) if lamp.kind == SKY and plan.meet else 1.0


@kernel
def trace(
    rng: np.random.Generator,
    medium: Any,
    bound: Any,
    region: Region,
    lobe: Any,
    lamp: Lamp,
    wall: Wall,
    plan: Plan,
    origin: np.ndarray,
    direction: np.ndarray,
    value: np.ndarray,
    cost: np.ndarray,
    scatterings: np.ndarray,
    cut: np.ndarray,
) -> tuple[float, float, float]:
    """Follow one path for each row of the results.

    origin, direction  (rays, 3), away from the camera; rays is 1, or as many as there are results
    value        (n, orders) results: radiance by the number of collisions on its way, the last column with all beyond
    cost         (n,) look-ups of the medium, those of shadow rays included
    scatterings  (n,) collisions
    cut          (n,) throughput left in a path that was cut after plan.events; 0 otherwise

    Returns (sigma, limit, t) of a look-up that broke the bound, NaN if none did.
    """
    last = value.shape[1] - 1
    for i in range(len(value)):
        j = i if len(origin) > 1 else 0
        x, y, z = origin[j, 0], origin[j, 1], origin[j, 2]
        dx, dy, dz = direction[j, 0], direction[j, 1], direction[j, 2]
        throughput, met = 1.0, 1.0  # met: share of light that is met by itself
        order, lookups, events = 0, 0, 0
        on_wall, on_boundary = False, False
        enter, leave = crossing(region, x, y, z, dx, dy, dz)
        inside = enter <= 0.0 < leave
        cut[i] = 0.0
        for k in range(last + 1):
            value[i, k] = 0.0
        while True:
            # What comes next: a collision between start and stop, the boundary, the wall, or nothing any more.
            end = reach(wall, x, y, z, dx, dy, dz, on_wall)
            enter, leave = crossing(region, x, y, z, dx, dy, dz)
            if plan.eta == 1.0:
                start, stop, boundary = max(enter, 0.0), min(leave, end), np.inf
            elif inside:
                start, stop, boundary = 0.0, min(leave, end), leave
            else:
                start, stop = 0.0, 0.0
                boundary = enter if 0.0 < enter < leave and not on_boundary else np.inf
            hit, t = False, 0.0
            if stop > start:
                at = (x + start * dx, y + start * dy, z + start * dz, dx, dy, dz)
                flight = fly(rng, medium, bound, at, stop - start)
                lookups += flight.lookups
                if not np.isnan(flight.limit):
                    return flight.sigma, flight.limit, start + flight.t
                hit, t = flight.hit, start + flight.t
            column = min(order, last)

            if not hit and boundary >= end and end == np.inf:
                if lamp.kind == SKY:
                    value[i, column] += throughput * met * lamp.strength
                break
            events += 1
            if events > plan.events:
                cut[i] = throughput
                break
            nx, ny, nz = 0.0, 0.0, 0.0
            if hit:
                x, y, z = x + t * dx, y + t * dy, z + t * dz
                value[i, column] += throughput * (1.0 - plan.albedo) * plan.emission
                throughput *= plan.albedo
                if plan.ambient >= 0.0:
                    value[i, min(order + 1, last)] += throughput * plan.ambient
                    break
                if order >= plan.deepest or throughput == 0.0:
                    break
                order += 1
                on_wall, on_boundary = False, False
            elif boundary < end:
                x, y, z = x + boundary * dx, y + boundary * dy, z + boundary * dz
                nx, ny, nz = outward(region, x, y, z)
                ratio = plan.eta
                if not inside:
                    nx, ny, nz, ratio = -nx, -ny, -nz, 1.0 / ratio
                cosine = abs(dx * nx + dy * ny + dz * nz)
                mirrored, beyond = fresnel(ratio, cosine)
                if rng.random() < mirrored:
                    dx, dy, dz = reflected(dx, dy, dz, nx, ny, nz)
                else:
                    dx, dy, dz = refracted(dx, dy, dz, -nx, -ny, -nz, ratio, cosine, beyond)
                    inside = not inside
                on_wall, on_boundary = False, True
                continue
            else:
                x, y, z = x + end * dx, y + end * dy, z + end * dz
                value[i, column] += throughput * wall.radiance
                throughput *= wall.albedo
                if throughput == 0.0:
                    break
                on_wall, on_boundary = True, False
                nx, ny, nz = wall_normal(wall, x, y, z)
                if dx * nx + dy * ny + dz * nz > 0.0:
                    nx, ny, nz = -nx, -ny, -nz
                if wall.finish == MIRROR:
                    dx, dy, dz = reflected(dx, dy, dz, nx, ny, nz)
                    met = 1.0
                    continue

            # A collision, or a reflection off a diffuse wall with the normal n.
            if plan.look and lamp.kind != DARK:
                wx, wy, wz, distance, arriving = towards(rng, lamp, x, y, z)
                along_n, along_d = wx * nx + wy * ny + wz * nz, wx * dx + wy * dy + wz * dz
                density = phase_density(lobe, x, y, z, along_d) if hit else max(0.0, along_n) / np.pi
                if density > 0.0 and reach(wall, x, y, z, wx, wy, wz, on_wall) >= distance:
                    enter, leave = crossing(region, x, y, z, wx, wy, wz)
                    start, stop = max(enter, 0.0), min(leave, distance)
                    through = 1.0
                    if stop > start:
                        at = (x + start * wx, y + start * wy, z + start * wz, wx, wy, wz)
                        light = shine(rng, medium, bound, at, stop - start)
                        lookups += light.lookups
                        if not np.isnan(light.limit):
                            return light.sigma, light.limit, start
                        through = light.value
                    weight = density * shared(lamp, plan, density)
                    value[i, min(order, last)] += throughput * weight * arriving * through
            if hit:
                ox, oy, oz = dx, dy, dz
                dx, dy, dz = scattered(rng, lobe, x, y, z, dx, dy, dz)
                density = phase_density(lobe, x, y, z, dx * ox + dy * oy + dz * oz)
            else:
                dx, dy, dz = diffuse(rng, nx, ny, nz)
                density = (dx * nx + dy * ny + dz * nz) / np.pi
            met = 1.0
            if plan.look:
                met = density / (UNIFORM + density) if plan.meet else 0.0
            if order >= plan.roulette:
                survival = min(throughput, plan.survival)
                if rng.random() >= survival:
                    break
                throughput /= survival
        cost[i], scatterings[i] = lookups, order
    return np.nan, np.nan, np.nan
