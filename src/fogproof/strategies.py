"""Hypothesis strategies for what scenes are made of: media, phase functions, rays, lights, shapes, whole scenes.

    from hypothesis import given
    from fogproof.strategies import media, rays

    @given(media(), rays())
    def test_my_tracker(medium, ray): ...

A kind is drawn field by field: what a field of some name may be stands in `FIELDS`, what belongs to one kind alone in `OWN`. Simple
values come first, so that a failure shrinks to a homogeneous grey medium and a ray along an axis. Importing this module tells
Hypothesis of all of them: `st.from_type(Ray)` or a bare `@given(medium=...)` is enough then.

Needs Hypothesis: python -m pip install 'fogproof[hypothesis]'.
"""

from __future__ import annotations

import dataclasses
import math
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
from fogproof.scene.phase import LegendreSeries, Mixture, PhaseFunction, Tabulated
from fogproof.scene.shapes import KINDS as SHAPES

__all__ = ["lights", "media", "phase_functions", "rays", "scenes", "shapes"]

_ASYMMETRY = 0.95
_FAR = 10.0


def _numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """Whole and round numbers first; closer to another than rounding is nothing that anybody means."""
    return st.one_of(
        st.integers(math.ceil(low), math.floor(high)).map(float), st.floats(low, high).map(lambda x: round(x, 9))
    )


def _positive(high: float) -> st.SearchStrategy[float]:
    return st.one_of(st.integers(1, math.floor(high)).map(float), st.floats(1e-3, high))


_points = st.tuples(*3 * [_numbers(-_FAR, _FAR)])
_asymmetry = st.one_of(st.sampled_from([0.0, 0.5, -0.5, 0.9, -0.9]), st.floats(-_ASYMMETRY, _ASYMMETRY))
_share = st.one_of(st.sampled_from([0.0, 1.0, 0.5]), st.floats(0, 1))


def _unit(v: tuple[float, ...]) -> tuple[float, ...]:
    """Return the unit vector along v, twice divided: once leaves rounding where v is tiny."""
    array = np.array(v) / np.linalg.norm(v)
    return tuple((array / np.linalg.norm(array)).tolist())


directions = st.one_of(
    st.sampled_from([(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)]),
    st.tuples(*3 * [_numbers(-1, 1)]).filter(lambda v: math.hypot(*v) > 1e-3).map(_unit),
)
"""Unit vectors (x, y, z), often along an axis."""

FIELDS: dict[str, st.SearchStrategy[Any]] = {
    **dict.fromkeys(("g", "g1", "g2", "k"), _asymmetry),
    **dict.fromkeys(("position", "center", "point", "corner", "eye"), _points),
    **dict.fromkeys(("direction", "normal", "axis"), directions),
    **dict.fromkeys(("radius", "thickness"), _positive(5.0)),
    **dict.fromkeys(("intensity", "irradiance", "radiance", "emission", "ambient", "background"), _numbers(0, 10)),
    **dict.fromkeys(("sigma_a", "sigma_s", "sigma_0", "sigma", "density"), _numbers(0, 2)),
    **dict.fromkeys(("albedo", "weight"), _share),
    "alpha": _numbers(0, 5),
    "kappa": _numbers(-20, 20),
    "gradient": st.tuples(*3 * [_numbers(-1, 1)]),
    "rate": st.tuples(*3 * [_numbers(-1, 1)]),
    "phase": st.deferred(lambda: phase_functions()),
}
"""What a field of this name may be, in whatever kind."""


def _box(draw: st.DrawFn) -> dict[str, Any]:
    lower = draw(_points)
    size = draw(st.tuples(*3 * [_positive(5.0)]))
    return {"lower": lower, "upper": tuple(low + s for low, s in zip(lower, size, strict=True))}


def _spot(draw: st.DrawFn) -> dict[str, Any]:
    half = draw(st.floats(0.05, math.pi / 2))
    start = draw(st.one_of(st.none(), _share.map(lambda share: share * half)))
    profile = draw(st.sampled_from(["smoothstep", "linear"]))
    return {"half_angle": half, "falloff_start": start, "exponent": draw(st.integers(0, 8)), "profile": profile}


