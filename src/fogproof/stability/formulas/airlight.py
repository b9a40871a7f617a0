"""Single scattering of a point light: where equiangular samplers put it, and the oracle's integral."""

from __future__ import annotations

import math

import numpy as np

from fogproof import analytic
from fogproof.estimators import Equiangular
from fogproof.scene.phase import HenyeyGreenstein, Rayleigh
from fogproof.stability.axes import decades, minus, symmetric, uniforms
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import BOTH, Formula, HardRegion, Naive

KULLA = "Kulla & Fajardo 2012, and most renderers"


def true_angle(h, a, b):
    return (b / h).atan() - (a / h).atan()


def true_place(xi, h, a, b):
    return h * ((a / h).atan() + xi * true_angle(h, a, b)).tan()


def naive_place(xi, h, a, b):
    low, high = np.arctan(a / h), np.arctan(b / h)
    return h * np.tan((1 - xi) * low + xi * high)


def naive_density(t, h, a, b):
    return h / ((np.arctan(b / h) - np.arctan(a / h)) * (h * h + t * t))


@each("h", "a", "b")
def placed(xi, h, a, b):
    return Equiangular(h, a, b).sample(xi[:, None]).x


@each("h", "a", "b")
def drawn_density(xi, h, a, b):
    return Equiangular(h, a, b).sample(xi[:, None]).pdf


@each("h", "a", "b")
def density(t, h, a, b):
    return Equiangular(h, a, b).pdf(t)


def true_density(t, h, a, b):
    return h / (true_angle(h, a, b) * (h * h + t * t))


def true_airlight(sigma_t, h, a, b):
    """Isotropic, by the exponential integral of complex argument (Pegoraro & Parker 2009): 2/h Im of a difference."""
    acb = flint().acb
    if h.is_zero():
        return on_the_line(sigma_t, a, b)
    if not b.is_finite() and sigma_t.is_zero():
        return (flint().arb.pi() / 2 - (a / h).atan()) / h
    H = sigma_t * h

    def tail(t):
        v = ((t * t + h * h).sqrt() + t) / h
        if sigma_t.is_zero():
            return flint().arb.pi() / 2 - v.atan()
        return (acb(0, -H).exp() * acb(H * v, -H).expint(1)).imag

    rest = tail(b) if b.is_finite() else 0
    return 2 / h * (sigma_t * a).exp() * (tail(a) - rest)


def on_the_line(sigma_t, a, b):
    """The light lies on the line, behind the camera or beyond the segment."""
    if b < 0:
        return (sigma_t * a).exp() * (1 / -b - 1 / -a)

    def tail(t):
        return (2 * sigma_t * t).expint(2) / t if t.is_finite() else flint().arb(0)

    return (sigma_t * a).exp() * (tail(a) - tail(b))


def by_quadrature(factor):
    """Return the integral with 4 pi f_p = factor(mu, ...), over s with t = h sinh s."""

    def truth(sigma_t, h, a, b, **parameters):
        acb = flint().acb
        start, stop = (a / h).asinh(), (b / h).asinh()
        far = (a * a + h * h).sqrt() + a

        def integrand(s, analytic_there):
            r = h * s.cosh()
            return (-sigma_t * (h * s.exp() - far)).exp() * factor(-s.tanh(), analytic_there, **parameters) / r

        front = (-sigma_t * (far - a)).exp()
        return front * acb.integral(integrand, acb(start), acb(stop), rel_tol=flint().arb(2) ** -190).real

    return truth


def hg_factor(mu, analytic_there, g):
    square = 1 + g * g - 2 * g * mu
    return (1 - g * g) / (square * flint().acb(square).sqrt(analytic=analytic_there))


def rayleigh_factor(mu, analytic_there):
    return (1 + mu * mu) * 3 / 4


def naive_closed_form(sigma_t, h, a, b):
    from scipy.special import exp1

    H = sigma_t * h

    def tail(t):
        return (np.exp(-1j * H) * exp1(H * ((np.sqrt(t * t + h * h) + t) / h - 1j))).imag

    return 2 / h * np.exp(sigma_t * a) * (tail(a) - np.where(np.isfinite(b), tail(np.where(np.isfinite(b), b, 1)), 0))


