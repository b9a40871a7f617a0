"""How much work is done does not grow unseen: look-ups, nodes and draws of fixed questions, which no clock has touched.

Counts follow from the seed alone. Who changes one on purpose writes the new one down here, in either direction.
"""

import numpy as np
import pytest

from fogproof.analytic import optical_thickness, single_scattering
from fogproof.checks import check_estimator, check_sampler
from fogproof.domains import HalfLine, UnitSphere
from fogproof.estimators import Directions, PathTracer, delta_tracking, ratio_tracking, regular_tracking
from fogproof.scene import HenyeyGreenstein, Medium, PointLight, Procedural, Ray, VoxelGrid
from fogproof.scene.lights import Environment
from fogproof.scene.shapes import Slab

GRID = np.arange(1.0, 513.0).reshape(8, 8, 8) / 64
RAYS = Ray(np.tile((-0.5, 0.3, 0.4), (64, 1)) + np.linspace(0, 0.3, 64)[:, None] * (0, 1, 1), (1.0, 0.0, 0.0), 2.0)


def grid(kind):
    return VoxelGrid(GRID, (0, 0, 0), (1, 1, 1), kind)


def generator():
    return np.random.default_rng(7)  # counts are of these very numbers


class Counting:
    """A function of arrays that counts how many points it was asked for."""

    def __init__(self, function):
        self.function, self.points = function, 0

    def __call__(self, x):
        self.points += len(x)
        return self.function(x)


def lookups(tracking):
    return int(np.sum(tracking(grid("trilinear"), RAYS, generator(), 8.0).cost))


def cells():
    return int(np.sum(regular_tracking(grid("nearest"), RAYS).cells))


def nodes(question):
    medium = Counting(lambda x: np.exp(-np.sum(x * x, axis=-1)))
    ray = Ray((0, 0, -1), (0, 0, 1), 2.0)
    fog = Procedural(medium, 1.0, albedo=0.5)
    question(fog, ray)
    return medium.points


def densities(g):
    hg = Directions(HenyeyGreenstein(g))
    pdf = Counting(hg.pdf)
    check_sampler(hg.sample, pdf, UnitSphere(), dimensions=2, samples=20_000, seed=1)
    return pdf.points


def drawn(rate):
    verdict = check_sampler(
        lambda u: -np.log1p(-u[:, 0]) / rate, lambda t: np.exp(-t), HalfLine(0), dimensions=1, samples=1_000_000, seed=1
    )
    assert verdict.outcome == ("rejected" if rate != 1 else "not rejected")
    return verdict.samples


def realisations(shift):
    return check_estimator(lambda rng, n: rng.random(n) + shift, 0.5, samples=1_000_000, seed=1).samples


def scatterings():
    slab = Slab((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.0)
    paths = PathTracer(Medium(0.1, 0.9), slab, Ray((0, 0, 2.0), (0, 0, -1)), Environment(1.0))
    return int(np.sum(paths.draw(generator(), 1000).cost))


COUNTS = {
    "look-ups of delta tracking": (lambda: lookups(delta_tracking), 229),
    "look-ups of ratio tracking": (lambda: lookups(ratio_tracking), 527),
    "cells of regular tracking": (cells, 512),
    "nodes of a thickness": (lambda: nodes(optical_thickness), 136),
    "nodes of single scattering": (
        lambda: nodes(lambda medium, ray: single_scattering(medium, ray, PointLight((1, 0, 0), 1.0))), 68_796,
    ),
    "densities of a verdict, g = 0.6": (lambda: densities(0.6), 463_152),
    "densities of a verdict, g = 0.99": (lambda: densities(0.99), 499_772),
    "samples of a pass": (lambda: drawn(1.0), 1_000_000),
    "samples that find a rate 10 % off": (lambda: drawn(1.1), 62_500),
    "realisations that find a bias of .1": (lambda: realisations(0.1), 65536),
    "scatterings of a thousand paths": (scatterings, 4260),
}  # fmt: skip
SLACK = 0.02
"""Share by which a count may differ on another machine, where libraries round differently."""


@pytest.mark.parametrize("what", COUNTS)
def test_the_work_is_what_it_was(what):
    count, expected = COUNTS[what]
    found = count()
    assert abs(found - expected) <= SLACK * expected, f"{what}: {found}, and {expected} before"
