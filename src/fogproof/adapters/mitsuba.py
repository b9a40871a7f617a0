"""Mitsuba 3's phase functions as samplers (variant scalar_rgb, single precision; mitsuba-renderer.org).

Mitsuba's `wi` points back along the ray, its `wo` forward, and g > 0 scatters forward: the forward cosine is -wi . wo.
"""

from __future__ import annotations

import importlib.util
import threading
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import UnitSphere
from fogproof.errors import NotInstalledError

VARIANT = "scalar_rgb"
_LOADING = threading.Lock()


def installed() -> bool:
    """Return whether Mitsuba can be imported, without importing it."""
    return importlib.util.find_spec("mitsuba") is not None


def load() -> Any:
    """Import Mitsuba and set the variant, or raise `NotInstalledError` with the line that installs it."""
    if not installed():
        raise NotInstalledError("Mitsuba 3", "mitsuba")
    with _LOADING:  # a second thread would meet a half-imported package
        import mitsuba

        if mitsuba.variant() != VARIANT:
            mitsuba.set_variant(VARIANT)
    return mitsuba


@dataclass(frozen=True)
class MitsubaPhase:
    """A phase function plugin: `kind` is its name, `parameters` its scalar parameters, `axis` the propagation direction before.

    Its three answers are all passed on: the sampled direction, the returned pdf, and `eval_pdf` as pdf and eval.
    """

    kind: str
    parameters: tuple[tuple[str, float], ...] = ()
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    domain: ClassVar[UnitSphere] = UnitSphere()
    dimensions: ClassVar[int] = 3

    def sample(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, 3) to directions, pdf [1/sr] and weight eval / pdf (one channel: the three are equal)."""
        mi = load()
        plugin, context, interaction = _plugin(self)
        sample, point = plugin.sample, mi.Point2f
        out = np.empty((len(u), 5))
        for row, (u1, u2, u3) in zip(out, u.tolist(), strict=True):
            wo, weight, pdf = sample(context, interaction, u1, point(u2, u3))
            row[:] = wo.x, wo.y, wo.z, pdf, weight[0]
        return Draw(out[:, :3], out[:, 3], out[:, 4])

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the pdf half of `eval_pdf` at directions x (n, 3) [1/sr]."""
        return self._eval_pdf(x)[:, 1]

    def eval(self, x: np.ndarray) -> np.ndarray:
        """Return the value half of `eval_pdf` at directions x (n, 3) [1/sr], first channel."""
        return self._eval_pdf(x)[:, 0]

    def _eval_pdf(self, x: np.ndarray) -> np.ndarray:
        mi = load()
        plugin, context, interaction = _plugin(self)
        eval_pdf, vector = plugin.eval_pdf, mi.Vector3f
        out = np.empty((len(x), 2))
        for row, (a, b, c) in zip(out, x.tolist(), strict=True):
            value, row[1] = eval_pdf(context, interaction, vector(a, b, c))
            row[0] = value[0]
        return out


@cache
def _plugin(phase: MitsubaPhase) -> tuple[Any, Any, Any]:
    mi = load()
    interaction = mi.MediumInteraction3f()
    x, y, z = phase.axis
    interaction.wi = mi.Vector3f(-x, -y, -z)
    interaction.sh_frame = mi.Frame3f(interaction.wi)
    return mi.load_dict({"type": phase.kind, **dict(phase.parameters)}), mi.PhaseFunctionContext(), interaction
