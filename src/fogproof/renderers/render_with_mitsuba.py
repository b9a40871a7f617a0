"""Mitsuba 3 renders a scene, by an interpreter that has mitsuba.

    python render_with_mitsuba.py SCENE.json OUT.exr [--samples N] [--seed S] [--threads N] [--integrator NAME]

This file needs nothing else of fogproof, so that it can be copied. What Mitsuba means by its parameters is written beside each.
"""

from __future__ import annotations

import argparse
import json
import math
from typing import Any

FAR = 1e4
"""Half the side of what is meant to be endless [m]."""


def scene_of(scene: dict[str, Any], mi: Any, samples: int, integrator: str = "volpath") -> dict[str, Any]:
    """Return the scene as Mitsuba's dictionary."""
    refuse_what_mitsuba_lacks(scene)
    camera = scene["camera"]
    transform = mi.ScalarTransform4f
    depth = {"none": 1, "single": 2, "multiple": -1}[scene["scattering"]]  # emitters alone, one bounce, all
    made: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": integrator, "max_depth": depth, "rr_depth": 1 << 20},
        "sensor": sensor_of(camera, samples, transform),
    }
    for i, part in enumerate(parts_of(scene)):
        made[f"fog{i}"] = medium_of(part["medium"], mi)
        body, fog = shape_of(part, transform), {"type": "ref", "id": f"fog{i}"}
        if body is None or inside(part["shape"], camera["origin"]):
            made["sensor"]["medium"] = fog  # a camera in a medium has to be told so
        if body is not None:
            made[f"body{i}"] = body | {"bsdf": {"type": "null"}, "interior": fog}
    light = scene.get("light")
    if light is not None and light["kind"] != "environment":
        made["light"] = light_of(light, transform)
    background = scene["background"]
    if camera["wall"] != "inf":
        made["wall"] = wall_of(camera, background, transform)
    elif positive(background):
        made["sky"] = {"type": "constant", "radiance": colour(background)}
    for i, occluder in enumerate(scene["occluders"]):
        made[f"occluder{i}"] = occluder_of(occluder, transform)
    return made


def refuse_what_mitsuba_lacks(scene: dict[str, Any]) -> None:
    """Exit with a sentence where Mitsuba has no such thing, or means another."""
    light, background = scene.get("light"), scene["background"]
    if scene["scattering"] == "ambient":
        raise SystemExit("Mitsuba has no constant in-scattered radiance: scattering = 'ambient' cannot be rendered")
    if positive(scene["medium"].get("emission", 0)):
        raise SystemExit("Mitsuba 3 has no emissive media")
    if light is not None and light["kind"] == "environment":
        if background != light["radiance"] or scene["camera"]["wall"] != "inf":
            raise SystemExit("an environment is seen where rays end: background must be its radiance, without a wall")
    elif scene["scattering"] != "none" and positive(background):
        raise SystemExit("a wall or sky that shines also lights the medium: give it background = 0")


def sensor_of(camera: dict[str, Any], samples: int, transform: Any) -> dict[str, Any]:
    """Return the sensor: a box filter of one pixel, full precision, and no clipping near the camera."""
    film = camera["film"]
    made: dict[str, Any] = {"type": "hdrfilm", "width": film["width"], "height": film["height"]}
    made |= {"rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32", "sample_border": False}
    if film["crop"] is not None:
        names = ("crop_offset_x", "crop_offset_y", "crop_width", "crop_height")
        made |= dict(zip(names, film["crop"], strict=True))
    view = transform().look_at(origin=camera["origin"], target=camera["target"], up=camera["up"])
    common = {
        "film": made,
        "sampler": {"type": "independent", "sample_count": samples},
        "near_clip": 1e-6,
        "far_clip": 1e9,
    }
    if camera["kind"] == "perspective":
        angles = {"fov": math.degrees(camera["fov"]), "fov_axis": camera["fov_axis"]}
        return {"type": "perspective", "to_world": view, **angles, **common}
    width = camera["width"] if camera["kind"] == "orthographic" else 1e-6  # one ray: all pixels within a micrometre
    return {"type": "orthographic", "to_world": view @ transform().scale([width / 2, width / 2, 1]), **common}


