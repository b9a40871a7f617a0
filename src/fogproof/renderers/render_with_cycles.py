"""Blender's Cycles renders a scene, by a Python 3.11 that has bpy 5.

    python render_with_cycles.py SCENE.json OUT.exr [--samples N] [--seed S] [--threads N] [--integrator NAME]

This file needs nothing else of fogproof, so that it can be copied. What Blender means by its parameters is written beside each.
"""

from __future__ import annotations

import argparse
import json
import math
from typing import Any

FAR = 1e3
"""Half the side of what is meant to be endless [m]."""


def build(scene: dict[str, Any], samples: int, seed: int, threads: int = 0, integrator: str = "tracked") -> None:
    """Make the scene Blender's own; volumes are tracked without bias, or marched in steps."""
    import bpy
    from mathutils import Matrix, Vector

    refuse_what_cycles_lacks(scene)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    settings = bpy.context.scene
    settings.render.engine = "CYCLES"
    cycles = settings.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    # Each of these is on by default, and each changes what is measured.
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_guiding = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sampling_pattern = "TABULATED_SOBOL"
    bounces = (
        1024 if scene["scattering"] == "multiple" else 0
    )  # the first scattering is no bounce: 0 is single scattering
    cycles.max_bounces = cycles.volume_bounces = cycles.transparent_max_bounces = bounces
    cycles.transparent_max_bounces = 1024
    cycles.volume_biased = integrator == "marched"
    cycles.volume_step_rate, cycles.volume_max_steps = 0.1, 65536
    settings.render.threads_mode, settings.render.threads = "FIXED", threads or 1
    settings.view_settings.view_transform = "Raw"
    settings.render.image_settings.file_format = "OPEN_EXR"
    settings.render.image_settings.color_depth = "32"  # half floats by default

    camera_of(bpy, Matrix, Vector, settings, scene["camera"])
    fog = fog_of(bpy, scene)
    shape_of(bpy, Vector, settings, scene, fog)
    if scene.get("light") is not None and scene["light"]["kind"] != "environment":
        light_of(bpy, Vector, settings, scene["light"])
    world = bpy.data.worlds.new("sky")
    settings.world = world
    world.use_nodes = True
    world.node_tree.nodes.clear()
    if scene["camera"]["wall"] != "inf":
        wall_of(bpy, Vector, settings, scene["camera"], scene["background"])
    elif positive(scene["background"]):
        shines(world.node_tree, "ShaderNodeBackground", "ShaderNodeOutputWorld", scene["background"])
    for occluder in scene["occluders"]:
        occluder_of(bpy, Vector, settings, occluder)


def refuse_what_cycles_lacks(scene: dict[str, Any]) -> None:
    """Exit with a sentence where Cycles has no such thing, or means another."""
    light, background = scene.get("light"), scene["background"]
    if scene["scattering"] == "ambient":
        raise SystemExit("Cycles has no constant in-scattered radiance: scattering = 'ambient' cannot be rendered")
    if scene["medium"]["kind"] != "homogeneous":
        raise SystemExit(f"a medium of kind {scene['medium']['kind']!r} is not translated for Cycles")
    if light is not None and light["kind"] == "environment":
        if background != light["radiance"] or scene["camera"]["wall"] != "inf":
            raise SystemExit("an environment is seen where rays end: background must be its radiance, without a wall")
    elif scene["scattering"] != "none" and positive(background):
        raise SystemExit("a wall or sky that shines also lights the medium: give it background = 0")
    if scene["scattering"] == "single" and positive(scene["medium"]["emission"]):
        raise SystemExit("emission scatters to all orders or not at all: scattering must be none or multiple")


def camera_of(bpy: Any, Matrix: Any, Vector: Any, settings: Any, camera: dict[str, Any]) -> None:
    """Place the camera: it looks along its -z, x to the right and y up."""
    film = camera["film"]
    settings.render.resolution_x, settings.render.resolution_y = film["width"], film["height"]
    settings.render.resolution_percentage = 100
    if film["crop"] is not None:
        x, y, width, height = film["crop"]
        border = settings.render
        border.use_border = border.use_crop_to_border = True
        border.border_min_x, border.border_max_x = x / film["width"], (x + width) / film["width"]
        border.border_min_y, border.border_max_y = 1 - (y + height) / film["height"], 1 - y / film["height"]
    data = bpy.data.cameras.new("camera")
    body = bpy.data.objects.new("camera", data)
    settings.collection.objects.link(body)
    settings.camera = body
    origin, target = Vector(camera["origin"]), Vector(camera["target"])
    ahead = (target - origin).normalized()
    right = ahead.cross(Vector(camera["up"])).normalized()
    up = right.cross(ahead)
    body.matrix_world = Matrix.Translation(origin) @ Matrix((right, up, -ahead)).transposed().to_4x4()
    data.clip_start, data.clip_end = 1e-5, 1e6
    data.sensor_fit = "HORIZONTAL"
    if camera["kind"] == "perspective":
        data.type, data.angle = "PERSP", 2 * math.atan(half_width(camera))
    else:
        data.type = "ORTHO"
        data.ortho_scale = camera["width"] if camera["kind"] == "orthographic" else 1e-5


