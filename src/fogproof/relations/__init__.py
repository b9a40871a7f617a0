"""Relations that hold for every renderer and every scene, and need no oracle: what must not change, or changes in a known way.

A relation takes a setting, radiance along a ray or an image, and returns what must average to the same. It knows neither
renderers nor statistics.
"""

from fogproof.relations.setting import Comparison, ImageSetting, PathSetting, RadianceTerm
from fogproof.relations.table import IMAGE_RELATIONS, RELATIONS, comparisons

__all__ = ["IMAGE_RELATIONS", "RELATIONS", "Comparison", "ImageSetting", "PathSetting", "RadianceTerm", "comparisons"]
