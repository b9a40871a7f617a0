"""A scene as a text file of pbrt-v4 (Pharr, Jakob & Humphreys 2023; https://pbrt.org/fileformat-v4). It is written, not run, here.

What pbrt means otherwise: its world is left-handed, so that x is mirrored before the camera; `fov` spans the shorter side;
`maxdepth` counts a scattering in a medium, single scattering is 1; a camera in a medium stands behind a `MediumInterface`;
intensities given as "rgb" come out of the film as they are.
"""

from __future__ import annotations

import math
from typing import Any

from fogproof.errors import UnsupportedError
from fogproof.scene import ImageScene
from fogproof.scene.to_json import to_json

FAR = 1e3
"""Half the side of what is meant to be endless [m]."""

FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""Corners of a box's faces, seen from outside; corner 4 a + 2 b + c is the upper one along x, y, z where a, b, c are 1."""


def pbrt_text(scene: ImageScene, samples: int = 256, image: str = "image.exr") -> str:
    """Return the text of a scene; raises `UnsupportedError` for what is not translated."""
    table = to_json(scene)
    lines = _camera(table, samples, image)
    inside = _inside(table["shape"], table["camera"]["origin"])
    lines[:0] = [*_medium(table), *(['MediumInterface "" "fog"'] if inside else [])]
    lines += ["WorldBegin", *_light(table), *_body(table["shape"])]
    return "\n".join(lines) + "\n"


def _camera(table: dict[str, Any], samples: int, image: str) -> list[str]:
    camera, film = table["camera"], table["camera"]["film"]
    if camera["kind"] != "perspective" or camera["wall"] != "inf":
        raise _refused("a camera other than a pinhole, or one with a wall")
    width, height = film["width"], film["height"]
    sides = {"x": width, "y": height, "smaller": min(width, height), "larger": max(width, height)}
    spanned = sides.get(camera["fov_axis"], math.hypot(width, height))
    shorter = 2 * math.atan(math.tan(camera["fov"] / 2) * min(width, height) / spanned)
    crop = film["crop"] or (0, 0, width, height)
    bounds = [crop[0], crop[0] + crop[2], crop[1], crop[1] + crop[3]]
    depth = {"none": 0, "single": 1, "multiple": 1000}.get(table["scattering"])
    if depth is None:
        raise _refused("constant in-scattered radiance")
    return [
        "Scale -1 1 1",
        f"LookAt {_numbers(camera['origin'])}  {_numbers(camera['target'])}  {_numbers(camera['up'])}",
        f'Camera "perspective" "float fov" [ {math.degrees(shorter)!r} ]',
        f'Film "rgb" "integer xresolution" [ {width} ] "integer yresolution" [ {height} ]'
        f' "integer pixelbounds" [ {_numbers(bounds)} ]'
        f' "string filename" [ "{image}" ]',
        'PixelFilter "box" "float xradius" [ 0.5 ] "float yradius" [ 0.5 ]',
        f'Sampler "independent" "integer pixelsamples" [ {samples} ]',
        f'Integrator "volpath" "integer maxdepth" [ {depth} ]',
    ]


def _medium(table: dict[str, Any]) -> list[str]:
    medium, phase = table["medium"], table["medium"].get("phase", {})
    if medium["kind"] != "homogeneous" or phase["kind"] not in ("isotropic", "henyey-greenstein"):
        raise _refused(f"a medium of kind {medium['kind']!r} with a phase function of kind {phase.get('kind')!r}")
    if any(_three(medium["emission"])):
        raise _refused("emission, whose unit differs from version to version,")
    parts = " ".join(f'"{_coefficient(name, medium[name])}' for name in ("sigma_a", "sigma_s"))
    return [
        f'MakeNamedMedium "fog" "string type" [ "homogeneous" ] {parts} "float g" [ {phase.get("g", 0.0)!r} ] "float scale" [ 1 ]'
    ]


def _coefficient(name: str, value: Any) -> str:
    """Return a grey coefficient as a constant spectrum, which no colour space touches; a coloured one as RGB."""
    if isinstance(value, int | float):
        return f'spectrum {name}" [ 200 {float(value)!r} 1000 {float(value)!r} ]'
    return f'rgb {name}" [ {_numbers(_three(value))} ]'


