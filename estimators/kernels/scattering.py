"""Directions inside kernels: phase functions, cosine-weighted hemispheres, reflection and refraction, one at a time."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.compiling import inlined
from fogproof.estimators.kernels.path_data import HENYEY_GREENSTEIN, ISOTROPIC, Lobe

Vector = tuple[float, float, float]


@inlined
def azimuth(rng: np.random.Generator) -> tuple[float, float]:
    """Return cosine and sine of a uniform angle: twice that of a point in the unit disk (von Neumann 1951)."""
    while True:
        a, b = 2.0 * rng.random() - 1.0, 2.0 * rng.random() - 1.0
        s = a * a + b * b
        if 0.0 < s <= 1.0:
            return (a * a - b * b) / s, 2.0 * a * b / s


@inlined
def uniform_direction(rng: np.random.Generator) -> Vector:
    """Return a uniform direction (Marsaglia 1972)."""
    while True:
        a, b = 2.0 * rng.random() - 1.0, 2.0 * rng.random() - 1.0
        s = a * a + b * b
        if s < 1.0:
            root = 2.0 * np.sqrt(1.0 - s)
            return a * root, b * root, 1.0 - 2.0 * s


@inlined
def about(dx: float, dy: float, dz: float, versine: float, coversine: float, cosine: float, sine: float) -> Vector:
    """Return the direction at 1 - mu = versine, 1 + mu = coversine from d and the azimuth with that cosine and sine.

    The frame is that of Duff et al. 2017.
    """
    mu, radius = 0.5 * (coversine - versine), np.sqrt(versine * coversine)
    u, v = radius * cosine, radius * sine
    sign = np.copysign(1.0, dz)
    a = -1.0 / (sign + dz)
    b = dx * dy * a
    x = u * (1.0 + sign * dx * dx * a) + v * b + mu * dx
    y = u * sign * b + v * (sign + dy * dy * a) + mu * dy
    z = -u * sign * dx - v * dy + mu * dz
    scale = 1.5 - 0.5 * (x * x + y * y + z * z)  # one Newton step towards unit length: rounding must not add up
    return x * scale, y * scale, z * scale


@inlined
def scattered(rng: np.random.Generator, lobe: Lobe, dx: float, dy: float, dz: float) -> Vector:
    """Return a direction after scattering of light that travels along d, with the density of the phase function."""
    if lobe.kind == ISOTROPIC:
        return uniform_direction(rng)
    xi = rng.random()
    if lobe.kind == HENYEY_GREENSTEIN:
        g = lobe.g
        d = 1.0 - g + 2.0 * g * xi
        versine = 2.0 * (1.0 - g) * (1.0 - g) * (1.0 - xi) * (1.0 + g * xi) / (d * d)
        coversine = 2.0 * (1.0 + g) * (1.0 + g) * xi * (1.0 - g + g * xi) / (d * d)
    else:  # Rayleigh: the root of mu^3 + 3 mu = 8 xi - 4
        half = 4.0 * xi - 2.0
        root = (abs(half) + np.sqrt(half * half + 1.0)) ** (1.0 / 3.0)
        mu = np.copysign(root - 1.0 / root, half)
        versine, coversine = max(0.0, 1.0 - mu), max(0.0, 1.0 + mu)
    cosine, sine = azimuth(rng)
    return about(dx, dy, dz, versine, coversine, cosine, sine)


@inlined
def phase_density(lobe: Lobe, mu: float) -> float:
    """Return the phase function at a forward cosine [1/sr]."""
    if lobe.kind == ISOTROPIC:
        return 0.25 / np.pi
    if lobe.kind == HENYEY_GREENSTEIN:
        k = abs(lobe.g)
        d = (1.0 - k) * (1.0 - k) + 2.0 * k * max(0.0, 1.0 - mu if lobe.g > 0.0 else 1.0 + mu)
        return (1.0 - k) * (1.0 + k) / (4.0 * np.pi * d * np.sqrt(d))
    return 3.0 / (16.0 * np.pi) * (1.0 + mu * mu)


@inlined
def diffuse(rng: np.random.Generator, nx: float, ny: float, nz: float) -> Vector:
    """Return a direction about the normal with density cos / pi (Malley: a uniform direction added to the normal)."""
    while True:
        x, y, z = uniform_direction(rng)
        x, y, z = x + nx, y + ny, z + nz
        square = x * x + y * y + z * z
        if square > 1e-20:
            scale = 1.0 / np.sqrt(square)
            return x * scale, y * scale, z * scale


@inlined
def reflected(dx: float, dy: float, dz: float, nx: float, ny: float, nz: float) -> Vector:
    """Return the mirror image of a direction."""
    twice = 2.0 * (dx * nx + dy * ny + dz * nz)
    return dx - twice * nx, dy - twice * ny, dz - twice * nz


@inlined
def fresnel(ratio: float, cosine: float) -> tuple[float, float]:
    """Return the reflectance of unpolarised light at a smooth boundary, and the cosine beyond it.

    ratio   refractive index on this side over that beyond
    cosine  of the incident direction to the normal, > 0
    """
    beyond = 1.0 - ratio * ratio * (1.0 - cosine) * (1.0 + cosine)
    if beyond <= 0.0:
        return 1.0, 0.0
    beyond = np.sqrt(beyond)
    s = (ratio * cosine - beyond) / (ratio * cosine + beyond)
    p = (cosine - ratio * beyond) / (cosine + ratio * beyond)
    return 0.5 * (s * s + p * p), beyond


@inlined
def refracted(
    dx: float, dy: float, dz: float, nx: float, ny: float, nz: float, ratio: float, cosine: float, beyond: float
) -> Vector:
    """Return a refracted direction (Snell's law); the normal points against d."""
    turn = ratio * cosine - beyond
    x, y, z = ratio * dx + turn * nx, ratio * dy + turn * ny, ratio * dz + turn * nz
    scale = 1.5 - 0.5 * (x * x + y * y + z * z)
    return x * scale, y * scale, z * scale
