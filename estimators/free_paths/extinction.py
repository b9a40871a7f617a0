"""Extinction along a ray as a function of the distance t: its value, the optical depth up to t, and where a depth is reached.

Each kind has sigma(t) [1/m], depth(t) [1] and reach(depth) [m], elementwise, in the precision of their arguments; reach is inf
where the depth is never reached. All are for t >= 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.medium_data import grey_medium, look_ups
from fogproof.estimators.tracking.optical_depth import optical_depth
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import box
from fogproof.validate import number


class Extinction(Protocol):
    """What the kinds below have in common."""

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient at distances t [1/m]."""

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth from 0 to t; t may be inf."""

    def reach(self, depth: np.ndarray) -> np.ndarray:
        """Return the distance at which the optical depth is `depth`, inf if there is none [m]."""


@dataclass(frozen=True)
class Constant:
    """The same extinction sigma_t [1/m] everywhere."""

    sigma_t: float

    def __post_init__(self) -> None:
        number("sigma_t", self.sigma_t, "must be finite and >= 0 [1/m]", 0)

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient."""
        return np.broadcast_to(t.dtype.type(self.sigma_t), t.shape)

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth."""
        with np.errstate(over="ignore"):  # beyond 1.8e308 nothing is transmitted, as at inf
            return self.sigma_t * t if self.sigma_t > 0 else np.zeros_like(t)

    def reach(self, depth: np.ndarray) -> np.ndarray:
        """Return the distance at which the optical depth is reached."""
        return depth / self.sigma_t if self.sigma_t > 0 else np.full_like(depth, np.inf)


@dataclass(frozen=True)
class Linear:
    """sigma(t) = max(0, sigma_0 + slope t).

    sigma_0  [1/m], may be negative: then vacuum comes first
    slope    [1/m^2], may be negative: then vacuum comes last
    """

    sigma_0: float
    slope: float

    def __post_init__(self) -> None:
        number("sigma_0", self.sigma_0, "must be finite [1/m]")
        number("slope", self.slope, "must be finite [1/m^2]")

    @property
    def _vacuum(self) -> bool:
        return self.sigma_0 <= 0 and self.slope <= 0

    @property
    def _start(self) -> float:
        """Where the extinction becomes positive."""
        return max(-self.sigma_0, 0.0) / self.slope if self.slope > 0 else 0.0

    @property
    def _end(self) -> float:
        """Where it becomes 0 again."""
        return self.sigma_0 / -self.slope if self.slope < 0 else np.inf

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient."""
        return np.maximum(self.sigma_0 + self.slope * t, 0) if self.slope else Constant(max(self.sigma_0, 0)).sigma(t)

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth."""
        if self.slope == 0:
            return Constant(max(self.sigma_0, 0.0)).depth(t)
        if self._vacuum:
            return np.zeros_like(t)
        s = np.clip(t, self._start, self._end) - self._start
        return s * (max(self.sigma_0, 0.0) + 0.5 * self.slope * s)

    def reach(self, depth: np.ndarray) -> np.ndarray:
        """Return the distance: 2 depth/(sigma_0 + sqrt(sigma_0^2 + 2 slope depth)) after the vacuum, whatever the slope's sign.

        The square root is that of a product of sums of roots, which neither overflows nor underflows.
        """
        base = max(self.sigma_0, 0.0)
        if self._vacuum:
            return np.full_like(depth, np.inf)
        bent = np.sqrt(2 * abs(self.slope)) * np.sqrt(depth)
        root = np.hypot(base, bent) if self.slope > 0 else np.sqrt(np.maximum(base - bent, 0)) * np.sqrt(base + bent)
        whole = base + root
        run = np.divide(2 * depth, whole, out=np.zeros_like(depth), where=whole > 0)
        return self._start + run if self.slope > 0 else np.where(bent <= base, run, np.inf)


@dataclass(frozen=True)
class Exponential:
    """sigma(t) = sigma_0 exp(rate t).

    sigma_0  [1/m], >= 0
    rate     [1/m], of either sign
    """

    sigma_0: float
    rate: float

    def __post_init__(self) -> None:
        number("sigma_0", self.sigma_0, "must be finite and >= 0 [1/m]", 0)
        number("rate", self.rate, "must be finite [1/m]")

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient."""
        return self.sigma_0 * np.exp(self.rate * t) if self.sigma_0 > 0 else np.zeros_like(t)

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth."""
        end = self.sigma_0 / -self.rate if self.rate < 0 else np.inf if self.sigma_0 > 0 else 0.0
        finite = np.isfinite(t)
        s = np.where(finite, t, 0)
        x = self.rate * s
        with np.errstate(over="ignore", invalid="ignore"):
            bent = np.where(x == 0, 1, np.expm1(x) / x)
            return np.where(finite, self.sigma_0 * s * bent, end)

    def reach(self, depth: np.ndarray) -> np.ndarray:
        """Return the distance: log1p(x)/x times depth/sigma_0, x = rate depth/sigma_0, and inf where x is not above -1."""
        if self.sigma_0 == 0:
            return Constant(0.0).reach(depth)
        straight = depth / self.sigma_0
        x = self.rate * straight
        with np.errstate(invalid="ignore", divide="ignore"):
            bent = np.where(x == 0, 1, np.log1p(x) / x)
            return np.where(x > -1, straight * bent, np.inf)


@dataclass(frozen=True)
class Vanishing:
    """sigma(t) = 1/(end - t) from start to end: OpenGL's linear fog, whose transmittance falls linearly to 0.

    start, end  [m], 0 <= start < end
    """

    start: float
    end: float

    def __post_init__(self) -> None:
        number("start", self.start, "must be finite and >= 0 [m]", 0)
        if not number("end", self.end, "must be finite [m]") > self.start:
            raise InvalidValueError("end", f"must be greater than start = {self.start:g} [m]", self.end)

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient."""
        inside = (t >= self.start) & (t < self.end)
        return np.divide(1, self.end - t, out=np.zeros_like(t), where=inside)

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth."""
        left = np.clip((self.end - t) / (self.end - self.start), 0, 1)
        with np.errstate(divide="ignore"):
            return -np.log(left)

    def reach(self, depth: np.ndarray) -> np.ndarray:
        """Return the distance, which is below `end` for every finite depth."""
        below = np.nextafter(depth.dtype.type(self.end), depth.dtype.type(0))
        return np.minimum(self.start - (self.end - self.start) * np.expm1(-depth), below)


@dataclass(frozen=True, eq=False)
class LookedUp:
    """The extinction of any grey medium along a ray, looked up point by point; where a depth is reached is not known.

    ray  one ray; t counts from its origin
    """

    medium: AnyMedium
    ray: Ray

    def sigma(self, t: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient, 0 outside of what the medium fills."""
        x = self.ray.origin + t[:, None] * self.ray.direction
        lower, upper = box(self.medium)
        inside = np.all((x >= lower) & (x <= upper), axis=-1)
        sigma = look_ups(self.medium)(x, np.broadcast_to(self.ray.direction, x.shape))[:, 0]
        return np.where(inside, sigma, 0.0)

    def depth(self, t: np.ndarray) -> np.ndarray:
        """Return the optical depth, cell by cell or by quadrature."""
        return optical_depth(self.medium, self.ray, np.atleast_1d(t))[:, 0].reshape(np.shape(t))

    def reach(self, depth: np.ndarray) -> np.ndarray:
        """Say that trackers know."""
        raise UnsupportedError(
            f"no closed form of the free path in a {type(self.medium).__name__}; track it instead", "medium"
        )


def as_extinction(value: Extinction | float) -> Extinction:
    """Return an extinction; a number is a constant sigma_t [1/m]."""
    return Constant(value) if isinstance(value, int | float) else value


def along(medium: AnyMedium, ray: Ray) -> Extinction:
    """Return the extinction along one ray of a grey medium, in closed form where there is one."""
    if ray.shape:
        raise UnsupportedError(f"an estimator looks along one ray, got a batch of shape {ray.shape}", "ray")
    own = given(medium, ROOM, "along")
    found: Extinction = own(medium, ray) if own is not None else LookedUp(grey_medium(medium), ray)
    return found
