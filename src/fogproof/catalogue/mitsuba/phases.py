"""Mitsuba 3's own phase function plugins against the oracle, in single precision."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fogproof.adapters.mitsuba import ANYWHERE, MitsubaPhase, load
from fogproof.analytic import phase_mean_cosine
from fogproof.catalogue.cases import SamplerCase, Twin
from fogproof.catalogue.mitsuba.builders import SOURCE, mitsuba_case
from fogproof.catalogue.phase.directions import TILTED, direction_case, oracle_pdf
from fogproof.contracts import Draw, Reference
from fogproof.domains import UnitSphere
from fogproof.scene import HenyeyGreenstein, Isotropic, Mixture, PhaseFunction, Rayleigh, Tabulated

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
    plugin = MitsubaPhase({"type": kind, **({"g": g} if kind == "hg" else {})}, axis)
    label = f"{kind}/g={g:g}" if kind == "hg" else kind
    return direction_case(
        f"mitsuba/{label}",
        f"Mitsuba 3, plugin {kind}" + (f", g = {g:g}" if kind == "hg" else ""),
        phase,
        g,
        lambda: plugin,
        Twin(error, lambda: twin(plugin)),
        SOURCE,
        axis=axis,
        options={"precision": "float32", "albedo": 1.0},
        samples=_SAMPLES,
        needs="mitsuba",
    )


def _hg(g: float, axis: tuple[float, float, float] = TILTED) -> MitsubaPhase:
    return MitsubaPhase({"type": "hg", "g": g}, axis)


def _mirrored(draw: Draw) -> Draw:
    assert isinstance(draw.x, np.ndarray)
    return draw._replace(x=-draw.x)


def _doubled_weight(draw: Draw) -> Draw:
    assert draw.weight is not None
    return draw._replace(weight=2 * draw.weight)


def cases() -> list[SamplerCase]:
    """Return the cases of Mitsuba's plugins: sampled direction, returned pdf, weight, and `eval_pdf`."""
    isotropic = MitsubaPhase({"type": "isotropic"}, TILTED)
    found = [
        _case(
            "isotropic",
            Isotropic(),
            0.0,
            "Rayleigh's density is returned",
            lambda p: _Mixed(p, MitsubaPhase({"type": "rayleigh"}, p.axis)),
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
    return [*found, *_swept()]


_AXES = ((0.0, 0.0, 1.0), TILTED, (-0.48, 0.64, -0.6))
_FLAKES = {"plate": (1.0, 1.0, 0.1, 0.0, 0.0, 0.0), "tilted": (1.0, 0.6, 0.3, 0.2, 0.1, -0.15)}
"""SGGX matrices: xx, yy, zz, xy, xz, yz."""
_AHEAD = "pdf() is NaN straight ahead, where the half-way vector is 0 (docs/findings.md)"
_FRAME = (
    "the frame about the incident direction is transposed: right only where that is an axis of S (docs/findings.md)"
)


def _blend(weight: float, first: dict[str, Any], second: dict[str, Any]) -> dict[str, Any]:
    return {"type": "blendphase", "weight": {"type": "constvolume", "value": weight}, "a": first, "b": second}


def sggx_plugin(flake: tuple[float, ...]) -> dict[str, Any]:
    """Return the plugin of an SGGX matrix that is the same everywhere."""
    grid = load().VolumeGrid(np.array(flake, dtype=np.float32).reshape(1, 1, 1, 6))
    return {"type": "sggx", "S": {"type": "gridvolume", "grid": grid}}


def _sggx_sampler(flake: tuple[float, ...], axis: tuple[float, float, float]) -> MitsubaPhase:
    return MitsubaPhase(partial(sggx_plugin, flake), axis, ANYWHERE)


def sggx(flake: tuple[float, ...], axis: tuple[float, float, float]) -> Callable[[np.ndarray], Reference]:
    """The specular SGGX phase function D(h) / (4 sigma(wi)), h half-way between wi and wo (Heitz et al. 2015, eqs. 10 and 13)."""
    xx, yy, zz, xy, xz, yz = flake
    s = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    wi, inverse = -np.array(axis), np.linalg.inv(s)
    scale = 1 / (4 * np.pi * np.sqrt(np.linalg.det(s)) * np.sqrt(wi @ s @ wi))

    def reference(x: np.ndarray) -> Reference:
        h = x + wi
        h /= np.maximum(np.linalg.norm(h, axis=1), 1e-12)[:, None]
        value = scale / np.einsum("ni,ij,nj->n", h, inverse, h) ** 2
        return Reference(value, 1e-4 * value)

    return reference


def _swept() -> list[SamplerCase]:
    """Return the cases that run by name: extreme g, nested blends, tables, flakes, about several axes."""
    forward, backward = {"type": "hg", "g": 0.7}, {"type": "hg", "g": -0.3}
    table = (0.4, 0.1, 0.05, 0.1, 0.3, 1.5)
    members: dict[str, tuple[dict[str, Any], PhaseFunction]] = {
        "rayleigh": ({"type": "rayleigh"}, Rayleigh()),
        "blendphase": (
            _blend(0.25, forward, backward),
            Mixture((HenyeyGreenstein(0.7), HenyeyGreenstein(-0.3)), (0.75, 0.25)),
        ),
        "blendphase/nested": (
            _blend(0.4, _blend(0.25, forward, backward), {"type": "rayleigh"}),
            Mixture((HenyeyGreenstein(0.7), HenyeyGreenstein(-0.3), Rayleigh()), (0.45, 0.15, 0.4)),
        ),
        "tabphase": (
            {"type": "tabphase", "values": ", ".join(map(str, table))},
            Tabulated.normalised(tuple(np.linspace(-1, 1, len(table)).tolist()), table),
        ),
    }
    members |= {f"hg/g={g:g}": ({"type": "hg", "g": g}, HenyeyGreenstein(g)) for g in (-0.9, -0.3, 0.05)}
    found = []
    for name, (plugin, phase) in members.items():
        for number, axis in enumerate(_AXES):
            found.append(
                mitsuba_case(
                    name=f"phase/{name}/axis-{number}",
                    title=f"phase function {name}",
                    make=partial(MitsubaPhase, plugin, axis),
                    reference=oracle_pdf(phase, axis, 1e-6),
                    oracle="phase_pdf",
                    options={"axis": axis, "mean_cosine": float(phase_mean_cosine(phase).value), "albedo": 1.0},
                )
            )
    for name, flake in _FLAKES.items():
        for number, axis in enumerate(_AXES):
            known: dict[str, Any] = {"expected": "rejected", "reason": _FRAME if number else _AHEAD}
            found.append(
                mitsuba_case(
                    name=f"phase/sggx/{name}/axis-{number}",
                    title=f"phase function sggx, {name}",
                    make=partial(_sggx_sampler, flake, axis),
                    reference=sggx(flake, axis),
                    options={"axis": axis},
                    **known,
                )
            )
    return found
