"""Path tracing with boundaries, a half space, a ground, a mirror and glass, against the exact solutions."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import Drawn, EstimatorCase
from fogproof.catalogue.multiple.builders import (
    ABOVE,
    BELOW,
    BLACK,
    FOG,
    NEXT_EVENT,
    SKY,
    SLAB,
    SUN,
    SUNLIGHT,
    UP,
    VIEW,
    combined,
    paths_case,
    scaled,
    times,
)
from fogproof.contracts import Draws, Reference
from fogproof.estimators import (
    PathTracer,
)
from fogproof.scene import HenyeyGreenstein, Medium
from fogproof.scene.shapes import HalfSpace
from fogproof.scene.surfaces import Plane, Surface


def _over_lambertian(ground: float) -> Reference:
    """R + T a T_d/(1 - a R_d): the ground and the diffuse reflection of the slab from below send light back and forth."""
    parts = (
        analytic.slab_reflectance(0.9, 1.0, VIEW),
        analytic.slab_transmittance(0.9, 1.0, VIEW),
        analytic.slab_diffuse_reflectance(0.9, 1.0),
        analytic.slab_diffuse_transmittance(0.9, 1.0),
    )
    return combined("adding", lambda R, T, Rd, Td: R + T * ground * Td / (1 - ground * Rd), *parts)


def _over_mirror() -> Reference:
    """A mirror at its lower face makes a slab look like one twice as thick, lit from both sides."""
    parts = analytic.slab_reflectance(0.9, 2.0, VIEW), analytic.slab_transmittance(0.9, 2.0, VIEW)
    return combined("image", lambda R, T: R + T, *parts)


def _scattered_only(tracer: PathTracer) -> Drawn:
    return Drawn(lambda rng, n: Draws(np.asarray(tracer.draw(rng, n).value)[:, 1]))


def cases() -> list[EstimatorCase]:
    """Return the cases of boundaries."""
    half_space = HalfSpace((0.0, 0.0, 0.0), UP)
    dim = Medium(0.3, 0.7)
    gray = Surface(BELOW, 0.6)
    mirror = Surface(Plane((0.0, 0.0, -1.0), UP), 1.0, "mirror")
    return [
        paths_case(
            name="half-space/sky",
            title="Half space under the sky",
            make=lambda: PathTracer(dim, half_space, ABOVE, SKY, light_sampling="bsdf"),
            reference=lambda: analytic.half_space_reflectance(0.7, VIEW),
            oracle="half_space_reflectance",
            error="the half space ends one mean free path down",
            twin=lambda: PathTracer(dim, SLAB, ABOVE, SKY, BLACK, light_sampling="bsdf"),
        ),
        paths_case(
            name="half-space/forward",
            title="Half space that scatters forwards, lit by the sun",
            make=lambda: PathTracer(Medium(0.1, 0.9, HenyeyGreenstein(0.5)), half_space, ABOVE, SUNLIGHT),
            reference=lambda: times(analytic.half_space_brdf(0.9, SUN, VIEW, HenyeyGreenstein(0.5), np.pi), SUN),
            oracle="half_space_brdf",
            error="scattering is isotropic",
            twin=lambda: PathTracer(Medium(0.1, 0.9), half_space, ABOVE, SUNLIGHT),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="half-space/sun",
            title="Half space in the sun",
            make=lambda: PathTracer(dim, half_space, ABOVE, SUNLIGHT),
            reference=lambda: times(analytic.half_space_brdf(0.7, SUN, VIEW), SUN),
            oracle="half_space_brdf",
            error="the factor 1/(4 pi) of the phase function is 1/pi",
            twin=lambda: scaled(PathTracer(dim, half_space, ABOVE, SUNLIGHT), 4.0),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="ground/lambert",
            title="Slab over a diffuse ground",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, gray),
            reference=lambda: _over_lambertian(0.6),
            oracle="slab_reflectance, slab_transmittance and their diffuse means",
            error="the albedo of the ground is divided by pi twice",
            twin=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, Surface(BELOW, 0.6 / np.pi)),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="ground/mirror",
            title="Slab on a mirror",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, mirror),
            reference=_over_mirror,
            oracle="slab_reflectance, slab_transmittance",
            error="the mirror swallows half",
            twin=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, Surface(Plane((0.0, 0.0, -1.0), UP), 0.5, "mirror")),
            source=NEXT_EVENT,
        ),
        paths_case(
            name="glass/reflected",
            title="Slab of refractive index 1.5 under the sky",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, refractive_index=1.5),
            reference=lambda: analytic.slab_reflectance(0.9, 1.0, VIEW, None, 1.5),
            oracle="slab_reflectance",
            error="light that the boundary reflects from outside is forgotten",
            twin=lambda: _scattered_only(PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, refractive_index=1.5, columns=2)),
        ),
        paths_case(
            name="glass/transmitted",
            title="Slab of refractive index 1.5 before a bright surface",
            make=lambda: PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=1.0), refractive_index=1.5),
            reference=lambda: analytic.slab_transmittance(0.9, 1.0, VIEW, None, 1.5),
            oracle="slab_transmittance",
            error="radiance is divided by the square of the index on the way out, never multiplied on the way in",
            twin=lambda: scaled(
                PathTracer(FOG, SLAB, ABOVE, None, Surface(BELOW, radiance=1.0), refractive_index=1.5), 1 / 1.5**2
            ),
        ),
    ]
