"""The oracle: closed forms and quadrature with error bounds that hold. No random numbers.

Every function broadcasts over arrays of rays and returns a `Reference` with |value - truth| <= error.
"""

from fogproof.analytic.airlight import airlight_integral
from fogproof.analytic.ambient_fog import ambient_fog
from fogproof.analytic.single_scattering import single_scattering
from fogproof.analytic.transmittance import optical_thickness, transmittance

__all__ = [
    "airlight_integral",
    "ambient_fog",
    "optical_thickness",
    "single_scattering",
    "transmittance",
]
