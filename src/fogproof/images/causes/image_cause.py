"""One thing that may have gone wrong, and what the image would be then."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fogproof.analytic.images.seen import seen
from fogproof.images.picture import RenderedImage
from fogproof.images.residuals import Residuals
from fogproof.scene import ImageScene
from fogproof.scene.kinds import given

Predict = Callable[[np.ndarray], np.ndarray]
"""Parameters (m,) -> the image at the chosen pixels, (k, channels)."""


@dataclass(frozen=True)
class ImageCause:
    """A cause.

    cause    its name
    predict  what the image would be
    words    fitted parameters -> a sentence
    starts   parameters from which the fit starts; empty: there are none
    low, high  bounds of the parameters
    blur     (k, channels) standard error of the prediction itself, where it is made by chance
    special  values of the parameter that have a name of their own: (value, cause, words)
    """

    cause: str
    predict: Predict
    words: Callable[[np.ndarray], str]
    starts: tuple[tuple[float, ...], ...] = ()
    low: float = -np.inf
    high: float = np.inf
    blur: np.ndarray | None = None
    special: tuple[tuple[float, str, str], ...] = ()


def fixed(cause: str, make: Callable[[], np.ndarray], words: str, blur: np.ndarray | None = None) -> ImageCause:
    """Return a cause without parameters."""
    return ImageCause(cause, lambda _: make(), lambda _: words, blur=blur)


@dataclass(frozen=True)
class Sight:
    """An image that is off, its scene, and the pixels at which causes are compared.

    rows, columns  (k,) chosen pixels
    """

    scene: ImageScene
    picture: RenderedImage
    found: Residuals
    rows: np.ndarray
    columns: np.ndarray

    @cached_property
    def image(self) -> np.ndarray:
        """What the image shows at the chosen pixels (k, channels)."""
        return np.asarray(self.picture.value[self.rows, self.columns])

    @cached_property
    def reference(self) -> np.ndarray:
        """What it should show there."""
        return np.asarray(self.found.reference[self.rows, self.columns])

    def at_centres(
        self, scene: ImageScene, dx: float = 0.0, dy: float = 0.0, near: float = 0.0, wall_at_distance: bool = False
    ) -> np.ndarray:
        """Return what another scene shows at the middles of the pixels (k, channels), moved on the film and along rays.

        wall_at_distance  rays end where they are as long as the wall is deep
        """
        from fogproof.scene import Ray

        x0, y0, _, _ = scene.camera.film.window
        x, y = self.columns + (x0 + 0.5 + dx), self.rows + (y0 + 0.5 + dy)
        ray = given(scene.camera, "fogproof.analytic.cameras", "rays")(scene.camera, x, y)
        if wall_at_distance:
            ray = Ray(ray.origin, ray.direction, scene.camera.wall)
        if near:
            ray = Ray(ray.origin + near * ray.direction, ray.direction, np.maximum(ray.length - near, 0.0))
        value, _ = seen(scene, ray)
        return np.broadcast_to(value, (len(value), self.reference.shape[1]))

    @cached_property
    def centres(self) -> np.ndarray:
        """What the scene shows at the middles of the pixels."""
        return self.at_centres(self.scene)

    def instead(
        self, scene: ImageScene, dx: float = 0.0, dy: float = 0.0, near: float = 0.0, wall_at_distance: bool = False
    ) -> np.ndarray:
        """Return the image of another scene: its middles, and what the means of the right one differ from its middles by."""
        other = self.at_centres(scene, dx, dy, near, wall_at_distance)
        with np.errstate(all="ignore"):
            ratio = np.where(self.centres > 0, self.reference / self.centres, 1.0)
        usual = np.isfinite(ratio) & np.isfinite(other)
        return np.where(usual, other * ratio, self.reference)
