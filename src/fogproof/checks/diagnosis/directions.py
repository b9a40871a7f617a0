"""What goes wrong with directions: signs, frames, axes, sines, parameters of phase functions, lobes about a normal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import permutations

import numpy as np

from fogproof.checks.diagnosis import grids, lobes
from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, known_number, of_points

_MIRROR = np.array([1.0, 1.0, -1.0])
_ALONG = 0.03  # from a coordinate axis: such a lobe is meant to be about it
_PER_CELL = 8  # samples in a cell, seen and expected, that tell a density
_UNIT_LENGTH = 0.3  # relative error of a direction that cells tell
_OUTER, _STEPS = 512, 2000  # samples that may bound a cone, and steps towards its axis
_LEAN = 0.03  # mean length of directions that have a direction


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to directions, the simplest first."""
    yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: _everywhere)
    yield Hypothesis(
        "sign convention", "these samples fit the pdf of the opposite direction", lambda s, _: lambda x: s.p(-x)
    )
    yield Hypothesis(
        "sign convention", "these samples fit the pdf with z mirrored", lambda s, _: lambda x: s.p(x * _MIRROR)
    )
    yield Hypothesis(
        "lost sign",
        "these samples fit the pdf with its lower half folded up: the sign of z is lost",
        lambda s, _: lambda x: (s.p(x) + s.p(x * _MIRROR)) * (x[:, 2] > 0),
    )
    for order in permutations(range(3)):
        if order != (0, 1, 2):
            names = "".join("xyz"[i] for i in order)
            words = f"these samples fit the pdf with its axes (x, y, z) taken for ({', '.join(names)})"
            yield Hypothesis("swapped axes", words, of_points(partial(np.take, indices=order, axis=1)))
    yield from _sines(setting)
    yield from _about_the_mean(setting)
    yield from _flat(setting)
    yield from _half_vectors(setting)
    yield from _frames(setting)
    yield from lobes.hypotheses(setting)
    yield from _powers(setting)
    yield Hypothesis(
        "another parameter",
        "these samples fit the pdf raised to the power {value}, as of a broader or a narrower lobe",
        lambda s, a: lambda x: np.maximum(s.p(x), 0.0) ** a,
        (0.3, 0.6, 0.8, 0.95, 1.05, 1.25, 1.7, 3.0),
        null=1.0,
    )
    yield from grids.of_directions(setting)


def _sines(setting: Setting) -> Iterator[Hypothesis]:
    sine = "missing Jacobian", "a sine is missing: these samples are uniform in theta where the pdf means solid angle"
    yield Hypothesis(*sine, lambda s, _: lambda x: s.p(x) / _sine(x))
    yield Hypothesis(
        "missing Jacobian", "these samples have a sine of theta too many", lambda s, _: lambda x: s.p(x) * _sine(x)
    )


def _powers(setting: Setting) -> Iterator[Hypothesis]:
    yield Hypothesis(
        "wrong power",
        "these samples fit the pdf times a power of the cosine, {value}",
        lambda s, a: lambda x: s.p(x) * np.abs(x[:, 2]) ** a,
        (-1.5, -1.0, -0.5, 0.5, 1.0, 2.0, 3.0),
        known_number(
            {
                -1.0: "a cosine is missing: uniform where the pdf is cosine-weighted",
                2.0: "two cosines too many",
                1.0: "a cosine too many",
            }
        ),
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
        known_number({2.0: "a square root of the cosine is missing", 0.5: "a square root too many"}),
        null=1.0,
    )


