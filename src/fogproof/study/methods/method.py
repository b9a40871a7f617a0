"""What every method of a study is: a frozen dataclass whose fields are its options in the study file."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from fogproof.contracts import Estimator, Reference
from fogproof.study.question import Estimated, Question

Axis = Literal["samples", "steps", "nothing"]

NO_VARIANCE = Reference(np.asarray(0.0), np.asarray(0.0), "nothing is random", "")
"""The variance of a method that draws nothing."""


class Method:
    """A way to estimate what scenes ask; a kind says what differs from this.

    quantity    what it estimates; a scene takes the methods of its own quantity
    title       in words
    axis        what the study's sample counts are to it: "samples" of a random estimator, "steps" of a march that is not
                random, or "nothing" for an exact one
    bias        why its mean is not the quantity, "" for an unbiased one, which alone must not be rejected
    dimensions  uniforms a realisation if it is a pure function of them, which then can be Sobol points; else None
    """

    quantity: ClassVar[Estimated]
    title: Any
    axis: Any = "samples"
    bias: Any = ""
    dimensions: Any = None

    @property
    def expected(self) -> Literal["not rejected", "rejected"]:
        """The outcome."""
        return "rejected" if self.bias else "not rejected"

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator for a scene and one of the study's counts."""
        raise NotImplementedError

    def variance(self, scene: Question) -> Reference | None:
        """Return the exact variance of one realisation, None where the oracle has none."""
        return None

    def bounds(self, scene: Question) -> tuple[float, float] | None:
        """Return numbers between which every realisation lies, None where there are none or nobody knows them."""
        return None
