"""Phase functions that vary in space: a blend, for compiled kernels and at points."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.kernels.path_data import BlendLobe
from fogproof.estimators.phase.functions import kernel_lobe, phase_value
from fogproof.scene.kinds import given
from fogproof.scene.phase import AnyPhase, PhaseFunction, PhaseOfMedia, Ramp, VaryingPhase


def lobe(phase: VaryingPhase) -> BlendLobe:
    """Return it for compiled kernels."""
    if not isinstance(phase.share, Ramp):
        raise UnsupportedError(
            "a share that is a Python function cannot enter a compiled kernel; give a Ramp", "medium.phase"
        )
    way = phase.share.end - phase.share.start
    way = way / np.sum(way * way)
    return BlendLobe(kernel_lobe(phase.first), kernel_lobe(phase.second), *phase.share.start.tolist(), *way.tolist())


def phase_value_at(phase: AnyPhase, x: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return f_p at points x (3, n) and forward cosines mu (n,) [1/sr]."""
    if isinstance(phase, PhaseFunction):
        return phase_value(phase, mu)
    if not isinstance(phase, VaryingPhase):
        return _of_media(phase, x, mu)
    share = _share(phase, x.T)
    return (1 - share) * phase_value(phase.first, mu) + share * phase_value(phase.second, mu)


def _of_media(phase: PhaseOfMedia, x: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return the mean by what scatters, 0 where nothing does."""
    medium = phase.medium
    if medium.channels is not None:
        raise UnsupportedError("phase functions that differ by channel: ask for one channel at a time", "medium")
    parts = np.array(given(medium, "fogproof.estimators.media", "scattering")(medium, x.T))
    total = parts.sum(axis=0)
    values = sum(part * phase_value(one.phase, mu) for part, one in zip(parts, medium.media, strict=True))
    return np.divide(values, total, out=np.zeros_like(total), where=total > 0)


def _share(phase: VaryingPhase, x: np.ndarray) -> np.ndarray:
    """Return the part of the second phase function at points x (n, 3)."""
    if not isinstance(phase.share, Ramp):
        return np.asarray(phase.share(x))
    way = phase.share.end - phase.share.start
    return np.clip((x - phase.share.start) @ way / (way @ way), 0.0, 1.0)
