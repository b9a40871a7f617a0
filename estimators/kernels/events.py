"""What happens at the events of a path, grey or in colour: looking for the light, a new direction, a boundary, a wall."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.compiling import inlined
from fogproof.estimators.kernels.path_data import (
    NOWHERE,
    PARALLEL,
    POINT,
    SKY,
    Lamp,
    PathRules,
    PathScene,
    Region,
    Wall,
)
from fogproof.estimators.kernels.regions import crossing, outward, reach, wall_normal
from fogproof.estimators.kernels.scattering import (
    Vector,
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
def only_scattering(scene: PathScene, glows: bool) -> bool:
    """Return whether a path that may not scatter again has no more light to find, once the light was looked for."""
    meets = scene.lamp.kind == SKY and scene.rules.meet
    return not (glows or meets or scene.wall.kind != NOWHERE)


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
def share_of_looking(lamp: Lamp, rules: PathRules, density: float) -> float:
    """Return the weight of looking for the light in a direction that the path itself draws with a density [1/sr].

    Only a sky can be met as well; a path has no chance to meet light from a single direction.
    """
    return UNIFORM / (UNIFORM + density) if lamp.kind == SKY and rules.meet else 1.0


@inlined
def share_of_meeting(rules: PathRules, density: float) -> float:
    """Return the weight of light that is met in a direction drawn with a density [1/sr]; the other half of the heuristic."""
    if not rules.look:
        return 1.0
    return density / (UNIFORM + density) if rules.meet else 0.0


@inlined
def next_event(
    rng: np.random.Generator,
    scene: PathScene,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    nx: float,
    ny: float,
    nz: float,
    hit: bool,
) -> tuple[float, ...]:
    """Look for the light from a collision, or from a diffuse wall with the normal n against the way d.

    Returns the direction w, where the way there enters and leaves the medium, and two factors whose product is scattering times
    arriving light over the density of w. The first is 0 if no light can come from there: then nothing has to be tracked.
    """
    wx, wy, wz, distance, arriving = towards(rng, scene.lamp, x, y, z)
    along_n, along_d = wx * nx + wy * ny + wz * nz, wx * dx + wy * dy + wz * dz
    density = phase_density(scene.lobe, x, y, z, along_d) if hit else max(0.0, along_n) / np.pi
    # From a wall nothing behind it is seen; a wall in the way, a convex one itself included, hides the light.
    if not density > 0.0 or reach(scene.wall, x, y, z, wx, wy, wz, not hit) < distance:
        return wx, wy, wz, 0.0, 0.0, 0.0, 0.0
    enter, leave = crossing(scene.region, x, y, z, wx, wy, wz)
    weight = density * share_of_looking(scene.lamp, scene.rules, density)
    return wx, wy, wz, max(enter, 0.0), min(leave, distance), weight, arriving


@inlined
def new_direction(
    rng: np.random.Generator,
    scene: PathScene,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    nx: float,
    ny: float,
    nz: float,
    hit: bool,
) -> tuple[float, float, float, float]:
    """Return the direction after a collision or a diffuse reflection, and the weight of light that is met in it.

    Directions are drawn in proportion to what scatters, so that the throughput does not change.
    """
    if hit:
        wx, wy, wz = scattered(rng, scene.lobe, x, y, z, dx, dy, dz)
        density = phase_density(scene.lobe, x, y, z, wx * dx + wy * dy + wz * dz)
    else:
        wx, wy, wz = diffuse(rng, nx, ny, nz)
        density = (wx * nx + wy * ny + wz * nz) / np.pi
    return wx, wy, wz, share_of_meeting(scene.rules, density)


@inlined
def facing_normal(wall: Wall, x: float, y: float, z: float, dx: float, dy: float, dz: float) -> Vector:
    """Return the normal of the wall on the side that the way d comes from: walls are seen from both sides."""
    nx, ny, nz = wall_normal(wall, x, y, z)
    if dx * nx + dy * ny + dz * nz > 0.0:
        return -nx, -ny, -nz
    return nx, ny, nz


@inlined
def through_boundary(
    rng: np.random.Generator,
    region: Region,
    eta: float,
    inside: bool,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
) -> tuple[float, float, float, bool]:
    """Return the way on from a refracting boundary, and whether it is inside.

    Reflected or refracted by chance, with Fresnel's reflectance as the probability: no path splits, none changes its weight.
    """
    nx, ny, nz = outward(region, x, y, z)
    ratio = eta
    if not inside:
        nx, ny, nz, ratio = -nx, -ny, -nz, 1.0 / ratio
    cosine = abs(dx * nx + dy * ny + dz * nz)
    mirrored, beyond = fresnel(ratio, cosine)
    if rng.random() < mirrored:
        dx, dy, dz = reflected(dx, dy, dz, nx, ny, nz)
        return dx, dy, dz, inside
    dx, dy, dz = refracted(dx, dy, dz, -nx, -ny, -nz, ratio, cosine, beyond)
    return dx, dy, dz, not inside