def marched(sigma_t, h, a, b):
    """The lecture's brute force: 256 steps of equal length."""
    step = (b - a) / 256
    t = a + step * (np.arange(256)[:, None] + 0.5)
    r = np.hypot(t, h)
    return np.sum(np.exp(-sigma_t * (t - a + r)) / (r * r), axis=0) * step


SEGMENTS = {
    "light beside": {"a": -0.75, "b": 1.5},
    "light behind": {"a": 0.25, "b": 2.0},
    "light beyond": {"a": -2.0, "b": -0.125},
}
HEIGHTS = decades(1e-15, 1e15)


def segments(first, heights=HEIGHTS):
    return tuple(HardRegion(name, {**first, "h": heights}, ends) for name, ends in SEGMENTS.items())


FORMULAS = [
    Formula(
        "airlight/equiangular",
        "Equiangular place on a segment, from the foot of the perpendicular",
        "estimators.Equiangular",
        placed,
        true_place,
        segments({"xi": uniforms}),
        bound=3.0,
        naive=(Naive("h tan(lerp of two angles)", KULLA, naive_place),),
        precisions=BOTH,
    ),
    Formula(
        "airlight/equiangular_density_drawn",
        "Density of an equiangular place that was drawn",
        "estimators.Equiangular",
        drawn_density,
        lambda xi, h, a, b: true_density(true_place(xi, h, a, b), h, a, b),
        segments({"xi": uniforms}),
        bound=5.0,
        precisions=BOTH,
    ),
    Formula(
        "airlight/equiangular_density",
        "Density of equiangular sampling at a given place",
        "estimators.Equiangular",
        density,
        true_density,
        (
            HardRegion("light beside", {"t": decades(1e-9, 1.5), "h": HEIGHTS}, {"a": -0.75, "b": 1.5}),
            HardRegion("light far behind", {"a": decades(1.0, 1e12), "h": decades(1e-6, 1e6)}, {"t": 3e12, "b": 4e12}),
        ),
        bound=3.0,
        naive=(Naive("difference of two arctangents", KULLA, naive_density),),
    ),
    Formula(
        "airlight/isotropic",
        "The oracle's airlight integral, isotropic",
        "analytic.airlight_integral",
        analytic.airlight_integral,
        true_airlight,
        (
            *segments({"sigma_t": decades(1e-9, 300.0, 0.0)}),
            HardRegion("ray without end", {"sigma_t": decades(1e-9, 300.0), "h": HEIGHTS}, {"a": -0.75, "b": math.inf}),
            HardRegion(
                "light on the line, behind",
                {"sigma_t": decades(1e-9, 300.0), "a": decades(1e-9, 10.0)},
                {"h": 0.0, "b": 20.0},
            ),
            HardRegion(
                "light on the line, beyond",
                {"sigma_t": decades(1e-9, 30.0), "b": minus(decades(1e-9, 1.0))},
                {"h": 0.0, "a": -2.0},
            ),
        ),
        naive=(
            Naive(
                "exponential integrals in double precision",
                "Pegoraro & Parker 2009 with a library's E1",
                naive_closed_form,
            ),
            Naive("ray marching, 256 steps", "the lecture, brute force", marched),
        ),
        size=0.5,
    ),
    Formula(
        "airlight/henyey_greenstein",
        "The oracle's airlight integral, Henyey-Greenstein",
        "analytic.airlight_integral",
        each("g")(lambda sigma_t, h, a, b, g: analytic.airlight_integral(sigma_t, h, a, b, HenyeyGreenstein(g))),
        by_quadrature(hg_factor),
        (
            HardRegion(
                "light beside", {"g": symmetric(1e-4), "h": decades(1e-9, 1e3)}, {"sigma_t": 0.5, "a": -0.75, "b": 1.5}
            ),
        ),
        size=0.29,
        condition=False,
    ),
    Formula(
        "airlight/rayleigh",
        "The oracle's airlight integral, Rayleigh",
        "analytic.airlight_integral",
        lambda sigma_t, h, a, b: analytic.airlight_integral(sigma_t, h, a, b, Rayleigh()),
        by_quadrature(rayleigh_factor),
        segments({"sigma_t": decades(1e-9, 100.0)}, decades(1e-9, 1e9)),
        size=0.34,
        condition=False,
    ),
]
