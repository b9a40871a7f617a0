"""What the path tracer works on: plain numbers, whose `kind` says what they mean. One kernel then serves all of them.

The kernels have words of their own for these numbers, so that nobody takes them for the classes of the scene, which have names and
check themselves: a *region* is a shape that holds a medium, a *lobe* a phase function, a *lamp* a light, a *wall* a surface.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

SPACE, LAYER, BALL, BOX = range(4)


class Region(NamedTuple):
    """The convex region that the medium fills.

    SPACE  everything
    LAYER  low <= a . x <= high with a unit vector a, low = bx, high = by; a half space if low = -inf
    BALL   centre a, radius bx
    BOX    corners a and b
    """

    kind: int
    ax: float
    ay: float
    az: float
    bx: float
    by: float
    bz: float


ISOTROPIC, HENYEY_GREENSTEIN, RAYLEIGH = range(3)


class Lobe(NamedTuple):
    """A phase function; g is the mean cosine of HENYEY_GREENSTEIN."""

    kind: int
    g: float


class TableLobe(NamedTuple):
    """A phase function that is linear in n cells of the versine v = 1 - mu, with jumps between them where they serve.

    versine      (n + 1,) edges of the cells, from 0 to 2, and
    coversine    (n + 1,) 1 + mu there, with digits of its own
    cdf          (n + 1,) probability below each edge, from 0 to 1
    left, right  (n,) density at the ends of the cells [1/sr]; a cell's probability is pi times its width times their sum
    """

    versine: np.ndarray
    coversine: np.ndarray
    cdf: np.ndarray
    left: np.ndarray
    right: np.ndarray


class BlendLobe(NamedTuple):
    """Two phase functions; the share of the second is (x - start) . way, cut to [0, 1]."""

    first: Any
    second: Any
    start_x: float
    start_y: float
    start_z: float
    way_x: float
    way_y: float
    way_z: float


class MediaLobe(NamedTuple):
    """The phase functions of several media: of the first, of all the rest, and the chain of media that says what scatters where."""

    first: Any
    second: Any
    media: Any


AnyLobe = Lobe | TableLobe | BlendLobe | MediaLobe


DARK, POINT, PARALLEL, SKY = range(4)


class Lamp(NamedTuple):
    """A light.

    DARK      none
    POINT     at (x, y, z) with intensity `strength` [W/sr]
    PARALLEL  travelling along (x, y, z) with irradiance `strength` [W/m^2]
    SKY       radiance `strength` [W/(m^2 sr)] from everywhere
    """

    kind: int
    x: float
    y: float
    z: float
    strength: float


NOWHERE, PLANE, SPHERE = range(3)
LAMBERT, MIRROR = range(2)


class Wall(NamedTuple):
    """A surface.

    PLANE   a . x = size with a unit vector a
    SPHERE  centre a, radius size
    """

    kind: int
    ax: float
    ay: float
    az: float
    size: float
    finish: int
    albedo: float
    radiance: float


class PathRules(NamedTuple):
    """How paths are followed.

    albedo    sigma_s / sigma_t of the medium
    emission  L_e of the medium [W/(m^2 sr)]
    eta       refractive index of the medium, 1 if its boundary does not reflect
    look      whether a collision looks for the light (next-event estimation)
    meet      whether light that a scattered path meets by itself counts; with both, each by its share (balance heuristic)
    deepest   scattering order at which paths end
    ambient   in-scattered radiance that a collision takes as constant, < 0 if it is followed instead
    roulette  scattering order from which on paths are ended at random
    survival  greatest probability of going on
    events    collisions and reflections after which a path is cut
    """

    albedo: float
    emission: float
    eta: float
    look: bool
    meet: bool
    deepest: int
    ambient: float
    roulette: int
    survival: float
    events: int


class PathScene(NamedTuple):
    """Everything but the ray. The type of the medium chooses code (`kernels.flights`), and so does that of the lobe.

    medium  extinction, see `kernels.data`
    bound   of the extinction, None where the medium needs none
    """

    medium: Any
    bound: Any
    region: Region
    lobe: AnyLobe
    lamp: Lamp
    wall: Wall
    rules: PathRules


class PathRows(NamedTuple):
    """One path a row.

    value        (n, columns) radiance [W/(m^2 sr)] by the number of collisions on its way, the last column with all beyond; or by
                 channel
    cost         (n,) look-ups of the medium, those of shadow rays included
    scatterings  (n,) collisions
    cut          (n,) throughput left in paths that were cut; its mean times the brightest radiance there is bounds the bias
    """

    value: np.ndarray
    cost: np.ndarray
    scatterings: np.ndarray
    cut: np.ndarray


class Colours(NamedTuple):
    """What differs by channel, (channels,) each: albedo and emission of the medium, strength of the light."""

    albedo: np.ndarray
    emission: np.ndarray
    light: np.ndarray


class UniformData(NamedTuple):
    """A homogeneous medium; extinction [1/m]."""

    sigma: float


class UniformSpectralData(NamedTuple):
    """The same with channels; extinction (channels,) [1/m]."""

    sigma: np.ndarray
