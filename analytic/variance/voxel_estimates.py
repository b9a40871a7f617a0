"""Mean, variance and cost of one realisation of estimators of the transmittance along a ray through a few voxels, exactly.

The voxels have constant extinctions sigma_i on lengths l_i. What an estimator draws is then discrete, or exponential piece by
piece: its law is written out and summed, or integrated in closed form. Nothing is simulated, and biased estimators have their bias.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.variance import comb_estimates, walk_estimates
from fogproof.analytic.variance.voxel_ray import EstimateMoments, VoxelRay, voxel_ray
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.arrays import AxisArray
from fogproof.validate import number

Estimate = Literal["march", "telescoping", "unbiased-march", "power-series", "weighted", "decomposition", "next-flight"]

SOURCE = "the law of one realisation, written out"

EXAMPLE = {"sigma": [0.5, 3], "length": [1, 0.7]}


@quantity(
    unit="1",
    convention="mean of one realisation: the transmittance, unless the estimator is biased",
    source="Kettunen et al. 2021; Misso et al. 2022; Georgiev et al. 2019; the law written out",
    example={**EXAMPLE, "estimate": "march", "points": 4},
)
def voxel_estimate_mean(
    sigma: AxisArray,
    length: AxisArray,
    estimate: Estimate,
    majorant: float | None = None,
    control: float = 0.0,
    pivot: float | None = None,
    reach: float = 2.0,
    points: int = 4,
    ratio: float = 0.35,
) -> Reference:
    """Return E[w] of an estimate w of the transmittance, of shape ().

    sigma     (k,) extinction of each voxel that the ray crosses [1/m]
    length    (k,) way in each [m]
    estimate  "march": exp(-depth) by `points` equidistant looks behind a random offset, which is biased. "telescoping": that,
              debiased by differences of marches twice as fine, each `ratio` times as likely as the one before. "unbiased-march": a
              power series around marches of `points` looks. "power-series": around `pivot`, on to order k with probability
              min(1, `reach`/k). "weighted": delta tracking with a `majorant` that need not bound. "decomposition":
              exp(-`control` s) times delta tracking of the rest. "next-flight": the expected flights of ratio tracking
    majorant  rate of tentative collisions [1/m]; None for the greatest sigma
    control   part of the extinction in closed form [1/m], at most the least sigma
    pivot     optical depth to expand around; None for that of the greatest sigma on the whole way
    reach     order up to which a power series nearly always goes
    points    looks of a (coarsest) march, at most 4096
    ratio     in (1/4, 1/2)

    Error: rounding of sums of the law, and what is left out of them.
    """
    moments = _moments(voxel_ray(sigma, length), estimate, majorant, control, pivot, reach, points, ratio)
    return _answer(moments.mean, moments.mean_error, estimate)


@quantity(
    unit="1",
    convention="variance of one realisation, about its own mean",
    source="Kettunen et al. 2021; Misso et al. 2022; Georgiev et al. 2019; the law written out",
    example={**EXAMPLE, "estimate": "unbiased-march", "points": 2},
)
def voxel_estimate_variance(
    sigma: AxisArray,
    length: AxisArray,
    estimate: Estimate,
    majorant: float | None = None,
    control: float = 0.0,
    pivot: float | None = None,
    reach: float = 2.0,
    points: int = 4,
    ratio: float = 0.35,
) -> Reference:
    """Return Var[w] of an estimate of the transmittance, of shape ().

    Arguments and error as in `voxel_estimate_mean`.
    """
    moments = _moments(voxel_ray(sigma, length), estimate, majorant, control, pivot, reach, points, ratio)
    return _answer(max(moments.variance, 0.0), moments.variance_error, estimate)


@quantity(
    unit="1",
    convention="expected look-ups of the extinction in one realisation",
    source="Kettunen et al. 2021; Misso et al. 2022; Georgiev et al. 2019; the law written out",
    example={**EXAMPLE, "estimate": "next-flight", "majorant": 4},
)
def voxel_estimate_cost(
    sigma: AxisArray,
    length: AxisArray,
    estimate: Estimate,
    majorant: float | None = None,
    control: float = 0.0,
    pivot: float | None = None,
    reach: float = 2.0,
    points: int = 4,
    ratio: float = 0.35,
) -> Reference:
    """Return the expected number of look-ups of one realisation, of shape ().

    Arguments and error as in `voxel_estimate_mean`.
    """
    moments = _moments(voxel_ray(sigma, length), estimate, majorant, control, pivot, reach, points, ratio)
    return _answer(moments.cost, 64 * EPS * moments.cost, estimate)


def _answer(value: float, error: float, estimate: str) -> Reference:
    return Reference(np.asarray(value), np.asarray(error + TINY), f"the law of {estimate}, summed", SOURCE)


def _moments(ray: VoxelRay, estimate: Estimate, *parameters: Any) -> EstimateMoments:
    """Return the moments of the estimator, or refuse where one of them is no float64."""
    try:
        return _moments_of(ray, estimate, *parameters)
    except OverflowError:
        what = f"a moment of the estimate {estimate!r} is beyond 1.8e308"
        raise UnsupportedError(f"{what}: take a larger majorant, or more points", "estimate") from None


def _moments_of(
    ray: VoxelRay,
    estimate: Estimate,
    majorant: float | None,
    control: float,
    pivot: float | None,
    reach: float,
    points: int,
    ratio: float,
) -> EstimateMoments:
    """Check the arguments that the estimator has, and return its moments."""
    if estimate in ("march", "telescoping", "unbiased-march"):
        if isinstance(points, bool) or not isinstance(points, int | np.integer) or not 1 <= points <= 4096:
            raise InvalidValueError("points", "must be a whole number in [1, 4096]", points)
        if estimate == "march":
            return comb_estimates.march(ray, int(points))
        if estimate == "unbiased-march":
            return comb_estimates.unbiased_march(ray, int(points))
        ratio = number("ratio", ratio, "must lie in the open interval (1/4, 1/2)", 0.25, 0.5, open_ends=True)
        return comb_estimates.telescoping(ray, int(points), ratio)
    if estimate == "power-series":
        whole = float(max(ray.sigma) * sum(ray.length))
        pivot = whole if pivot is None else number("pivot", pivot, "must be finite and >= 0", 0)
        reach = number("reach", reach, "must lie in (0, 10000]", 1e-300, 1e4)
        return walk_estimates.power_series(ray, pivot, reach)
    if estimate not in get_args(Estimate):
        raise InvalidValueError("estimate", f"must be one of {', '.join(get_args(Estimate))}", estimate)
    highest, lowest = float(max(ray.sigma)), float(min(ray.sigma))
    rate = (
        highest if majorant is None else number("majorant", majorant, "must be finite and > 0 [1/m]", 0, open_ends=True)
    )
    if rate == 0:
        raise InvalidValueError("majorant", "must be > 0 [1/m]", rate, "in a vacuum no estimator has anything to do")
    if estimate == "weighted":
        return walk_estimates.weighted(ray, rate)
    if estimate == "next-flight":
        return walk_estimates.next_flight(ray, rate)
    control = number("control", control, f"must lie in [0, {lowest:g}], the least sigma [1/m]", 0, lowest)
    if rate < highest:
        fix = "decomposition tracking is biased there"
        raise InvalidValueError("majorant", f"must not lie below the greatest sigma {highest:g} [1/m]", rate, fix)
    return walk_estimates.decomposition(ray, rate, control)
