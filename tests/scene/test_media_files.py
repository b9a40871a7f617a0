"""Invariant: every medium can be given in a file, means there what it means in Python, and a wrong one is refused with
the place, the rule and what came instead."""

import numpy as np
import pytest

from fogproof.analytic import ambient_fog
from fogproof.errors import FogproofError, InvalidInputError, InvalidValueError
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
    HenyeyGreenstein,
    Isotropic,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    PointLight,
    Procedural,
    Ramp,
    Ray,
    Scene,
    VaryingPhase,
    VoxelGrid,
    media,
)
from fogproof.scene.files import read_fields, read_scene

RAY = Ray((0, 0, 0), (0, 0, 1), 2.0)
LINEAR = 'kind = "linear", sigma_0 = 1, gradient = [0, 0, 1]'


def read(tmp_path, medium):
    path = tmp_path / "scene.toml"
    path.write_text(f"medium = {{{medium}}}\n[ray]\norigin = [0, 0, 0]\ndirection = [0, 0, 1]\nlength = 2.0\n")
    return read_scene(path).medium


@pytest.mark.parametrize(
    ("text", "medium"),
    [
        ("sigma_a = 0.1, sigma_s = 0.2", Medium(0.1, 0.2)),
        ("sigma_a = [0.1, 0.3], sigma_s = 0.2", Medium((0.1, 0.3), 0.2)),
        ('kind = "homogeneous", sigma_a = 0.1, sigma_s = 0.2, emission = 1', Medium(0.1, 0.2, emission=1)),
        (LINEAR, LinearMedium(1, (0, 0, 1))),
        (
            'kind = "linear", sigma_0 = [1, 2], gradient = [[0, 0, 1], [0, 0, 2]], albedo = [0.5, 0.25], emission = 1',
            LinearMedium((1, 2), [(0, 0, 1), (0, 0, 2)], (0.5, 0.25), emission=1),
        ),
        ('kind = "exponential", sigma_0 = 1, rate = [0, 0, -1]', ExponentialMedium(1, (0, 0, -1))),
        (
            'kind = "piecewise-constant", boundaries = [-inf, 0.5, 1], sigma_t = [1, 2], albedo = [0, 1], emission = 1',
            PiecewiseConstantMedium([-np.inf, 0.5, 1], [1, 2], albedo=[0, 1], emission=1),
        ),
        (
            'kind = "anisotropic", sigma = 2, S = [[1, 0, 0], [0, 1, 0], [0, 0, 4]]',
            AnisotropicMedium(2, np.diag([1, 1, 4])),
        ),
        ('kind = "opengl-fog", mode = "exp2", density = 0.5', OpenGLFog("exp2", 0.5)),
        (
            'kind = "voxel-grid", sigma_t = [[[1, 2], [3, 4]]], lower = [-1, -1, 0], upper = [1, 1, 1]',
            VoxelGrid([[[1, 2], [3, 4]]], (-1, -1, 0), (1, 1, 1)),
        ),
    ],
)
def test_files_mean_what_python_means(tmp_path, text, medium):
    found = read(tmp_path, text)
    assert type(found) is type(medium)
    one, two = ambient_fog(found, RAY, 1.0, 0.5), ambient_fog(medium, RAY, 1.0, 0.5)
    assert np.array_equal(one.value, two.value)


def test_a_phase_function_that_varies(tmp_path):
    share = "{start = [0, 0, 0], end = [0, 0, 1]}"
    second = '{kind = "henyey-greenstein", g = 0.5}'
    phase = f'{{kind = "varying", first = {{kind = "isotropic"}}, second = {second}, share = {share}}}'
    found = read(tmp_path, f"{LINEAR}, phase = {phase}").phase
    assert isinstance(found, VaryingPhase)
    assert (found.first, found.second) == (Isotropic(), HenyeyGreenstein(0.5))
    assert isinstance(found.share, Ramp)
    assert found.share.end.tolist() == [0, 0, 1]


