"""Relations that hold for every renderer and every scene, and need no oracle: what must not change, or changes in a known way.

A relation takes a setting and returns what must average to the same. It knows neither renderers nor statistics.
"""

from fogproof.relations.setting import Comparison, PathSetting, RadianceTerm
from fogproof.relations.table import RELATIONS, comparisons

__all__ = ["RELATIONS", "Comparison", "PathSetting", "RadianceTerm", "comparisons"]
