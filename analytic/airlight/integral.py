"""The airlight integral: light of a point source scattered once towards a camera by a homogeneous medium.

    I = int_a^b exp(-sigma_t ((t - a) + r)) / r^2  4 pi f_p(-t/r) dt,    r^2 = t^2 + h^2          [1/m]

t is measured along the ray from the foot of the perpendicular from the light, whose distance is h; the camera is at a.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np

from fogproof.analytic.airlight import asinh as airlight_asinh
from fogproof.analytic.airlight import equiangular as airlight_equiangular
from fogproof.analytic.airlight import pegoraro2009 as airlight_pegoraro2009
from fogproof.analytic.airlight import pegoraro2010 as airlight_pegoraro2010
from fogproof.analytic.airlight import sun2005 as airlight_sun2005
from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.airlight.segments import Segments, whole
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.proven.airlight import rigorous_airlight
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.arrays import AxisArray, FloatArray
from fogproof.scene.phase import Isotropic, PhaseFunction, PhaseFunctionField
from fogproof.validate import as_float_array, require

Method = Literal["asinh", "equiangular", "sun2005", "pegoraro2009", "pegoraro2010"]
"""Ways to the airlight integral; all but "asinh" are there to be compared with it."""

ALTERNATIVES: dict[str, Any] = {
    "equiangular": airlight_equiangular,
    "sun2005": airlight_sun2005,
    "pegoraro2009": airlight_pegoraro2009,
    "pegoraro2010": airlight_pegoraro2010,
}
"""Each has METHOD, SOURCE and `integrate(sigma, h, a, b, phase) -> (value, error)`, arrays of one axis."""

WORST = 0.01
"""Relative error beyond which an alternative method has nothing to say."""


@quantity(
    unit="1/m",
    convention="integral over t in [a, b] of exp(-sigma_t ((t - a) + r)) / r^2 4 pi f_p(-t/r), r^2 = t^2 + h^2",
    source="Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model, eq. 5",
    example={"sigma_t": 0.5, "h": [0.1, 1, 10], "a": -2, "b": "inf", "phase": {"kind": "henyey-greenstein", "g": 0.6}},
)
def airlight_integral(
    sigma_t: FloatArray,
    h: FloatArray,
    a: FloatArray,
    b: FloatArray,
    phase: PhaseFunctionField | None = None,
    method: Method = "asinh",
    *,
    rigorous: bool = False,
) -> Reference:
    """Return the integral over t in [a, b] of exp(-sigma_t ((t - a) + r)) / r^2  4 pi f_p(-t/r), r^2 = t^2 + h^2 [1/m].

    sigma_t   extinction coefficient [1/m], >= 0
    h         distance of the light from the line of the ray [m], >= 0
    a, b      the segment, as coordinates along the ray from the foot of the perpendicular [m]: camera at a, surface at
              b >= a, which may be inf
    phase     phase function, isotropic unless given; its forward cosine at t is -t/r
    method    "asinh" is accurate everywhere; "equiangular", "sun2005", "pegoraro2009" and "pegoraro2010" are there to be
              compared, with an honest error, and refuse where that exceeds 1 % or the phase function is not theirs
    rigorous  prove the result by ball arithmetic, whatever the method (slow; phase functions with a formula)

    All four broadcast. The inputs are taken as exact. With "asinh" the relative error is below 1e-14 for isotropic,
    Henyey-Greenstein, Schlick and Rayleigh scattering until the result underflows. A light on the segment (h = 0) gives
    inf.
    Source: Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model, eq. 5 (isotropic).
    """
    sigma_t, h, a, b = _checked(sigma_t, h, a, b)
    if rigorous:
        return rigorous_airlight(sigma_t, h, a, b, phase or Isotropic())
    segments = whole(sigma_t.ravel(), h.ravel(), a.ravel(), b.ravel())
    value, error, name, source = integrate(segments, phase or Isotropic(), method)
    refuse_beyond(method, value, error)
    return Reference(value.reshape(h.shape), error.reshape(h.shape), name, source)


@quantity(
    unit="1/m",
    convention="airlight_integral on the grid of h, a and b, in this order of axes",
    source="Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model, eq. 5",
    example={"sigma_t": 0.5, "h": [0.1, 1], "a": [-2, -1], "b": [0, 1, 2]},
)
def airlight_table(
    sigma_t: float,
    h: AxisArray,
    a: AxisArray,
    b: AxisArray,
    phase: PhaseFunctionField | None = None,
    method: Method = "asinh",
) -> Reference:
    """Return the airlight integral at every h, a, b of a table, (len(h), len(a), len(b)) [1/m]; NaN where b < a.

    h, a, b  one-dimensional, as in `airlight_integral`, whose other arguments and promises are the same
    """
    axes = {"h": as_float_array("h", h), "a": as_float_array("a", a), "b": as_float_array("b", b)}
    for name, axis in axes.items():
        if axis.ndim != 1:
            raise InvalidValueError(name, "must have one axis", list(axis.shape), "give the grid of the table")
    H, A, B = np.meshgrid(*axes.values(), indexing="ij")
    there = B >= A
    reference = airlight_integral(sigma_t, H[there], A[there], B[there], phase, method)
    value, error = np.full((2, *there.shape), np.nan)
    value[there], error[there] = reference.value, reference.error
    return Reference(value, error, reference.method, reference.source)


def integrate(
    segments: Segments, phase: PhaseFunction, method: Method = "asinh"
) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Return value, error (n,), method and source of the integral over segments."""
    if method == "asinh":
        return *airlight_asinh.integrate(segments, airlight_phase(phase)), airlight_asinh.METHOD, airlight_asinh.SOURCE
    if method not in ALTERNATIVES:
        raise InvalidValueError("method", f"must be one of {', '.join(get_args(Method))}", method)
    module = ALTERNATIVES[method]
    sigma, h, start, end = segments.sigma, segments.h, segments.start, segments.end
    with np.errstate(all="ignore"):
        value, error = module.integrate(sigma, h, start, end, phase)
        tau = sigma * (start - segments.a)
        lit = np.exp(-tau)
        value, error = value * lit, (error + (2 + tau) * EPS * value) * lit + TINY
        on_light = (h == 0) & (start <= 0) & (end >= 0) & (end > start)
        value[on_light], error[on_light] = np.inf, 0.0
    return value, error, module.METHOD, module.SOURCE


