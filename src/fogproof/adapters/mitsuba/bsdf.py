"""Mitsuba's BSDFs: directions wo on the whole sphere, `eval` with the cosine in it, samples that it gives up with a pdf of 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fogproof.adapters.mitsuba.runtime import ANYWHERE, Plugin, built, evaluate, loaded
from fogproof.contracts import Draw
from fogproof.domains import Domain


@dataclass(frozen=True, eq=False)
class MitsubaBSDF:
    """A BSDF without delta lobes.

    plugin  the dict for `mitsuba.load_dict`
    wi      the incident direction; z is the normal
    domain  all directions, without a chart of them: most of these densities end along curves, which labels judge better than
            quadrature. `UnitSphere()` where they do not, or an integral is the question
    """

    plugin: Plugin
    wi: tuple[float, float, float] = (0.0, 0.0, 1.0)
    domain: Domain = ANYWHERE
    dimensions: ClassVar[int] = 3

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 3) to directions, pdf [1/sr] and weight (n, 3); a sample without probability or weight is given up."""
        plugin, context, interaction = self._built

        def ask(first: Any, others: Any) -> tuple[Any, ...]:
            drawn, weight = plugin.sample(context, interaction, first, others)
            return drawn.wo, drawn.pdf, weight

        rows = evaluate(ask, u[:, 0], u[:, 1:])
        return Draw(rows[:, :3], rows[:, 3], rows[:, 4:], valid=(rows[:, 3] > 0) & (rows[:, 4:] != 0).any(axis=1))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density of directions x (n, 3) [1/sr]."""
        plugin, context, interaction = self._built
        return evaluate(lambda wo: (plugin.pdf(context, interaction, wo),), x)[:, 0]

    def eval(self, x: np.ndarray) -> np.ndarray:
        """Return f |cos| at directions x (n, 3) [1/sr], (n, 3) channels."""
        plugin, context, interaction = self._built
        return evaluate(lambda wo: (plugin.eval(context, interaction, wo),), x)

    @cached_property
    def _built(self) -> tuple[Any, Any, Any]:
        return built(self._build)

    def _build(self, mi: Any) -> tuple[Any, Any, Any]:
        import drjit

        interaction = drjit.zeros(mi.SurfaceInteraction3f)
        interaction.wi = mi.Vector3f(*self.wi)
        interaction.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
        interaction.sh_frame.s, interaction.sh_frame.t = mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0)
        interaction.n, interaction.uv, interaction.t = mi.Normal3f(0, 0, 1), mi.Point2f(0.3, 0.3), 1.0
        interaction.dp_du, interaction.dp_dv = mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0)
        return loaded(mi, self.plugin), mi.BSDFContext(), interaction
