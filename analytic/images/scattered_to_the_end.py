"""Multiple scattering in images: what is known to the last order, by the shape's module or by the furnace.

    sky(shape, medium, ray)           a uniform sky of radiance 1 all around   -> how much of it is seen, (n,) per channel
    parallel(shape, medium, ray, ..)  light from infinitely far

What emits L_e in cold surroundings shows L_e times what is missing from a sky of radiance 1 (Kirchhoff).
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.media.coefficients import is_uniform
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import ImageScene, Ray
from fogproof.scene.kinds import given
from fogproof.scene.lights import strength
from fogproof.scene.one_channel import one_channel

ROOM = "fogproof.analytic.images.shapes"
LIGHTS = "fogproof.analytic.lights"


def scattered_to_the_end(scene: ImageScene, ray: Ray) -> tuple[np.ndarray, np.ndarray]:
    """Return radiance and error (n,) or (n, channels) of rays of shape (n,), all orders of scattering."""
    if scene.channels is None:
        return _grey(scene, ray)
    parts = [_grey(one_channel(scene, i), ray) for i in range(scene.channels)]
    value, error = (np.stack(columns, axis=-1) for columns in zip(*parts, strict=True))
    return value, error


def _grey(scene: ImageScene, ray: Ray) -> tuple[np.ndarray, np.ndarray]:
    medium, light = scene.medium, scene.light
    assert light is not None  # an ImageScene sees to it
    power = float(np.asarray(strength(light)))
    if given(light, LIGHTS, "same_all_around") and scene.background == power and np.isinf(ray.length).all():
        absorbs = not is_uniform(medium) or np.any(medium.sigma_a)
        if is_uniform(medium) and (not absorbs or medium.emission == power):
            return np.full(ray.shape, power), np.zeros(ray.shape)
        sky = given(scene.shape, ROOM, "sky")
        if sky and is_uniform(medium):
            share: Reference = sky(scene.shape, medium, ray)
            glow = float(np.asarray(medium.emission))
            value = power * share.value + glow * (1 - share.value)
            return value, (power + glow) * share.error + 4e-16 * value
    parallel, travel = given(scene.shape, ROOM, "parallel"), getattr(light, "direction", None)
    dark = scene.background == 0 and not np.any(medium.emission)
    if parallel and travel and light.distant and is_uniform(medium) and dark:
        found: Reference = parallel(scene.shape, medium, ray, np.array(travel))
        return power * found.value, power * found.error + 4e-16 * power * found.value
    raise UnsupportedError(
        f"all orders of scattering from a {type(light).__name__} in a {type(scene.shape).__name__} are not known here;"
        " known are a uniform sky whose radiance is also the background, around a slab, half-space or ball, and parallel light on"
        " a slab or half-space before a black background",
        "scattering",
    )
