"""The first sample: it sets scales and shows where the density is; it is not counted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.checks.promises import inside, usual_labels
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject

PILOT = 1 << 14
"""Samples that set scales and show where the density is; they are not counted."""

LARGE_PILOT = 1 << 17  # samples that the histogram of the label test follows, at most


@dataclass(frozen=True)
class Pilot:
    """A first sample: good points (n, ...) of the continuous part, usual event labels, and how many channels its weights have."""

    points: np.ndarray
    labels: dict[Any, int]
    channels: int


def draw_pilot(subject: Subject, seed: int, index: int = 0, n: int = PILOT) -> Pilot:
    """Draw the pilot number `index` of n samples, and keep what is good of it."""
    draw = subject.draw(batch_generator(seed, "samples", 0, index), subject.pilot or n)
    good = inside(subject, draw)
    for at in subject.at_atom(draw.x).values():
        good = good & ~at
    if draw.valid is not None:
        good = good & draw.valid
    channels = 0 if draw.weight is None else draw.weight.size // len(draw.x)
    return Pilot(draw.x[good], usual_labels(subject, draw), channels)
