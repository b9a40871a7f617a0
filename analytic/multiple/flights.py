"""Where a photon is after n flights between collisions in an infinite medium: the first two moments, exactly.

Flights have exponential lengths with the mean free path l, and each scattering has the mean cosine g.
Source: Chandrasekhar 1943, Stochastic problems in physics and astronomy; Bohren & Clothiaux 2006, section 5.3.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.scattering_arguments import checked_count
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray
from fogproof.validate import as_float_array, require

MOST_FLIGHTS = 1 << 53
METHOD = "closed form"
SOURCE = "Chandrasekhar 1943, Stochastic problems in physics and astronomy"


@quantity(
    unit="m",
    convention="along the first direction, after n flights between collisions in an infinite medium",
    source="Chandrasekhar 1943, Stochastic problems in physics and astronomy",
    example={"flights": 3, "g": [-0.5, 0, 0.9], "mean_free_path": 2},
)
def mean_displacement(flights: int, g: FloatArray, mean_free_path: FloatArray = 1.0) -> Reference:
    """Return the mean displacement along the first direction after n flights, l (1 + g + … + g^(n-1)) [m].

    flights         n >= 0, a whole number
    g               (...) mean cosine of the phase function, in [-1, 1]
    mean_free_path  (...) l [m], > 0; broadcast against g

    Error: (n + 8) eps, relative to the sum of |g|^k.
    """
    n, g, length = _checked(flights, g, mean_free_path)
    value, size = length * _sums(n, g)[0], length * _sums(n, np.abs(g))[0]
    return Reference(value, (n + 8) * EPS * size + TINY, METHOD, SOURCE)


@quantity(
    unit="m^2",
    convention="after n flights between collisions in an infinite medium",
    source="Chandrasekhar 1943, Stochastic problems in physics and astronomy; Bohren & Clothiaux 2006, section 5.3",
    example={"flights": 3, "g": [-0.5, 0, 0.9], "mean_free_path": 2},
)
def mean_square_displacement(flights: int, g: FloatArray, mean_free_path: FloatArray = 1.0) -> Reference:
    """Return the mean square displacement after n flights, 2 l^2 sum_(k=0)^(n-1) (n - k) g^k [m^2].

    Arguments as in `mean_displacement`; in closed form 2 l^2 [n/(1 - g) - g (1 - g^n)/(1 - g)^2]. Error: likewise.
    """
    n, g, length = _checked(flights, g, mean_free_path)

    square = 2 * length * length
    return Reference(
        square * _sums(n, g)[1], 2 * (n + 8) * EPS * square * _sums(n, np.abs(g))[1] + TINY, METHOD, SOURCE
    )


def _sums(n: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return S_n = 1 + x + … + x^(n-1) and S_1 + … + S_n, in as many steps as n has bits.

    S_(2m) = S_m + x^m S_m, and the sum of the sums doubles likewise, with m S_m for what the first half adds to the second.
    """
    power, single, double = np.ones_like(x), np.zeros_like(x), np.zeros_like(x)
    m = 0
    with np.errstate(under="ignore"):
        for bit in f"{n:b}":
            double = double + (m * single + power * double)
            single, power, m = single + power * single, power * power, 2 * m
            if bit == "1":
                single, power, m = 1 + x * single, x * power, m + 1
                double = double + single
    return single, double


def _checked(flights: Any, g: Any, mean_free_path: Any) -> tuple[int, np.ndarray, np.ndarray]:
    n, g, length = (
        checked_count("flights", flights, MOST_FLIGHTS),
        as_float_array("g", g),
        as_float_array("mean_free_path", mean_free_path),
    )
    require("g", g, np.abs(g) <= 1, "must lie in [-1, 1]", "it is the mean cosine of the phase function")
    require("mean_free_path", length, np.isfinite(length) & (length > 0), "must be finite and > 0 [m]")
    g, length = np.broadcast_arrays(g, length)
    return n, g, length
