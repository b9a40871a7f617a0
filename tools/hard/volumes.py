"""Media that vary: voxels, layers, puffs and a user's function, along rays that follow axes, edges and corners, from near and far.

A ray is cut in many digits where anything changes its form; in between the extinction is a polynomial, or has a primitive.
"""

from __future__ import annotations

import itertools

import mpmath as mp
import numpy as np

from fogproof import analytic
from fogproof.scene import PiecewiseConstantMedium, Procedural, Ray, VoxelGrid
from fogproof.scene.media.gaussian_puffs import GaussianPuffs
from hard.case import Kind, number


def ray_through(rng, size):
    """Return origin, direction and length: along an axis, a diagonal, or any way; from a face, a corner, inside or far away."""
    way = rng.integers(3)
    if way == 0:
        d = np.zeros(3)
        d[rng.integers(3)] = rng.choice([-1.0, 1.0])
    elif way == 1:
        d = rng.choice([-1.0, 1.0], 3) / np.sqrt(3)
    else:
        d = rng.normal(size=3)
        d /= np.linalg.norm(d)
    target = size * rng.random(3)
    where = rng.integers(4)
    if where == 0:
        origin = target
    elif where == 1:
        origin = np.where(d > 0, 0.0, size)
    else:
        origin = target - d * (number(rng, 1, 1e9) if where == 2 else 2 * np.linalg.norm(size))
    length = float(np.linalg.norm(origin - target) + number(rng, 1e-3, 10))
    return tuple(map(float, origin)), tuple(map(float, d)), length


def pieces(origin, d, length, planes):
    """Return where a ray crosses planes (per axis), with its ends, in many digits."""
    cuts = {mp.mpf(0), mp.mpf(length)}
    for x, w, at in zip(origin, d, planes, strict=True):
        if w:
            cuts |= {t for t in ((p - mp.mpf(x)) / mp.mpf(w) for p in at) if 0 < t < length}
    return itertools.pairwise(sorted(cuts))


def voxels(interpolation, passed):
    """A grid of a few voxels of any size; trilinear values are linear between their centres and constant beyond."""

    def draw(rng):
        counts, size = rng.integers(1, 5, 3), rng.uniform(0.2, 3, 3)
        values = rng.random(counts) * rng.choice([0.0, 1.0, 3.0], counts)
        origin, d, length = ray_through(rng, size)
        medium = VoxelGrid(values, (0.0, 0.0, 0.0), tuple(size), interpolation=interpolation)
        with mp.workdps(50):
            step = [mp.mpf(float(s)) / int(n) for s, n in zip(size, counts, strict=True)]
            faces = [[i * s for i in range(int(n) + 1)] for s, n in zip(step, counts, strict=True)]
            centres = [[(i + mp.mpf(1) / 2) * s for i in range(int(n))] for s, n in zip(step, counts, strict=True)]
            top = [f[-1] for f in faces]

            def sigma(t):
                x = [mp.mpf(o) + t * mp.mpf(w) for o, w in zip(origin, d, strict=True)]
                if any(not 0 <= a <= b for a, b in zip(x, top, strict=True)):
                    return mp.mpf(0)
                if interpolation == "nearest":
                    cell = tuple(min(int(a / s), int(n) - 1) for a, s, n in zip(x, step, counts, strict=True))
                    return mp.mpf(float(values[cell]))
                places = [
                    min(max(a / s - mp.mpf(1) / 2, 0), int(n) - 1) for a, s, n in zip(x, step, counts, strict=True)
                ]
                low = [min(int(p), max(int(n) - 2, 0)) for p, n in zip(places, counts, strict=True)]
                total = mp.mpf(0)
                for corner in itertools.product((0, 1), repeat=3):
                    share = mp.mpf(1)
                    for c, p, i in zip(corner, places, low, strict=True):
                        share *= (p - i) if c else 1 - (p - i)
                    if share:
                        total += share * mp.mpf(float(values[tuple(i + c for i, c in zip(low, corner, strict=True))]))
                return total

            truth = mp.mpf(0)
            planes = [f + c for f, c in zip(faces, centres, strict=True)]
            for a, b in pieces(origin, d, length, planes):
                half, middle = (b - a) / 2, (a + b) / 2
                node = half / mp.sqrt(3)  # two Gauss nodes: exact for the cubic between centres
                truth += half * (sigma(middle - node) + sigma(middle + node))
            if passed:
                truth = mp.exp(-truth)
        function = analytic.transmittance if passed else analytic.optical_thickness
        # Where a ray runs within a face, either side will do: such rays start on a corner and follow an axis.
        within = sum(w == 0 for w in d) == 2 and any(
            w == 0 and o in (0.0, s) for o, w, s in zip(origin, d, size, strict=True)
        )
        doubt = mp.mpf(1e300) if within else mp.mpf(10) ** -40
        if way_along_corners(origin, d, size, counts):
            doubt = mp.mpf(1e300)
        ray = Ray(origin, d, length)
        return lambda: function(medium, ray), truth, doubt, f"{values.tolist()} {size.tolist()} {origin} {d} {length}"

    return draw


