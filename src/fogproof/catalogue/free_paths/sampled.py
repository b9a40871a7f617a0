"""Free-path samplers against the oracle's transmittance: a density before the surface, a probability at it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import coefficients, transmittance
from fogproof.catalogue.cases import Altered, SamplerCase, Twin
from fogproof.contracts import Draw, Reference
from fogproof.estimators import Constant, FreePath, HomogeneousSpectralFreePath, Linear, TruncatedFreePath, along
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, OpenGLFog, Ray

_START = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
_FARTHEST = 1e300


def _transmittance(medium: AnyMedium, t: np.ndarray) -> Reference:
    """Return the oracle's transmittance to distances t (n,), 1 at t = 0; (n, channels) if the medium has any."""
    return transmittance(medium, Ray(*_START, np.clip(t, np.finfo(float).tiny, _FARTHEST)))


def _sigma_t(medium: AnyMedium, t: np.ndarray) -> np.ndarray:
    return coefficients(medium, np.multiply.outer(t, _START[1]), _START[1]).sigma_t


def _density(medium: AnyMedium, length: float) -> Callable[[np.ndarray], Reference]:
    """The density of collisions is sigma_t T(t), minus the derivative of the transmittance: on average over the channels,
    and divided by the probability of a collision before `length`."""

    def reference(t: np.ndarray) -> Reference:
        through, sigma = _transmittance(medium, t), _sigma_t(medium, t)
        nearby = np.abs(_sigma_t(medium, t * (1 + 4e-16)) - sigma) + np.abs(_sigma_t(medium, t * (1 - 4e-16)) - sigma)
        value = sigma * through.value
        error = sigma * through.error + nearby * through.value + 1e-15 * value
        if medium.channels is not None:
            value, error = value.mean(axis=-1), error.mean(axis=-1)
        within = _within(medium, length)
        return Reference(value / within, (error + 1e-15 * value) / within, through.method, through.source)

    return reference


def _within(medium: AnyMedium, length: float) -> float:
    """Return the probability of a collision before `length`; 1 for inf, which stands for no truncation."""
    if length == np.inf:
        return 1.0
    lost = 1 - float(_transmittance(medium, np.array([length])).value[0])
    return lost if lost > 0.1 else float(-np.expm1(-_sigma_t(medium, np.zeros(1))[0] * length))


def _cdf(medium: AnyMedium, surface: float, length: float) -> Callable[[np.ndarray], np.ndarray]:
    def cdf(t: np.ndarray) -> np.ndarray:
        through = _transmittance(medium, t).value
        if medium.channels is not None:
            through = through.mean(axis=-1)
        return np.where(t >= min(surface, length), 1.0, (1 - through) / _within(medium, length))

    return cdf


def _case(
    name: str,
    title: str,
    medium: AnyMedium,
    make: Callable[[], Any],
    error: str,
    sample: Any = None,
    pdf: Any = None,
    *,
    length: float = np.inf,
    source: str = "Beer-Lambert law",
    with_cdf: bool = True,
    **options: Any,
) -> SamplerCase:
    cdf = _cdf(medium, getattr(make(), "surface", np.inf), length)
    return SamplerCase(
        name=f"free-path/{name}",
        title=title,
        make=make,
        reference=_density(medium, length),
        oracle="transmittance",
        source=source,
        twin=Twin(error, lambda: Altered(make(), sample, pdf)),
        options={**({"cdf": cdf} if with_cdf else {}), **options},
    )


def _homogeneous(
    name: str,
    title: str,
    sigma_t: float,
    surface: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    **options: Any,
) -> SamplerCase:
    return _case(name, title, Medium(sigma_t, 0.0), lambda: FreePath(sigma_t, surface), error, sample, pdf, **options)


def _graded(
    name: str,
    title: str,
    medium: AnyMedium,
    surface: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    **options: Any,
) -> SamplerCase:
    def make() -> FreePath:
        return FreePath(along(medium, Ray(*_START)), surface)

    return _case(name, title, medium, make, error, sample, pdf, **options)


def _truncated(
    name: str,
    title: str,
    medium: AnyMedium,
    length: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    with_cdf: bool = True,
    **options: Any,
) -> SamplerCase:
    def make() -> TruncatedFreePath:
        return TruncatedFreePath(along(medium, Ray(*_START)), length)

    return _case(
        f"truncated/{name}", title, medium, make, error, sample, pdf, length=length, with_cdf=with_cdf, **options
    )


def _spectral(
    name: str,
    title: str,
    sigma_t: tuple[float, ...],
    surface: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
) -> SamplerCase:
    medium = Medium(sigma_t, (0.0,) * len(sigma_t))

    def make() -> HomogeneousSpectralFreePath:
        return HomogeneousSpectralFreePath(sigma_t, surface)

    source = "Veach & Guibas 1995, balance heuristic of one sample"
    return _case(f"spectral/{name}", title, medium, make, error, sample, pdf, source=source)


