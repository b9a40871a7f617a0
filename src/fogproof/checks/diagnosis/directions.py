"""What goes wrong with directions: signs, frames, axes, sines, parameters of phase functions, lobes about a normal."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import permutations

import numpy as np

from fogproof.checks.diagnosis import folds, frames, grids, half_vectors, holes, lobes, planes, visible_normals
from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, known_number, of_points

_MIRROR = np.array([1.0, 1.0, -1.0])
_ALONG = 0.03  # from a coordinate axis: such a lobe is meant to be about it
_OUTER, _STEPS = 512, 2000  # samples that may bound a cone, and steps towards its axis
_FAMILY = math.log(20)  # how much likelier a law is off by its own parameter
_EVEN = 1e-9  # relative difference of densities that are one
_LEAN = 0.03  # mean length of directions that have a direction


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to directions, the simplest first.

    Where the claim is a law that everybody uses, its own parameter is likelier off than anything else that takes one.
    """
    laws = list(lobes.hypotheses(setting))
    known = any(law.null is not None for law in laws)
    yield from _simple()
    yield from folds.hypotheses(setting, "xyz", azimuth=(0, 1))
    for each in (*_of_places(setting), *_powers(setting), *(() if known else lobes.powers(setting))):
        yield replace(each, prior=-_FAMILY) if known and each.trials else each
    yield from laws
    yield from grids.of_directions(setting)


def _simple() -> Iterator[Hypothesis]:
    yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: _everywhere)
    yield Hypothesis(
        "sign convention", "these samples fit the pdf of the opposite direction", lambda s, _: lambda x: s.p(-x)
    )
    yield Hypothesis(
        "sign convention", "these samples fit the pdf with z mirrored", lambda s, _: lambda x: s.p(x * _MIRROR)
    )
    for order in permutations(range(3)):
        if order != (0, 1, 2):
            names = "".join("xyz"[i] for i in order)
            words = f"these samples fit the pdf with its axes (x, y, z) taken for ({', '.join(names)})"
            yield Hypothesis("swapped axes", words, of_points(partial(np.take, indices=order, axis=1)))


def _of_places(setting: Setting) -> Iterator[Hypothesis]:
    yield from _sines(setting)
    yield from _about_the_mean(setting)
    yield from planes.hypotheses(setting)
    yield from half_vectors.hypotheses(setting)
    yield from visible_normals.hypotheses(setting)
    yield from frames.hypotheses(setting)


def _sines(setting: Setting) -> Iterator[Hypothesis]:
    sine = "missing Jacobian", "a sine is missing: these samples are uniform in theta where the pdf means solid angle"
    yield Hypothesis(*sine, lambda s, _: lambda x: s.p(x) / _sine(x))
    yield Hypothesis(
        "missing Jacobian", "these samples have a sine of theta too many", lambda s, _: lambda x: s.p(x) * _sine(x)
    )


def _powers(setting: Setting) -> Iterator[Hypothesis]:
    plane = planes.within(setting, np.array([0.0, 0.0, 1.0]))
    claim = setting.values[setting.values > 0]
    even = len(claim) > 0 and float(np.ptp(claim)) <= _EVEN * float(claim.max())
    weighted = ": cosine-weighted where the pdf is uniform" * even
    yield Hypothesis(
        "missing Jacobian" if plane else "wrong power",
        "these samples fit the pdf times a power of the cosine, {value}",
        lambda s, a: lambda x: s.p(x) * np.abs(x[:, 2]) ** a,
        (-1.5, -1.0, -0.5, 0.5, 1.0, 2.0, 3.0),
        known_number(
            {
                -1.0: "a cosine is missing" + ": uniform where the pdf is cosine-weighted" * (not plane),
                2.0: "two cosines too many",
                1.0: "a cosine too many" + weighted,
            }
        ),
        otherwise="wrong power",
        null=0.0,
    )
    yield Hypothesis(
        "stretched",
        "these samples fit the pdf with x and y stretched by {value}",
        lambda s, a: s.moved(lambda x: _unit(x * (1 / a, 1 / a, 1.0)), _squeezed(1 / a)),
        (0.04, 0.1, 0.25, 0.5, 0.7, 0.9, 0.97, 1.03, 1.1, 1.4, 2.0, 4.0, 10.0, 25.0),
        null=1.0,
    )
    yield Hypothesis(
        "missing square root",
        "these samples fit the pdf with the cosine raised to the power {value}",
        lambda s, a: s.moved(_cosine_to(1 / a), lambda x: np.abs(x[:, 2]) ** (1 / a - 1) / a),
        (0.5, 0.7, 0.9, 0.97, 1.03, 1.1, 1.5, 2.0, 3.0),
        known_number({2.0: "a square root of the cosine is missing", 0.5: "a square root too many" + weighted}),
        null=1.0,
        below="wrong power",
        otherwise="wrong power",
    )


