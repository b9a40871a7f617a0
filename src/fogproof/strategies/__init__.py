"""Hypothesis strategies for what scenes are made of: media, phase functions, rays, lights, shapes, whole scenes.

    from hypothesis import given
    from fogproof.strategies import media, rays

    @given(media(), rays())
    def test_my_tracker(medium, ray): ...

A kind is drawn field by field: `fields` says what a field of some name may be, `own_fields` what belongs to one kind alone. Simple
values come first, so that a failure shrinks to a homogeneous grey medium and a ray along an axis. Importing this package tells
Hypothesis of all of them: `st.from_type(Ray)` or a bare `@given(medium=...)` is enough then.

Needs Hypothesis: python -m pip install 'fogproof[hypothesis]'.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError, NotInstalledError

try:
    from hypothesis import strategies as st
except ImportError:
    raise NotInstalledError("Hypothesis", "hypothesis") from None

from fogproof.scene import Ray, Scene
from fogproof.scene.lights import KINDS as LIGHTS
from fogproof.scene.media import KINDS as MEDIA
from fogproof.scene.phase import KINDS as PHASES
from fogproof.scene.phase import PhaseFunction
from fogproof.scene.shapes import KINDS as SHAPES
from fogproof.strategies.fields import FIELDS
from fogproof.strategies.kinds import known, of_kind
from fogproof.strategies.values import directions, points, positive

__all__ = ["lights", "media", "phase_functions", "rays", "scenes", "shapes"]


def _of(table: dict[str, type], kinds: tuple[str, ...]) -> st.SearchStrategy[Any]:
    chosen = kinds or tuple(table)
    if unknown := [kind for kind in chosen if kind not in table]:
        raise InvalidValueError("kinds", f"must be among {', '.join(table)}", unknown[0])
    return st.one_of([of_kind(kind, table[kind]) for kind in chosen])


def phase_functions(*kinds: str, mixtures: bool = True) -> st.SearchStrategy[PhaseFunction]:
    """Draw phase functions, of the given kinds or of all that the installed packages can compute; |g| up to 0.95."""
    return _of(PHASES, kinds or tuple(kind for kind in PHASES if known(kind) and (mixtures or kind != "mixture")))


def media(*kinds: str) -> st.SearchStrategy[Any]:
    """Draw grey media, of the given kinds or of all; coefficients up to a few per metre, within 10 m of the origin."""
    return _of(MEDIA, kinds)


def lights(*kinds: str) -> st.SearchStrategy[Any]:
    """Draw grey lights, of the given kinds or of all."""
    return _of(LIGHTS, kinds)


def shapes(*kinds: str) -> st.SearchStrategy[Any]:
    """Draw shapes that hold a medium, of the given kinds or of all."""
    return _of(SHAPES, kinds)


def rays(endless: bool = True) -> st.SearchStrategy[Ray]:
    """Draw single rays, often along an axis; without `endless`, none of infinite length."""
    lengths = st.one_of(st.just(1.0), *([st.just(np.inf)] if endless else []), positive(20.0))
    return st.builds(Ray, points, directions, lengths)


def scenes() -> st.SearchStrategy[Scene]:
    """Draw scenes of every level of scattering; a ray in OpenGL's fog starts at its eye."""

    @st.composite
    def scene(draw: st.DrawFn) -> Scene:
        medium, ray = draw(media()), draw(rays())
        if hasattr(medium, "eye"):
            ray = dataclasses.replace(ray, origin=medium.eye)
        level = draw(st.sampled_from(["none", "ambient", "single"]))
        light = draw(lights()) if level == "single" else None
        ambient = draw(FIELDS["ambient"]) if level == "ambient" else 0.0
        return Scene(medium, ray, level, light, ambient=ambient, background=draw(FIELDS["background"]))

    return scene()


for _table in (PHASES, MEDIA, LIGHTS, SHAPES):
    for _kind, _made in _table.items():
        st.register_type_strategy(_made, of_kind(_kind, _made))
st.register_type_strategy(PhaseFunction, phase_functions())
st.register_type_strategy(Ray, rays())
st.register_type_strategy(Scene, scenes())
