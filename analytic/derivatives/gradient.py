"""Derivatives of the oracle's quantities by any of their parameters, with an error bound.

Where a quantity is bounded for complex parameters (`discs`), Cauchy's inequality bounds the derivative's error. Elsewhere two
interpolations that share no node but one are held against each other, and the method says that the error is estimated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import FOG, declaration_of
from fogproof.analytic.declaration import quantity as declared
from fogproof.analytic.derivatives.discs import ALONG_A_RAY, discs
from fogproof.analytic.derivatives.from_values import NODES, Disc, Function, derivative_from_values, differentiated
from fogproof.analytic.derivatives.parameters import Parameter, parameter
from fogproof.analytic.media.coefficients import ROOM
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene.kinds import given

PROVEN = "interpolation; error bounded by Cauchy's inequality"
ESTIMATED = "interpolation; error estimated from two sets of nodes"
SOURCE = "Berrut & Trefethen 2004, Barycentric Lagrange interpolation, eq. 9.4"

LIMITS = {"albedo": (0.0, 1.0), "g": (-1.0, 1.0), "mu0": (0.0, 1.0), "mu": (0.0, 1.0)}
"""Where a parameter of that name lies; all others are taken to be >= 0 if they are, and free if they are not."""

AHEAD = {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 2}
"""Of the example."""

FACTORS = ("albedo", "intensity", "irradiance", "radiance", "background", "ambient", "emission")
"""Parameters that light along a ray is proportional to, one term of it at a time, at the same extinction."""

SAFETY = 10.0
"""By how much the difference of two interpolations is taken to be too small."""


@declared(
    unit="unit of the quantity / unit of the parameter",
    convention="by one parameter alone; of a homogeneous medium sigma_t changes at the same albedo, albedo at the same sigma_t",
    source=SOURCE,
    example={"of": {"quantity": "transmittance", "medium": FOG, "ray": AHEAD}, "wrt": "medium.sigma_t"},
    of=True,
)
def gradient(quantity: str | Callable[..., Reference], wrt: str, **arguments: Any) -> Reference:
    """Return the derivative of a quantity of the oracle by one of its parameters.

    quantity   a function of `fogproof.analytic` or its name
    wrt        the parameter: an argument ("albedo"), a field of one ("medium.sigma_t", "medium.phase.g"), an entry of an
               array ("medium.sigma_t[1,0,2]"). Of a homogeneous medium, sigma_t is changed at the same albedo, and albedo
               at the same sigma_t
    arguments  of the quantity

    Shape: that of the quantity, and behind it that of the parameter if it is an array of which no entry is chosen. Unit:
    that of the quantity over that of the parameter. The error is a bound wherever the quantity is a sum of non-negative
    terms in which the parameter stands in powers and exponentials: coefficients along a ray, g of single scattering, albedo
    and size of bodies. `method` tells the others, whose error is estimated.

    >>> from fogproof import analytic
    >>> from fogproof.scene import Medium, Ray
    >>> slope = analytic.gradient("transmittance", "medium.sigma_t", medium=Medium(0.5, 0.5), ray=Ray((0, 0, 0), (0, 0, 1), 2))
    >>> bool(abs(float(slope) - -2 * np.exp(-2)) <= slope.error <= 1e-13)
    True
    """
    name, function = named(quantity)
    wanted = parameter(wrt, arguments)
    shape = wanted.read(arguments).shape
    if not shape:
        return _one(name, function, arguments, wanted)
    if len(wanted.path) == 1 and not wanted.index:
        return _each(name, function, arguments, wanted)
    slopes = [_one(name, function, arguments, entry) for entry in wanted.entries(arguments)]
    _require_some(slopes, wanted)
    value, error = (np.stack([getattr(s, what) for s in slopes], axis=-1) for what in ("value", "error"))
    end = value.shape[:-1] + shape
    return Reference(value.reshape(end), error.reshape(end), max(s.method for s in slopes), SOURCE)


def _require_some(slopes: list[Reference], wanted: Parameter) -> None:
    if not slopes:
        fix = "an empty array has no derivative"
        raise InvalidValueError(".".join(map(str, wanted.path)), "must stand with one value at least", [], fix)


def named(quantity: str | Callable[..., Reference]) -> tuple[str, Callable[..., Reference]]:
    """Return the name and the function of a quantity that is given by either."""
    from fogproof import analytic

    function = getattr(analytic, quantity, None) if isinstance(quantity, str) else quantity
    known = declaration_of(function)
    if function is None or known is None or known.of:
        raise InvalidValueError("quantity", "must be a quantity of fogproof.analytic, or its name", quantity)
    return str(function.__name__), function


def _each(name: str, function: Callable[..., Reference], arguments: Mapping[str, Any], wanted: Parameter) -> Reference:
    """Return the derivatives where a parameter that broadcasts against other arguments has several values."""
    arrays = {
        key: np.asarray(x, dtype=float) for key, x in arguments.items() if isinstance(x, list | tuple | np.ndarray)
    }
    shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    flat = {key: np.broadcast_to(array, shape).ravel() for key, array in arrays.items()}
    slopes = [
        _one(name, function, {**arguments, **{key: float(x[i]) for key, x in flat.items()}}, wanted)
        for i in range(int(np.prod(shape)))
    ]
    _require_some(slopes, wanted)
    value, error = (np.stack([getattr(s, what) for s in slopes]) for what in ("value", "error"))
    end = shape + value.shape[1:]
    return Reference(value.reshape(end), error.reshape(end), max(s.method for s in slopes), SOURCE)


def _one(name: str, function: Callable[..., Reference], arguments: Mapping[str, Any], wanted: Parameter) -> Reference:
    """Return the derivative by a single number."""

    def at(x: float) -> Reference:
        return function(**wanted.replaced(arguments, x))

    place = float(wanted.read(arguments))
    if name in ("transmittance", "optical_thickness") and _thickness_is_linear(arguments, wanted):
        return _of_a_linear_thickness(name, arguments, wanted, place)
    if name in ALONG_A_RAY and wanted.path[-1] in FACTORS:
        return _of_a_straight_line(at, place, wanted.path[-1])
    best = least_error(at, place, discs(name, function, arguments, wanted))
    if best is not None:
        return Reference(*best, PROVEN, SOURCE)
    return Reference(*_estimated(at, place, wanted.path[-1]), ESTIMATED, SOURCE)


def least_error(
    f: Function, place: float, series: Sequence[Iterator[Disc]], order: int = 1
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the derivative with the least bound among all discs, element by element; None without any."""
    best: tuple[np.ndarray, np.ndarray] | None = None
    for smaller_and_smaller in series:
        previous: Any = np.inf
        for disc in smaller_and_smaller:
            value, error = derivative_from_values(f, place, disc, order)
            if best is None:
                best = value, error
            else:
                better = error < best[1]
                best = np.where(better, value, best[0]), np.where(better, error, best[1])
            if not np.any(error < 0.5 * previous):
                break  # smaller ones only carry more rounding
            previous = error
    return best