def _about_the_mean(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened about the mean direction of the claim, if it has one that is not z, and a cone too narrow."""
    yield from _cone(setting)
    mean = setting.claimed_mean()
    length = float(np.linalg.norm(mean))
    if length < _LEAN or np.linalg.norm(np.cross(mean, (0, 0, 1))) < _ALONG * length:
        return
    axis = frames.axis_of_symmetry(setting, mean / length)
    frame = frames.turn(axis, np.array([0.0, 0.0, 1.0]))
    name = ", about (" + ", ".join(f"{c:.3f}" for c in axis) + ")"
    known = [
        (setting, _turned(setting, frame))
    ]  # the last one: hypotheses are asked of the same points again and again

    def lifted(hypothesis: Hypothesis, s: Setting, value: float) -> Density:
        if known[0][0] is not s:
            known[0] = s, _turned(s, frame)
        turned = known[0][1]
        density = hypothesis.density(turned, value)
        return lambda x: density(turned.contrast.points if x is s.contrast.points else x @ frame.T)

    turned = known[0][1]
    for hypothesis in (*_sines(turned), *_powers(turned), *_about_the_axis(), *holes.along(turned, 1)):
        yield replace(hypothesis, words=hypothesis.words + name, density=partial(lifted, hypothesis))


def _about_the_axis() -> Iterator[Hypothesis]:
    """Yield turns about z: by a quarter, which swaps the axes of an anisotropic lobe, and by any angle."""
    words = "these samples fit the pdf turned by a quarter: as of the two axes across swapped"
    yield Hypothesis("swapped axes", words, lambda s, _: lambda x: s.p(x[:, [1, 0, 2]] * (1.0, -1.0, 1.0)))
    yield Hypothesis(
        "rotated frame",
        "these samples fit the pdf turned by {value} of a turn",
        lambda s, d: lambda x: s.p(x @ _spin(-2 * np.pi * d)),
        grids.SHIFTS,
        null=0.0,
    )


def _spin(angle: float) -> np.ndarray:
    """Return the matrix (3, 3) that x @ matrix turns by an angle about z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _turned(setting: Setting, frame: np.ndarray) -> Setting:
    """Return what hypotheses may look at in another frame, of orthonormal rows (3, 3)."""
    contrast = setting.contrast
    turned = replace(contrast, x=contrast.x @ frame.T, z=contrast.z @ frame.T)
    return replace(setting, claim=lambda y: setting.p(y @ frame), contrast=turned)


def _cone(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that all samples lie in a cone, of which the claim has more: the narrowest (Badoiu & Clarkson 2003)."""
    x = setting.contrast.x
    axis = x.mean(axis=0)
    if np.linalg.norm(axis) < _LEAN:
        return
    for _ in range(2):
        outer = x[np.argsort(x @ axis)[:_OUTER]]
        for i in range(1, _STEPS):
            axis = axis / np.linalg.norm(axis)
            axis = axis + (outer[np.argmin(outer @ axis)] - axis) / (i + 1)
    axis /= np.linalg.norm(axis)
    least = float((x @ axis).min())
    if least < 0:
        return
    angle, to = float(np.degrees(np.arccos(min(least, 1.0)))), ", ".join(f"{c:.4f}" for c in axis)
    words = f"no sample lies farther than {angle:.4g} degrees from ({to}), and the pdf has more; the others fit it"
    yield Hypothesis("missing tail", words, lambda s, _: lambda x: s.p(x) * (x @ axis >= least))


def _everywhere(x: np.ndarray) -> np.ndarray:
    return np.ones(len(x))


def _sine(x: np.ndarray) -> np.ndarray:
    return np.sqrt(np.maximum(x[:, 0] ** 2 + x[:, 1] ** 2, 1e-24))


def _unit(x: np.ndarray) -> np.ndarray:
    return np.asarray(x / np.sqrt(np.sum(x * x, axis=1, keepdims=True)))


def _squeezed(factor: float) -> Density:
    """Return the solid angle that x times (factor, factor, 1) fills, per solid angle at x: its determinant over its length^3."""
    return lambda x: np.asarray(factor**2 / np.sum((x * (factor, factor, 1.0)) ** 2, axis=1) ** 1.5)


def _cosine_to(power: float) -> Callable[[np.ndarray], np.ndarray]:
    def back(x: np.ndarray) -> np.ndarray:
        mu = np.sign(x[:, 2]) * np.abs(x[:, 2]) ** power
        scale = np.sqrt(np.maximum(1 - mu * mu, 0)) / _sine(x)
        return np.stack([x[:, 0] * scale, x[:, 1] * scale, mu], axis=-1)

    return back
