"""Which phase function a medium has: parameters only. The oracle and the estimators each bring their own formulas.

Convention: mu is the *forward* cosine, (propagation direction in) . (propagation direction out); g is the mean of mu
and g > 0 scatters forward.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.complex_numbers import ComplexNumber, as_complex
from fogproof.scene.kinds import ByKind
from fogproof.validate import as_float_array, number, require


@dataclass(frozen=True)
class Isotropic:
    """Equal in all directions: 1/(4 pi) [1/sr]."""


@dataclass(frozen=True)
class HenyeyGreenstein:
    """Henyey & Greenstein 1941, with mean cosine `g` in the open interval (-1, 1)."""

    g: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", _asymmetry("g", self.g))


@dataclass(frozen=True)
class DoubleHenyeyGreenstein:
    """Two Henyey-Greenstein lobes: `weight` in [0, 1] of the one with mean cosine `g1`, the rest with `g2`."""

    g1: float
    g2: float
    weight: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "g1", _asymmetry("g1", self.g1))
        object.__setattr__(self, "g2", _asymmetry("g2", self.g2))
        object.__setattr__(self, "weight", number("weight", self.weight, "must lie in [0, 1]", 0, 1))


@dataclass(frozen=True)
class Schlick:
    """Schlick's rational stand-in for Henyey-Greenstein (Blasi, Le Saec & Schlick 1993), |k| < 1.

    Its mean cosine is about 2k/3 for small k; it is not the g of a Henyey-Greenstein function, however k was found.
    """

    k: float

    def __post_init__(self) -> None:
        rule, fix = "must lie in the open interval (-1, 1)", "beyond it the formula is not a density"
        object.__setattr__(self, "k", number("k", self.k, rule, -1, 1, open_ends=True, fix=fix))

    @classmethod
    def from_g(cls, g: float) -> Schlick:
        """Return the function with k = 1.55 g - 0.55 g^3, which looks like Henyey-Greenstein with this g.

        The fit is for moderate g: it exceeds 1 for 0.9381 < |g| < 1, where it is refused, and the mean cosine of the
        result is not g (0.8726 for g = 0.8).
        """
        g = _asymmetry("g", g)
        k = 1.55 * g - 0.55 * g**3
        if not abs(k) < 1:
            fix = f"here k = {k:.6g}, which is no density: give Schlick(k) directly"
            raise InvalidValueError("g", "must keep |1.55 g - 0.55 g^3| below 1, that is |g| < 0.9381", g, fix)
        return cls(k)


@dataclass(frozen=True)
class Hazy:
    """Hazy atmosphere, (1/2 + 9/2 u^8)/(4 pi) with u = (1 + mu)/2 (after Nishita, Miyawaki & Nakamae 1987)."""


@dataclass(frozen=True)
class Murky:
    """Murky atmosphere, (1/2 + 33/2 u^32)/(4 pi) with u = (1 + mu)/2 (after Nishita, Miyawaki & Nakamae 1987)."""


@dataclass(frozen=True)
class Rayleigh:
    """Scattering by particles much smaller than the wavelength, unpolarised light (Rayleigh 1871)."""


@dataclass(frozen=True)
class CornetteShanks:
    """Cornette & Shanks 1992: Henyey-Greenstein times 1 + mu^2; `g` in (-1, 1) is not the mean cosine."""

    g: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", _asymmetry("g", self.g))


@dataclass(frozen=True)
class Draine:
    """Draine 2003: Henyey-Greenstein times 1 + alpha mu^2, `g` in (-1, 1), `alpha` >= 0.

    alpha = 0 is Henyey-Greenstein, alpha = 1 Cornette-Shanks, g = 0 with alpha = 1 Rayleigh.
    """

    g: float
    alpha: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", _asymmetry("g", self.g))
        object.__setattr__(self, "alpha", number("alpha", self.alpha, "must be finite and >= 0", 0))


@dataclass(frozen=True)
class Mie:
    """Scattering of unpolarised light by a homogeneous sphere (Lorenz 1890, Mie 1908).

    diameter          of the sphere [m]
    wavelength        in vacuum [m]
    refractive_index  of the sphere, n + ik with n > 0 and k >= 0 (a positive imaginary part absorbs); [n, k] in files
    medium_index      real refractive index of what surrounds it
    """

    diameter: float
    wavelength: float
    refractive_index: ComplexNumber
    medium_index: float = 1.0

    def __post_init__(self) -> None:
        for name in ("diameter", "wavelength"):
            value = number(name, getattr(self, name), "must be finite and > 0 [m]", 0, np.inf, open_ends=True)
            object.__setattr__(self, name, value)
        medium = number("medium_index", self.medium_index, "must be finite and > 0", 0, np.inf, open_ends=True)
        object.__setattr__(self, "medium_index", medium)
        index = as_complex("refractive_index", self.refractive_index)
        if not (index.real > 0 and index.imag >= 0):
            fix = "absorption is a positive imaginary part here; take the conjugate of n - ik"
            raise InvalidValueError("refractive_index", "must be n + ik with n > 0 and k >= 0", index, fix)
        if index == medium:
            raise InvalidValueError(
                "refractive_index",
                "must differ from medium_index",
                index,
                "a sphere of the same index scatters nothing",
            )
        object.__setattr__(self, "refractive_index", index)


@dataclass(frozen=True)
class Tabulated:
    """Linear between `values` [1/sr] at increasing `cosines` from -1 to 1.

    The values must be normalised, 2 pi int_-1^1 f dmu = 1, to 1e-9; what remains is divided out.
    `Tabulated.normalised` scales values that are not.
    """

    cosines: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        total = _table_integral(self.cosines, self.values)
        if not abs(total - 1) <= 1e-9:
            rule = "must integrate to 1 over the sphere"
            raise InvalidValueError(
                "values", rule, total, "divide them by that, or use Tabulated.normalised(cosines, values)"
            )
        object.__setattr__(self, "cosines", tuple(as_float_array("cosines", self.cosines).tolist()))
        object.__setattr__(self, "values", tuple(as_float_array("values", self.values).tolist()))

    @classmethod
    def normalised(cls, cosines: Any, values: Any) -> Tabulated:
        """Return the function proportional to the piecewise linear one through `values` at `cosines`."""
        total = _table_integral(cosines, values)
        if not 0 < total < np.inf:
            raise InvalidValueError("values", "must have a positive finite integral", total)
        return cls(cosines, tuple((as_float_array("values", values) / total).tolist()))


@dataclass(frozen=True)
class Mixture:
    """A weighted mean of phase functions: `weights` >= 0 that sum to 1 (to 1e-9; what remains is divided out)."""

    components: tuple[PhaseFunctionField, ...]
    weights: tuple[float, ...]

    def __post_init__(self) -> None:
        components = self.components
        if not (isinstance(components, tuple | list) and components):
            raise InvalidValueError("components", "must be a list of phase functions", components)
        for component in components:
            if not isinstance(component, PhaseFunction):
                raise InvalidValueError("components", "must be a list of phase functions", component)
        weights = as_float_array("weights", self.weights)
        if weights.shape != (len(components),):
            fix = f"there are {len(components)} components"
            raise InvalidValueError("weights", "must be one number a component", self.weights, fix)
        require("weights", weights, np.isfinite(weights) & (weights >= 0), "must be finite and >= 0")
        if not abs(weights.sum() - 1) <= 1e-9:
            raise InvalidValueError("weights", "must sum to 1", weights.sum(), "divide each by their sum")
        object.__setattr__(self, "components", tuple(components))
        object.__setattr__(self, "weights", tuple(weights.tolist()))


def _asymmetry(name: str, value: Any) -> float:
    fix = "at the ends the phase function is a delta, which has no density"
    return number(name, value, "must lie in the open interval (-1, 1)", -1, 1, open_ends=True, fix=fix)


def _table_integral(cosines: Any, values: Any) -> float:
    """Return 2 pi int f dmu of a table whose shape and signs have been checked."""
    c, f = as_float_array("cosines", cosines), as_float_array("values", values)
    if c.ndim != 1 or c.size < 2:
        raise InvalidValueError("cosines", "must be a list of at least two numbers", cosines)
    require("cosines", c, np.isfinite(c), "must be finite")
    if c[0] != -1 or c[-1] != 1 or not (np.diff(c) > 0).all():
        raise InvalidValueError("cosines", "must increase from -1 to 1", cosines)
    if f.shape != c.shape:
        raise InvalidValueError("values", "must be one number a cosine", values, f"there are {c.size} cosines")
    require("values", f, np.isfinite(f) & (f >= 0), "must be finite and >= 0 [1/sr]")
    return float(np.pi * np.sum(np.diff(c) * (f[1:] + f[:-1])))


PhaseFunction = (
    Isotropic
    | HenyeyGreenstein
    | DoubleHenyeyGreenstein
    | Schlick
    | Hazy
    | Murky
    | Rayleigh
    | CornetteShanks
    | Draine
    | Mie
    | Tabulated
    | Mixture
)
PHASE_FUNCTIONS: dict[str, type[PhaseFunction]] = {
    "isotropic": Isotropic,
    "henyey-greenstein": HenyeyGreenstein,
    "double-henyey-greenstein": DoubleHenyeyGreenstein,
    "schlick": Schlick,
    "hazy": Hazy,
    "murky": Murky,
    "rayleigh": Rayleigh,
    "cornette-shanks": CornetteShanks,
    "draine": Draine,
    "mie": Mie,
    "tabulated": Tabulated,
    "mixture": Mixture,
}
"""The `kind` of each phase function in files and requests."""

PhaseFunctionField = Annotated[PhaseFunction, ByKind(PHASE_FUNCTIONS)]
