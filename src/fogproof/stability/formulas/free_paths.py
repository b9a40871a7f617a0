"""Free paths by inversion, as samplers draw them: -log(1 - xi)/sigma_t and its relatives in graded media."""

from __future__ import annotations

import numpy as np

from fogproof.estimators import Exponential, FreePath, HomogeneousSpectralFreePath, Linear, TruncatedFreePath, Vanishing
from fogproof.stability.axes import both_signs, decades, fine_uniforms, uniforms
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import BOTH, Formula, HardRegion, Naive

LECTURE = "the lecture, free-path sampling"


@each("sigma_t")
def distance(xi, sigma_t):
    return FreePath(sigma_t).distances(xi[:, None])


@each("sigma_t")
def density_drawn(xi, sigma_t):
    return FreePath(sigma_t).sample(xi[:, None]).pdf


@each("sigma_t")
def density(t, sigma_t):
    return FreePath(sigma_t).pdf(t)


@each("tau")
def truncated(xi, tau):
    return TruncatedFreePath(tau, 1.0).sample(xi[:, None]).x


@each("tau")
def truncated_density(t, tau):
    return TruncatedFreePath(tau, 1.0).pdf(t)


@each("sigma_0", "slope")
def linear_reach(depth, sigma_0, slope):
    return Linear(sigma_0, slope).reach(depth)


def true_linear_reach(depth, sigma_0, slope):
    if slope.is_zero():
        return depth / sigma_0
    square = sigma_0 * sigma_0 + 2 * slope * depth
    if square < 0:
        return flint().arb.pos_inf()
    return (square.sqrt() - sigma_0) / slope


@each("sigma_0", "slope")
def linear_depth(t, sigma_0, slope):
    return Linear(sigma_0, slope).depth(t)


def true_linear_depth(t, sigma_0, slope):
    end = -sigma_0 / slope if slope < 0 else t
    s = end if end < t else t
    return s * (sigma_0 + slope * s / 2)


@each("sigma_0", "rate")
def exponential_reach(depth, sigma_0, rate):
    return Exponential(sigma_0, rate).reach(depth)


def true_exponential_reach(depth, sigma_0, rate):
    if rate.is_zero():
        return depth / sigma_0
    x = rate * depth / sigma_0
    return flint().arb.pos_inf() if x <= -1 else x.log1p() / rate


@each("sigma_0", "rate")
def exponential_depth(t, sigma_0, rate):
    return Exponential(sigma_0, rate).depth(t)


def true_exponential_depth(t, sigma_0, rate):
    return sigma_0 * (rate * t).expm1() / rate if not rate.is_zero() else sigma_0 * t


@each("end")
def vanishing_reach(depth, end):
    return Vanishing(0.0, end).reach(depth)


def naive_root(depth, sigma_0, slope):
    return (np.sqrt(sigma_0 * sigma_0 + 2 * slope * depth) - sigma_0) / slope


@each("sigma_t1", "sigma_t2")
def spectral_density(t, sigma_t1, sigma_t2):
    return HomogeneousSpectralFreePath((sigma_t1, sigma_t2)).pdf(t)


SLOPES = both_signs(1e-300, 1e6, 0.0)