@pytest.mark.parametrize(
    ("text", "place", "rule"),
    [
        ("sigma_a = -1, sigma_s = 2", "scene.medium.sigma_a", "must be finite and >= 0 [1/m], got -1.0"),
        ("sigma_a = 1", "scene.medium.sigma_s", "is missing"),
        ("sigma_a = 1, sigma_s = 2, rho = 3", "scene.medium.rho", "is not a known key"),
        ('kind = "procedural", sigma_t = 1', "scene.medium", "known are 'homogeneous', 'linear'"),
        ('kind = "linear", sigma_0 = 1', "scene.medium.gradient", "is missing"),
        ('kind = "linear", sigma_0 = 1, gradient = [0, 1]', "scene.medium.gradient", "one vector [x, y, z]"),
        (f"{LINEAR}, albedo = 1.5", "scene.medium.albedo", "must lie in [0, 1], got 1.5"),
        (f"{LINEAR}, albedo = [0.5, 0.5], emission = [1, 1, 1]", "scene.medium.albedo", "as many channels"),
        (f'{LINEAR}, phase = {{kind = "henyey-greenstein", g = 2}}', "scene.medium.phase.g", "open interval"),
        ('kind = "exponential", sigma_0 = -1, rate = [0, 0, 1]', "scene.medium.sigma_0", ">= 0"),
        ('kind = "exponential", sigma_0 = 1, rate = [0, 0, inf]', "scene.medium.rate", "must be finite"),
        (
            'kind = "piecewise-constant", boundaries = [0, 1, 1], sigma_t = [1, 2]',
            "scene.medium.boundaries",
            "increase",
        ),
        ('kind = "piecewise-constant", boundaries = [0, 1], sigma_t = [1, 2]', "scene.medium.sigma_t", "shape [1]"),
        ('kind = "anisotropic", sigma = 1, S = [[1, 0], [0, 1]]', "scene.medium.S", "3 x 3"),
        ('kind = "anisotropic", sigma = 1, S = [[1, 1, 0], [0, 1, 0], [0, 0, 1]]', "scene.medium.S", "symmetric"),
        (
            'kind = "anisotropic", sigma = 1, S = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]',
            "scene.medium.S",
            "negative eigenvalue",
        ),
        ('kind = "opengl-fog", mode = "linear", start = 2, end = 1', "scene.medium.end", "greater than start"),
        ('kind = "opengl-fog", mode = "exp3"', "scene.medium.mode", "'exp2'"),
        (
            'kind = "voxel-grid", sigma_t = [], lower = [0, 0, 0], upper = [1, 1, 1]',
            "scene.medium.sigma_t",
            "one voxel",
        ),
        (
            'kind = "voxel-grid", sigma_t = [[[-1]]], lower = [0, 0, 0], upper = [1, 1, 1]',
            "scene.medium.sigma_t",
            ">= 0",
        ),
        (
            'kind = "voxel-grid", sigma_t = [[[nan]]], lower = [0, 0, 0], upper = [1, 1, 1]',
            "scene.medium.sigma_t",
            "nan",
        ),
        (
            'kind = "voxel-grid", sigma_t = [[[1]]], lower = [0, 0, 0], upper = [1, 0, 1]',
            "scene.medium.upper",
            "above lower",
        ),
        (
            'kind = "voxel-grid", sigma_t = [[[1]]], lower = [0, 0, 0], upper = [1, 1, 1], interpolation = "cubic"',
            "scene.medium.interpolation",
            "'nearest'",
        ),
        (
            'kind = "voxel-grid", sigma_t = [[[1]]], lower = [0, 0, 0], upper = [1, 1, 1], albedo = [[[2]]]',
            "scene.medium.albedo",
            "<= 1",
        ),
    ],
)
def test_a_wrong_medium_is_named(tmp_path, text, place, rule):
    with pytest.raises(FogproofError) as raised:
        read(tmp_path, text)
    assert raised.value.path == place
    assert rule in str(raised.value)
    assert isinstance(raised.value, InvalidInputError | InvalidValueError)


