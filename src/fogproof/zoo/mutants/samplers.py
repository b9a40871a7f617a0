"""Errors of samplers: of the uniforms, of the points, of what is returned beside them, of how the sampler is written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.catalogue import SamplerCase
from fogproof.catalogue.cases import points_of
from fogproof.contracts import Draw
from fogproof.domains import Interval, UnitSphere
from fogproof.zoo.bug import Bug, Planted
from fogproof.zoo.limits import samples_needed
from fogproof.zoo.mutants.mutation import Mutated, Mutation, mutants

Array = np.ndarray
BEND, SKIPPED, TAIL, RIPPLE = 1.1, 0.01, 1e-3, 0.1
OTHER_LAW = (
    "wrong probability of an atom",
    "shape",
    "another law",
    "another parameter",
    "wrong scale",
    "wrong power",
    "few entries",
)
MISSING = ("skipped band", "skipped region", "missing tail", "never drawn", "few entries", "atom", "claimed hole")


def _planted(case: SamplerCase) -> Planted:
    s = case.make()
    return Planted(s.sample, s.pdf, s.domain, s.dimensions, dict(getattr(s, "atoms", {})), getattr(s, "eval", None))


def _draw(result: Any) -> Draw:
    return result if isinstance(result, Draw) else Draw(np.asarray(result))


@dataclass(frozen=True)
class OfUniforms:
    """The sampler of changed uniforms: of those that its points depend on.

    change   (n, d) uniforms -> changed ones
    density  of the changed uniforms at (n, d) of them, None where no density has what gives the error away
    least    least number of uniforms that matter
    """

    change: Callable[[Array], Array]
    density: Callable[[Array], Array] | None = None
    least: int = 1

    def __call__(self, case: SamplerCase) -> Mutated | None:
        """Plant it."""
        right = _planted(case)
        used = _that_matter(right, case)
        if len(used) < self.least:
            return None

        def sample(u: Array) -> Any:
            changed = u.copy()
            changed[:, used] = self.change(u[:, used])
            return right.sample(changed)

        density = self.density
        needed = (lambda: 1.0) if density is None else (lambda: _needed(right, lambda u: density(u[:, used])))
        return Mutated(replace(right, sample=sample), needed)


def _that_matter(subject: Planted, case: SamplerCase) -> list[int]:
    """Return which uniforms points depend on: some plugins take one that they ignore."""
    if subject.dimensions is None:
        return []
    rng = np.random.default_rng(1)
    u = rng.random((64, subject.dimensions)).astype(case.options.get("precision", "float64"))
    x, found = np.asarray(points_of(subject.sample(u))), []
    for column in range(subject.dimensions):
        other = u.copy()
        other[:, column] = rng.permutation(u[:, column])
        if not np.array_equal(x, points_of(subject.sample(other))):
            found.append(column)
    return found


def _needed(right: Planted, density: Callable[[Array], Array], pairs: int = 200_000) -> float:
    """Return a lower bound on the samples that the best test of the points needs, from the density of the changed uniforms.

    The points' chi-square distance is the variance of E[f(U) | X], the mean of (f(U) - 1)(f(U') - 1) over uniforms U, U' that
    lead to the same point: here to neighbouring points of many. Five standard errors are added, so that chance excuses nothing.
    """
    from scipy.spatial import cKDTree

    u = np.random.default_rng(1).random((pairs, right.dimensions or 0))
    x = np.asarray(points_of(right.sample(u)), dtype=float).reshape(pairs, -1)
    at = np.all(np.isfinite(x), axis=1)
    x, off = x[at], density(u[at]) - 1
    _, near = cKDTree(x + 1e-12 * np.random.default_rng(2).standard_normal(x.shape)).query(x, k=2)
    product = off * off[near[:, 1]]
    return samples_needed(max(float(product.mean()), 0.0) + 5 * float(product.std()) / np.sqrt(len(product)))


@dataclass(frozen=True)
class OfDraws:
    """The sampler with what it returns changed.

    change   (draw, share in [0, 1) for each sample, a function of its uniforms) -> changed draw, None where it does not apply
    """

    change: Callable[[Draw, Array], Draw | None]

    def __call__(self, case: SamplerCase) -> Mutated | None:
        """Plant it."""
        right = _planted(case)
        if right.dimensions is None:
            return None
        few = np.random.default_rng(1).random((64, right.dimensions)).astype(case.options.get("precision", "float64"))
        if self.change(_draw(right.sample(few)), _share(few)) is None:
            return None
        return Mutated(replace(right, sample=lambda u: self.change(_draw(right.sample(u)), _share(u))))


def _share(u: Array) -> Array:
    return np.asarray(u[:, 0] * 4099.0 % 1, dtype=float)


def _first(change: Callable[[Array], Array]) -> Callable[[Array], Array]:
    def changed(u: Array) -> Array:
        u[:, 0] = change(u[:, 0])
        return u

    return changed


def _last(change: Callable[[Array], Array]) -> Callable[[Array], Array]:
    def changed(u: Array) -> Array:
        u[:, -1] = change(u[:, -1])
        return u

    return changed


def _skip(v: Array) -> Array:
    squeezed = (1 - SKIPPED) * v
    return np.where(squeezed > 0.41, squeezed + SKIPPED, squeezed)


_STEPS = np.linspace(0, 1, 4097)
_RIPPLED = _STEPS + RIPPLE * (1 - np.cos(6 * np.pi * _STEPS)) / (6 * np.pi)


def _ripple(v: Array) -> Array:
    return np.minimum(np.interp(v, _RIPPLED, _STEPS), 1 - 2.0**-24)


def _as_first(u: Array) -> Array:
    u[:, 1] = u[:, 0]
    return u


def _lumped(case: SamplerCase) -> Mutated | None:
    """All uniforms of a strip lead to one point, which is no atom by itself."""
    right = _planted(case)
    for place in (0.3, 0.05, 0.7, 0.95):
        change = OfUniforms(partial(_lump, place))
        mutated = change(case)
        if mutated is None or _single(right, place):
            return mutated
    return None


def _lump(place: float, u: Array) -> Array:
    u[np.abs(u[:, 0] - place) < 5e-4] = place
    return u


def _single(subject: Planted, place: float) -> bool:
    """Return whether uniforms beside a place lead to different points, so that the point there is no atom."""
    u = np.full((2, subject.dimensions or 1), place)
    u[1] += 1e-3
    x = np.asarray(points_of(subject.sample(u)))
    return not np.array_equal(x[0], x[1])


def _coarse(u: Array) -> Array:
    return np.floor(u * 4096) / 4096 + 2.0**-13


def _mirrored(case: SamplerCase) -> Mutated | None:
    right = _planted(case)
    if right.atoms or right.dimensions is None or not isinstance(right.domain, UnitSphere | Interval):
        return None
    middle = right.domain.a + right.domain.b if isinstance(right.domain, Interval) else 0.0

    def mirrored(u: Array) -> Draw:
        draw = _draw(right.sample(u))
        x = middle - draw.x
        pdf = None if draw.pdf is None else np.asarray(right.pdf(np.asarray(x, dtype=float)))
        return Draw(x, pdf, None, draw.event)

    u = np.random.default_rng(1).random((4096, right.dimensions))
    x = np.asarray(points_of(right.sample(u)), dtype=float)
    ratio = right.pdf(middle - x) / right.pdf(x) - 1
    distance = float(np.mean(ratio * ratio))
    return Mutated(replace(right, sample=mirrored, eval=None), lambda: samples_needed(distance), distance < 1e-20)


def _nan(draw: Draw, share: Array) -> Draw:
    x = np.array(draw.x, dtype=float)
    x[share < 1e-3] = np.nan
    return draw._replace(x=x)


def _returned(part: str, factor: float) -> OfDraws:
    def scaled(draw: Draw, share: Array) -> Draw | None:
        value = getattr(draw, part)
        return None if value is None else draw._replace(**{part: value * factor})

    return OfDraws(scaled)


def _label(case: SamplerCase) -> Mutated | None:
    """Labels are held to atoms: without one nobody says what they mean."""
    if not getattr(case.make(), "atoms", {}):
        return None

    def exchanged(draw: Draw, share: Array) -> Draw | None:
        return None if draw.event is None else draw._replace(event=np.where(share < 0.02, 1 - draw.event, draw.event))

    return OfDraws(exchanged)(case)


def _density(case: SamplerCase) -> Mutated:
    right = _planted(case)
    return Mutated(replace(right, pdf=lambda x: 1.01 * right.pdf(x)))


def _atom(case: SamplerCase) -> Mutated | None:
    """One sample in five that is at an atom is drawn anew: what else there is has more than its share."""
    right = _planted(case)
    if not right.atoms or right.dimensions is None:
        return None
    probability = sum(right.atoms.values())

    def redrawn(u: Array) -> Draw:
        draw, share = _draw(right.sample(u)), _share(u)
        at = np.isin(draw.x, list(right.atoms)) if draw.x.ndim == 1 else np.zeros(len(u), bool)
        again = u.copy()
        again[:, 0] = (share * 5 % 1).astype(u.dtype)
        other, which = _draw(right.sample(again)), at & (share < 0.2)
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


def _stateful(case: SamplerCase) -> Mutated | None:
    right = _planted(case)
    if right.dimensions is None:
        return None
    calls = [0]

    def sample(u: Array) -> Any:
        calls[0] += 1
        return right.sample(u if calls[0] % 2 else u[::-1])

    return Mutated(replace(right, sample=sample))


def _paired(case: SamplerCase) -> Mutated | None:
    right = _planted(case)
    if right.dimensions is None:
        return None
    return Mutated(replace(right, sample=lambda u: right.sample(u[np.arange(len(u)) // 2 * 2])))


def _writing(case: SamplerCase) -> Mutated | None:
    right = _planted(case)
    if right.dimensions is None:
        return None

    def sample(u: Array) -> Any:
        result = right.sample(u.copy())
        u *= 0.5
        return result

    return Mutated(replace(right, sample=sample))


def _bent(u: Array) -> Array:
    return np.maximum(u[:, 0], 1e-300) ** (1 / BEND - 1) / BEND


def _without(low: float, high: float) -> Callable[[Array], Array]:
    return lambda u: np.where((u[:, 0] > low) & (u[:, 0] < high), 0.0, 1 / (1 - (high - low)))


MUTATIONS: tuple[Mutation[SamplerCase], ...] = (
    Mutation("pdf-scaled", "the pdf is 1 % too large", ("normalisation", "wrong measure"), _density),
    Mutation("bent", "first uniform to the power 1.1", OTHER_LAW, OfUniforms(_first(lambda v: v**BEND), _bent)),
    Mutation(
        "bent-last", "last uniform to the power 1.1", OTHER_LAW,
        OfUniforms(_last(lambda v: v**BEND), lambda u: _bent(u[:, -1:]), 2),
    ),
    Mutation(
        "ripple", "first uniform with a ripple of 10 %", OTHER_LAW,
        OfUniforms(_first(_ripple), lambda u: 1 + RIPPLE * np.sin(6 * np.pi * u[:, 0])),
    ),
    Mutation(
        "skipped", "a piece of mass .01 is never drawn", MISSING,
        OfUniforms(_first(_skip), _without(0.41, 0.41 + SKIPPED)),
    ),
    Mutation(
        "tail", "the last .001 is never drawn", MISSING,
        OfUniforms(_first(lambda v: v * (1 - TAIL)), _without(1 - TAIL, 1.0)),
    ),
    Mutation("reused", "second uniform is the first", ("correlation", "shape", *MISSING), OfUniforms(_as_first, None, 2)),
    Mutation("lump", "one point in a thousand is the same", ("repeated samples", "atom"), _lumped),
    Mutation("coarse", "uniforms of 12 bits", ("coarse numbers",), OfUniforms(_coarse)),
    Mutation("mirrored", "points are mirrored", ("sign convention", "claimed hole"), _mirrored),
    Mutation("nan", "one point in a thousand is no number", ("not a number", "outside the domain"), OfDraws(_nan)),
    Mutation("returned-pdf", "the pdf returned is .1 % too large", ("wrong pdf returned",), _returned("pdf", 1.001)),
    Mutation("weight", "weights are 1 % too large", ("wrong weight",), _returned("weight", 1.01)),
    Mutation("label", "one label in fifty is wrong", ("wrong event label",), _label),
    Mutation("atom", "one hit of an atom in five is drawn anew", ("wrong probability of an atom", "atom"), _atom),
    Mutation("stateful", "every second call has its rows reversed", ("hidden state", "order of the rows"), _stateful),
    Mutation("paired", "every point is returned twice", ("repeated samples", "order of the rows", "size of the call"), _paired),
    Mutation("writing", "the uniforms are written into", ("writes into its uniforms",), _writing),
)  # fmt: skip


def bugs() -> list[Bug]:
    """Return each error in each sampler of the catalogue."""
    return mutants(SamplerCase, MUTATIONS)
