"""The oracle: closed forms and quadrature with error bounds that hold. No random numbers, nothing shared with the estimators.

Every function broadcasts over arrays and returns a `Reference` with |value - truth| <= error, rounding counted; inputs count as
exact binary64 numbers.
"""

from fogproof.analytic.airlight import airlight_integral, airlight_table
from fogproof.analytic.airlight_moments import airlight_second_moment
from fogproof.analytic.ambient_fog import ambient_fog
from fogproof.analytic.coefficients import Coefficients, coefficients
from fogproof.analytic.colour import sky_colour, sun_colour
from fogproof.analytic.emission import emitted_radiance
from fogproof.analytic.free_path import free_path
from fogproof.analytic.furnace import thermal_furnace, white_furnace
from fogproof.analytic.phase_functions import phase_cdf, phase_mean_cosine, phase_pdf, phase_quantile
from fogproof.analytic.radiance import radiance
from fogproof.analytic.radiance_by_ode import radiance_by_ode
from fogproof.analytic.radiance_by_quadrature import radiance_by_quadrature
from fogproof.analytic.rayleigh_atmosphere import air_cross_section, air_optical_depth, plane_parallel_sky
from fogproof.analytic.rayleigh_coefficient import rayleigh_scattering_coefficient
from fogproof.analytic.second_moments import (
    ambient_fog_variance,
    transmittance_lookups,
    transmittance_second_moment,
    transmittance_variance,
)
from fogproof.analytic.single_scattering import single_scattering
from fogproof.analytic.single_scattering_moments import single_scattering_second_moment, single_scattering_variance
from fogproof.analytic.transmittance import optical_thickness, transmittance
from fogproof.analytic.varying_phase import phase_pdf_at

__all__ = [
    "Coefficients",
    "air_cross_section",
    "air_optical_depth",
    "airlight_integral",
    "airlight_second_moment",
    "airlight_table",
    "ambient_fog",
    "ambient_fog_variance",
    "coefficients",
    "emitted_radiance",
    "free_path",
    "optical_thickness",
    "phase_cdf",
    "phase_mean_cosine",
    "phase_pdf",
    "phase_pdf_at",
    "phase_quantile",
    "plane_parallel_sky",
    "radiance",
    "radiance_by_ode",
    "radiance_by_quadrature",
    "rayleigh_scattering_coefficient",
    "single_scattering",
    "single_scattering_second_moment",
    "single_scattering_variance",
    "sky_colour",
    "sun_colour",
    "thermal_furnace",
    "transmittance",
    "transmittance_lookups",
    "transmittance_second_moment",
    "transmittance_variance",
    "white_furnace",
]
