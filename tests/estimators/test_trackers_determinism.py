"""Protects: a batch is the same bits wherever and beside whatever it runs: one or two workers, threads or processes, or alone."""

from __future__ import annotations

import hashlib
import multiprocessing
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from tracker_media import MEDIA, OBLIQUE, voxels

from fogproof.checks.streams import batch_generator
from fogproof.estimators import (
    DeltaFreePath,
    DeltaTransmittance,
    MajorantGrid,
    RatioTransmittance,
    ResidualRatioTransmittance,
    SpectralFreePath,
)

BATCHES = range(4)
SUBJECTS = {
    "delta": DeltaTransmittance(MEDIA["trilinear"], OBLIQUE),
    "delta, distances": DeltaFreePath(MEDIA["trilinear"], OBLIQUE),
    "delta, blocks": DeltaTransmittance(MEDIA["nearest"], OBLIQUE, MajorantGrid.of(MEDIA["nearest"], 2)),
    "ratio": RatioTransmittance(MEDIA["linear"], OBLIQUE, 2.0),
    "residual": ResidualRatioTransmittance(MEDIA["noise"], OBLIQUE, 2.0, 0.5),
    "spectral": SpectralFreePath(voxels((4, 5, 6, 3)), OBLIQUE),
    "array function": RatioTransmittance(MEDIA["waves"], OBLIQUE),
}


def batch(name: str, index: int) -> str:
    """Return a digest of all that one batch of a subject returns."""
    subject: Any = SUBJECTS[name]
    rng = batch_generator(7, name, 0, index)
    drawn = subject.draw(rng, 3000) if hasattr(subject, "draw") else subject.sample(rng, 3000)
    digest = hashlib.sha256()
    for part in drawn:
        if part is not None:
            digest.update(np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()


def run(pool: Executor) -> dict[str, list[str]]:
    jobs = {name: [pool.submit(batch, name, index) for index in BATCHES] for name in SUBJECTS}
    return {name: [job.result() for job in parts] for name, parts in jobs.items()}


@pytest.fixture(scope="module")
def alone() -> dict[str, list[str]]:
    """Every batch drawn alone, in reverse order."""
    return {name: [batch(name, index) for index in reversed(BATCHES)][::-1] for name in SUBJECTS}


@pytest.mark.parametrize("workers", [1, 2])
def test_threads(alone: dict[str, list[str]], workers: int) -> None:
    with ThreadPoolExecutor(workers) as pool:
        assert run(pool) == alone


@pytest.mark.parametrize("workers", [1, 2])
def test_processes(alone: dict[str, list[str]], workers: int) -> None:
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert run(pool) == alone


def test_batches_differ(alone: dict[str, list[str]]) -> None:
    for digests in alone.values():
        assert len(set(digests)) == len(BATCHES)