def _rectangle(draw: st.DrawFn) -> dict[str, Any]:
    w = np.array(draw(directions))
    u = np.cross(w, (1.0, 0.0, 0.0) if abs(w[0]) < 0.7 else (0.0, 1.0, 0.0))
    u /= np.linalg.norm(u)
    a, b = draw(_positive(4.0)), draw(_positive(4.0))
    return {"edge_u": tuple((a * u).tolist()), "edge_v": tuple((b * np.cross(w, u)).tolist())}


def _layers(draw: st.DrawFn) -> dict[str, Any]:
    count = draw(st.integers(1, 4))
    widths = draw(st.lists(_positive(3.0), min_size=count, max_size=count))
    sigma_t = draw(st.lists(_numbers(0, 2), min_size=count, max_size=count))
    return {"boundaries": np.cumsum([draw(_numbers(-5, 5)), *widths]), "sigma_t": np.array(sigma_t)}


def _voxels(draw: st.DrawFn) -> dict[str, Any]:
    shape = draw(st.tuples(*3 * [st.integers(1, 3)]))
    values = draw(st.lists(_numbers(0, 2), min_size=math.prod(shape), max_size=math.prod(shape)))
    between = draw(st.sampled_from(["nearest", "trilinear"]))
    return {**_box(draw), "sigma_t": np.reshape(values, shape), "interpolation": between}


def _flakes(draw: st.DrawFn) -> dict[str, Any]:
    """S = R diag(areas^2) R^T, as whole as rounding lets it be."""
    w = np.array(draw(directions))
    u = np.cross(w, (1.0, 0.0, 0.0) if abs(w[0]) < 0.7 else (0.0, 1.0, 0.0))
    u /= np.linalg.norm(u)
    R = np.stack([u, np.cross(w, u), w], axis=-1)
    S = R @ np.diag(np.square(draw(st.tuples(*3 * [st.floats(0.1, 1.0)])))) @ R.T
    return {"S": (S + S.T) / 2}


def _fog(draw: st.DrawFn) -> dict[str, Any]:
    start = draw(_numbers(0, 5))
    return {
        "mode": draw(st.sampled_from(["exp", "exp2", "linear"])),
        "start": start,
        "end": start + draw(_positive(20.0)),
    }


def _puffs(draw: st.DrawFn) -> dict[str, Any]:
    count = draw(st.integers(1, 3))

    def each(strategy: st.SearchStrategy[Any]) -> np.ndarray:
        return np.array(draw(st.lists(strategy, min_size=count, max_size=count)))

    return {"centers": each(_points), "widths": each(_positive(3.0)), "densities": each(_numbers(0, 2))}


def _sphere(draw: st.DrawFn) -> dict[str, Any]:
    return {
        "diameter": draw(st.floats(1e-8, 2e-6)),
        "wavelength": draw(st.floats(380e-9, 780e-9)),
        "refractive_index": complex(draw(st.floats(1.05, 2.0)), draw(st.sampled_from([0.0, 0.01, 0.1]))),
        "medium_index": 1.0,
    }


def _spheres(draw: st.DrawFn) -> dict[str, Any]:
    one = _sphere(draw)
    return {
        "distribution": draw(st.sampled_from(["gamma", "log-normal"])),
        "effective_diameter": one.pop("diameter") / 4,
        "effective_variance": draw(st.floats(0.01, 0.2)),
        **one,
    }


def _hot(draw: st.DrawFn) -> dict[str, Any]:
    grid = draw(of_kind("voxel-grid", MEDIA["voxel-grid"]))
    grid = dataclasses.replace(grid, emission=0.0)
    return {"grid": grid, "temperature": 800.0 + 300.0 * grid.sigma_t, "wavelengths": draw(st.floats(4e-7, 1e-5))}


def _moved(draw: st.DrawFn) -> dict[str, Any]:
    """A grid, turned about an axis and stretched."""
    w = np.array(draw(directions))
    turn = np.eye(3) - 2 * np.outer(w, w)
    matrix = np.concatenate(
        [turn @ np.diag(draw(st.tuples(*3 * [st.floats(0.5, 2.0)]))), np.reshape(draw(_points), (3, 1))], 1
    )
    return {"medium": draw(of_kind("voxel-grid", MEDIA["voxel-grid"])), "to_world": matrix}


