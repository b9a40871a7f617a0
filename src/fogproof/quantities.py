"""What the oracle answers to programs: every quantity with its function, its arguments, its unit and its convention."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from fogproof import analytic
from fogproof.analytic.airlight.integral import Method
from fogproof.analytic.variance.airlight import Sampling
from fogproof.analytic.variance.transmittance import Tracking
from fogproof.contracts import Reference
from fogproof.scene import Isotropic, PointLight, Ray, Scattering, Scene
from fogproof.scene.arrays import FloatArray
from fogproof.scene.complex_numbers import ComplexNumber
from fogproof.scene.lights import LightField
from fogproof.scene.media import AnyMediumField
from fogproof.scene.occluders import OccluderField
from fogproof.scene.phase import PhaseFunctionField
from fogproof.scene.shapes import ShapeField, Unbounded
from fogproof.validate import Channels

_FORWARD = "mu is the forward cosine: propagation direction in . propagation direction out"


@dataclass(frozen=True)
class Quantity:
    """A question the oracle answers: its function, its arguments (type, or (type, default)), unit and convention."""

    function: Callable[..., Reference]
    arguments: dict[str, Any]
    unit: str
    convention: str


@cache
def quantities() -> dict[str, Quantity]:
    """Return every quantity by name."""
    scene = {"medium": AnyMediumField, "ray": Ray}
    airlight = {"sigma_t": FloatArray, "h": FloatArray, "a": FloatArray, "b": FloatArray}
    phase = {"phase": PhaseFunctionField}
    how = {"method": (Method, "asinh")}
    proof = {"rigorous": (bool, False)}
    tracker = {"tracking": Tracking, "majorant": (Channels | None, None), "control": (Channels, 0.0)}
    radiance = "W/(m^2 sr)"
    return {
        "optical_thickness": Quantity(
            analytic.optical_thickness, {**scene, **proof}, "1", "integral of sigma_t along the ray"
        ),
        "transmittance": Quantity(
            analytic.transmittance,
            {**scene, **proof},
            "1",
            "fraction of the radiance that arrives: exp(-optical thickness)",
        ),
        "free_path": Quantity(
            analytic.free_path,
            {**scene, "tau": FloatArray},
            "m",
            "distance at which the optical thickness is tau; inf where the ray ends or escapes before",
        ),
        "ambient_fog": Quantity(
            analytic.ambient_fog,
            {**scene, "ambient": (Channels, 0.0), "background": (Channels, 0.0), **proof},
            radiance,
            "in-scattered radiance constant along the ray; emission is multiplied by sigma_a",
        ),
        "emitted_radiance": Quantity(
            analytic.emitted_radiance,
            {**scene, "times_sigma_a": (bool, True), **proof},
            radiance,
            "times_sigma_a: the medium's emission is L_e and is multiplied by sigma_a; otherwise it is a power per volume",
        ),
        "white_furnace": Quantity(
            analytic.white_furnace,
            {**scene, "radiance": (Channels, 1.0)},
            radiance,
            "albedo 1 in uniform light: nothing changes",
        ),
        "thermal_furnace": Quantity(
            analytic.thermal_furnace,
            {**scene, "radiance": (Channels, 1.0)},
            radiance,
            "emission equal to the surrounding radiance: nothing changes",
        ),
        "single_scattering": Quantity(
            analytic.single_scattering,
            {
                **scene,
                "light": LightField,
                "occluders": (tuple[OccluderField, ...], ()),
                "shape": (ShapeField, Unbounded()),
                **how,
            },
            radiance,
            "airlight alone, without the background; the light's intensity is in W/sr; " + _FORWARD,
        ),
        "radiance": Quantity(
            lambda **scene: analytic.radiance(Scene(**scene)),
            {
                **scene,
                "scattering": (Scattering, "none"),
                "light": (LightField | None, None),
                "occluders": (tuple[OccluderField, ...], ()),
                "ambient": (Channels, 0.0),
                "background": (Channels, 0.0),
            },
            radiance,
            "everything a camera ray sees: background, emission, and in-scattering as far as `scattering` says",
        ),
        "transmittance_variance": Quantity(
            analytic.transmittance_variance,
            {**scene, **tracker},
            "1",
            "variance of one realisation of a tracker's estimate",
        ),
        "transmittance_lookups": Quantity(
            analytic.transmittance_lookups,
            {**scene, **tracker},
            "1",
            "expected look-ups of the medium in one realisation",
        ),
        "single_scattering_variance": Quantity(
            analytic.single_scattering_variance,
            {**scene, "light": PointLight, "sampling": Sampling},
            "(W/(m^2 sr))^2",
            "variance of one realisation that places its scattering event by `sampling`",
        ),
        "airlight_integral": Quantity(
            analytic.airlight_integral,
            {**airlight, "phase": (PhaseFunctionField, Isotropic()), **how, **proof},
            "1/m",
            "integral over t in [a, b] of exp(-sigma_t ((t - a) + r)) / r^2 4 pi f_p(-t/r), r^2 = t^2 + h^2",
        ),
        "airlight_table": Quantity(
            analytic.airlight_table,
            {**airlight, "phase": (PhaseFunctionField, Isotropic()), **how},
            "1/m",
            "airlight_integral on the grid of h, a and b, in this order of axes",
        ),
        "phase_pdf": Quantity(analytic.phase_pdf, {**phase, "mu": FloatArray}, "1/sr", _FORWARD),
        "phase_cdf": Quantity(
            analytic.phase_cdf, {**phase, "mu": FloatArray}, "1", "probability that the cosine is <= mu; " + _FORWARD
        ),
        "phase_quantile": Quantity(
            analytic.phase_quantile,
            {**phase, "xi": FloatArray},
            "1",
            "the cosine below which a share xi is scattered; " + _FORWARD,
        ),
        "phase_mean_cosine": Quantity(analytic.phase_mean_cosine, phase, "1", "g, the mean of mu; " + _FORWARD),
        "rayleigh_scattering_coefficient": Quantity(
            analytic.rayleigh_scattering_coefficient,
            {
                "diameter": FloatArray,
                "refractive_index": ComplexNumber,
                "number_density": FloatArray,
                "wavelength": FloatArray,
            },
            "1/m",
            "lengths in m, number density in 1/m^3, refractive index and wavelength as the medium sees them",
        ),
        "transmittance_second_moment": Quantity(
            analytic.transmittance_second_moment,
            {**scene, **tracker},
            "1",
            "mean square of one realisation of a tracker's estimate",
        ),
        "ambient_fog_variance": Quantity(
            analytic.ambient_fog_variance,
            {**scene, "ambient": (Channels, 0.0), "background": (Channels, 0.0)},
            "(W/(m^2 sr))^2",
            "variance of one analog free path",
        ),
        "air_cross_section": Quantity(
            analytic.air_cross_section,
            {"wavelength": FloatArray},
            "m^2",
            "Rayleigh scattering by a molecule of dry air; wavelength in m",
        ),
        "air_optical_depth": Quantity(
            analytic.air_optical_depth,
            {"wavelength": FloatArray},
            "1",
            "the whole atmosphere above sea level, straight up",
        ),
        "plane_parallel_sky": Quantity(
            analytic.plane_parallel_sky,
            {"tau": FloatArray, "mu_sun": FloatArray, "mu_view": FloatArray, "azimuth": FloatArray},
            "1/sr",
            "the clear sky for unit irradiance of the sun, by single scattering; cosines from the zenith, azimuth in rad",
        ),
        "sky_colour": Quantity(
            analytic.sky_colour,
            {"mu_sun": FloatArray, "mu_view": FloatArray, "azimuth": FloatArray},
            "1/sr",
            "CIE 1931 XYZ in the last axis; the sun above the atmosphere, D65, has Y = 1",
        ),
        "sun_colour": Quantity(
            analytic.sun_colour,
            {"air_mass": FloatArray},
            "1",
            "CIE 1931 XYZ in the last axis; the sun above the atmosphere, D65, has Y = 1",
        ),
    }