def half_width(camera: dict[str, Any]) -> float:
    """Return the tangent of half the horizontal angle of view."""
    width, height = camera["film"]["width"], camera["film"]["height"]
    sides = {"x": width, "y": height, "smaller": min(width, height), "larger": max(width, height)}
    side = sides.get(camera["fov_axis"], math.hypot(width, height))
    return float(math.tan(0.5 * camera["fov"]) * width / side)


def fog_of(bpy: Any, scene: dict[str, Any]) -> Any:
    """Return the material: coefficient = density x colour; what absorbs has the density of what its colour is not."""
    medium = scene["medium"]
    material = bpy.data.materials.new("fog")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    out, parts = tree.nodes.new("ShaderNodeOutputMaterial"), []
    sigma_a, sigma_s = three(medium["sigma_a"]), three(medium["sigma_s"])
    if scene["scattering"] == "none":  # scattered light never comes back: that is absorption
        sigma_a, sigma_s, glows = [a + s for a, s in zip(sigma_a, sigma_s, strict=True)], [0.0] * 3, list(sigma_a)
    else:
        glows = sigma_a
    if any(sigma_s):
        density = max(sigma_s)
        node = tree.nodes.new("ShaderNodeVolumeScatter")
        node.inputs["Density"].default_value = density
        node.inputs["Color"].default_value = (*[s / density for s in sigma_s], 1)
        kind = medium["phase"]["kind"]
        if kind not in ("isotropic", "henyey-greenstein", "rayleigh"):
            raise SystemExit(f"a phase function of kind {kind!r} is not translated for Cycles")
        if kind == "rayleigh":
            node.phase = "RAYLEIGH"
        else:
            node.inputs["Anisotropy"].default_value = medium["phase"].get("g", 0.0)
        parts.append(node)
    if any(sigma_a):
        density = max(sigma_a)
        node = tree.nodes.new("ShaderNodeVolumeAbsorption")  # absorbs density x (1 - colour)
        node.inputs["Density"].default_value = density
        node.inputs["Color"].default_value = (*[1 - a / density for a in sigma_a], 1)
        parts.append(node)
    emission = [a * e for a, e in zip(glows, three(medium["emission"]), strict=True)]
    if any(emission):
        node = tree.nodes.new("ShaderNodeEmission")  # in a volume: radiance per metre
        node.inputs["Strength"].default_value = max(emission)
        node.inputs["Color"].default_value = (*[e / max(emission) for e in emission], 1)
        parts.append(node)
    if parts:
        last = parts[0].outputs[0]
        for part in parts[1:]:
            add = tree.nodes.new("ShaderNodeAddShader")
            tree.links.new(last, add.inputs[0])
            tree.links.new(part.outputs[0], add.inputs[1])
            last = add.outputs[0]
        tree.links.new(last, out.inputs["Volume"])
    return material


def shape_of(bpy: Any, Vector: Any, settings: Any, scene: dict[str, Any], fog: Any) -> None:
    """Make what the medium fills."""
    shape = scene["shape"]
    kind = shape["kind"]
    if kind == "ball":  # a mesh is a polyhedron: fine enough that its volume is right to 1e-5
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=1024, ring_count=512, radius=shape["radius"], location=shape["center"]
        )
    else:
        if kind == "box":
            lower, upper = Vector(shape["lower"]), Vector(shape["upper"])
            middle, size, axis = (lower + upper) / 2, upper - lower, None
        elif kind == "unbounded":
            middle, size, axis = Vector(scene["camera"]["origin"]), Vector((FAR, FAR, FAR)), None
        else:
            depth = shape["thickness"] if kind == "slab" else FAR
            axis = Vector(shape["normal"])
            middle, size = Vector(shape["point"]) - 0.5 * depth * axis, Vector((FAR, FAR, depth))
        bpy.ops.mesh.primitive_cube_add(size=1, location=middle)
        body = bpy.context.object
        body.scale = size
        if axis is not None:
            body.rotation_mode = "QUATERNION"
            body.rotation_quaternion = axis.to_track_quat("Z", "Y")
    bpy.context.object.data.materials.append(fog)


