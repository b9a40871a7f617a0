"""What the batches of one cell at one count are batches of: all that their numbers depend on, and nothing else."""

from __future__ import annotations

import hashlib
import json

from fogproof.study.cells import Cell

_IN_WORDS = ("question", "estimators")
"""Keys of a scene that change no batch of one of its estimators."""


def identity_of(cell: Cell, size: int) -> str:
    """Return the digest of the scene, the estimator, the points, the seed and the batch size, for one count.

    The text of the study has them as they were written: a default that is spelt out is another study, which costs a drawing
    more but never mixes two.
    """
    table = json.loads(cell.study.text)
    number = cell.study.scenes.index(cell.scene)
    scene = table["scenes"][number]
    estimator = scene["estimators"][cell.scene.estimators.index(cell.method)]
    said = {
        "scene": {key: value for key, value in scene.items() if key not in _IN_WORDS},
        "estimator": estimator,
        "name": cell.name,
        "points": cell.points,
        "seed": cell.study.seed,
        "batch": cell.study.batch,
        "size": size,
    }
    return hashlib.blake2b(json.dumps(said, sort_keys=True).encode(), digest_size=16).hexdigest()
