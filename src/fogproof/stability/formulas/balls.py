"""Where rays meet balls: from afar, grazing."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.shapes import ball as oracle_ball
from fogproof.estimators.lights import sphere as sphere_light
from fogproof.estimators.shapes import ball
from fogproof.scene import Ball
from fogproof.scene.lights import SphereLight
from fogproof.stability.axes import decades, to_one
from fogproof.stability.exact import flint
from fogproof.stability.formula import Formula, HardRegion, Naive

AFAR = decades(2.0, 1e8)


def unit_ball():
    return Ball((0.0, 0.0, 0.0), 1.0)


def aligned(far, beside):
    """A ray along +z that passes the centre at the distance `beside`."""
    zero, one = np.zeros_like(far), np.ones_like(far)
    return {"ox": beside, "oy": zero, "oz": -far, "dx": zero, "dy": zero, "dz": one}


def slanting(far, beside):
    """The same along a direction that is a unit vector but for rounding."""
    dx, dy, dz = (np.full_like(far, v) for v in (0.48, 0.6, 0.64))
    return {
        "ox": 0.8 * beside - far * dx,
        "oy": -far * dy,
        "oz": -0.6 * beside - far * dz,
        "dx": dx,
        "dy": dy,
        "dz": dz,
    }


def true_entrance(ox, oy, oz, dx, dy, dz):
    """The smaller root of |o + t d|^2 = 1."""
    a, b = dx * dx + dy * dy + dz * dz, ox * dx + oy * dy + oz * dz
    square = b * b - a * (ox * ox + oy * oy + oz * oz - 1)
    return (-b - square.sqrt()) / a if square > 0 else flint().arb.pos_inf()


def lines(ox, oy, oz, dx, dy, dz):
    return np.stack([ox, oy, oz]), np.stack([dx, dy, dz])


def quadratic(ox, oy, oz, dx, dy, dz):
    a, b = dx * dx + dy * dy + dz * dz, 2 * (ox * dx + oy * dy + oz * dz)
    square = b * b - 4 * a * (ox * ox + oy * oy + oz * oz - 1)
    return np.where(square > 0, (-b - np.sqrt(square)) / (2 * a), np.inf)


def met(**line):
    light = SphereLight((0.0, 0.0, 0.0), 1.0, 1.0)
    origin, direction = lines(**line)
    return np.array([sphere_light.met(light, origin[:, i], direction[:, i]) for i in range(origin.shape[1])])


def oracle_enters(**line):
    origin, direction = lines(**line)
    return oracle_ball.through(unit_ball(), origin.T, direction.T, 0.0)[0]


PASSING = (
    HardRegion("from afar, grazing", {"far": AFAR, "beside": to_one(1e-12, 1e-9)}, derived=aligned),
    HardRegion("from afar, slanting", {"far": AFAR, "beside": to_one(1e-6, 1e-9)}, derived=slanting),
)
FORMULAS = [
    Formula(
        "geometry/ball_enter",
        "Distance at which a ray enters a ball",
        "estimators.LitMedium",
        lambda **line: ball.through(unit_ball(), *lines(**line))[0],
        true_entrance,
        PASSING,
        bound=3.0,
        naive=(Naive("(-b - sqrt(b^2 - 4 a c))/(2 a)", "textbooks and most renderers", quadratic),),
    ),
    Formula(
        "geometry/ball_enter_oracle",
        "Distance at which the oracle lets a ray enter a ball",
        "analytic.radiance",
        oracle_enters,
        true_entrance,
        PASSING,
        bound=2.0,
    ),
    Formula(
        "geometry/sphere_light",
        "Distance at which a ray meets a shining sphere",
        "estimators.LitMedium",
        met,
        true_entrance,
        PASSING,
        bound=3.0,
    ),
]