def refuse_beyond(method: Method, value: np.ndarray, error: np.ndarray) -> None:
    """Raise `UnsupportedError` if an alternative method leaves any element without two digits."""
    with np.errstate(invalid="ignore"):
        bad = ~(error <= WORST * np.abs(value) + 1e-300)
    if method != "asinh" and bad.any():
        raise UnsupportedError(
            f"{ALTERNATIVES[method].METHOD} does not deliver two digits for {bad.sum()} of {bad.size} rays, the first "
            f"at index {int(np.argmax(bad))}; use method='asinh'",
            "method",
        )


def _checked(sigma_t: Any, h: Any, a: Any, b: Any) -> list[np.ndarray]:
    """Return the arguments of an airlight integral as float64 arrays of one shape, or say what is wrong with them."""
    sigma_t, h, a, b = (as_float_array(*item) for item in {"sigma_t": sigma_t, "h": h, "a": a, "b": b}.items())
    require("sigma_t", sigma_t, np.isfinite(sigma_t) & (sigma_t >= 0), "must be finite and >= 0 [1/m]")
    require("h", h, np.isfinite(h) & (h >= 0), "must be finite and >= 0 [m]", "h is a distance from the line")
    require("a", a, np.isfinite(a), "must be finite [m]", "the camera is somewhere")
    try:
        arrays = list(np.broadcast_arrays(sigma_t, h, a, b))
    except ValueError:
        shapes = [x.shape for x in (sigma_t, h, a, b)]
        raise InvalidValueError("sigma_t", "must broadcast with h, a and b", shapes) from None
    require("b", arrays[3], arrays[3] >= arrays[2], "must be >= a [m]", "the surface is at b; inf if there is none")
    return arrays