FORMULAS = [
    Formula(
        name="free_path/distance",
        title="Free path in a homogeneous medium, -log(1 - xi)/sigma_t",
        of="estimators.FreePath",
        ours=distance,
        truth=lambda xi, sigma_t: -(-xi).log1p() / sigma_t,
        bound=1.5,
        regions=(
            HardRegion("uniforms off the grid", {"xi": fine_uniforms, "sigma_t": decades(1e-300, 1e300)}),
            HardRegion("a generator's uniforms", {"xi": uniforms}, {"sigma_t": 1.0}),
        ),
        naive=(Naive("-log(1 - xi)/sigma_t", LECTURE, lambda xi, sigma_t: -np.log(1 - xi) / sigma_t),),
        precisions=BOTH,
    ),
    Formula(
        name="free_path/density_drawn",
        title="Density of a drawn free path, (1 - xi) sigma_t",
        of="estimators.FreePath",
        ours=density_drawn,
        truth=lambda xi, sigma_t: (1 - xi) * sigma_t,
        bound=1.5,
        regions=(HardRegion("uniforms off the grid", {"xi": fine_uniforms, "sigma_t": decades(1e-300, 1e300)}),),
        precisions=BOTH,
    ),
    Formula(
        name="free_path/density",
        title="Density of a free path at a given distance, sigma_t exp(-sigma_t t)",
        of="estimators.FreePath",
        ours=density,
        truth=lambda t, sigma_t: sigma_t * (-sigma_t * t).exp(),
        bound=2.0,
        regions=(HardRegion("thin to opaque", {"t": decades(1e-300, 1e3), "sigma_t": decades(1e-2, 1.0)}),),
    ),
    Formula(
        name="free_path/truncated",
        title="Free path that ends before the optical thickness tau, in units of the length",
        of="estimators.TruncatedFreePath",
        ours=truncated,
        truth=lambda xi, tau: -(xi * (-tau).expm1()).log1p() / tau,
        bound=3.0,
        regions=(HardRegion("thin to opaque", {"xi": uniforms, "tau": decades(0, 1e3)}),),
        naive=(
            Naive(
                "-log(1 - xi (1 - exp(-tau)))/tau",
                "Wrenninge & Villemin 2020 and others",
                lambda xi, tau: -np.log(1 - xi * (1 - np.exp(-tau))) / tau,
            ),
        ),
        precisions=BOTH,
    ),
    Formula(
        name="free_path/truncated_density",
        title="Density of a free path that ends before tau, tau exp(-tau t)/(1 - exp(-tau))",
        of="estimators.TruncatedFreePath",
        ours=truncated_density,
        truth=lambda t, tau: tau * (-tau * t).exp() / -(-tau).expm1(),
        bound=3.0,
        regions=(HardRegion("thin to opaque", {"t": uniforms, "tau": decades(1e-300, 1e3)}),),
        naive=(
            Naive(
                "over 1 - exp(-tau)",
                "the usual form",
                lambda t, tau: tau * np.exp(-tau * t) / (1 - np.exp(-tau)),
            ),
        ),
    ),
    Formula(
        name="free_path/linear",
        title="Distance at which an optical depth is reached, extinction sigma_0 + slope t",
        of="estimators.Linear",
        ours=linear_reach,
        truth=true_linear_reach,
        bound=3.0,
        regions=(
            HardRegion("slopes", {"slope": SLOPES, "depth": decades(1e-300, 700)}, {"sigma_0": 0.75}),
            HardRegion("from vacuum", {"slope": decades(1e-300, 1e6), "depth": decades(1e-300, 700)}, {"sigma_0": 0.0}),
        ),
        naive=(Naive("root by the quadratic formula", "textbooks", naive_root),),
    ),
    Formula(
        name="free_path/linear_depth",
        title="Optical depth of extinction sigma_0 + slope t, which ends where it is 0",
        of="estimators.Linear",
        ours=linear_depth,
        truth=true_linear_depth,
        bound=2.0,
        regions=(HardRegion("slopes", {"slope": SLOPES, "t": decades(1e-150, 1e150)}, {"sigma_0": 0.75}),),
        naive=(
            Naive(
                "difference of squares",
                "the antiderivative at both ends",
                lambda t, sigma_0, slope: ((sigma_0 + slope * t) ** 2 - sigma_0**2) / (2 * slope),
            ),
        ),
    ),
    Formula(
        name="free_path/exponential",
        title="Distance at which an optical depth is reached, extinction sigma_0 exp(rate t)",
        of="estimators.Exponential",
        ours=exponential_reach,
        truth=true_exponential_reach,
        bound=3.0,
        regions=(HardRegion("rates", {"rate": SLOPES, "depth": decades(1e-300, 700)}, {"sigma_0": 0.75}),),
        naive=(
            Naive(
                "log(1 + rate depth/sigma_0)/rate",
                "textbooks",
                lambda depth, sigma_0, rate: np.log(1 + rate * depth / sigma_0) / rate,
            ),
        ),
    ),
    Formula(
        name="free_path/exponential_depth",
        title="Optical depth of extinction sigma_0 exp(rate t)",
        of="estimators.Exponential",
        ours=exponential_depth,
        truth=true_exponential_depth,
        bound=2.0,
        regions=(HardRegion("rates", {"rate": SLOPES, "t": decades(1e-150, 1e150)}, {"sigma_0": 0.75}),),
        naive=(
            Naive(
                "sigma_0 (exp(rate t) - 1)/rate",
                "the antiderivative at both ends",
                lambda t, sigma_0, rate: sigma_0 * (np.exp(rate * t) - 1) / rate,
            ),
        ),
    ),
    Formula(
        name="free_path/vanishing",
        title="Distance at which an optical depth is reached in OpenGL's linear fog",
        of="estimators.Vanishing",
        ours=vanishing_reach,
        truth=lambda depth, end: -end * (-depth).expm1(),
        bound=2.0,
        regions=(HardRegion("thin to opaque", {"depth": decades(1e-300, 700), "end": decades(1e-3, 1e3)}),),
        naive=(Naive("end (1 - exp(-depth))", "the usual form", lambda depth, end: end * (1 - np.exp(-depth))),),
    ),
    Formula(
        name="free_path/spectral_density",
        title="Mean of the densities of two channels",
        of="estimators.HomogeneousSpectralFreePath",
        ours=spectral_density,
        truth=lambda t, sigma_t1, sigma_t2: (sigma_t1 * (-sigma_t1 * t).exp() + sigma_t2 * (-sigma_t2 * t).exp()) / 2,
        bound=2.0,
        regions=(
            HardRegion(
                "thin to opaque", {"t": decades(1e-300, 1e3), "sigma_t2": decades(1e-6, 1e2)}, {"sigma_t1": 0.5}
            ),
        ),
    ),
]