def _about_the_mean(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened about the mean direction of the claim, if it has one that is not z, and a cone too narrow."""
    yield from _cone(setting)
    mean = setting.claimed_mean()
    length = float(np.linalg.norm(mean))
    if length < _LEAN or np.linalg.norm(np.cross(mean, (0, 0, 1))) < _ALONG * length:
        return
    axis = mean / length
    frame = _turn(axis, np.array([0.0, 0.0, 1.0]))
    name = " about (" + ", ".join(f"{c:.3f}" for c in axis) + ")"
    known = [
        (setting, _turned(setting, frame))
    ]  # the last one: hypotheses are asked of the same points again and again

    def lifted(hypothesis: Hypothesis, s: Setting, value: float) -> Density:
        if known[0][0] is not s:
            known[0] = s, _turned(s, frame)
        turned = known[0][1]
        density = hypothesis.density(turned, value)
        return lambda x: density(turned.contrast.points if x is s.contrast.points else x @ frame.T)

    for hypothesis in (*_sines(known[0][1]), *_powers(known[0][1])):
        yield replace(hypothesis, words=hypothesis.words + name, density=partial(lifted, hypothesis))


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


def _flat(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that points of a cube, or of one plane, are normalised as if that kept areas.

    Seen from its origin, a plane's area of unit distance and normal n fills the solid angle (x . n)^3. The normal is not known: in
    cells, samples over what the claim expects, to the power -1/3, are a linear function of x, of which it is the gradient.
    """
    x = setting.contrast.x
    told = _cells(setting)
    if len(np.unique(3 * (x.max(axis=1) == np.abs(x).max(axis=1)) + np.abs(x).argmax(axis=1))) > 3:
        yield Hypothesis(
            "normalised cube",
            "these samples are points of a cube, normalised without rejection",
            lambda s, _: lambda x: s.p(x) / np.abs(x).max(axis=1) ** 3,
        )
    if told is None:
        return
    places, ratio = told
    gradient = np.linalg.lstsq(places, ratio ** (-1 / 3), rcond=None)[0]
    normal = gradient / max(float(np.linalg.norm(gradient)), 1e-300)
    if np.any(x @ normal <= 0):
        return
    to = ", ".join(f"{c:.3f}" for c in normal)
    words = f"these samples are even on the area of a plane of normal ({to}) where the pdf means solid angle"
    words += ": the cosine over the squared distance is missing"
    yield Hypothesis(
        "missing Jacobian", words, lambda s, _: lambda x: s.p(x) / np.maximum(x @ normal, 1e-9) ** 3, fitted=2
    )


def _half_vectors(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that directions reflected at a sampled half vector have the half vector's density.

    With h the half of wo and x, dh/dx = 1 / (4 h . wo), and 2 h . wo = |wo + x| (Walter et al. 2007, eq. 14). Where wo is unknown,
    in cells, samples over what the claim expects, to the power -2, are proportional to 1 + x . wo.
    """
    told = _cells(setting)
    if told is None:
        return
    places, ratio = told
    level, *gradient = np.linalg.lstsq(np.column_stack([np.ones(len(places)), places]), ratio**-2.0, rcond=None)[0]
    length = float(np.linalg.norm(gradient))
    if not (level > 0 and abs(length / level - 1) < _UNIT_LENGTH):
        return
    wo = np.asarray(gradient) / length
    to = ", ".join(f"{c:.3f}" for c in wo)
    words = f"the Jacobian 1/(4 h . wo) of a reflection at half vectors h is missing, with wo = ({to})"
    yield Hypothesis(
        "missing Jacobian", words, lambda s, _: lambda x: s.p(x) / np.sqrt(np.maximum(1 + x @ wo, 1e-9)), fitted=2
    )


def _cells(setting: Setting) -> tuple[np.ndarray, np.ndarray] | None:
    """Return where cells are, (m, 3), and how many samples they have over what the claim expects, (m,); None of too few cells."""
    contrast = setting.contrast
    n, cells = len(contrast.x), int(contrast.cell.max()) + 1
    weight = setting.values[n:] / contrast.q[n:]
    seen = np.bincount(contrast.cell[:n], minlength=cells)
    expected = np.bincount(contrast.cell[n:], weight, cells) * n / max(float(weight.sum()), 1e-300)
    full = (seen >= _PER_CELL) & (expected >= _PER_CELL)
    if np.count_nonzero(full) < 2 * _PER_CELL:
        return None
    middle = np.stack(
        [np.bincount(contrast.cell[n:], weight * contrast.z[:, axis], cells) for axis in range(3)], axis=1
    )
    places = middle[full] / np.bincount(contrast.cell[n:], weight, cells)[full, None]
    return places, seen[full] / expected[full]


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


def _frames(setting: Setting) -> Iterator[Hypothesis]:
    """Yield the turn that takes the mean direction of the claim to that of the samples, if both have one."""
    claim, samples = setting.claimed_mean(), setting.contrast.x.mean(axis=0)
    lengths = float(np.linalg.norm(claim)), float(np.linalg.norm(samples))
    if min(lengths) < _LEAN:
        return
    a, b = claim / lengths[0], samples / lengths[1]
    back = _turn(b, a)
    degrees = float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))
    lean = ", ".join(f"{c:.3f}" for c in b)
    words = f"these samples fit the pdf in another frame: turned by {degrees:.3g} degrees, towards ({lean})"
    yield Hypothesis("rotated frame", words, lambda s, _: lambda x: s.p(x @ back.T), fitted=2)


def _turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the rotation that takes the unit vector a to b the shortest way (Rodrigues)."""
    axis, cosine = np.cross(a, b), float(a @ b)
    if cosine < -1 + 1e-9:
        other = np.eye(3)[int(np.argmin(np.abs(a)))]
        axis = np.cross(a, other)
        axis /= np.linalg.norm(axis)
        return 2 * np.outer(axis, axis) - np.eye(3)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1 + cosine)
