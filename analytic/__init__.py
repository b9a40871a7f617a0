"""The oracle: closed forms and quadrature with error bounds. No random numbers, nothing shared with the estimators.

Every function returns a `Reference` with |value - truth| <= error, rounding counted; inputs count as exact binary64.
"""

from fogproof.analytic.phase_functions import phase_cdf, phase_pdf

__all__ = [
    "phase_cdf",
    "phase_pdf",
]
