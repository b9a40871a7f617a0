"""Random streams: every batch of every check has a generator of its own, named by what it is for.

No two cases, stages or batches share uniforms, and a batch can be drawn again alone.
"""

from __future__ import annotations

import hashlib

import numpy as np

BATCH = 1 << 16
"""Samples a batch: part of a check's definition, so that results do not depend on workers or memory."""


def fresh_seed() -> int:
    """Return a 64-bit seed from the operating system."""
    return int(np.random.SeedSequence().generate_state(1, np.uint64)[0])


def batch_generator(seed: int, name: str, stage: int, index: int) -> np.random.Generator:
    """Return the generator of batch `index` in `stage` of the case `name`."""
    words = np.frombuffer(
        hashlib.blake2b(name.encode("utf-8", "surrogatepass"), digest_size=16).digest(), dtype=np.uint32
    )
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(*map(int, words), stage, index)))


def batch_sizes(samples: int) -> list[int]:
    """Return the sizes of the batches that make up `samples`."""
    full, rest = divmod(samples, BATCH)
    return [BATCH] * full + ([rest] if rest else [])


def growing_sizes(samples: int) -> tuple[list[int], list[int]]:
    """Return the sizes of batches for a sample that grows by doubling, and the numbers of samples at which it may end."""
    ends = [size for size in (256 << k for k in range(64)) if size < samples] + [samples]
    sizes: list[int] = []
    for before, end in zip([0, *ends[:-1]], ends, strict=True):
        sizes += batch_sizes(end - before)
    return sizes, ends
