"""Which of all hypotheses explains an image that is off."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from fogproof.images.causes import brightness, factors, film, lengths, medium, orders, terms
from fogproof.images.causes.fit import CauseFit, fit, noise_of
from fogproof.images.causes.image_cause import Sight
from fogproof.images.picture import RenderedImage
from fogproof.images.residuals import Residuals
from fogproof.scene import ImageScene

PIXELS, SLOW_PIXELS = 4096, 256
"""Pixels at which causes are compared, and those where a ray takes longer than `FAST`."""

FAST = 5e-5
"""Seconds."""

PLAIN = 0.995
"""Share of the misfit that a cause without costly parameters explains, so that no other is looked for."""

BELIEVED = 0.8
"""Share of the misfit that a cause has to explain to be named."""

ROUGH = 0.02
"""Relative difference of a pixel from the mean of its neighbourhood beyond which the image is not smooth there."""

MARGIN = 3
"""Pixels around such a pixel that are left out as well."""

EXACT = 1e-4
"""Relative error of predictions: nothing is told apart by less."""

SURE = 3.0
"""Standard deviations of noise that a cause may leave more than noise does."""

GAIN = 10.0
"""What a cause must explain at least, in squares of the noise: that there is one has been found by better tests."""

PRICE = 12.0
"""What a parameter must gain, in squares of the noise, to be worth it."""


def diagnose(scene: ImageScene, picture: RenderedImage, found: Residuals) -> tuple[str, str] | None:
    """Return the name of the likely cause and a sentence with its fit, or None where no hypothesis explains the misfit."""
    sight = _sight(scene, picture, found)
    if sight is None:
        return None
    noise = noise_of(sight)
    nothing = float(np.sum(((sight.image - sight.reference) / noise) ** 2))
    quick = list(_fits(sight, noise, fast=True))
    told = _choice(sight, quick, noise, nothing)
    if told is not None and told.explained >= PLAIN and told.clean:
        return told.cause, told.words
    told = _choice(sight, [*quick, *_fits(sight, noise, fast=False)], noise, nothing)
    return None if told is None else (told.cause, told.words)


@dataclass(frozen=True)
class Choice:
    """The best cause: its name, a sentence, the share of the misfit it explains, and whether it leaves noise alone."""

    cause: str
    words: str
    explained: float
    clean: bool


def _choice(sight: Sight, fits: list[CauseFit], noise: np.ndarray, nothing: float) -> Choice | None:
    """Return the best of the fits, if any explains the misfit."""
    count = sight.image.size
    if not fits:
        return None
    # Where no noise is left, as in a deterministic image, differences of neighbours were bias: the best fit says how little it is.
    exact = float(np.mean((EXACT * np.abs(sight.reference) / noise) ** 2))
    unit = min(1.0, max(min(one.left for one in fits) / count, exact))
    fits = [replace(one, left=one.left / unit) for one in fits]
    nothing /= unit
    price = [one.left + PRICE * len(one.parameters) for one in fits]
    least = min(price)
    best = next(one for one, cost in zip(fits, price, strict=True) if _as_good(one, cost, least, nothing, unit < 0.5))
    explained = _explained(best, nothing, count)
    gain = nothing - best.left - PRICE * len(best.parameters)
    clean = best.left <= count + SURE * np.sqrt(2 * count)
    if gain < GAIN or (explained < BELIEVED and not clean):
        return None
    cause, sentence = best.told
    others = [
        one.told[0]
        for one, cost in zip(fits, price, strict=True)
        if one is not best and _as_good(one, cost, least, nothing, unit < 0.5) and one.told[0] != cause
    ]
    words = f"{sentence}; that explains {min(explained, 1.0):.2%} of the misfit"
    if others:
        words += f"; so would {', '.join(dict.fromkeys(others))}"
    return Choice(cause, words, explained, clean)


def _as_good(one: CauseFit, cost: float, least: float, nothing: float, exact: bool) -> bool:
    """Return whether nothing tells a cause from the best one; the first of those, which is the simplest, is named.

    Without noise what is left is the error of taking middles for means, the same for all, which fitted parameters take up.
    """
    if not exact:
        return cost <= least + PRICE
    return cost <= 2 * least or (not len(one.parameters) and one.left <= 10 * least and one.left <= 1e-4 * nothing)


def _fits(sight: Sight, noise: np.ndarray, fast: bool) -> Iterator[CauseFit]:
    """Yield the fits of hypotheses that cost little, or of those whose parameters need many evaluations of the scene."""
    for module in (factors, film, terms, medium, lengths, orders, brightness):
        for hypothesis in module.hypotheses(sight):
            if fast == (not hypothesis.starts or module in (factors, brightness)):
                found = fit(sight, hypothesis, noise)
                if found is not None:
                    yield found


def _explained(one: CauseFit, nothing: float, count: int) -> float:
    """Return the share of the misfit beyond noise that is explained."""
    noise = min(float(count), one.left)
    return (nothing - one.left) / (nothing - noise) if nothing > noise else 0.0


def _sight(scene: ImageScene, picture: RenderedImage, found: Residuals) -> Sight | None:
    """Choose pixels: evenly, where the reference is known well, and as many as can be evaluated quickly."""
    known = found.good & (found.allowed <= 0.01 * np.abs(found.reference) + 1e-300).all(axis=2)
    smooth = known & ~_rough(found.reference)
    known = smooth if 4 * smooth.sum() > known.sum() else known
    rows, columns = np.nonzero(known if known.any() else found.good)
    if len(rows) < 2:
        return None
    order = np.random.default_rng(0).permutation(len(rows))
    few = np.sort(order[: min(64, len(rows))])
    probe = Sight(scene, picture, found, rows[few], columns[few])
    probe.at_centres(scene)
    clock = time.perf_counter()
    probe.at_centres(scene)
    each = (time.perf_counter() - clock) / len(few)
    some = np.sort(order[: PIXELS if each < FAST else SLOW_PIXELS])
    return Sight(scene, picture, found, rows[some], columns[some])


def _rough(reference: np.ndarray) -> np.ndarray:
    """Return which pixels (rows, columns) are near an edge or a pole, where middles of pixels tell little of their means."""
    from scipy.ndimage import maximum_filter, uniform_filter

    off = np.abs(reference - uniform_filter(reference, (3, 3, 0), mode="nearest")) > ROUGH * np.abs(reference)
    return np.asarray(maximum_filter(off.any(axis=2), 2 * MARGIN + 1))
