"""Evidence for what relations found in renders of volumes: thickness that is missing where rays start inside."""

from __future__ import annotations

import json
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from fogproof.images.picture import read_picture
from fogproof.relations import ImageSetting
from fogproof.relations.moved import scaled, translated
from fogproof.renderers.running import RenderFailure, render_one
from fogproof.renderers.table import RENDERERS
from fogproof.scene import Film, ImageScene, Medium, OneRay
from fogproof.scene.shapes import Slab
from fogproof.scene.to_json import to_json

RAY_EPSILON = 1500 * 2.0**-24
"""Mitsuba's, in single precision; a ray starts it times 1 + the largest coordinate beyond the surface."""

SIGMA_T, THICKNESS = 0.7, 2.0


def missing_thickness() -> str:
    """Measure by how much an absorbing slab is too thin, from its transmittance alone (Beer and Lambert)."""
    scene = ImageScene(
        Medium(SIGMA_T, 0.0),
        OneRay((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), Film(48, 48)),
        shape=Slab((0.0, 0.0, 2.0), (0.0, 0.0, -1.0), THICKNESS),
        background=1.0,
    )
    here = ImageSetting(scene)
    places = {
        "500 m away": (translated(here, (500.0, -500.0, 250.0)), 1.0),
        "a thousandth as large": (scaled(here, 1e-3), 1e-3),
    }
    told = []
    for name, (setting, unit) in places.items():
        value = rendered(setting.scene)
        mean, error = float(np.mean(value)), float(np.std(value)) / np.sqrt(value.size)
        missing = unit * (THICKNESS + np.log(mean) / SIGMA_T)
        shape = setting.shape
        assert isinstance(shape, Slab)
        predicted = (1 + max(np.abs(shape.point))) * RAY_EPSILON
        told.append(f"{name}: {missing:.4g} +- {unit * error / mean / SIGMA_T:.1g} m, predicted {predicted:.4g} m")
    return f"Thickness that an absorbing slab lacks, from its transmittance: {'; '.join(told)}."


def rendered(scene: ImageScene) -> np.ndarray:
    """Return the pixels of a scene, by Mitsuba's scalar variant."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "scene.json"
        source.write_text(json.dumps(to_json(replace(scene, purpose=""))))
        values = {"python": sys.executable, "samples": "4096", "seed": "1", "threads": "0", "integrator": "volpath"}
        found = render_one(RENDERERS["mitsuba"], source, Path(folder) / "out.exr", values, 600.0)
        if isinstance(found, RenderFailure):
            raise SystemExit(found.reason)
        pixels: np.ndarray = read_picture([found], scene.camera.film, None).value
        return pixels
