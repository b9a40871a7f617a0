"""Numerical stability: formulas and samplers against 50-digit truth where floating point fails, naive forms beside them.

One entry a formula (`formulas/<theme>.py`): what we compute, the truth in ball arithmetic, a bound, the regions where it is hard,
and how others write it. `table` finds them, `measuring` compares, `record` keeps; the extra `rigorous` (python-flint) is needed.
"""

from fogproof.stability.axes import both_signs, decades, symmetric, to_one, uniforms
from fogproof.stability.formula import Formula, HardRegion, Naive
from fogproof.stability.measuring import FormError, measure

__all__ = [
    "FormError",
    "Formula",
    "HardRegion",
    "Naive",
    "both_signs",
    "decades",
    "measure",
    "symmetric",
    "to_one",
    "uniforms",
]