def way_along_corners(origin, d, size, counts):
    """Return whether a diagonal of a grid of equal voxels is followed, where rounding decides which side of an edge it is on."""
    return bool(np.ptp(np.abs(d)) == 0 and np.ptp(size / counts) < 1e-12)


def layered(rng):
    n = int(rng.integers(1, 6))
    bounds = np.cumsum(rng.random(n + 1) * 10.0 ** rng.integers(-6, 3, n + 1)) - float(rng.uniform(0, 5))
    sigma = rng.random(n) * 10.0 ** rng.integers(-3, 3, n)
    origin, d, length = ray_through(rng, np.full(3, 3.0))
    medium = PiecewiseConstantMedium(tuple(bounds), tuple(sigma))
    with mp.workdps(60):
        truth, z, w = mp.mpf(0), mp.mpf(origin[2]), mp.mpf(d[2])
        for low, high, s in zip(bounds[:-1], bounds[1:], sigma, strict=True):
            if d[2] == 0:
                truth += mp.mpf(float(s)) * length * bool(low <= origin[2] < high)
                continue
            a, b = sorted((mp.mpf(float(x)) - z) / w for x in (low, high))
            truth += mp.mpf(float(s)) * max(min(b, mp.mpf(length)) - max(a, mp.mpf(0)), mp.mpf(0))
    ray = Ray(origin, d, length)
    return (
        lambda: analytic.optical_thickness(medium, ray),
        truth,
        0,
        f"{bounds.tolist()} {sigma.tolist()} {origin} {d} {length}",
    )


def between(a, b):
    """erf(b) - erf(a) for a <= b, also where both are 1 to all digits."""
    if a > 0:
        return mp.erfc(a) - mp.erfc(b)
    return mp.erfc(-b) - mp.erfc(-a) if b < 0 else mp.erf(b) - mp.erf(a)


def puffs(rng):
    n = int(rng.integers(1, 4))
    centres, widths, heights = rng.uniform(-2, 2, (n, 3)), 10.0 ** rng.uniform(-4, 1, n), 10.0 ** rng.uniform(-3, 3, n)
    origin, d, length = ray_through(rng, np.full(3, 2.0))
    if rng.random() < 0.5:  # right through one of them
        start = centres[0] - np.asarray(d) * length / 2
        origin = tuple(map(float, start))
    with mp.workdps(60):
        truth, w = mp.mpf(0), [mp.mpf(x) for x in d]
        square = sum(x * x for x in w)
        for centre, width, height in zip(centres, widths, heights, strict=True):
            away = [mp.mpf(o) - mp.mpf(float(c)) for o, c in zip(origin, centre, strict=True)]
            foot = sum(a * x for a, x in zip(away, w, strict=True)) / square
            apart = sum(a * a for a in away) - foot * foot * square
            scale = mp.sqrt(square / 2) / mp.mpf(float(width))
            ends = between(scale * foot, scale * (length + foot))
            truth += (
                mp.mpf(float(height))
                * mp.exp(-apart / (2 * mp.mpf(float(width)) ** 2))
                * mp.sqrt(mp.pi)
                / (2 * scale)
                * ends
            )
    medium, ray = GaussianPuffs(centres, widths, heights), Ray(origin, d, length)
    given = f"{centres.tolist()} {widths.tolist()} {heights.tolist()} {origin} {d} {length}"
    return lambda: analytic.optical_thickness(medium, ray), truth, 0, given


def waves(rng):
    """A user's function: sigma (1 + sin(k z)), as smooth as the detail it declares says."""
    sigma, k, length = number(rng, 1e-3, 10), number(rng, 0.1, 30), number(rng, 1e-2, 10)
    with mp.workdps(40):
        s, kk, t = mp.mpf(sigma), mp.mpf(k), mp.mpf(length)
        truth = s * (t + (1 - mp.cos(kk * t)) / kk)
    doubt = 2e-15 * sigma * (1 + k * length) * length  # the function itself is in double precision
    medium = Procedural(lambda x: sigma * (1 + np.sin(k * x[..., 2])), majorant=2 * sigma, detail=min(1 / k, length))
    ray = Ray((0, 0, 0), (0, 0, 1), length)
    return lambda: analytic.optical_thickness(medium, ray), truth, doubt, f"{sigma} {k} {length}"


KINDS = {
    "optical_thickness/nearest": Kind(voxels("nearest", False), 3),
    "optical_thickness/trilinear": Kind(voxels("trilinear", False), 2),
    "transmittance/nearest": Kind(voxels("nearest", True), 2),
    "transmittance/trilinear": Kind(voxels("trilinear", True), 2),
    "optical_thickness/layers": Kind(layered, 5),
    "optical_thickness/puffs": Kind(puffs, 3),
    "optical_thickness/procedural": Kind(waves, 1),
}
