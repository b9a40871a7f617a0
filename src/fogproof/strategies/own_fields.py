"""Fields that belong together in one kind, or mean something else in it than elsewhere."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from hypothesis import strategies as st

from fogproof.scene import Medium, VoxelGrid
from fogproof.scene.phase import LegendreSeries
from fogproof.scene.shapes import Box
from fogproof.strategies.values import directions, numbers, points, positive, share


def _box(draw: st.DrawFn) -> dict[str, Any]:
    lower = draw(points)
    size = draw(st.tuples(*3 * [positive(5.0)]))
    return {"lower": lower, "upper": tuple(low + s for low, s in zip(lower, size, strict=True))}


def _spot(draw: st.DrawFn) -> dict[str, Any]:
    half = draw(st.floats(0.05, math.pi / 2))
    start = draw(st.one_of(st.none(), share.map(lambda share: share * half)))
    profile = draw(st.sampled_from(["smoothstep", "linear"]))
    return {"half_angle": half, "falloff_start": start, "exponent": draw(st.integers(0, 8)), "profile": profile}


def _rectangle(draw: st.DrawFn) -> dict[str, Any]:
    w = np.array(draw(directions))
    u = np.cross(w, (1.0, 0.0, 0.0) if abs(w[0]) < 0.7 else (0.0, 1.0, 0.0))
    u /= np.linalg.norm(u)
    a, b = draw(positive(4.0)), draw(positive(4.0))
    return {"edge_u": tuple((a * u).tolist()), "edge_v": tuple((b * np.cross(w, u)).tolist())}


def _layers(draw: st.DrawFn) -> dict[str, Any]:
    count = draw(st.integers(1, 4))
    widths = draw(st.lists(positive(3.0), min_size=count, max_size=count))
    sigma_t = draw(st.lists(numbers(0, 2), min_size=count, max_size=count))
    return {"boundaries": np.cumsum([draw(numbers(-5, 5)), *widths]), "sigma_t": np.array(sigma_t)}


def _voxels(draw: st.DrawFn) -> dict[str, Any]:
    shape = draw(st.tuples(*3 * [st.integers(1, 3)]))
    values = draw(st.lists(numbers(0, 2), min_size=math.prod(shape), max_size=math.prod(shape)))
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
    start = draw(numbers(0, 5))
    return {
        "mode": draw(st.sampled_from(["exp", "exp2", "linear"])),
        "start": start,
        "end": start + draw(positive(20.0)),
    }


def _puffs(draw: st.DrawFn) -> dict[str, Any]:
    count = draw(st.integers(1, 3))

    def each(strategy: st.SearchStrategy[Any]) -> np.ndarray:
        return np.array(draw(st.lists(strategy, min_size=count, max_size=count)))

    return {"centers": each(points), "widths": each(positive(3.0)), "densities": each(numbers(0, 2))}


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
    grid = draw(st.from_type(VoxelGrid))
    grid = dataclasses.replace(grid, emission=0.0)
    return {"grid": grid, "temperature": 800.0 + 300.0 * grid.sigma_t, "wavelengths": draw(st.floats(4e-7, 1e-5))}


def _moved(draw: st.DrawFn) -> dict[str, Any]:
    """A grid, turned about an axis and stretched."""
    w = np.array(draw(directions))
    turn = np.eye(3) - 2 * np.outer(w, w)
    matrix = np.concatenate(
        [turn @ np.diag(draw(st.tuples(*3 * [st.floats(0.5, 2.0)]))), np.reshape(draw(points), (3, 1))], 1
    )
    return {"medium": draw(st.from_type(VoxelGrid)), "to_world": matrix}


def _several(draw: st.DrawFn) -> dict[str, Any]:
    """Two media in boxes that may overlap."""
    one = st.from_type(Medium)
    return {
        "media": (draw(one), draw(one)),
        "shapes": tuple(draw(st.from_type(Box)) for _ in range(2)),
        "overlap": draw(st.sampled_from(["sum", "first"])),
    }


OWN: dict[str, Any] = {
    "composite": _several,
    "transformed": _moved,
    "temperature-grid": _hot,
    "spot": _spot,
    "rectangle": _rectangle,
    "environment-map": lambda draw: {
        "image": np.array(draw(st.lists(st.tuples(*4 * [share]), min_size=2, max_size=2)))
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
