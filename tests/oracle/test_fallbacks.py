"""Invariant: a shape that gives only its chord, and a light that gives only where it arrives from, work in the oracle and the
estimators: what has no closed form is found by quadrature.
"""

import sys
from dataclasses import dataclass
from types import ModuleType
from typing import ClassVar

import numpy as np
import pytest

from fogproof import check_estimator
from fogproof.analytic import mean_path_length, single_scattering
from fogproof.analytic.airlight.by_quadrature import single_scattering_by_quadrature
from fogproof.analytic.airlight.incident import Incident
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.estimators import Airlight
from fogproof.estimators.airlight.lighting import Sampled
from fogproof.scene import HenyeyGreenstein, Medium, PointLight, Ray
from fogproof.scene.lights import DirectionalLight
from fogproof.scene.shapes import Ball

FOG = Medium(0.2, 0.7, HenyeyGreenstein(0.3))
RAY = Ray((0.2, -0.1, -3.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Spheroid:
    """x^2 + y^2 + (z/c)^2 <= 1."""

    c: float


@dataclass(frozen=True)
class FarPatch:
    """Radiance from the directions within an angle whose cosine is `edge` about +z, from infinitely far."""

    edge: float
    radiance: float
    strength_field: ClassVar[str] = "radiance"
    distant: ClassVar[bool] = True
    delta: ClassVar[bool] = False


def _roots(shape, o, d, radius):
    scale = np.array([1, 1, 1 / shape.c])
    o, d = o * scale, d * scale
    a, b, c = np.sum(d * d, -1), np.sum(o * d, -1), np.sum(o * o, -1) - radius * radius
    half = np.sqrt(b * b - a * c)
    return (-b - half) / a, (-b + half) / a


@pytest.fixture(autouse=True)
def newcomers(monkeypatch):
    """The modules of both, as files of their names would be found."""

    def room(name, **functions):
        module = ModuleType(name)
        module.__dict__.update(functions)
        monkeypatch.setitem(sys.modules, name, module)

    monkeypatch.setattr(Spheroid, "__module__", "fogproof.scene.shapes.spheroid")
    monkeypatch.setattr(FarPatch, "__module__", "fogproof.scene.lights.far_patch")
    room("fogproof.analytic.shapes.spheroid", through=lambda s, o, d, margin: _roots(s, o, d, 1 + margin))

    def ways(shape, x, w):
        enter, leave = _roots(shape, x.T, w.T, 1.0)
        return np.nan_to_num(enter, nan=np.inf), np.nan_to_num(leave, nan=-np.inf)

    room("fogproof.estimators.shapes.spheroid", through=ways)

    def directions(edge, u, v):
        c = 1 - (1 - edge) * u
        s = np.sqrt(1 - c * c)
        return np.stack([s * np.cos(2 * np.pi * v), s * np.sin(2 * np.pi * v), c], -1)

    def incident(light, x, nodes):
        y, weights = np.polynomial.legendre.leggauss(nodes)
        u, v = np.meshgrid(0.5 * (y + 1), (np.arange(2 * nodes) + 0.5) / (2 * nodes), indexing="ij")
        w = directions(light.edge, u, v).reshape(1, -1, 3)
        weight = 2 * np.pi * (1 - light.edge) * np.outer(0.5 * weights, np.full(2 * nodes, 0.5 / nodes)).reshape(1, -1)
        size = (len(x), weight.shape[1])
        return Incident(np.broadcast_to(w, (*size, 3)), np.full(size, np.inf), np.broadcast_to(weight, size))

    def sample(light, x, u):
        w = directions(light.edge, u[:, 0], u[:, 1]).T
        return Sampled(w, np.full(len(u), np.inf), np.full(len(u), 2 * np.pi * (1 - light.edge) * light.radiance))

    room("fogproof.analytic.lights.far_patch", incident=incident)
    room("fogproof.estimators.lights.far_patch", sample=sample)


def by_quadrature(light, shape):
    flat = FlatRays(RAY.origin[None], RAY.direction[None], RAY.length[None])
    value, error, method, source = single_scattering_by_quadrature(FOG, flat, light, shape, ())
    return Reference(value[0, 0], error[0, 0], method, source)


@pytest.mark.parametrize(
    "light", [PointLight((0.3, 0.2, 0.4), 2.0), PointLight((2.0, 1.0, 0.5), 2.0), DirectionalLight((0.6, 0, 0.8), 2.0)]
)
def test_a_spheroid_that_is_a_ball(light):
    ball = single_scattering(FOG, RAY, light, shape=Ball((0, 0, 0), 1.0))
    round_one = by_quadrature(light, Spheroid(1.0))
    assert abs(ball.value - round_one.value) <= ball.error + round_one.error
    assert round_one.error < 1e-10 * round_one.value


@pytest.mark.parametrize("light", [PointLight((2.0, 1.0, 0.5), 2.0), FarPatch(0.8, 3.0)], ids=["point", "patch"])
def test_estimator_and_oracle_agree_on_newcomers(light):
    reference = by_quadrature(light, Spheroid(2.0))
    assert reference.error < 1e-6 * reference.value
    estimator = Airlight(FOG, RAY, light, "distance", shape=Spheroid(2.0))
    seed = int(np.random.SeedSequence().generate_state(1)[0])
    check_estimator(estimator.draw, reference, samples=100_000, alpha=1e-9, seed=seed).raise_unless_passed()


def test_what_has_no_fallback_is_refused_by_name():
    with pytest.raises(UnsupportedError, match="Spheroid"):
        mean_path_length(Spheroid(1.0))
