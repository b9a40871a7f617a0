"""What a field of some name may be, in whatever kind."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from fogproof.scene.phase import PhaseFunction
from fogproof.strategies.values import directions, numbers, points, positive, share

_ASYMMETRY = 0.95
_asymmetry = st.one_of(st.sampled_from([0.0, 0.5, -0.5, 0.9, -0.9]), st.floats(-_ASYMMETRY, _ASYMMETRY))

FIELDS: dict[str, st.SearchStrategy[Any]] = {
    **dict.fromkeys(("g", "g1", "g2", "k"), _asymmetry),
    **dict.fromkeys(("position", "center", "point", "corner", "eye"), points),
    **dict.fromkeys(("direction", "normal", "axis"), directions),
    **dict.fromkeys(("radius", "thickness"), positive(5.0)),
    **dict.fromkeys(("intensity", "irradiance", "radiance", "emission", "ambient", "background"), numbers(0, 10)),
    **dict.fromkeys(("sigma_a", "sigma_s", "sigma_0", "sigma", "density"), numbers(0, 2)),
    **dict.fromkeys(("albedo", "weight"), share),
    "alpha": numbers(0, 5),
    "kappa": numbers(-20, 20),
    "gradient": st.tuples(*3 * [numbers(-1, 1)]),
    "rate": st.tuples(*3 * [numbers(-1, 1)]),
    "phase": st.deferred(lambda: st.from_type(PhaseFunction)),
}
"""name -> what a field of it may be."""