def _sigma(sampler: FreePath) -> float:
    assert isinstance(sampler.extinction, Constant)
    return sampler.extinction.sigma_t


def _log10(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    return -np.log10(1 - u[:, 0]) / _sigma(sampler)


def _log_of_zero(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return -np.log(u[:, 0]) / _sigma(sampler)


def _without_sigma(sampler: FreePath, t: np.ndarray) -> np.ndarray:
    return np.exp(-_sigma(sampler) * t)


def _cdf_without_sigma(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    return -np.log1p(-_sigma(sampler) * u[:, 0]) / _sigma(sampler)


def _density_at_surface(sampler: FreePath, u: np.ndarray) -> Draw:
    draw = sampler.sample(u)
    return draw._replace(pdf=sampler.pdf(draw.x))


def _leaky_surface(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    t = sampler.sample(u).x
    stopped = (t == sampler.surface) & (u[:, 0] > 1 - 0.05 * sampler.atoms[sampler.surface])
    return np.where(stopped, 0.5 * sampler.surface, t)


def _thinned(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    return FreePath(0.9 * _sigma(sampler), sampler.surface).sample(u).x


def _doubled_slope(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The optical depth is taken for sigma_0 t + slope t^2, without the half."""
    assert isinstance(sampler.extinction, Linear)
    return FreePath(Linear(sampler.extinction.sigma_0, 2 * sampler.extinction.slope), sampler.surface).sample(u).x


def _constant_from_start(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The extinction at the start is taken for the whole path."""
    assert not isinstance(sampler.extinction, int | float)
    return FreePath(float(sampler.extinction.sigma(np.zeros(1))[0]), sampler.surface).sample(u).x


def _nobody_escapes(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """Paths that leave the medium are stopped where it ends."""
    return np.minimum(sampler.sample(u).x, 4.0)


def _pole_clipped(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The logarithm of a negative number is clipped to that of a small positive one: nobody escapes the atmosphere."""
    return np.minimum(sampler.sample(u).x, 100.0)


def _from_eye(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The fog is taken to start at the eye."""
    return np.minimum(12.0 * u[:, 0], 12.0)


def _clipped(sampler: TruncatedFreePath, u: np.ndarray) -> np.ndarray:
    return np.minimum(FreePath(sampler.extinction).sample(u).x, sampler.length)


def _not_renormalised(sampler: TruncatedFreePath, x: np.ndarray) -> np.ndarray:
    return FreePath(sampler.extinction).pdf(x)


def _coarse(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """Uniforms of 12 bits."""
    return sampler.sample(np.floor(4096 * u) / 4096).x


def _cancelling(sampler: TruncatedFreePath, u: np.ndarray) -> np.ndarray:
    """The probability of a collision as 1 - exp(-depth), which is a multiple of the roundoff."""
    sigma = np.float32(sampler.extinction.sigma(np.zeros(1, u.dtype))[0])  # type: ignore[union-attr]
    share = 1 - np.exp(-sigma * np.float32(sampler.length))
    return np.minimum(-np.log(1 - u[:, 0] * share) / sigma, sampler.length)


def _chosen_channel(sampler: HomogeneousSpectralFreePath, u: np.ndarray) -> Draw:
    """Everything is divided by the density of the channel that was drawn."""
    draw = sampler.sample(u)
    sigma = np.array(sampler.sigma_t)[(u[:, 0] * len(sampler.sigma_t)).astype(int)]
    pdf = np.where(draw.event == 1, np.exp(-sigma * draw.x), sigma * np.exp(-sigma * draw.x))
    return draw._replace(pdf=pdf, weight=sampler.eval(draw.x) / pdf[:, None])


def _channel_zero(sampler: HomogeneousSpectralFreePath, u: np.ndarray) -> Draw:
    draw = sampler.sample(u)
    assert draw.weight is not None
    return draw._replace(weight=np.repeat(draw.weight[:, :1], draw.weight.shape[1], axis=1))


def _mean_extinction(sampler: HomogeneousSpectralFreePath, u: np.ndarray) -> np.ndarray:
    return FreePath(float(np.mean(sampler.sigma_t)), sampler.surface).sample(u[:, 1:]).x


def cases() -> list[SamplerCase]:
    """Return the free-path cases."""
    rising, falling = LinearMedium(0.2, (0, 0, 0.8)), LinearMedium(1.0, (0, 0, -0.25))
    late, atmosphere = LinearMedium(-0.5, (0, 0, 0.5)), ExponentialMedium(0.4, (0, 0, -0.3))
    sinking = ExponentialMedium(0.05, (0, 0, 0.9))
    milk = (0.8, 1.5, 4.0)
    return [
        _homogeneous(
            "unbounded", "Free path, no surface", 2.5, np.inf, "log10 instead of the natural logarithm", _log10
        ),
        _homogeneous(
            "dense",
            "Free path, mean free path of a micrometre",
            1e6,
            np.inf,
            "-log(xi), infinite at xi = 0",
            _log_of_zero,
        ),
        _homogeneous(
            "thin",
            "Free path, mean free path of 10^9 m",
            1e-9,
            np.inf,
            "the density lacks the factor sigma_t",
            None,
            _without_sigma,
        ),
        _homogeneous(
            "haze",
            "Free path, mean free path of 1.25 m",
            0.8,
            np.inf,
            "the cdf that is inverted lacks the factor sigma_t",
            _cdf_without_sigma,
        ),
        _homogeneous(
            "surface",
            "Free path before a surface at tau = 0.7",
            1.4,
            0.5,
            "at the surface the density is returned in place of the probability",
            _density_at_surface,
        ),
        _homogeneous(
            "surface/far",
            "Free path before a surface at tau = 2",
            0.4,
            5.0,
            "5 % of the surface events are moved",
            _leaky_surface,
        ),
        _homogeneous(
            "surface/near", "Free path before a surface at tau = 0.05", 0.1, 0.5, "extinction 10 % too small", _thinned
        ),
        _graded(
            "linear/rising",
            "Free path, extinction that grows linearly",
            rising,
            np.inf,
            "the optical depth lacks the half of the quadratic term",
            _doubled_slope,
        ),
        _graded(
            "linear/falling",
            "Free path, extinction that falls linearly to vacuum",
            falling,
            np.inf,
            "paths that escape are stopped where the medium ends",
            _nobody_escapes,
        ),
        _graded(
            "linear/late",
            "Free path, vacuum first, a surface last",
            late,
            2.5,
            "at the surface the density is returned in place of the probability",
            _density_at_surface,
        ),
        _graded(
            "exponential/up",
            "Free path upwards through an atmosphere",
            atmosphere,
            np.inf,
            "nobody escapes: the logarithm is clipped",
            _pole_clipped,
        ),
        _graded(
            "exponential/down",
            "Free path down through an atmosphere to the ground",
            sinking,
            6.0,
            "the extinction at the start is taken for the whole path",
            _constant_from_start,
        ),
        _graded(
            "opengl/linear",
            "Free path in OpenGL's linear fog",
            OpenGLFog("linear", start=2.0, end=12.0),
            9.0,
            "the fog is taken to start at the eye",
            _from_eye,
        ),
        _graded(
            "opengl/exp2",
            "Free path in OpenGL's squared exponential fog",
            OpenGLFog("exp2", density=0.4),
            np.inf,
            "the optical depth lacks the half of the quadratic term",
            _doubled_slope,
        ),
        _truncated(
            "dense",
            "Free path that ends before tau = 2",
            Medium(1.0, 0.0),
            2.0,
            "free paths beyond the end are put there",
            _clipped,
        ),
        _truncated(
            "thin",
            "Free path that ends before tau = 1e-9",
            Medium(1e-9, 0.0),
            1.0,
            "the density is not divided by the probability of ending there",
            None,
            _not_renormalised,
            with_cdf=False,
        ),
        _truncated(
            "linear",
            "Free path that ends before tau = 3.6, extinction that grows linearly",
            rising,
            2.75,
            "the density is not divided by the probability of ending there",
            None,
            _not_renormalised,
        ),
        _homogeneous(
            "float32",
            "Free path in single precision, no surface",
            2.5,
            np.inf,
            "uniforms of 12 bits, which cut the tail off",
            _coarse,
            with_cdf=False,
            precision="float32",
        ),
        _homogeneous(
            "float32/surface",
            "Free path in single precision before a surface at tau = 2",
            0.4,
            5.0,
            "5 % of the surface events are moved",
            _leaky_surface,
            with_cdf=False,
            precision="float32",
        ),
        _graded(
            "float32/linear",
            "Free path in single precision, extinction that falls linearly to vacuum",
            falling,
            np.inf,
            "paths that escape are stopped where the medium ends",
            _nobody_escapes,
            with_cdf=False,
            precision="float32",
        ),
        _graded(
            "float32/exponential",
            "Free path in single precision, upwards through an atmosphere",
            atmosphere,
            np.inf,
            "nobody escapes: the logarithm is clipped",
            _pole_clipped,
            with_cdf=False,
            precision="float32",
        ),
        _truncated(
            "float32",
            "Free path in single precision that ends before tau = 1e-6",
            Medium(1e-6, 0.0),
            1.0,
            "1 - exp(-depth), whose digits cancel",
            _cancelling,
            with_cdf=False,
            precision="float32",
        ),
        _spectral(
            "unbounded",
            "Free path of three channels, no surface",
            milk,
            np.inf,
            "the path is drawn with the mean extinction",
            _mean_extinction,
        ),
        _spectral(
            "surface",
            "Free path of three channels before a surface",
            milk,
            0.9,
            "the density is that of the chosen channel, not the mean of all",
            _chosen_channel,
        ),
        _spectral(
            "weights",
            "Free path of three channels, one of them clear",
            (0.0, 0.7, 2.0),
            1.6,
            "the weights of all channels are those of the first",
            _channel_zero,
        ),
    ]
