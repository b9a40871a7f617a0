"""Samples of whole numbers carry their table with them: each tells the probability that is claimed of its entry.

Entries that the first rows show are known by what is claimed there; those rows are not judged, so that it is no accident of the
others which ones are known. All other entries count as one, whose probability is what is left of 1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.contracts import Draw, Reference
from fogproof.pipe.truth import KnownLaw

_KNOWN = 0.5  # of probability that entries must claim which the first rows show: else too little is known of the rest


def with_its_table(truth: KnownLaw, draw: Draw, pilot: int) -> tuple[KnownLaw, Draw] | None:
    """Return the law that samples (n,) of a `Discrete` domain claim, and the samples with all unknown entries as one.

    None where the first `pilot` rows show too little, or what is no probability.
    """
    assert draw.pdf is not None
    whole = truth.domain.contains(draw.x, 0.0)
    if not whole.all() or not bool(np.all((draw.pdf > 0) & (draw.pdf <= 1))):
        return None
    known, first = np.unique(draw.x[:pilot], return_index=True)
    claimed = draw.pdf[:pilot][first]
    if claimed.sum() < _KNOWN:
        return None
    other = _first_missing(known)
    rest = max(1.0 - float(claimed.sum()), 0.0)

    def density(x: np.ndarray) -> Reference:
        at = np.minimum(np.searchsorted(known, x), len(known) - 1)
        return Reference(np.where(known[at] == x, claimed[at], np.where(x == other, rest, 0.0)))

    unknown = ~np.isin(draw.x, known)
    x, pdf = np.where(unknown, other, draw.x), np.where(unknown, rest, draw.pdf)
    return replace(truth, density=density), draw._replace(x=x, pdf=pdf)


def _first_missing(known: np.ndarray) -> float:
    """Return the smallest number >= 0 that is none of the sorted ones."""
    gaps = np.flatnonzero(known != np.arange(len(known)))
    return float(gaps[0]) if len(gaps) else float(len(known))
