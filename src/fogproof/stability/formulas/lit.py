"""The oracle's lit rays: single scattering, its moments, whole rays, and what else comes of the airlight integral."""

from __future__ import annotations

from fogproof import analytic
from fogproof.contracts import Reference
from fogproof.scene import Medium, PointLight, Ray, Scene
from fogproof.scene.phase import HenyeyGreenstein
from fogproof.stability.axes import decades, of, symmetric
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import Formula, HardRegion
from fogproof.stability.formulas.airlight import true_airlight

LENGTH, BEFORE = 4.0, 1.5
"""A ray of that length along z begins so far before the foot of the perpendicular from a lamp at height h."""


def ray():
    return Ray((0.0, 0.0, -BEFORE), (0.0, 0.0, 1.0), LENGTH)


def lamp(h):
    return PointLight((h, 0.0, 0.0), 2.0)


def core(sigma_t, h, factor=1):
    arb = flint().arb
    return true_airlight(factor * sigma_t, h, arb(-BEFORE), arb(LENGTH - BEFORE))


def front(sigma_s):
    return sigma_s * 2 / (4 * flint().arb.pi())


def square(sigma_s, h):
    """Equiangular sampling: that of twice the extinction, times the angle over h."""
    arb = flint().arb
    angle = (arb(LENGTH - BEFORE) / h).atan() - (arb(-BEFORE) / h).atan()
    return front(sigma_s) ** 2 * angle / h * core(sigma_s, h, 2)


def single(function, *more):
    return each("sigma_s", "h")(lambda sigma_s, h: function(Medium(0.0, sigma_s), ray(), lamp(h), *more))


@each("sigma_s", "h")
def whole(sigma_s, h):
    scene = Scene(Medium(0.0, sigma_s), ray(), "single", light=lamp(h), background=0.5)
    return analytic.radiance(scene)


@each("sigma_s")
def by_quadrature(sigma_s, ambient):
    return analytic.radiance_by_quadrature(Medium(0.0, sigma_s), ray(), ambient[0], 0.5)


@each("g", "order")
def moment(g, order):
    found = analytic.phase_legendre_moments(HenyeyGreenstein(g), int(order))
    return Reference(found.value[-1], found.error[-1])


def _only(answer):
    return Reference(answer.value.ravel()[0], answer.error.ravel()[0])


THIN = {"sigma_s": decades(1e-12, 30.0), "h": decades(1e-6, 1e3)}
REGION = (HardRegion("lamp near and far", THIN),)

FORMULAS = [
    Formula(
        "lit/single_scattering",
        "Radiance scattered once from a lamp beside a ray",
        "analytic.single_scattering",
        single(analytic.single_scattering),
        lambda sigma_s, h: front(sigma_s) * core(sigma_s, h),
        REGION,
        size=0.34,
    ),
    Formula(
        "lit/second_moment",
        "Second moment of equiangular sampling",
        "analytic.single_scattering_second_moment",
        single(analytic.single_scattering_second_moment, "equiangular"),
        square,
        (HardRegion("lamp near and far", {"sigma_s": decades(1e-3, 3.0), "h": decades(1e-2, 10.0)}),),
        size=0.12,
    ),
    Formula(
        "lit/variance",
        "Variance of equiangular sampling",
        "analytic.single_scattering_variance",
        single(analytic.single_scattering_variance, "equiangular"),
        lambda sigma_s, h: square(sigma_s, h) - (front(sigma_s) * core(sigma_s, h)) ** 2,
        (HardRegion("lamp near and far", {"sigma_s": decades(1e-3, 3.0), "h": decades(1e-2, 10.0)}),),
        size=0.12,
    ),
    Formula(
        "lit/whole",
        "Background and single scattering together",
        "analytic.radiance",
        whole,
        lambda sigma_s, h: (-sigma_s * LENGTH).exp() / 2 + front(sigma_s) * core(sigma_s, h),
        REGION,
        size=0.25,
    ),
    Formula(
        "lit/by_quadrature",
        "Fog before a background, by quadrature of the medium's coefficients",
        "analytic.radiance_by_quadrature",
        by_quadrature,
        lambda sigma_s, ambient: (-sigma_s * LENGTH).exp() / 2 - ambient * (-sigma_s * LENGTH).expm1(),
        (HardRegion("thin to thick", {"sigma_s": decades(1e-12, 100.0)}, {"ambient": 0.75}),),
    ),
    Formula(
        "lit/legendre_moments",
        "Legendre moments of Henyey-Greenstein, g^l",
        "analytic.phase_legendre_moments",
        moment,
        lambda g, order: g ** int(float(order.mid())),
        (HardRegion("orders", {"g": symmetric(1e-12), "order": of(1, 2, 7, 30, 200)}),),
    ),
    Formula(
        "lit/airlight_second_moment",
        "Second moment of the airlight integral under equiangular sampling",
        "analytic.airlight_second_moment",
        each("sigma_t", "h")(lambda sigma_t, h: analytic.airlight_second_moment(sigma_t, h, -BEFORE, LENGTH - BEFORE)),
        lambda sigma_t, h: square(sigma_t, h) / front(sigma_t) ** 2,
        (HardRegion("lamp near and far", {"sigma_t": decades(1e-3, 3.0), "h": decades(1e-2, 10.0)}),),
        size=0.2,
    ),
    Formula(
        "lit/airlight_table",
        "Airlight integrals as a table",
        "analytic.airlight_table",
        each("sigma_t", "h")(
            lambda sigma_t, h: _only(analytic.airlight_table(sigma_t, [h], [-BEFORE], [LENGTH - BEFORE]))
        ),
        core,
        (HardRegion("lamp near and far", {"sigma_t": decades(1e-9, 30.0), "h": decades(1e-6, 1e6)}),),
        size=0.34,
    ),
]