def parts_of(scene: dict[str, Any]) -> list[dict[str, Any]]:
    """Return media with the shape each fills: layers are slabs that touch, grids are boxes."""
    medium = scene["medium"]
    if medium["kind"] == "voxel-grid":
        return [{"medium": medium, "shape": {"kind": "box", "lower": medium["lower"], "upper": medium["upper"]}}]
    if medium["kind"] != "piecewise-constant":
        return [{"medium": medium, "shape": scene["shape"]}]
    parts, axis, count = [], medium["axis"], len(medium["sigma_t"])
    places = [max(-FAR, min(FAR, float(b))) for b in medium["boundaries"]]
    albedos = medium["albedo"] if isinstance(medium["albedo"], list) else [medium["albedo"]] * count
    for low, high, sigma_t, albedo in zip(places, places[1:], medium["sigma_t"], albedos, strict=False):
        layer = {"kind": "homogeneous", "phase": medium["phase"]}
        if isinstance(sigma_t, list) or isinstance(albedo, list):
            raise SystemExit("layers in colour are not translated for Mitsuba")
        layer |= {"sigma_a": sigma_t * (1 - albedo), "sigma_s": sigma_t * albedo}
        slab = {"kind": "slab", "point": [high * x for x in axis], "normal": axis, "thickness": high - low}
        parts.append({"medium": layer, "shape": slab})
    return parts


def medium_of(medium: dict[str, Any], mi: Any) -> dict[str, Any]:
    """Return the medium; sigma_t = scale times a spectrum that must not exceed 1."""
    phase = phase_of(medium["phase"])
    if medium["kind"] == "homogeneous":
        sigma_t, albedo = [], []
        for a, s in channels(medium["sigma_a"], medium["sigma_s"]):
            sigma_t.append(a + s)
            albedo.append(s / (a + s) if a + s > 0 else 0.0)
        scale = max(sigma_t) or 1.0
        spectrum = [x / scale for x in sigma_t]
        return {
            "type": "homogeneous",
            "scale": scale,
            "sigma_t": colour(spectrum),
            "albedo": colour(albedo),
            "phase": phase,
        }
    if medium["kind"] == "voxel-grid":
        import numpy as np

        values = np.asarray(medium["sigma_t"], np.float32)  # [x, y, z] here, [z, y, x] there
        grid = mi.VolumeGrid(np.ascontiguousarray(values.transpose(2, 1, 0))[..., None])
        lower, upper = medium["lower"], medium["upper"]
        to_world = mi.ScalarTransform4f().translate(lower).scale([b - a for a, b in zip(lower, upper, strict=True)])
        kind = {"nearest": "nearest", "trilinear": "trilinear"}[medium["interpolation"]]
        volume = {"type": "gridvolume", "grid": grid, "filter_type": kind, "to_world": to_world, "raw": True}
        return {"type": "heterogeneous", "albedo": medium["albedo"], "sigma_t": volume, "phase": phase}
    raise SystemExit(f"a medium of kind {medium['kind']!r} is not translated for Mitsuba")


def phase_of(phase: dict[str, Any]) -> dict[str, Any]:
    """Return the phase function; g > 0 scatters forward there too."""
    if phase["kind"] == "henyey-greenstein":
        return {"type": "hg", "g": phase["g"]}
    if phase["kind"] in ("isotropic", "rayleigh"):
        return {"type": phase["kind"]}
    raise SystemExit(f"a phase function of kind {phase['kind']!r} is not translated for Mitsuba")


def shape_of(scene: dict[str, Any], transform: Any) -> dict[str, Any] | None:
    """Return what a medium fills, None for all of space."""
    shape = scene["shape"]
    kind = shape["kind"]
    if kind == "unbounded":
        return None
    if kind == "ball":
        return {"type": "sphere", "center": shape["center"], "radius": shape["radius"]}
    if kind == "box":
        return box_of(shape["lower"], shape["upper"], transform)
    depth = shape["thickness"] if kind == "slab" else FAR
    middle = [p - 0.5 * depth * n for p, n in zip(shape["point"], shape["normal"], strict=True)]
    return {
        "type": "cube",
        "to_world": facing(middle, shape["normal"], transform) @ transform().scale([FAR, FAR, depth / 2]),
    }


def box_of(lower: list[float], upper: list[float], transform: Any) -> dict[str, Any]:
    """Return a cube; Mitsuba's own reaches from -1 to 1."""
    middle = [0.5 * (a + b) for a, b in zip(lower, upper, strict=True)]
    half = [0.5 * (b - a) for a, b in zip(lower, upper, strict=True)]
    return {"type": "cube", "to_world": transform().translate(middle).scale(half)}


def facing(origin: list[float], normal: list[float], transform: Any) -> Any:
    """Return the transform whose z-axis is the normal."""
    up = [0, 1, 0] if abs(normal[1]) < 0.9 else [1, 0, 0]
    return transform().look_at(origin=origin, target=[o + n for o, n in zip(origin, normal, strict=True)], up=up)


