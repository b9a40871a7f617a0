"""Invariant: light with extent is the sum of its points: single scattering agrees, within its error, with an integral over the
surface of the light of the airlight integral of a point that shines as cos(alpha), and the rules fill the solid angle.
"""

import math

import numpy as np
import pytest

from fogproof.analytic import single_scattering
from fogproof.analytic.lights import disk, rectangle, sphere
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import HenyeyGreenstein, Isotropic, LinearMedium, Medium, PointLight, Ray, VoxelGrid
from fogproof.scene.lights import DiskLight, RectangleLight, SphereLight, SpotLight
from fogproof.scene.occluders import Sphere
from fogproof.scene.shapes import Slab

RAY = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 5.0)
BALL = SphereLight((0.6, -0.8, 0.5), 0.4, 3.0)
PANE = RectangleLight((0.4, -0.8, 0.2), (0.0, 0.0, 0.6), (0.3, 0.4, 0.0), 3.0)
PLATE = DiskLight((0.6, -0.8, 0.5), (-0.6, 0.8, 0.0), 0.4, 3.0)
LIGHTS = [BALL, PANE, PLATE]


def legendre(n, low, high):
    y, w = np.polynomial.legendre.leggauss(n)
    return low + (high - low) * 0.5 * (y + 1), 0.5 * (high - low) * w


def surface(light, n):
    """Points, normals and areas that add up the surface of a light."""
    if isinstance(light, RectangleLight):
        (a, wa), (b, wb) = legendre(n, 0, 1), legendre(n, 0, 1)
        u, v = np.array(light.edge_u), np.array(light.edge_v)
        normal = np.cross(u, v)
        points = np.array(light.corner) + a[:, None, None] * u + b[None, :, None] * v
        areas = np.outer(wa, wb) * np.linalg.norm(normal)
        return points.reshape(-1, 3), np.tile(normal / np.linalg.norm(normal), (n * n, 1)), areas.ravel()
    phi = (np.arange(2 * n) + 0.5) * math.pi / n
    if isinstance(light, DiskLight):
        r, wr = legendre(n, 0, light.radius)
        e1 = np.cross(light.normal, (0, 0, 1.0))
        e2 = np.cross(light.normal, e1)
        points = r[:, None, None] * (np.cos(phi)[:, None] * e1 + np.sin(phi)[:, None] * e2)
        areas = np.outer(wr * r, np.full(2 * n, math.pi / n))
        return (points + light.center).reshape(-1, 3), np.tile(light.normal, (areas.size, 1)), areas.ravel()
    c, wc = legendre(n, -1, 1)
    s = np.sqrt(1 - c * c)
    normals = np.stack([np.outer(s, np.cos(phi)), np.outer(s, np.sin(phi)), np.outer(c, np.ones(2 * n))], -1).reshape(
        -1, 3
    )
    areas = light.radius**2 * np.outer(wc, np.full(2 * n, math.pi / n)).ravel()
    return np.array(light.center) + light.radius * normals, normals, areas


def summed(medium, ray, light, n, **more):
    total = 0.0
    for y, normal, area in zip(*surface(light, n), strict=True):
        point = SpotLight(tuple(y), tuple(normal), light.radiance, math.pi / 2, exponent=1)
        total += area * float(single_scattering(medium, ray, point, **more).value)
    return total


