"""Mitsuba's phase functions.

Its `wi` points back along the ray, its `wo` forward, and g > 0 scatters forward: the forward cosine is -wi . wo.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fogproof.adapters.mitsuba.runtime import SPHERE, Plugin, built, evaluate, loaded
from fogproof.contracts import Draw
from fogproof.domains import Domain


@dataclass(frozen=True, eq=False)
class MitsubaPhase:
    """A phase function: `plugin` is the dict for `mitsuba.load_dict`, `axis` the direction of propagation before.

    Its three answers are all passed on: the sampled direction, the returned pdf, and `eval_pdf` as pdf and eval.
    """

    plugin: Plugin
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    domain: Domain = SPHERE
    dimensions: ClassVar[int] = 3

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 3) to directions, pdf [1/sr] and weight eval / pdf (one channel: the three are equal)."""
        plugin, context, interaction = self._built

        def ask(first: Any, others: Any) -> tuple[Any, ...]:
            wo, weight, pdf = plugin.sample(context, interaction, first, others)
            return wo, weight[0], pdf

        rows = evaluate(ask, u[:, 0], u[:, 1:])
        return Draw(rows[:, :3], rows[:, 4], rows[:, 3])

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the pdf half of `eval_pdf` at directions x (n, 3) [1/sr]."""
        return self._eval_pdf(x)[:, 1]

    def eval(self, x: np.ndarray) -> np.ndarray:
        """Return the value half of `eval_pdf` at directions x (n, 3) [1/sr], first channel."""
        return self._eval_pdf(x)[:, 0]

    def _eval_pdf(self, x: np.ndarray) -> np.ndarray:
        plugin, context, interaction = self._built

        def ask(wo: Any) -> tuple[Any, ...]:
            value, pdf = plugin.eval_pdf(context, interaction, wo)
            return value[0], pdf

        return evaluate(ask, x)

    @cached_property
    def _built(self) -> tuple[Any, Any, Any]:
        return built(self._build)

    def _build(self, mi: Any) -> tuple[Any, Any, Any]:
        import drjit

        interaction = drjit.zeros(mi.MediumInteraction3f)
        interaction.wi = mi.Vector3f(*(-c for c in self.axis))
        interaction.sh_frame = mi.Frame3f(interaction.wi)
        interaction.p, interaction.t = mi.Point3f(0.5, 0.5, 0.5), 1.0
        return loaded(mi, self.plugin), mi.PhaseFunctionContext(), interaction
