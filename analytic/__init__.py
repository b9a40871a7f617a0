"""The oracle: closed forms and quadrature with error bounds that hold. No random numbers.

Every function broadcasts over arrays of rays and returns a `Reference` with |value - truth| <= error.
"""

from fogproof.analytic.ambient_fog import ambient_fog
from fogproof.analytic.transmittance import optical_thickness, transmittance

__all__ = [
    "ambient_fog",
    "optical_thickness",
    "transmittance",
]
