"""The oracle: closed forms and quadrature with error bounds that hold. No random numbers, nothing shared with the estimators.

Every function broadcasts over arrays and returns a `Reference` with |value - truth| <= error, rounding counted; inputs count as
exact binary64 numbers.
"""

from fogproof.analytic.airlight import airlight_integral
from fogproof.analytic.ambient_fog import ambient_fog
from fogproof.analytic.coefficients import Coefficients, coefficients
from fogproof.analytic.emission import emitted_radiance
from fogproof.analytic.free_path import free_path
from fogproof.analytic.furnace import thermal_furnace, white_furnace
from fogproof.analytic.phase_functions import phase_cdf, phase_pdf
from fogproof.analytic.radiance_by_ode import radiance_by_ode
from fogproof.analytic.radiance_by_quadrature import radiance_by_quadrature
from fogproof.analytic.single_scattering import single_scattering
from fogproof.analytic.transmittance import optical_thickness, transmittance

__all__ = [
    "Coefficients",
    "airlight_integral",
    "ambient_fog",
    "coefficients",
    "emitted_radiance",
    "free_path",
    "optical_thickness",
    "phase_cdf",
    "phase_pdf",
    "radiance_by_ode",
    "radiance_by_quadrature",
    "single_scattering",
    "thermal_furnace",
    "transmittance",
    "white_furnace",
]
