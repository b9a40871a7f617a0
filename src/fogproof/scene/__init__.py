"""Scenes as plain frozen data that validate themselves. No formula lives here."""

from fogproof.scene import cameras as _cameras
from fogproof.scene import grounds as _grounds
from fogproof.scene import lights as _lights
from fogproof.scene import media as _media
from fogproof.scene import occluders as _occluders
from fogproof.scene import phase as _phase
from fogproof.scene import shapes as _shapes
from fogproof.scene import surfaces as _surfaces
from fogproof.scene.cameras import *  # noqa: F403
from fogproof.scene.grounds import *  # noqa: F403
from fogproof.scene.image_scenes import ImageScene
from fogproof.scene.lights import *  # noqa: F403
from fogproof.scene.media import *  # noqa: F403
from fogproof.scene.occluders import *  # noqa: F403
from fogproof.scene.phase import *  # noqa: F403
from fogproof.scene.rays import Ray
from fogproof.scene.scenes import Scattering, Scene
from fogproof.scene.shapes import *  # noqa: F403
from fogproof.scene.slab_layers import SlabLayer
from fogproof.scene.surfaces import *  # noqa: F403

__all__ = ["ImageScene", "Ray", "Scattering", "Scene", "SlabLayer"]
__all__ += _cameras.__all__
__all__ += _grounds.__all__
__all__ += _lights.__all__
__all__ += _media.__all__
__all__ += _occluders.__all__
__all__ += _phase.__all__
__all__ += _shapes.__all__
__all__ += _surfaces.__all__
