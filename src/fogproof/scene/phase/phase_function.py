"""What all phase functions share: their type, how files tell them apart, and the checks of their parameters.

Convention: mu is the *forward* cosine, (propagation direction in) . (propagation direction out); g is the mean of mu
and g > 0 scatters forward.
"""

from __future__ import annotations

from typing import Annotated, Any

from fogproof.errors import InvalidValueError
from fogproof.scene.kinds import ByKind
from fogproof.validate import number


class PhaseFunction:
    """Where a medium scatters to: parameters only. The oracle and the estimators each bring their own formulas.

    Its density depends on mu alone [1/sr] and integrates to 1 over the sphere.
    """


PhaseFunctionField = Annotated[PhaseFunction, ByKind("fogproof.scene.phase")]


def require_phase(name: str, value: Any, rule: str = "must be a phase function") -> None:
    """Refuse what is no phase function of mu alone."""
    if not isinstance(value, PhaseFunction):
        raise InvalidValueError(name, rule, value, "for example HenyeyGreenstein(g=0.5)")


def asymmetry(name: str, value: Any) -> float:
    """Return a parameter g in (-1, 1)."""
    fix = "at the ends the phase function is a delta, which has no density"
    return number(name, value, "must lie in the open interval (-1, 1)", -1, 1, open_ends=True, fix=fix)
