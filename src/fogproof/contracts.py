"""What is checked, and what says what is right: the protocols that users' code fulfils without inheriting anything."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from fogproof.domains import Domain
from fogproof.errors import InvalidValueError
from fogproof.validate import as_float_array, require


@dataclass(frozen=True, eq=False)
class Reference:
    """What the oracle says: `|value - truth| <= error`, element by element.

    value   a number or an array of them; colour channels, if any, are the last axis
    error   a bound >= 0 on how far each is from the truth; broadcasts against `value`; inf says that nothing is known
    method  names the algorithm
    source  the paper

    Entries of a table that are not there are NaN, which no check accepts. A plain number is a reference without error:

    >>> float(Reference(0.5))
    0.5
    >>> Reference([0.25, 0.5], error=1e-9).error.shape
    ()
    """

    value: np.ndarray
    error: np.ndarray = 0.0  # type: ignore[assignment]  # numbers are turned into arrays
    method: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        value, error = as_float_array("value", self.value), as_float_array("error", self.error)
        try:
            np.broadcast_shapes(value.shape, error.shape)
        except ValueError:
            rule = f"must broadcast against value, of shape {value.shape}"
            raise InvalidValueError("error", rule, list(error.shape)) from None
        require("error", error, ~(error < 0), "must be >= 0", "it bounds |value - truth|")
        object.__setattr__(self, "value", value)
        object.__setattr__(self, "error", error)

    def __float__(self) -> float:
        if self.value.size != 1:
            rule = "must hold a single number to become a float"
            raise InvalidValueError("reference", rule, list(self.value.shape), "take reference.value")
        return float(self.value.reshape(()))

    @staticmethod
    def of(name: str, value: Reference | float | Any) -> Reference:
        """Return `value` if it is a `Reference`, else the reference whose exact value it is; `name` is for the error."""
        if isinstance(value, Reference):
            return value
        array = as_float_array(name, value)
        require(name, array, np.isfinite(array), "must be finite")
        return Reference(array)


class Draw(NamedTuple):
    """One batch of a sampler. Only `x` is required.

    x       (n,) or (n, k) points of the domain
    pdf     (n,) the density the sampler claims at x; at a declared atom, its probability
    weight  (n,) or (n, channels) eval(x) / pdf(x)
    event   (n,) integer labels (0 medium, 1 surface by convention of the free-path samplers)
    valid   (n,) bool; False marks a sample that the sampler itself gave up on
    """

    x: np.ndarray
    pdf: np.ndarray | None = None
    weight: np.ndarray | None = None
    event: np.ndarray | None = None
    valid: np.ndarray | None = None


class Draws(NamedTuple):
    """One batch of an estimator. Only `value` is required.

    value   (n,) or (n, channels) independent realisations
    cost    (n,) work done, in look-ups of the medium
    order   (n,) scattering order of each realisation
    stderr  (n,), or (n, channels), standard errors that the estimator itself reports
    """

    value: np.ndarray
    cost: np.ndarray | None = None
    order: np.ndarray | None = None
    stderr: np.ndarray | None = None


@runtime_checkable
class Sampler(Protocol):
    """A pure function of uniforms, with the density it claims.

    Optional: `cdf(x)` (the Rosenblatt map on k dimensions), `atoms` (a dict from point to probability), `eval(x)`.
    """

    @property
    def domain(self) -> Domain:
        """Where the samples live."""

    @property
    def dimensions(self) -> int | None:
        """Uniforms consumed by one sample; None for samplers that take `(rng, n)` and use a varying number."""

    def sample(self, u: np.ndarray, /) -> Any:
        """Map (n, dimensions) uniforms in [0, 1) to points, or to a `Draw`."""

    def pdf(self, x: np.ndarray, /) -> np.ndarray:
        """Return the density of the continuous part at x, in the measure of the domain."""


@runtime_checkable
class Estimator(Protocol):
    """Something that draws independent realisations of a quantity."""

    def draw(self, rng: np.random.Generator, n: int, /) -> Any:
        """Return n realisations: (n,), (n, channels) or a `Draws`."""


Progress = Callable[[str, int, int], None]
"""Called as (what, done, total)."""
