"""Every kind of the scene has a strategy, found by the tables; what it draws obeys laws that hold for all of them."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import find, given, settings
from hypothesis import strategies as st

from fogproof import strategies
from fogproof.analytic import optical_thickness, phase_cdf, phase_pdf, phase_quantile
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, PhaseFunction, Ray, Scene
from fogproof.scene.lights import KINDS as LIGHTS
from fogproof.scene.media import KINDS as MEDIA
from fogproof.scene.phase import KINDS as PHASES
from fogproof.scene.shapes import KINDS as SHAPES

ROOMS = {
    "phase_functions": PHASES,
    "media": MEDIA,
    "lights": LIGHTS,
    "shapes": SHAPES,
}


@pytest.mark.parametrize(("room", "kind"), [(room, kind) for room, table in ROOMS.items() for kind in table])
def test_every_kind_is_drawn_and_its_parameters_vary(room, kind):
    made = []

    @settings(max_examples=50, database=None)
    @given(getattr(strategies, room)(kind), st.from_type(ROOMS[room][kind]))
    def draws(thing, typed):
        assert type(thing) is type(typed) is ROOMS[room][kind]
        made.append(repr(thing))

    draws()
    constant = kind in ("isotropic", "hazy", "murky", "rayleigh", "unbounded")
    assert constant or len(set(made)) > 5


def test_a_kind_without_a_strategy_is_told():
    import dataclasses

    @dataclasses.dataclass
    class Odd:
        oddness: float

    with pytest.raises(LookupError, match="no strategy for the field 'oddness' of odd"):
        find(strategies.of_kind("odd", Odd), lambda _: True)
    with pytest.raises(InvalidValueError, match="kinds must be among homogeneous"):
        strategies.media("homogenous")


def test_the_simplest_is_simple():
    assert find(strategies.phase_functions(), lambda _: True) == Isotropic()
    medium = find(strategies.media(), lambda _: True)
    assert (type(medium), medium.sigma_a, medium.sigma_s) == (Medium, 0, 0)
    ray = find(strategies.rays(), lambda _: True)
    assert (ray.direction.tolist(), float(ray.length)) == ([0, 0, 1], 1)
    forward = find(strategies.phase_functions("henyey-greenstein"), lambda p: p.g > 0.3)
    assert forward == HenyeyGreenstein(0.5)


@settings(max_examples=40)
@given(strategies.media(), strategies.rays(endless=False), st.floats(0.1, 0.9))
def test_thickness_adds_up_along_a_ray(medium, ray, share):
    if hasattr(medium, "eye"):
        return  # its rays start at the eye
    middle = Ray(ray.origin + share * ray.length * ray.direction, ray.direction, (1 - share) * ray.length)
    whole, first, second = (
        optical_thickness(medium, r) for r in (ray, Ray(ray.origin, ray.direction, share * ray.length), middle)
    )
    # The middle is rounded: a step of the medium may lie within its last digits, where the ray is parallel to it.
    slack = whole.error + first.error + second.error + 1e-9 * (1 + abs(whole.value))
    assert abs(whole.value - first.value - second.value) <= slack


@settings(max_examples=40)
@given(strategies.phase_functions(), st.floats(0.01, 0.99))
def test_the_quantile_inverts_the_distribution_of_any_phase_function(phase, xi):
    mu = phase_quantile(phase, np.array(xi))
    ends = np.clip(mu.value + np.array([-1, 1]) * np.nextafter(mu.error, 1), -1, 1)
    cdf = phase_cdf(phase, ends)
    assert cdf.value[0] - cdf.error.max() <= xi <= cdf.value[1] + cdf.error.max()
    assert phase_pdf(phase, mu.value).value >= 0


@given(medium=..., phase=..., ray=..., scene=...)
@settings(max_examples=20)
def test_types_are_enough(medium: Medium, phase: PhaseFunction, ray: Ray, scene: Scene):
    assert medium.channels is None
    assert scene.channels is None
    assert ray.shape == ()
    assert isinstance(phase, PhaseFunction)


def test_without_hypothesis_the_extra_is_named():
    code = "import sys; sys.modules['hypothesis'] = None; import fogproof.strategies"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "python -m pip install 'fogproof[hypothesis]'" in out.stderr
