"""A light without extent as rays meet it: one direction for every point, all from a point or all parallel."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.asinh import Gain
from fogproof.analytic.airlight.ray_and_light import Placement


class Beam(NamedTuple):
    """A light at a point, or parallel light, and how the intensity of the former varies with direction.

    where    the n rays in the coordinates of a light at a point; None for parallel light
    travel   (3,) direction in which parallel light travels
    edges    (n, m) places along the rays, from the foot of the perpendicular, at which the intensity is not smooth
    weight   (ray (p,), place (p,)) -> 1 where the light shines, 0 where not, 1/2 where that is unsure; None: it shines everywhere
    profile  (ray (p,), places (p, nodes)) -> intensity relative to its largest where it shines, and its error; None: constant
    gain     (ray (p,)) -> the same for the airlight integral, and its error (n,), one a ray; None: there is no such form
    """

    where: Placement | None = None
    travel: np.ndarray | None = None
    edges: np.ndarray | None = None
    weight: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None
    profile: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]] | None = None
    gain: Callable[[np.ndarray], tuple[Gain, np.ndarray]] | None = None
