"""Errors of what a sampler returns: points, densities, weights, labels, atoms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fogproof.catalogue import SamplerCase
from fogproof.catalogue.cases import points_of
from fogproof.contracts import Draw
from fogproof.domains import Interval, UnitSphere
from fogproof.zoo.limits import samples_needed
from fogproof.zoo.mutants.mutation import Mutated
from fogproof.zoo.mutants.planting import Array, draw_of, planted, share_of


@dataclass(frozen=True)
class OfDraws:
    """The sampler with what it returns changed.

    change   (draw, share in [0, 1) for each sample, a function of its uniforms) -> changed draw, None where it does not apply
    """

    change: Callable[[Draw, Array], Draw | None]

    def __call__(self, case: SamplerCase) -> Mutated | None:
        """Plant it."""
        right = planted(case)
        if right.dimensions is None:
            return None
        few = np.random.default_rng(1).random((64, right.dimensions)).astype(case.options.get("precision", "float64"))
        if self.change(draw_of(right.sample(few)), share_of(few)) is None:
            return None
        return Mutated(replace(right, sample=lambda u: self.change(draw_of(right.sample(u)), share_of(u))))


def mirrored_points(case: SamplerCase) -> Mutated | None:
    """Mirror the points of a line or sphere, where the pdf tells the two sides apart."""
    right = planted(case)
    if right.atoms or right.dimensions is None or not isinstance(right.domain, UnitSphere | Interval):
        return None
    middle = right.domain.a + right.domain.b if isinstance(right.domain, Interval) else 0.0

    def mirrored(u: Array) -> Draw:
        draw = draw_of(right.sample(u))
        x = middle - draw.x
        pdf = None if draw.pdf is None else np.asarray(right.pdf(np.asarray(x, dtype=float)))
        return Draw(x, pdf, None, draw.event)

    u = np.random.default_rng(1).random((4096, right.dimensions))
    x = np.asarray(points_of(right.sample(u)), dtype=float)
    ratio = right.pdf(middle - x) / right.pdf(x) - 1
    distance = float(np.mean(ratio * ratio))
    return Mutated(replace(right, sample=mirrored, eval=None), lambda: samples_needed(distance), distance < 1e-20)


def nan(draw: Draw, share: Array) -> Draw:
    """Return one point in a thousand that is no number."""
    x = np.array(draw.x, dtype=float)
    x[share < 1e-3] = np.nan
    return draw._replace(x=x)


def returned(part: str, factor: float) -> OfDraws:
    """Scale the part of a draw that has this name."""

    def scaled(draw: Draw, share: Array) -> Draw | None:
        value = getattr(draw, part)
        return None if value is None else draw._replace(**{part: value * factor})

    return OfDraws(scaled)


def label(case: SamplerCase) -> Mutated | None:
    """Labels are held to atoms: without one nobody says what they mean."""
    if not getattr(case.make(), "atoms", {}):
        return None

    def exchanged(draw: Draw, share: Array) -> Draw | None:
        return None if draw.event is None else draw._replace(event=np.where(share < 0.02, 1 - draw.event, draw.event))

    return OfDraws(exchanged)(case)


def density_scaled(case: SamplerCase) -> Mutated:
    """Claim a pdf that is 1 % too large."""
    right = planted(case)
    return Mutated(replace(right, pdf=lambda x: 1.01 * right.pdf(x)))


def atom(case: SamplerCase) -> Mutated | None:
    """One sample in five that is at an atom is drawn anew: what else there is has more than its share."""
    right = planted(case)
    if not right.atoms or right.dimensions is None:
        return None
    probability = sum(right.atoms.values())

    def redrawn(u: Array) -> Draw:
        draw, share = draw_of(right.sample(u)), share_of(u)
        at = np.isin(draw.x, list(right.atoms)) if draw.x.ndim == 1 else np.zeros(len(u), bool)
        again = u.copy()
        again[:, 0] = (share * 5 % 1).astype(u.dtype)
        other, which = draw_of(right.sample(again)), at & (share < 0.2)
        mixed: list[Any] = [
            None if a is None or b is None else np.where(_wide(which, a), b, a)
            for a, b in zip(draw, other, strict=True)
        ]
        return Draw(*mixed)

    shift = 0.2 * probability * (1 - probability)
    distance = shift**2 / (probability * (1 - probability))
    plain = np.ndim(next(iter(right.atoms))) == 0
    return Mutated(replace(right, sample=redrawn), lambda: samples_needed(distance)) if plain else None


def _wide(which: Array, like: Array) -> Array:
    return which.reshape(-1, *[1] * (np.ndim(like) - 1))
