"""A wrong constant: the whole image, one channel of it, or channels exchanged."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from functools import partial

import numpy as np

from fogproof.images.causes.image_cause import ImageCause, Sight, fixed


def hypotheses(sight: Sight) -> Iterator[ImageCause]:
    """Yield factors; a constant with a name is tried as it is, and then any."""
    reference = sight.reference
    for name, factor in constants(sight).items():
        words = f"the image is {name} = {factor:.6g} times the reference"
        yield fixed("factor", partial(np.multiply, reference, factor), words)
    words = "the image is {:.6g} times the reference"
    yield ImageCause("factor", lambda p: p[0] * reference, lambda p: words.format(p[0]), ((1.0,),))
    if reference.shape[1] > 1:
        yield from _channels(sight)


def _channels(sight: Sight) -> Iterator[ImageCause]:
    reference, names, count = sight.reference, sight.picture.names, sight.reference.shape[1]
    for c in range(count):

        def scaled(p: np.ndarray, c: int = c) -> np.ndarray:
            return np.asarray(reference * np.where(np.arange(count) == c, p[0], 1.0))

        def words(p: np.ndarray, c: int = c) -> str:
            return f"channel {names[c]} is {p[0]:.6g} times the reference"

        yield ImageCause("channel", scaled, words, ((1.0,),))
    for order in itertools.permutations(range(count)) if count <= 3 else ():
        if list(order) != sorted(order):
            told = ", ".join(names[i] for i in order)
            yield fixed("channels-exchanged", partial(np.take, reference, order, axis=1), f"the channels hold {told}")


def constants(sight: Sight) -> dict[str, float]:
    """Return the constants that images are wrong by, and those of the scene."""
    found = {
        "1/(4 pi)": 1 / (4 * math.pi),
        "4 pi": 4 * math.pi,
        "1/pi": 1 / math.pi,
        "pi": math.pi,
        "1/(2 pi)": 0.5 / math.pi,
        "2 pi": 2 * math.pi,
        "1/2": 0.5,
        "2": 2.0,
        "1/4": 0.25,
        "4": 4.0,
    }
    for name in ("albedo", "sigma_s", "sigma_t", "sigma_a"):
        value = getattr(sight.scene.medium, name, None)
        if value is not None and not callable(value) and np.ndim(value) == 0 and 0 < float(value) != 1:
            found[name], found[f"1/{name}"] = float(value), 1 / float(value)
    return found
