"""fogproof proves Monte Carlo volume estimators right or wrong.

The two calls every user meets first are `check_sampler` and `check_estimator`; the oracle is `fogproof.analytic`. `Ball` and `Box`
are domains here; the shapes of that name, which hold a medium, are in `fogproof.scene`.
Importing this package loads NumPy alone; everything heavier loads where it is used.
"""

from __future__ import annotations

from fogproof import module_start as _module_start  # noqa: F401  # before all that a file could stand in the place of

# isort: split
import importlib
from typing import TYPE_CHECKING, Any

from fogproof import checks as _checks
from fogproof import domains as _domains
from fogproof.contracts import Draw, Draws, Estimator, Reference, Sampler
from fogproof.domains import *  # noqa: F403
from fogproof.errors import FogproofError, InvalidValueError, UnsupportedError

if TYPE_CHECKING:
    from fogproof.checks import *  # noqa: F403
    from fogproof.distributed import check_distributed
    from fogproof.gradient_check import check_gradient
    from fogproof.images.compare import compare_image
    from fogproof.images.pairs import compare_pictures
    from fogproof.relation_check import check_relations
    from fogproof.runs import Run
    from fogproof.scene import cameras as _cameras
    from fogproof.scene import grounds as _grounds
    from fogproof.scene import lights as _lights
    from fogproof.scene import media as _media
    from fogproof.scene import occluders as _occluders
    from fogproof.scene import phase as _phase
    from fogproof.scene import surfaces as _surfaces
    from fogproof.scene.cameras import *  # noqa: F403
    from fogproof.scene.files import read_image_scene, read_scene
    from fogproof.scene.grounds import *  # noqa: F403
    from fogproof.scene.image_scenes import ImageScene
    from fogproof.scene.lights import *  # noqa: F403
    from fogproof.scene.media import *  # noqa: F403
    from fogproof.scene.occluders import *  # noqa: F403
    from fogproof.scene.phase import *  # noqa: F403
    from fogproof.scene.rays import Ray
    from fogproof.scene.scenes import Scattering, Scene
    from fogproof.scene.shapes import HalfSpace, Shape, Slab, Unbounded
    from fogproof.scene.slab_layers import SlabLayer
    from fogproof.scene.surfaces import *  # noqa: F403
    from fogproof.scene.volume_files import read_voxel_grid
    from fogproof.scene_estimator import estimator_for

__version__ = "0.1.0"

__all__ = [
    "Draw",
    "Draws",
    "Estimator",
    "FogproofError",
    "HalfSpace",
    "ImageScene",
    "InvalidValueError",
    "Ray",
    "Reference",
    "Run",
    "Sampler",
    "Scattering",
    "Scene",
    "Shape",
    "Slab",
    "SlabLayer",
    "Unbounded",
    "UnsupportedError",
    "check_distributed",
    "check_gradient",
    "check_relations",
    "compare_image",
    "compare_pictures",
    "estimator_for",
    "read_image_scene",
    "read_scene",
    "read_voxel_grid",
]
__all__ += _checks.__all__
__all__ += _domains.__all__
if TYPE_CHECKING:
    __all__ += _cameras.__all__
    __all__ += _grounds.__all__
    __all__ += _lights.__all__
    __all__ += _media.__all__
    __all__ += _occluders.__all__
    __all__ += _phase.__all__
    __all__ += _surfaces.__all__
_NAMES = list(__all__)
if not TYPE_CHECKING:  # what scenes are made of loads when it is first asked for, and with it the list of all names
    del __all__

_LAZY = {
    "check_distributed": "fogproof.distributed",
    "check_gradient": "fogproof.gradient_check",
    "check_relations": "fogproof.relation_check",
    "Run": "fogproof.runs",
    "compare_image": "fogproof.images.compare",
    "compare_pictures": "fogproof.images.pairs",
    "estimator_for": "fogproof.scene_estimator",
    "read_image_scene": "fogproof.scene.files",
    "read_scene": "fogproof.scene.files",
    "read_voxel_grid": "fogproof.scene.volume_files",
}
_SUBPACKAGES = {"adapters", "analytic", "catalogue", "checks", "estimators", "reports", "scene", "strategies", "study"}


def __getattr__(name: str) -> Any:
    if name in _checks.__all__:
        return getattr(_checks, name)
    if name in _LAZY:
        return getattr(importlib.import_module(_LAZY[name]), name)
    if name in _SUBPACKAGES:
        return importlib.import_module(f"fogproof.{name}")
    if name == "__all__":
        return globals().setdefault(name, sorted({*_NAMES, *importlib.import_module("fogproof.scene").__all__}))
    if name[:1].isupper() and name in (scene := importlib.import_module("fogproof.scene")).__all__:
        return globals().setdefault(name, getattr(scene, name))
    raise AttributeError(f"module 'fogproof' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__getattr__("__all__"), *_SUBPACKAGES})
