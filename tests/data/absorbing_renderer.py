"""A renderer of absorbing slabs in front of a background, by samples in each pixel; it needs NumPy alone, and can have a fault.

python absorbing_renderer.py SCENE.json OUT.npy [--samples N] [--seed S] [--fault NAME]
"""

import argparse
import json
import sys

import numpy as np

OPTIONS = argparse.ArgumentParser()
OPTIONS.add_argument("scene")
OPTIONS.add_argument("out")
OPTIONS.add_argument("--samples", type=int, default=16)
OPTIONS.add_argument("--seed", type=int, default=0)
OPTIONS.add_argument("--fault", default="none", choices=["none", "offset", "crash"])


def rays(camera, rng, samples):
    """Return origin and directions (rows, columns, samples, 3) of a pinhole camera."""
    film = camera["film"]
    x0, y0, columns, rows = film["crop"] or (0, 0, film["width"], film["height"])
    shape = (rows, columns, samples)
    x = x0 + np.arange(columns)[:, None] + rng.random(shape)
    y = y0 + np.arange(rows)[:, None, None] + rng.random(shape)
    origin = np.array(camera["origin"], float)
    ahead = np.array(camera["target"]) - origin
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, camera["up"])
    right /= np.linalg.norm(right)
    side = {"x": film["width"], "y": film["height"]}[camera["fov_axis"]]
    scale = 2 * np.tan(camera["fov"] / 2) / side
    across, down = scale * (x - film["width"] / 2), scale * (y - film["height"] / 2)
    w = ahead + across[..., None] * right - down[..., None] * np.cross(right, ahead)
    return origin, w / np.linalg.norm(w, axis=-1, keepdims=True)


def main():
    """Render."""
    given = OPTIONS.parse_args()
    with open(given.scene, encoding="utf-8") as file:
        scene = json.load(file)
    medium, shape, camera = scene["medium"], scene["shape"], scene["camera"]
    if scene["scattering"] != "none":
        sys.exit("scattering is not translated")
    if medium["kind"] != "homogeneous" or shape["kind"] != "slab" or camera["kind"] != "perspective":
        sys.exit("only slabs seen by a pinhole are translated")
    if given.fault == "crash":
        1 / 0  # noqa: B018
    rng = np.random.default_rng(given.seed)
    origin, w = rays(camera, rng, given.samples)
    cosine = np.abs(w @ np.array(shape["normal"]))
    depth = shape["thickness"]
    if given.fault == "offset":  # rays start inside by a share of their coordinates, as if those were rounded
        depth = max(depth - 2e-4 * np.max(np.abs(origin)), 0)
    sigma_t = np.add(medium["sigma_a"], medium["sigma_s"])
    seen = np.exp(-np.multiply.outer(depth / cosine, sigma_t)) * scene["background"]
    np.save(given.out, np.float32(seen.mean(axis=2).reshape(*w.shape[:2], -1)))


if __name__ == "__main__":
    main()
