"""The oracle: closed forms and quadrature with error bounds that hold. No random numbers, nothing shared with the estimators.

Every function broadcasts over arrays and returns a `Reference` with |value - truth| <= error, rounding counted; inputs count as
exact binary64 numbers.
"""

from fogproof.analytic.airlight.integral import airlight_integral, airlight_table
from fogproof.analytic.airlight.single_scattering import single_scattering
from fogproof.analytic.derivatives.gradient import gradient
from fogproof.analytic.derivatives.path_length import path_length_mean, path_length_transform, path_length_variance
from fogproof.analytic.derivatives.scattering_counts import scattering_count_law, scattering_count_mean
from fogproof.analytic.images.image import image
from fogproof.analytic.media.black_body import black_body_radiance
from fogproof.analytic.media.coefficients import Coefficients, coefficients
from fogproof.analytic.multiple.ball import (
    ball_albedo,
    ball_albedo_orders,
    ball_radiance,
    ball_radiance_orders,
    ball_source,
)
from fogproof.analytic.multiple.chandrasekhar_h import chandrasekhar_h
from fogproof.analytic.multiple.flights import mean_displacement, mean_square_displacement
from fogproof.analytic.multiple.half_space import (
    half_space_brdf,
    half_space_reflectance,
    half_space_reflectance_orders,
    half_space_spherical_albedo,
)
from fogproof.analytic.multiple.infinite_medium import point_source_collisions, point_source_fluence
from fogproof.analytic.multiple.layers import (
    layered_brdf,
    layered_btdf,
    layered_emission,
    layered_reflectance,
    layered_transmittance,
)
from fogproof.analytic.multiple.mean_path_length import mean_path_length, mean_scatterings
from fogproof.analytic.multiple.rod import (
    rod_reflectance,
    rod_reflectance_orders,
    rod_transmittance,
    rod_transmittance_orders,
)
from fogproof.analytic.multiple.slab import (
    slab_diffuse_reflectance,
    slab_diffuse_transmittance,
    slab_emissivity,
    slab_reflectance,
    slab_transmittance,
)
from fogproof.analytic.multiple.slab_brdf import slab_brdf, slab_btdf
from fogproof.analytic.multiple.slab_orders import slab_reflectance_orders, slab_transmittance_orders
from fogproof.analytic.phase.delta_m import delta_m, delta_m_moments
from fogproof.analytic.phase.functions import (
    phase_cdf,
    phase_legendre_moments,
    phase_mean_cosine,
    phase_pdf,
    phase_quantile,
)
from fogproof.analytic.phase.microflakes import microflake_pdf
from fogproof.analytic.phase.rayleigh_coefficient import rayleigh_scattering_coefficient
from fogproof.analytic.phase.varying import phase_pdf_at
from fogproof.analytic.proven.golden import Golden, golden_values
from fogproof.analytic.rays.ambient_fog import ambient_fog
from fogproof.analytic.rays.emission import emitted_radiance
from fogproof.analytic.rays.free_path import free_path
from fogproof.analytic.rays.furnace import thermal_furnace, white_furnace
from fogproof.analytic.rays.radiance_by_ode import radiance_by_ode
from fogproof.analytic.rays.radiance_by_quadrature import radiance_by_quadrature
from fogproof.analytic.rays.transmittance import optical_thickness, transmittance
from fogproof.analytic.scene_radiance import radiance
from fogproof.analytic.sky.colour import sky_colour, sun_colour
from fogproof.analytic.sky.rayleigh_atmosphere import air_cross_section, air_optical_depth, plane_parallel_sky
from fogproof.analytic.variance.airlight import airlight_second_moment
from fogproof.analytic.variance.fog import ambient_fog_variance
from fogproof.analytic.variance.single_scattering import single_scattering_second_moment, single_scattering_variance
from fogproof.analytic.variance.transmittance import (
    transmittance_lookups,
    transmittance_second_moment,
    transmittance_variance,
)
from fogproof.analytic.variance.voxel_estimates import (
    voxel_estimate_cost,
    voxel_estimate_mean,
    voxel_estimate_variance,
)

__all__ = [
    "Coefficients",
    "Golden",
    "air_cross_section",
    "air_optical_depth",
    "airlight_integral",
    "airlight_second_moment",
    "airlight_table",
    "ambient_fog",
    "ambient_fog_variance",
    "ball_albedo",
    "ball_albedo_orders",
    "ball_radiance",
    "ball_radiance_orders",
    "ball_source",
    "black_body_radiance",
    "chandrasekhar_h",
    "coefficients",
    "delta_m",
    "delta_m_moments",
    "emitted_radiance",
    "free_path",
    "golden_values",
    "gradient",
    "half_space_brdf",
    "half_space_reflectance",
    "half_space_reflectance_orders",
    "half_space_spherical_albedo",
    "image",
    "layered_brdf",
    "layered_btdf",
    "layered_emission",
    "layered_reflectance",
    "layered_transmittance",
    "mean_displacement",
    "mean_path_length",
    "mean_scatterings",
    "mean_square_displacement",
    "microflake_pdf",
    "optical_thickness",
    "path_length_mean",
    "path_length_transform",
    "path_length_variance",
    "phase_cdf",
    "phase_legendre_moments",
    "phase_mean_cosine",
    "phase_pdf",
    "phase_pdf_at",
    "phase_quantile",
    "plane_parallel_sky",
    "point_source_collisions",
    "point_source_fluence",
    "radiance",
    "radiance_by_ode",
    "radiance_by_quadrature",
    "rayleigh_scattering_coefficient",
    "rod_reflectance",
    "rod_reflectance_orders",
    "rod_transmittance",
    "rod_transmittance_orders",
    "scattering_count_law",
    "scattering_count_mean",
    "single_scattering",
    "single_scattering_second_moment",
    "single_scattering_variance",
    "sky_colour",
    "slab_brdf",
    "slab_btdf",
    "slab_diffuse_reflectance",
    "slab_diffuse_transmittance",
    "slab_emissivity",
    "slab_reflectance",
    "slab_reflectance_orders",
    "slab_transmittance",
    "slab_transmittance_orders",
    "sun_colour",
    "thermal_furnace",
    "transmittance",
    "transmittance_lookups",
    "transmittance_second_moment",
    "transmittance_variance",
    "voxel_estimate_cost",
    "voxel_estimate_mean",
    "voxel_estimate_variance",
    "white_furnace",
]