def _of_a_straight_line(f: Function, place: float, name: str) -> Reference:
    """Return the slope where a parameter is a factor of some terms, and of no other."""
    low, high = (0.0, 1.0) if name == "albedo" else (0.0, max(2 * place, 1.0))
    ends = f(low), f(high)
    value = (ends[1].value - ends[0].value) / (high - low)
    size = (np.abs(ends[1].value) + np.abs(ends[0].value)) / (high - low)
    return Reference(value, (ends[0].error + ends[1].error) / (high - low) + 4 * EPS * size, "closed form", SOURCE)


def _thickness_is_linear(arguments: Mapping[str, Any], wanted: Parameter) -> bool:
    medium = arguments.get("medium")
    return wanted.path[0] == "medium" and wanted.path[-1] in (given(medium, ROOM, "LINEAR_IN") or ())


def _of_a_linear_thickness(name: str, arguments: Mapping[str, Any], wanted: Parameter, place: float) -> Reference:
    """Return l = d tau/d s, or -l T, from two values of the thickness: it is a straight line in s."""
    from fogproof.analytic.rays.transmittance import optical_thickness, transmittance

    apart = max(place, 1.0)
    ends = [optical_thickness(**wanted.replaced(arguments, x)) for x in (0.0, place + apart)]
    length = (ends[1].value - ends[0].value) / (place + apart)
    error = (ends[1].error + ends[0].error) / (place + apart) + 8 * EPS * np.abs(length)
    if name == "optical_thickness":
        return Reference(length, error, "closed form", "Bouguer 1729")
    through = transmittance(**arguments)
    value = -length * through.value
    error = error * through.value + np.abs(length) * through.error + 2 * EPS * np.abs(value) + TINY
    return Reference(value, error, "closed form", "Bouguer 1729")


def _estimated(f: Function, place: float, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivative from two sets of nodes, and ten times their difference."""
    low, high = LIMITS.get(name, (0.0 if place >= 0 else -np.inf, np.inf))
    reach = min(0.2 * max(abs(place), 0.5), 0.5 * max(place - low, high - place))
    found = []
    for share, count in ((1.0, NODES), (0.7, NODES - 8)):
        a, b = max(place - share * reach, low), min(place + share * reach, high)
        nodes = place + np.where(
            (up := np.cos(np.pi * np.arange(count) / (count - 1))) < 0, -up * (a - place), up * (b - place)
        )
        nodes = np.unique(np.append(nodes, place))
        found.append(differentiated(f, nodes, int(np.searchsorted(nodes, place)), 1))
    (value, noise, size), (other, more, _) = found
    return value, SAFETY * np.abs(value - other) + noise + more + 64 * EPS * size