@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: type(light).__name__)
@pytest.mark.parametrize("medium", [Medium(0.1, 0.4, HenyeyGreenstein(0.5)), Medium(0.5, 1.5)], ids=["thin", "thick"])
def test_the_sum_of_its_points(light, medium):
    n = 20 if isinstance(light, SphereLight) else 10
    found = single_scattering(medium, RAY, light)
    truth, rough = summed(medium, RAY, light, n), summed(medium, RAY, light, n // 2)
    assert abs(float(found.value) - truth) <= float(found.error) + abs(truth - rough)
    assert abs(truth - rough) < 1e-3 * truth
    assert 0 < found.error < 1e-9 * found.value


def test_the_sum_of_its_points_in_a_slab_and_in_a_gradient():
    slab = Slab((0, 0, 1.0), (0, 0, 1.0), 2.0)
    for medium, more in ((Medium(0.2, 0.6), {"shape": slab}), (LinearMedium(0.5, (0.1, 0.0, 0.2), 0.8), {})):
        found = single_scattering(medium, RAY, PANE, **more)
        truth = summed(medium, RAY, PANE, 6, **more)
        assert abs(float(found.value) - truth) <= float(found.error) + 1e-6 * truth
        assert found.error < 1e-5 * found.value


def solid_angle_of_rectangle(light, x):
    """Van Oosterom & Strackee 1983, by two triangles."""
    u, v, p = np.array(light.edge_u), np.array(light.edge_v), np.array(light.corner) - x
    total = 0.0
    for a, b, c in ((p, p + u, p + u + v), (p, p + u + v, p + v)):
        la, lb, lc = (np.linalg.norm(w) for w in (a, b, c))
        total += 2 * math.atan2(abs(a @ np.cross(b, c)), la * lb * lc + (a @ b) * lc + (a @ c) * lb + (b @ c) * la)
    return total


@pytest.mark.parametrize("distance", [1e-3, 0.03, 0.5, 4.0, 1e3])
def test_the_rules_fill_the_solid_angle(distance):
    front = np.array([-0.6, 0.8, 0.0])
    for aside in (0.0, 0.1, 0.9):
        offset = np.array([0.6, 0.8, 0.0]) * aside + distance * np.array([-0.8, 0.6, 0.0])
        x = np.array([0.55, -0.6, 0.5]) + offset
        rule = rectangle.incident(PANE, x[None], 40)
        assert rule.weight.sum() == pytest.approx(solid_angle_of_rectangle(PANE, x), rel=1e-7)
    near = np.array(BALL.center) + front * (BALL.radius + distance)
    D = BALL.radius + distance
    cap = 2 * math.pi * (1 - math.sqrt((D - BALL.radius) * (D + BALL.radius)) / D)
    assert sphere.incident(BALL, near[None], 24).weight.sum() == pytest.approx(cap, rel=1e-11)
    above = np.array(PLATE.center) + front * distance
    cone = 2 * math.pi * (1 - distance / math.hypot(distance, PLATE.radius))
    assert disk.incident(PLATE, above[None], 24).weight.sum() == pytest.approx(cone, rel=1e-9)
    assert disk.incident(PLATE, (above - 2 * distance * front)[None], 8).weight.sum() == 0


def test_small_lights_are_points():
    medium = Medium(0.1, 0.4, Isotropic())
    point = single_scattering(medium, RAY, PointLight((0.6, -0.8, 0.5), math.pi * 1e-10))
    ball = single_scattering(medium, RAY, SphereLight((0.6, -0.8, 0.5), 1e-5, 1.0))
    assert ball.value == pytest.approx(float(point.value), rel=1e-5)


def test_a_ray_ends_at_the_light():
    medium = Medium(0.1, 0.4)
    for light, end in (
        (SphereLight((0, 0, 1.0), 0.5, 2.0), 2.5),
        (RectangleLight((-1, -1, 0.5), (0, 2.0, 0), (2.0, 0, 0), 2.0), 2.5),
        (DiskLight((0, 0, 0.5), (0, 0, -1.0), 0.3, 2.0), 2.5),
    ):
        whole, part = (
            single_scattering(medium, RAY, light),
            single_scattering(medium, Ray(RAY.origin, RAY.direction, end), light),
        )
        assert float(whole.value) == pytest.approx(float(part.value), rel=1e-12)
        assert whole.error < 1e-6 * whole.value


def test_voxels_see_the_light():
    grid = VoxelGrid(np.full((2, 2, 2), 0.5), (-9, -9, -9), (9, 9, 9), "nearest", 0.8)
    one = single_scattering(Medium(0.1, 0.4), RAY, PANE)
    other = single_scattering(grid, RAY, PANE)
    assert abs(one.value - other.value) <= one.error + other.error


@pytest.mark.parametrize(
    ("build", "argument"),
    [
        (lambda: SphereLight((0, 0, 0), 0.0, 1.0), "radius"),
        (lambda: SphereLight((0, 0, 0), 1.0, -1.0), "radiance"),
        (lambda: DiskLight((0, 0, 0), (0, 0, 2.0), 1.0, 1.0), "normal"),
        (lambda: RectangleLight((0, 0, 0), (1, 0, 0), (1, 1, 0), 1.0), "edge_v"),
        (lambda: RectangleLight((0, 0, 0), (0, 0, 0), (0, 1, 0), 1.0), "edge_u"),
    ],
)
def test_bad_lights_are_named(build, argument):
    with pytest.raises(InvalidValueError, match=argument):
        build()


def test_half_shadows_are_refused():
    with pytest.raises(UnsupportedError, match="SphereLight"):
        single_scattering(Medium(0.1, 0.4), RAY, BALL, occluders=[Sphere((0.3, -0.4, 0.4), 0.1)])
