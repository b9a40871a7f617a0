"""Directions inside kernels: phase functions, cosine-weighted hemispheres, reflection and refraction, one at a time.

The type of a lobe chooses at compile time how it is drawn from: by a closed form, from a table, or one of two by the place.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.extending import overload

from fogproof.estimators.kernels.compiling import KERNEL_OPTIONS, inlined
from fogproof.estimators.kernels.composites import share_of_rest
from fogproof.estimators.kernels.path_data import HENYEY_GREENSTEIN, ISOTROPIC, BlendLobe, Lobe, MediaLobe

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


def scattered(
    rng: np.random.Generator, lobe: Any, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Vector:
    """Return a direction after light along d scatters at (x, y, z), with the density of the phase function; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def phase_density(lobe: Any, x: float, y: float, z: float, mu: float) -> float:
    """Return the phase function at (x, y, z) and a forward cosine [1/sr]; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def _scattered_closed(
    rng: np.random.Generator, lobe: Any, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Vector:
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


def _density_closed(lobe: Any, x: float, y: float, z: float, mu: float) -> float:
    if lobe.kind == ISOTROPIC:
        return 0.25 / np.pi
    if lobe.kind == HENYEY_GREENSTEIN:
        k = abs(lobe.g)
        d = (1.0 - k) * (1.0 - k) + 2.0 * k * max(0.0, 1.0 - mu if lobe.g > 0.0 else 1.0 + mu)
        return (1.0 - k) * (1.0 + k) / (4.0 * np.pi * d * np.sqrt(d))
    return 3.0 / (16.0 * np.pi) * (1.0 + mu * mu)


@inlined
def cell_of(edges: np.ndarray, at: float) -> int:
    """Return the cell between increasing edges that holds a number, the first or last if none does."""
    low, high = 0, len(edges) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if edges[middle] <= at:
            low = middle
        else:
            high = middle
    return low


def _scattered_table(
    rng: np.random.Generator, lobe: Any, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Vector:
    xi = rng.random()
    i = cell_of(lobe.cdf, xi)
    left, right = lobe.left[i], lobe.right[i]
    # Of the cell's probability a share r lies before the place, s after it: the density there is root, and the place divides
    # the cell in r/(left + root) and s/(right + root), no difference of close numbers in either.
    mass = lobe.cdf[i + 1] - lobe.cdf[i]
    r = (xi - lobe.cdf[i]) / mass if mass > 0.0 else 0.5
    s = 1.0 - r
    root = np.sqrt(s * left * left + r * right * right)
    before = r * (left + right) / (left + root) if left + root > 0.0 else 0.0
    after = s * (left + right) / (right + root) if right + root > 0.0 else 0.0
    versine = lobe.versine[i] + before * (lobe.versine[i + 1] - lobe.versine[i])
    coversine = lobe.coversine[i + 1] + after * (lobe.coversine[i] - lobe.coversine[i + 1])
    cosine, sine = azimuth(rng)
    return about(dx, dy, dz, versine, coversine, cosine, sine)


def _density_table(lobe: Any, x: float, y: float, z: float, mu: float) -> float:
    versine = max(0.0, 1.0 - mu)
    i = cell_of(lobe.versine, versine)
    width = lobe.versine[i + 1] - lobe.versine[i]
    share = min((versine - lobe.versine[i]) / width, 1.0) if width > 0.0 else 1.0  # at the very back widths round to 0
    return (1.0 - share) * lobe.left[i] + share * lobe.right[i]


def share_of_second(lobe: Any, x: float, y: float, z: float) -> float:
    """Return the share of the second lobe at a place; in kernels only."""
    raise NotImplementedError("runs inside kernels only")


def _share_along(lobe: Any, x: float, y: float, z: float) -> float:
    along = (x - lobe.start_x) * lobe.way_x + (y - lobe.start_y) * lobe.way_y + (z - lobe.start_z) * lobe.way_z
    return min(max(along, 0.0), 1.0)


def _share_of_media(lobe: Any, x: float, y: float, z: float) -> float:
    return share_of_rest(lobe.media, x, y, z)


def _scattered_blend(
    rng: np.random.Generator, lobe: Any, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Vector:
    if rng.random() < share_of_second(lobe, x, y, z):
        return scattered(rng, lobe.second, x, y, z, dx, dy, dz)
    return scattered(rng, lobe.first, x, y, z, dx, dy, dz)


def _density_blend(lobe: Any, x: float, y: float, z: float, mu: float) -> float:
    share = share_of_second(lobe, x, y, z)
    first, second = phase_density(lobe.first, x, y, z, mu), phase_density(lobe.second, x, y, z, mu)
    return (1.0 - share) * first + share * second


_INLINED = {"forceinline": True, **KERNEL_OPTIONS}

BLENDS = (BlendLobe, MediaLobe)


@overload(share_of_second, jit_options=_INLINED)
def _choose_share(lobe: Any, x: float, y: float, z: float) -> Any:
    return _share_along if lobe.instance_class is BlendLobe else _share_of_media


@overload(scattered, jit_options=_INLINED)
def _choose_scattered(
    rng: np.random.Generator, lobe: Any, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Any:
    if lobe.instance_class is Lobe:
        return _scattered_closed
    return _scattered_blend if lobe.instance_class in BLENDS else _scattered_table


@overload(phase_density, jit_options=_INLINED)
def _choose_density(lobe: Any, x: float, y: float, z: float, mu: float) -> Any:
    if lobe.instance_class is Lobe:
        return _density_closed
    return _density_blend if lobe.instance_class in BLENDS else _density_table


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