def _light(table: dict[str, Any]) -> list[str]:
    light, background = table["light"], _three(table["background"])
    made = []
    if light is not None and light["kind"] == "environment":
        if _three(light["radiance"]) != background:
            raise _refused("an environment other than the background")
    elif any(background) and table["scattering"] != "none":
        raise _refused("a sky that is seen and lights nothing")
    if any(background):
        made.append(f'LightSource "infinite" "rgb L" [ {_numbers(background)} ]')
    if table["occluders"]:
        raise _refused("an occluder")
    if light is None or light["kind"] == "environment" or table["scattering"] == "none":
        return made
    if light["kind"] == "point":
        strength = _numbers(_three(light["intensity"]))
        return [*made, f'LightSource "point" "point3 from" [ {_numbers(light["position"])} ] "rgb I" [ {strength} ]']
    if light["kind"] == "directional":
        ends = f'"point3 from" [ 0 0 0 ] "point3 to" [ {_numbers(light["direction"])} ]'
        return [*made, f'LightSource "distant" {ends} "rgb L" [ {_numbers(_three(light["irradiance"]))} ]']
    raise _refused(f"a light of kind {light['kind']!r}")


def _body(shape: dict[str, Any]) -> list[str]:
    """Return what the medium fills: a sphere, or a box of twelve triangles; nothing for all of space."""
    kind = shape["kind"]
    if kind == "unbounded":
        return []
    head = ["AttributeBegin", 'Material "interface"', 'MediumInterface "fog" ""']
    if kind == "ball":
        place = f"Translate {_numbers(shape['center'])}"
        return [*head, place, f'Shape "sphere" "float radius" [ {float(shape["radius"])!r} ]', "AttributeEnd"]
    corners = [" ".join(map(repr, corner)) for corner in _corners(shape)]
    triangles = [i for a, b, c, d in FACES for i in (a, b, c, a, c, d)]
    mesh = f'Shape "trianglemesh" "point3 P" [ {"  ".join(corners)} ] "integer indices" [ {_numbers(triangles)} ]'
    return [*head, mesh, "AttributeEnd"]


def _corners(shape: dict[str, Any]) -> list[tuple[float, ...]]:
    """Return the eight corners of a box, or of a slab or half space cut off far away."""
    if shape["kind"] == "box":
        axes: list[list[float]] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        ends = list(zip(shape["lower"], shape["upper"], strict=True))
        origin = [0.0, 0.0, 0.0]
    else:
        n, origin = [float(x) for x in shape["normal"]], shape["point"]
        least = min(range(3), key=lambda i: abs(n[i]))
        across = _cross(n, [float(i == least) for i in range(3)])
        size = math.hypot(*across)
        across = [x / size for x in across]
        axes = [across, _cross(n, across), n]
        ends = [(-FAR, FAR), (-FAR, FAR), (-float(shape.get("thickness", FAR)), 0.0)]
    return [
        tuple(origin[k] + sum(ends[i][side] * axes[i][k] for i, side in enumerate((a, b, c))) + 0.0 for k in range(3))
        for a in (0, 1)
        for b in (0, 1)
        for c in (0, 1)
    ]


def _inside(shape: dict[str, Any], x: list[float]) -> bool:
    kind = shape["kind"]
    if kind == "unbounded":
        return True
    if kind == "ball":
        return bool(math.dist(shape["center"], x) < float(shape["radius"]))
    if kind == "box":
        return all(a < b < c for a, b, c in zip(shape["lower"], x, shape["upper"], strict=True))
    depth = sum((p - q) * n for p, q, n in zip(shape["point"], x, shape["normal"], strict=True))
    return bool(0 < depth < float(shape.get("thickness", math.inf)))


def _cross(a: list[float], b: list[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _three(value: Any) -> list[float]:
    values = [float(value)] * 3 if isinstance(value, int | float) else [float(x) for x in value]
    if len(values) != 3:
        raise _refused(f"a scene of {len(values)} channels")
    return values


def _numbers(values: Any) -> str:
    return " ".join(repr(value) for value in values)


def _refused(what: str) -> UnsupportedError:
    return UnsupportedError(f"{what} is not translated for pbrt", "scene")
