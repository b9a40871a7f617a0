"""The point light."""

from __future__ import annotations

from collections.abc import Sequence

from fogproof.analytic.airlight.beam import Beam
from fogproof.analytic.airlight.from_a_point import from_a_point
from fogproof.analytic.airlight.integral import Method
from fogproof.analytic.airlight.ray_and_light import place
from fogproof.analytic.airlight.result import Result
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene import AnyMedium
from fogproof.scene.lights import PointLight
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape


def beam(light: PointLight, ray: FlatRays, exact: bool) -> Beam:
    """Return the light for quadrature along rays."""
    return Beam(place(ray, light.position, exact))


def single_scattering(
    medium: AnyMedium,
    ray: FlatRays,
    light: PointLight,
    shape: Shape,
    occluders: Sequence[Occluder],
    method: Method,
    exact: bool,
) -> Result | None:
    """Return the airlight integral over the lit pieces of the rays, with a bound of its error."""
    return from_a_point(medium, ray, light.position, light.intensity, beam(light, ray, exact), shape, occluders, method)