def _several(draw: st.DrawFn) -> dict[str, Any]:
    """Two media in boxes that may overlap."""
    one = of_kind("homogeneous", MEDIA["homogeneous"])
    return {
        "media": (draw(one), draw(one)),
        "shapes": tuple(draw(of_kind("box", SHAPES["box"])) for _ in range(2)),
        "overlap": draw(st.sampled_from(["sum", "first"])),
    }


OWN: dict[str, Any] = {
    "composite": _several,
    "transformed": _moved,
    "temperature-grid": _hot,
    "spot": _spot,
    "rectangle": _rectangle,
    "environment-map": lambda draw: {
        "image": np.array(draw(st.lists(st.tuples(*4 * [_share]), min_size=2, max_size=2)))
    },
    "box": _box,
    "piecewise-constant": _layers,
    "voxel-grid": _voxels,
    "anisotropic": _flakes,
    "opengl-fog": _fog,
    "gaussian-puffs": _puffs,
    "mie": _sphere,
    "polydisperse-mie": _spheres,
    "approximate-mie": lambda draw: {"diameter": draw(st.floats(1e-8, 50e-6))},
    "legendre-series": lambda draw: {
        "moments": LegendreSeries((1.0, *draw(st.tuples(*(st.floats(-r, r) for r in (0.12, 0.08, 0.05)))))).moments
    },
    "fournier-forand": lambda draw: {
        "refractive_index": draw(st.floats(1.02, 1.35)),
        "junge_slope": draw(st.floats(3.2, 4.8)),
    },
}
"""kind -> the fields that belong together in it, or mean something else in it than elsewhere."""


def _tables() -> st.SearchStrategy[Tabulated]:
    @st.composite
    def table(draw: st.DrawFn) -> Tabulated:
        inner = draw(st.lists(st.integers(-63, 63), max_size=4, unique=True))
        cosines = [-1.0, *sorted(k / 64 for k in inner), 1.0]
        values = draw(st.lists(_numbers(0, 10), min_size=len(cosines), max_size=len(cosines)))
        return Tabulated.normalised(cosines, values if sum(values) > 0.01 else [1.0] * len(cosines))

    return table()


def _mixtures() -> st.SearchStrategy[Mixture]:
    @st.composite
    def mixture(draw: st.DrawFn) -> Mixture:
        parts = draw(st.lists(phase_functions(mixtures=False), min_size=1, max_size=3))
        raw = np.array(draw(st.lists(st.integers(1, 8), min_size=len(parts), max_size=len(parts))), dtype=float)
        return Mixture(tuple(parts), tuple((raw / raw.sum()).tolist()))

    return mixture()


WHOLE: dict[str, Any] = {"tabulated": _tables, "mixture": _mixtures}
"""kind -> strategy of the whole thing, where fields one by one make no sense."""


def of_kind(kind: str, made: type) -> st.SearchStrategy[Any]:
    """Return the strategy of one kind; a field of which nothing is known keeps its default, or is an error that names it."""
    if kind in WHOLE:
        whole: st.SearchStrategy[Any] = WHOLE[kind]()
        return whole

    @st.composite
    def thing(draw: st.DrawFn) -> Any:
        together = OWN[kind](draw) if kind in OWN else {}
        names = [f for f in dataclasses.fields(made) if f.init and f.name not in together]
        for f in names:
            if f.name in FIELDS:
                together[f.name] = draw(FIELDS[f.name])
            elif f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING:
                raise LookupError(f"no strategy for the field {f.name!r} of {kind}: add one to FIELDS or OWN")
        return made(**together)

    return thing()


def _of(table: dict[str, type], kinds: tuple[str, ...]) -> st.SearchStrategy[Any]:
    chosen = kinds or tuple(table)
    if unknown := [kind for kind in chosen if kind not in table]:
        raise InvalidValueError("kinds", f"must be among {', '.join(table)}", unknown[0])
    return st.one_of([of_kind(kind, table[kind]) for kind in chosen])


def phase_functions(*kinds: str, mixtures: bool = True) -> st.SearchStrategy[PhaseFunction]:
    """Draw phase functions, of the given kinds or of all; |g| up to 0.95."""
    return _of(PHASES, kinds or tuple(kind for kind in PHASES if mixtures or kind != "mixture"))


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
    lengths = st.one_of(st.just(1.0), *([st.just(np.inf)] if endless else []), _positive(20.0))
    return st.builds(Ray, _points, directions, lengths)


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
