"""Mitsuba 3's own phase function plugins against the oracle, in single precision."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.adapters.mitsuba import MitsubaPhase
from fogproof.catalogue.cases import SamplerCase, Twin
from fogproof.catalogue.phase.directions import TILTED, direction_case
from fogproof.contracts import Draw
from fogproof.domains import UnitSphere
from fogproof.scene import HenyeyGreenstein, Isotropic, PhaseFunction, Rayleigh

_SAMPLES = 200_000


class _Mixed:
    """A twin that takes its sample and its pdf from different plugins, or alters the drawn batch."""

    domain = UnitSphere()
    dimensions = 3

    def __init__(
        self, sampling: MitsubaPhase, density: MitsubaPhase, alter: Callable[[Draw], Draw] | None = None
    ) -> None:
        self.sampling, self.density, self.alter = sampling, density, alter

    def sample(self, u: np.ndarray) -> Any:
        draw = self.sampling.sample(u)
        return draw if self.alter is None else self.alter(draw)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        return self.density.pdf(x)

    def eval(self, x: np.ndarray) -> np.ndarray:
        return self.density.eval(x)


def _case(
    kind: str,
    phase: PhaseFunction,
    g: float,
    error: str,
    twin: Callable[[MitsubaPhase], Any],
    axis: tuple[float, float, float] = TILTED,
) -> SamplerCase:
    parameters = (("g", g),) if kind == "hg" else ()
    plugin = MitsubaPhase(kind, parameters, axis)
    label = f"{kind}/g={g:g}" if kind == "hg" else kind
    return direction_case(
        f"mitsuba/{label}",
        f"Mitsuba 3, plugin {kind}" + (f", g = {g:g}" if kind == "hg" else ""),
        phase,
        g,
        lambda: plugin,
        Twin(error, lambda: twin(plugin)),
        "mitsuba-renderer.org, variant scalar_rgb",
        axis=axis,
        options={"precision": "float32", "albedo": 1.0},
        samples=_SAMPLES,
        needs="mitsuba",
    )


def _hg(g: float, axis: tuple[float, float, float] = TILTED) -> MitsubaPhase:
    return MitsubaPhase("hg", (("g", g),), axis)


def _mirrored(draw: Draw) -> Draw:
    assert isinstance(draw.x, np.ndarray)
    return draw._replace(x=-draw.x)


def _doubled_weight(draw: Draw) -> Draw:
    assert draw.weight is not None
    return draw._replace(weight=2 * draw.weight)


def cases() -> list[SamplerCase]:
    """Return the cases of Mitsuba's plugins: sampled direction, returned pdf, weight, and `eval_pdf`."""
    isotropic = MitsubaPhase("isotropic", (), TILTED)
    return [
        _case(
            "isotropic",
            Isotropic(),
            0.0,
            "Rayleigh's density is returned",
            lambda p: _Mixed(p, MitsubaPhase("rayleigh", (), p.axis)),
        ),
        _case(
            "rayleigh", Rayleigh(), 0.0, "isotropic sampling under the Rayleigh density", lambda p: _Mixed(isotropic, p)
        ),
        _case(
            "hg",
            HenyeyGreenstein(-0.7),
            -0.7,
            "for g < 0 directions are drawn uniformly",
            lambda p: _Mixed(isotropic, p),
        ),
        _case("hg", HenyeyGreenstein(0.0), 0.0, "the weight is applied twice", lambda p: _Mixed(p, p, _doubled_weight)),
        _case(
            "hg",
            HenyeyGreenstein(0.3),
            0.3,
            "wi and wo are exchanged in the sampled direction",
            lambda p: _Mixed(p, p, _mirrored),
        ),
        _case(
            "hg",
            HenyeyGreenstein(0.6),
            0.6,
            "backward means forward, in sampler and density alike",
            lambda p: _hg(-0.6, p.axis),
        ),
        _case("hg", HenyeyGreenstein(0.85), 0.85, "the sampler has g = 0.8", lambda p: _Mixed(_hg(0.8, p.axis), p)),
        _case("hg", HenyeyGreenstein(0.95), 0.95, "the sampler has g = 0.93", lambda p: _Mixed(_hg(0.93, p.axis), p)),
    ]