def flat(x):
    return 0 * x[..., 0]


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: Procedural(1.0, majorant=1.0), "sigma_t"),
        (lambda: Procedural(flat, majorant=-1.0), "majorant"),
        (lambda: Procedural(flat, majorant=np.inf), "majorant"),
        (lambda: Procedural(flat, majorant=1.0, channels=0), "channels"),
        (lambda: Procedural(flat, majorant=1.0, channels=2, emission=(1.0, 2.0, 3.0)), "sigma_t"),
        (lambda: Procedural(flat, majorant=1.0, lower=(0, 0, 0), upper=(1, 0, 1)), "upper"),
        (lambda: Procedural(flat, majorant=1.0, detail=0.0), "detail"),
        (lambda: Procedural(flat, majorant=1.0, albedo=1.5), "albedo"),
        (lambda: Procedural(flat, majorant=1.0, phase="hazy"), "phase"),
        (lambda: LinearMedium(np.nan, (0, 0, 1)), "sigma_0"),
        (lambda: LinearMedium((), (0, 0, 1)), "sigma_0"),
        (lambda: LinearMedium(1.0, (0, 0, 1), phase=3), "phase"),
        (lambda: Ramp((0, 0, 0), (0, 0, 0)), "end"),
        (lambda: Scene(medium="fog", ray=RAY), "medium"),
    ],
)
def test_wrong_arguments_are_named(make, argument):
    with pytest.raises(InvalidValueError) as raised:
        make()
    assert raised.value.argument == argument


def test_media_cannot_be_changed_afterwards():
    sigma_t = np.ones((2, 2, 2))
    grid = VoxelGrid(sigma_t, (0, 0, 0), (1, 1, 1))
    sigma_t[:] = 7
    assert (grid.sigma_t == 1).all()
    with pytest.raises(ValueError, match="read-only"):
        grid.sigma_t[0, 0, 0] = 7


def test_a_scene_counts_the_channels_of_its_medium():
    medium = LinearMedium((1.0, 2.0), (0, 0, 1))
    with pytest.raises(InvalidValueError, match="channels"):
        Scene(medium=medium, ray=RAY, scattering="single", light=PointLight((0, 0, 0), (1.0, 2.0, 3.0)))


def test_a_ray_made_of_a_ray_has_the_same_direction():
    """Normalised twice it would differ in the last bit, and every exact answer with it."""
    w = np.random.default_rng(5).normal(size=(1000, 3))
    once = Ray((0, 0, 0), w / np.linalg.norm(w, axis=-1, keepdims=True)).direction
    single = Ray((0, 0, 0), once.astype(np.float32)).direction
    assert np.abs(np.linalg.norm(single, axis=-1) - 1).max() < 1e-15
    for direction in (once, single):
        assert np.array_equal(Ray((0, 0, 0), direction).direction, direction)


def test_each_channel_of_a_linear_medium_has_its_own_gradient():
    medium = LinearMedium((1.0, 2.0), ((0, 0, 1), (3, 0, 0)), albedo=(0.5, 0.25))
    for c, gradient in enumerate([(0, 0, 1), (3, 0, 0)]):
        grey = medium.channel(c)
        assert np.array_equal(grey.gradient, gradient)
        assert (grey.sigma_0, grey.albedo) == ((1.0, 2.0)[c], (0.5, 0.25)[c])


def test_minus_infinity_is_read_as_such():
    medium = {"kind": "piecewise-constant", "boundaries": ["-inf", 0, "inf"], "sigma_t": [1, 2]}
    read = read_fields({"medium": media.AnyMediumField}, {"medium": medium}, "request")["medium"]
    assert read.boundaries.tolist() == [-np.inf, 0, np.inf]


def test_every_class_of_the_room_has_a_kind():
    classes = {getattr(media, name) for name in media.__all__} - {media.AnyMedium}
    assert set(media.KINDS.values()) | set(media.FROM_PYTHON) == classes
    assert all(media.KINDS[kind].__module__ == f"{media.__name__}.{kind.replace('-', '_')}" for kind in media.KINDS)
