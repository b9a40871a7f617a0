"""The mean path length through a body, which scattering does not change.

Under a uniform sky the mean length of the paths through a body that absorbs nothing is 4 V/S, the mean chord, whatever
scatters in it and how. With the scattering coefficient integrated over the volume instead of V it is the mean number of
scatterings.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import quantity
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene.kinds import given
from fogproof.scene.shapes import ShapeField

METHOD = "closed form"
SOURCE = "Cauchy 1850; Blanco & Fournier 2003, An invariance property of diffusive random walks"


@quantity(
    unit="m",
    convention="4 V/S: mean path under a uniform sky if nothing is absorbed",
    source="Blanco & Fournier 2003, An invariance property of diffusive random walks",
    example={"shape": {"kind": "ball", "center": [0, 0, 0], "radius": 2}},
)
def mean_path_length(shape: ShapeField) -> Reference:
    """Return 4 V/S of a slab, ball or box [m]: the mean path length under a uniform sky if nothing is absorbed.

    shape  what the medium fills

    Error: 4 eps, relative.
    Source: Blanco & Fournier 2003, An invariance property of diffusive random walks, Europhysics Letters 61.
    """
    mean_chord = given(shape, "fogproof.analytic.shapes", "mean_chord")
    if mean_chord is None:
        raise UnsupportedError(f"4 V/S needs a slab, a ball or a box, got {type(shape).__name__}", "shape")
    value = mean_chord(shape)
    return Reference(np.asarray(value), np.asarray(4 * EPS * value), METHOD, SOURCE)


@quantity(
    unit="1",
    convention="4 V sigma_s/S: mean number of scatterings under a uniform sky if nothing is absorbed",
    source="Blanco & Fournier 2003, An invariance property of diffusive random walks",
    example={"shape": {"kind": "box", "lower": [0, 0, 0], "upper": [1, 2, 3]}, "sigma_s": 2},
)
def mean_scatterings(shape: ShapeField, sigma_s: float) -> Reference:
    """Return the mean number of scatterings 4 V sigma_s/S of paths under a uniform sky if nothing is absorbed.

    shape    as for `mean_path_length`
    sigma_s  scattering coefficient [1/m], or its mean over the volume where it varies
    """
    length = mean_path_length(shape)
    return Reference(length.value * sigma_s, length.error * sigma_s + EPS * length.value * sigma_s, METHOD, SOURCE)
