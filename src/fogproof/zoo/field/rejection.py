"""A rejection sampler's bug that no sampling test can see, and by how far."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import binom

from fogproof.domains import Discrete
from fogproof.zoo.bug import Bug, sampler_bug
from fogproof.zoo.laws import Array
from fogproof.zoo.limits import chi_square_distance, samples_needed

TRIALS = 1000
COUNT = np.arange(TRIALS + 1)
RIGHT = binom(TRIALS, 0.5).pmf(COUNT)


def _series(x: Array, first: float) -> Array:
    """Return the correction of Stirling's formula; `first` is 13860, 13680 where the digits are exchanged."""
    y = 1 / (x * x)
    return (first - (462 - (132 - (99 - 140 * y) * y) * y) * y) / x / 166320


def _drawn() -> Array:
    """Return the law that Kachitvichyanukul & Schmeiser (1988) print: two of four corrections have the other sign.

    The bound is used where |k - mode| > 20 alone; squeezes, which make the effect smaller still, are left out.
    """
    up, down = _series(COUNT + 1.0, 13680), _series(TRIALS - COUNT + 1.0, 13680)
    right = _series(COUNT + 1.0, 13860), _series(TRIALS - COUNT + 1.0, 13860)
    off = up + down + right[0] + right[1]
    middle = TRIALS // 2
    law = RIGHT * np.where(np.abs(COUNT - middle) > 20, np.exp(off), 1.0)
    return law / law.sum()


def bugs() -> list[Bug]:
    """Return it."""
    drawn = _drawn()
    table = np.cumsum(drawn)
    bug = sampler_bug(
        "signs of Stirling's corrections in a binomial",
        "numpy#31238",
        lambda u: np.minimum(np.searchsorted(table, u[:, 0] * table[-1], side="right"), TRIALS),
        lambda k: RIGHT[k.astype(int)],
        ("few entries", "another law", "shape"),
        Discrete(TRIALS + 1),
        {"dimensions": 1},
    )
    return [replace(bug, needed=lambda: samples_needed(chi_square_distance(drawn, RIGHT)))]