def light_of(bpy: Any, Vector: Any, settings: Any, light: dict[str, Any]) -> None:
    """Place the light: a point's power is 4 pi times its intensity in W/sr, a spot's too; a sun's strength is its irradiance."""
    kind = light["kind"]
    if kind == "point":
        data = bpy.data.lights.new("light", "POINT")
        strength = light["intensity"]
    elif kind == "directional":
        data = bpy.data.lights.new("light", "SUN")
        data.angle = 0.0
        strength = light["irradiance"]
    elif kind == "spot" and light["profile"] == "smoothstep" and not light["exponent"]:
        data = bpy.data.lights.new("light", "SPOT")
        edge = math.cos(light["half_angle"])
        full = math.cos(light["half_angle"] if light["falloff_start"] is None else light["falloff_start"])
        data.spot_size, data.spot_blend = 2 * light["half_angle"], (full - edge) / (1 - edge)
        strength = light["intensity"]
    else:
        raise SystemExit(f"a light of kind {kind!r} of this profile is not translated for Cycles")
    values = three(strength)
    largest = max(values) or 1.0
    data.color = [value / largest for value in values]
    data.energy = largest if kind == "directional" else 4 * math.pi * largest
    if kind != "directional":
        data.shadow_soft_size = 0.0
    body = bpy.data.objects.new("light", data)
    settings.collection.objects.link(body)
    if "position" in light:
        body.location = light["position"]
    if "direction" in light:
        body.rotation_mode = "QUATERNION"
        body.rotation_quaternion = Vector(light["direction"]).to_track_quat("-Z", "Y")


def wall_of(bpy: Any, Vector: Any, settings: Any, camera: dict[str, Any], background: Any) -> None:
    """Make the wall: a plane across the axis that shines, or is black."""
    origin, target = Vector(camera["origin"]), Vector(camera["target"])
    ahead = (target - origin).normalized()
    bpy.ops.mesh.primitive_plane_add(size=FAR / 2, location=origin + camera["wall"] * ahead)
    body = bpy.context.object
    body.rotation_mode = "QUATERNION"
    body.rotation_quaternion = (-ahead).to_track_quat("Z", "Y")
    body.data.materials.append(plain(bpy, background))


def occluder_of(bpy: Any, Vector: Any, settings: Any, occluder: dict[str, Any]) -> None:
    """Make something black that casts a shadow."""
    if occluder["kind"] == "sphere":
        radius, center = occluder["radius"], occluder["center"]
        bpy.ops.mesh.primitive_uv_sphere_add(segments=512, ring_count=256, radius=radius, location=center)
    else:
        bpy.ops.mesh.primitive_circle_add(
            vertices=1024, fill_type="TRIFAN", radius=occluder["radius"], location=occluder["center"]
        )
        bpy.context.object.rotation_mode = "QUATERNION"
        bpy.context.object.rotation_quaternion = Vector(occluder["normal"]).to_track_quat("Z", "Y")
    bpy.context.object.data.materials.append(plain(bpy, 0.0))


def plain(bpy: Any, radiance: Any) -> Any:
    """Return a surface of one radiance, black if that is 0."""
    material = bpy.data.materials.new("plain")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    shines(material.node_tree, "ShaderNodeEmission", "ShaderNodeOutputMaterial", radiance)
    return material


def shines(tree: Any, node_kind: str, output_kind: str, radiance: Any) -> None:
    """Let a surface or the sky shine."""
    node, out = tree.nodes.new(node_kind), tree.nodes.new(output_kind)
    values = three(radiance)
    largest = max(values)
    node.inputs["Color"].default_value = (*[v / largest if largest else 0.0 for v in values], 1)
    node.inputs["Strength"].default_value = largest
    tree.links.new(node.outputs[0], out.inputs["Surface"])


def three(value: Any) -> list[float]:
    """Return three channels of a grey value or of three."""
    if isinstance(value, int | float):
        return [float(value)] * 3
    if len(value) == 1:
        return [float(value[0])] * 3
    if len(value) != 3:
        raise SystemExit(f"Cycles has 3 channels, the scene has {len(value)}")
    return [float(x) for x in value]


def positive(value: Any) -> bool:
    """Return whether any channel is above 0."""
    return any(x > 0 for x in three(value))


def main() -> None:
    """Render."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("out")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=0, help="0: as many as it likes")
    parser.add_argument("--integrator", default="tracked", choices=["tracked", "marched"])
    given = parser.parse_args()
    with open(given.scene, encoding="utf-8") as file:
        scene = json.load(file)
    build(scene, given.samples, given.seed, given.threads, given.integrator)
    import bpy

    bpy.context.scene.render.filepath = given.out
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