def light_of(light: dict[str, Any], transform: Any) -> dict[str, Any]:
    """Return the light: intensities are in W/sr, irradiances across the direction in W/m^2, as here."""
    if light["kind"] == "point":
        return {"type": "point", "position": light["position"], "intensity": colour(light["intensity"])}
    if light["kind"] == "directional":
        return {"type": "directional", "direction": light["direction"], "irradiance": colour(light["irradiance"])}
    if light["kind"] == "spot" and light["profile"] == "linear" and not light["exponent"]:
        edge = math.degrees(light["half_angle"])
        full = edge if light["falloff_start"] is None else math.degrees(light["falloff_start"])
        view = facing(light["position"], light["direction"], transform)
        return {
            "type": "spot",
            "to_world": view,
            "intensity": colour(light["intensity"]),
            "cutoff_angle": edge,
            "beam_width": full,
        }
    raise SystemExit(f"a light of kind {light['kind']!r} of this profile is not translated for Mitsuba")


def wall_of(camera: dict[str, Any], background: Any, transform: Any) -> dict[str, Any]:
    """Return the wall: a plane across the axis that shines towards the camera, black where the background is."""
    axis = [t - o for o, t in zip(camera["origin"], camera["target"], strict=True)]
    length = math.sqrt(sum(x * x for x in axis))
    normal = [-x / length for x in axis]
    place = [o - camera["wall"] * n for o, n in zip(camera["origin"], normal, strict=True)]
    made = {"type": "rectangle", "to_world": facing(place, normal, transform) @ transform().scale(FAR)}
    if positive(background):
        return made | {"emitter": {"type": "area", "radiance": colour(background)}}
    return made | {"bsdf": {"type": "diffuse", "reflectance": colour(0.0)}}


def occluder_of(occluder: dict[str, Any], transform: Any) -> dict[str, Any]:
    """Return something black that casts a shadow."""
    black = {"bsdf": {"type": "twosided", "nested": {"type": "diffuse", "reflectance": colour(0.0)}}}
    if occluder["kind"] == "sphere":
        return {"type": "sphere", "center": occluder["center"], "radius": occluder["radius"], **black}
    place = facing(occluder["center"], occluder["normal"], transform) @ transform().scale(occluder["radius"])
    return {"type": "disk", "to_world": place, **black}


def inside(shape: dict[str, Any], point: list[float]) -> bool:
    """Return whether the camera is in the medium."""
    kind = shape["kind"]
    if kind == "unbounded":
        return True
    if kind == "ball":
        return bool(math.dist(shape["center"], point) < shape["radius"])
    if kind == "box":
        return all(a < x < b for a, x, b in zip(shape["lower"], point, shape["upper"], strict=True))
    depth = sum((p - x) * n for p, x, n in zip(shape["point"], point, shape["normal"], strict=True))
    return bool(0 < depth < (shape["thickness"] if kind == "slab" else math.inf))


def colour(value: Any) -> Any:
    """Return a grey value or three channels as Mitsuba's RGB, which is not scaled or converted."""
    return {"type": "rgb", "value": [value] * 3 if isinstance(value, int | float) else three(value)}


def three(values: list[float]) -> list[float]:
    """Return the three channels, or exit."""
    if len(values) == 1:
        return values * 3
    if len(values) != 3:
        raise SystemExit(f"Mitsuba's RGB variants have 3 channels, the scene has {len(values)}")
    return values


def channels(*values: Any) -> list[tuple[float, ...]]:
    """Return the values channel by channel."""
    count = max([len(v) for v in values if isinstance(v, list)], default=1)
    return list(zip(*[v if isinstance(v, list) else [v] * count for v in values], strict=True))


def positive(value: Any) -> bool:
    """Return whether any channel is above 0."""
    return any(x > 0 for x in value) if isinstance(value, list) else value > 0


def main() -> None:
    """Render."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("out")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=0, help="0: as many as it likes")
    parser.add_argument("--integrator", default="volpath", choices=["volpath", "volpathmis"])
    given = parser.parse_args()
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    if given.threads == 1:
        raise SystemExit("Mitsuba's scalar variants did not end where they might use one thread alone: allow two")
    if given.threads:
        import drjit

        drjit.set_thread_count(given.threads)
    with open(given.scene, encoding="utf-8") as file:
        scene = json.load(file)
    image = mi.render(
        mi.load_dict(scene_of(scene, mi, given.samples, given.integrator)), spp=given.samples, seed=given.seed
    )
    mi.Bitmap(image).write(given.out)


if __name__ == "__main__":
    main()
