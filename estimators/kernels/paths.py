"""Volumetric path tracing of grey light: the one-sample estimator of the volume rendering equation, path by path.

At each step a distance is drawn, in proportion to transmittance: a collision at t has the density sigma_t T(t), whatever lies
beyond the medium the probability T(z), so that T / p is 1 / sigma_t there and 1 here. Then a direction is drawn from the
phase function or off a surface. Light is gathered by looking for it at collisions and reflections (next-event estimation), by
meeting it on the way, or by both with the balance heuristic.
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.compiling import inlined, kernel
from fogproof.estimators.kernels.composites import at_collision
from fogproof.estimators.kernels.events import (
    facing_normal,
    new_direction,
    next_event,
    only_scattering,
    through_boundary,
)
from fogproof.estimators.kernels.flights import fly, shine
from fogproof.estimators.kernels.path_data import DARK, MIRROR, SKY, PathRows, PathScene
from fogproof.estimators.kernels.regions import crossing, reach
from fogproof.estimators.kernels.scattering import reflected


@inlined
def ahead(eta: float, enter: float, leave: float, end: float, inside: bool, on_boundary: bool) -> tuple[float, ...]:
    """Return where the medium starts and stops before the wall, and where a refracting boundary is met, inf if not.

    Behind such a boundary `inside` is what the path knows, not what rounding makes of a point on it.
    """
    if eta == 1.0:
        return max(enter, 0.0), min(leave, end), np.inf
    if inside:
        return 0.0, min(leave, end), leave
    return 0.0, 0.0, enter if 0.0 < enter < leave and not on_boundary else np.inf


@kernel
def trace(
    rng: np.random.Generator, scene: PathScene, origin: np.ndarray, direction: np.ndarray, rows: PathRows
) -> tuple[float, float, float]:
    """Follow one path for each row.

    origin, direction  (rays, 3), away from the camera; rays is 1, or as many as there are rows

    Returns (sigma, limit, t) of a look-up that broke the bound, NaN if none did.
    """
    medium, bound, lamp, wall, rules = scene.medium, scene.bound, scene.lamp, scene.wall, scene.rules
    value = rows.value
    last = value.shape[1] - 1
    nothing_beyond = only_scattering(scene, rules.emission > 0.0 or rules.albedo == 0.0)  # 0: it is looked up
    for i in range(len(value)):
        j = i if len(origin) > 1 else 0
        x, y, z = origin[j, 0], origin[j, 1], origin[j, 2]
        dx, dy, dz = direction[j, 0], direction[j, 1], direction[j, 2]
        throughput, met = 1.0, 1.0  # met: weight of light that is met; the camera looks for none
        order, lookups, events = 0, 0, 0
        on_wall, on_boundary = False, False
        enter, leave = crossing(scene.region, x, y, z, dx, dy, dz)
        inside = enter <= 0.0 < leave
        rows.cut[i] = 0.0
        for k in range(last + 1):
            value[i, k] = 0.0
        while True:
            # What comes next: a collision between start and stop, the boundary, the wall, or nothing any more.
            end = reach(wall, x, y, z, dx, dy, dz, on_wall)
            enter, leave = crossing(scene.region, x, y, z, dx, dy, dz)
            start, stop, boundary = ahead(rules.eta, enter, leave, end, inside, on_boundary)
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
            if events > rules.events:
                rows.cut[i] = throughput
                break
            nx, ny, nz = 0.0, 0.0, 0.0
            if hit:
                # The share 1 - albedo of the collisions absorbs, and there sigma_a L_e is emitted: no event has to be drawn for it.
                x, y, z = x + t * dx, y + t * dy, z + t * dz
                albedo, glow = at_collision(medium, 0, rules.albedo, rules.emission, x, y, z)
                value[i, column] += throughput * glow
                throughput *= albedo
                if rules.ambient >= 0.0:
                    value[i, min(order + 1, last)] += throughput * rules.ambient
                    break
                if order >= rules.deepest or throughput == 0.0:
                    break
                order += 1
                on_wall, on_boundary = False, False
            elif boundary < end:
                x, y, z = x + boundary * dx, y + boundary * dy, z + boundary * dz
                dx, dy, dz, inside = through_boundary(rng, scene.region, rules.eta, inside, x, y, z, dx, dy, dz)
                on_wall, on_boundary = False, True  # the same boundary is not met again where the way starts
                continue
            else:
                x, y, z = x + end * dx, y + end * dy, z + end * dz
                value[i, column] += throughput * wall.radiance
                throughput *= wall.albedo
                if throughput == 0.0:
                    break
                on_wall, on_boundary = True, False
                nx, ny, nz = facing_normal(wall, x, y, z, dx, dy, dz)
                if wall.finish == MIRROR:
                    dx, dy, dz = reflected(dx, dy, dz, nx, ny, nz)
                    met = 1.0  # nobody looked for the light from a mirror, so what it shows counts in full
                    continue

            # A collision, or a reflection off a diffuse wall with the normal n.
            if rules.look and lamp.kind != DARK:
                wx, wy, wz, start, stop, weight, arriving = next_event(rng, scene, x, y, z, dx, dy, dz, nx, ny, nz, hit)
                if weight > 0.0:
                    through = 1.0
                    if stop > start:
                        at = (x + start * wx, y + start * wy, z + start * wz, wx, wy, wz)
                        light = shine(rng, medium, bound, at, stop - start)
                        lookups += light.lookups
                        if not np.isnan(light.limit):
                            return light.sigma, light.limit, start
                        through = light.value
                    value[i, min(order, last)] += throughput * weight * arriving * through
            if order >= rules.deepest and nothing_beyond:
                break
            dx, dy, dz, met = new_direction(rng, scene, x, y, z, dx, dy, dz, nx, ny, nz, hit)
            if order >= rules.roulette:
                # A path goes on with its throughput as the probability: survivors weigh 1 then, never more.
                survival = min(throughput, rules.survival)
                if rng.random() >= survival:
                    break
                throughput /= survival
        rows.cost[i], rows.scatterings[i] = lookups, order
    return np.nan, np.nan, np.nan
