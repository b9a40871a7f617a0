"""The oracle: closed forms and quadrature with error bounds that hold. No random numbers, nothing shared with the estimators.

Every function broadcasts over arrays and returns a `Reference` with |value - truth| <= error, rounding counted; inputs count as
exact binary64 numbers.
"""

from fogproof.analytic.airlight import airlight_integral
from fogproof.analytic.ambient_fog import ambient_fog
from fogproof.analytic.phase_functions import phase_cdf, phase_pdf
from fogproof.analytic.single_scattering import single_scattering
from fogproof.analytic.phase_functions import phase_cdf, phase_mean_cosine, phase_pdf, phase_quantile
from fogproof.analytic.rayleigh_coefficient import rayleigh_scattering_coefficient
from fogproof.analytic.transmittance import optical_thickness, transmittance

__all__ = [
    "airlight_integral",
    "ambient_fog",
    "optical_thickness",
    "phase_cdf",
    "phase_mean_cosine",
    "phase_pdf",
    "single_scattering",
    "phase_quantile",
    "rayleigh_scattering_coefficient",
    "transmittance",
]
