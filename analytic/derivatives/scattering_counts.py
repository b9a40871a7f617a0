"""How often light scatters on its way: the albedo is the variable of a generating function.

A path with n scatterings carries the factor albedo^n. So the terms of a quantity in powers of the albedo, over their sum, are
the probabilities of n scatterings, and the logarithmic derivative is the mean of n.
"""

from __future__ import annotations

from collections.abc import Callable
from inspect import signature
from typing import Any

import numpy as np

from fogproof import analytic
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity as declared
from fogproof.analytic.derivatives.gradient import gradient, named
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.arrays import Count

ROD = {"quantity": "rod_reflectance", "albedo": 0.5, "length": 1}
"""Of the examples."""

SOURCE = "Irvine 1964, The formation of absorption bands and the distribution of photon optical paths"


@declared(
    unit="1",
    convention="n counts scatterings, 0 first; probabilities of light that is counted, not of light that is sent",
    source=SOURCE,
    example={"of": ROD, "count": 3},
    of=True,
)
def scattering_count_law(
    quantity: str | Callable[..., Reference], albedo: float, count: Count, **arguments: Any
) -> Reference:
    """Return the probabilities that light which a quantity counts has scattered 0 … count times: (..., count + 1).

    quantity   a function of `fogproof.analytic` with an albedo and known scattering orders, or its name
    albedo     one number in (0, 1]
    count      the highest number of scatterings
    arguments  the others of the quantity

    >>> from fogproof import analytic
    >>> law = analytic.scattering_count_law("rod_reflectance", albedo=0.5, count=2, length=1.0)
    >>> law.value.round(3).tolist()
    [0.0, 0.826, 0.142]
    """
    name, function = named(quantity)
    orders = getattr(analytic, f"{name}_orders", None)
    if orders is None:
        raise UnsupportedError(f"the scattering orders of {name} are not known", "quantity")
    share = _positive(albedo)
    terms = orders(**_taken(name, orders, function, arguments), count=count)
    whole = function(albedo=share, **arguments)
    powers = share ** np.arange(count + 1.0)
    sums, off = np.asarray(whole.value)[..., None], np.asarray(whole.error)[..., None]
    if not np.all(sums > off):
        raise UnsupportedError("no light is counted, which therefore has no law", "quantity")
    value = terms.value * powers / sums
    error = (terms.error * powers + value * off) / (sums - off) + 8 * EPS * value + TINY
    return Reference(value, error, terms.method, SOURCE)


def _taken(
    name: str, orders: Callable[..., Reference], function: Callable[..., Reference], arguments: dict[str, Any]
) -> dict[str, Any]:
    """Return the arguments that the orders have; the others must be what the quantity takes when nothing is said."""
    known, defaults = signature(orders).parameters, signature(function).parameters
    for argument, value in arguments.items():
        if argument not in known and not np.all(value == defaults[argument].default):
            raise UnsupportedError(f"the scattering orders of {name} are known without {argument} alone", argument)
    return {argument: value for argument, value in arguments.items() if argument in known}


@declared(
    unit="1",
    convention="scatterings of light that is counted",
    source=SOURCE,
    example={"of": ROD},
    of=True,
)
def scattering_count_mean(quantity: str | Callable[..., Reference], albedo: float, **arguments: Any) -> Reference:
    """Return the mean number of scatterings of light that a quantity counts, albedo d ln Q/d albedo.

    Arguments as in `scattering_count_law`; scattering orders need not be known.
    """
    share = _positive(albedo)
    slope, whole = (
        gradient(quantity, "albedo", albedo=share, **arguments),
        named(quantity)[1](albedo=share, **arguments),
    )
    if not np.all(whole.value > whole.error):
        raise UnsupportedError("no light is counted, which therefore has no law", "quantity")
    value = share * slope.value / whole.value
    error = (share * slope.error + np.abs(value) * whole.error) / (whole.value - whole.error) + 4 * EPS * np.abs(value)
    return Reference(value, error, slope.method, SOURCE)


def _positive(albedo: Any) -> float:
    if isinstance(albedo, bool) or not np.ndim(albedo) == 0 or not 0 < float(albedo) <= 1:
        raise InvalidValueError("albedo", "must be one number in (0, 1]", albedo)
    return float(albedo)
