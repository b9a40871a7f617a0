"""The image of a scene: what a perfect renderer with a box filter would write."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.declaration import FOG, LAMP, RADIANCE, quantity
from fogproof.analytic.images.pixel_means import pixel_means
from fogproof.analytic.images.seen import seen
from fogproof.contracts import Reference
from fogproof.scene import ImageScene
from fogproof.scene.kinds import given

TOLERANCE = 1e-8
MOST, SPARE = 32, {"single": 1 << 16, "multiple": 1 << 14, "ambient": 1 << 19, "none": 1 << 19}
"""Evaluations that quadrature may take where an image is not smooth: so many a pixel, and some more by the cost of a ray."""


@quantity(
    unit=RADIANCE,
    convention="row 0 is the upper one, column 0 the left one; the mean over each pixel, a box filter",
    source="Chandrasekhar 1960, Radiative Transfer, section 7, averaged over pixels",
    example={
        "medium": FOG,
        "camera": {
            "kind": "perspective",
            "origin": [0, 0, 0],
            "target": [0, 0, 1],
            "fov": 0.6,
            "film": {"width": 4, "height": 3},
            "wall": 10,
        },
        "scattering": "single",
        "light": LAMP,
    },
)
def image(scene: ImageScene) -> Reference:
    """Return the mean radiance of each pixel [W/(m^2 sr)], (height, width) or (height, width, channels).

    The error of the radiance along rays is as `radiance` has it; that of the means is estimated by two rules, see
    `analytic/images/pixel_means.py`. What is smaller than a pixel and met by no centre is not seen.
    """
    camera, channels = scene.camera, scene.channels or 1
    room = "fogproof.analytic.cameras"
    rays, rows, columns = given(camera, room, "rays"), *camera.film.shape
    if given(camera, room, "same"):
        value, error = seen(scene, rays(camera, np.zeros(1), np.zeros(1)))
        value, error = (np.broadcast_to(x, (rows, columns, channels)) for x in (value, error))
    else:
        found = pixel_means(
            lambda x, y: seen(scene, rays(camera, x, y)),
            camera.film.window,
            channels,
            TOLERANCE,
            MOST * rows * columns + SPARE[scene.scattering],
        )
        value, error = found.value, found.error
    if scene.channels is None:
        value, error = value[..., 0], error[..., 0]
    return Reference(value, error, "means over pixels by central differences and Gauss-Legendre rules", "")
