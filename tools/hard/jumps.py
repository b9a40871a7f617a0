"""A user's function that jumps across z: along z, on any way and at grazing angles, glowing and under a lamp."""

from __future__ import annotations

import itertools

import mpmath as mp
import numpy as np

from fogproof import PointLight, analytic
from fogproof.scene import PiecewiseConstantMedium, Procedural, Ray
from hard.case import Kind, number


def jumping(heights, values):
    """Return the function that has these values (n + 1,) between those heights (n,)."""
    return lambda x: values[np.searchsorted(heights, x[..., 2], side="right")]


def apart(rng, most, length):
    """Return heights in (0, length), none closer to the next than a 500th, and the least distance, a little less."""
    while True:
        heights = np.sort(length * rng.random(rng.integers(1, most + 1)))
        least = float(np.diff(heights).min(initial=length))
        if least > length / 500:
            return heights, 0.999 * least


def steps(passed):
    """The optical thickness of layers, and what passes."""

    def draw(rng):
        length = number(rng, 1e-2, 100)
        distances, detail = apart(rng, 5, length)
        fall = float(rng.choice([1.0, number(rng, 1e-9, 1)]))
        direction = (float(np.sqrt((1 - fall) * (1 + fall))), 0.0, fall)
        origin = (0.0, 0.0, 0.0) if rng.random() < 0.5 else tuple(map(float, length * rng.normal(size=3)))
        ray, heights = Ray(origin, direction, length), origin[2] + fall * distances
        n = len(heights) + 1
        values = rng.random(n) * 10.0 ** rng.uniform(-2, 1) * rng.choice([0.0, 1.0], n, p=[0.2, 0.8])
        medium = Procedural(jumping(heights, values), float(values.max()), detail=detail)
        with mp.workdps(50):
            places = [(mp.mpf(float(z)) - mp.mpf(origin[2])) / mp.mpf(float(ray.direction[2])) for z in heights]
            cuts = [mp.mpf(0), *(min(max(t, mp.mpf(0)), mp.mpf(length)) for t in places), mp.mpf(length)]
            truth = mp.fsum(
                mp.mpf(float(v)) * (b - a) for v, (a, b) in zip(values, itertools.pairwise(cuts), strict=True)
            )
            truth = mp.exp(-truth) if passed else truth
        function = analytic.transmittance if passed else analytic.optical_thickness
        return lambda: function(medium, ray), truth, 0, f"{heights.tolist()} {values.tolist()} {ray} {detail}"

    return draw


def glowing(rng):
    """Emission that jumps with the extinction; between jumps all is homogeneous."""
    length = number(rng, 1e-2, 10)
    heights, detail = apart(rng, 4, length)
    values, glow = rng.random(len(heights) + 1), rng.random(len(heights) + 1)
    medium = Procedural(jumping(heights, values), 1.0, detail=detail, emission=jumping(heights, glow))
    with mp.workdps(50):
        truth, passed = mp.mpf(0), mp.mpf(1)
        cuts = [mp.mpf(0), *(mp.mpf(float(z)) for z in heights), mp.mpf(length)]
        for v, e, (a, b) in zip(values, glow, itertools.pairwise(cuts), strict=True):
            through = mp.exp(-mp.mpf(float(v)) * (b - a))
            truth, passed = truth + passed * (1 - through) * mp.mpf(float(e)), passed * through
    ray = Ray((0, 0, 0), (0, 0, 1), length)
    return (
        lambda: analytic.emitted_radiance(medium, ray),
        truth,
        0,
        f"{heights.tolist()} {values.tolist()} {glow.tolist()} {length}",
    )


def lit(rng):
    """A lamp over layers, against layers whose breaks are known."""
    heights, detail = apart(rng, 3, 1.0)
    values = rng.random(len(heights) + 1)
    lamp = PointLight((0.3, float(rng.uniform(0.2, 1.0)), float(rng.uniform(-0.2, 1.2))), 2.0)
    ray = Ray((0.0, 0.0, -0.1), (0.0, 0.0, 1.0), 1.2)
    box = {"lower": (-1.0, -1.0, 0.0), "upper": (1.0, 1.0, 1.0)}
    medium = Procedural(jumping(heights, values), 1.0, detail=max(detail, 0.02), albedo=0.5, **box)
    layers = PiecewiseConstantMedium((0.0, *map(float, heights), 1.0), tuple(map(float, values)), albedo=0.5)
    other = analytic.single_scattering(layers, ray, lamp)
    given = f"{heights.tolist()} {values.tolist()} {lamp}"
    return lambda: analytic.single_scattering(medium, ray, lamp), mp.mpf(float(other.value)), float(other.error), given


KINDS = {
    "optical_thickness/steps": Kind(steps(False), 0.5),
    "transmittance/steps": Kind(steps(True), 0.2),
    "emitted_radiance/steps": Kind(glowing, 0.2),
    "single_scattering/steps": Kind(lit, 0.01),
}
