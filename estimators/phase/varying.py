"""Phase functions that vary in space: a blend, for compiled kernels and at points."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.kernels.path_data import BlendLobe
from fogproof.estimators.phase.functions import kernel_lobe, phase_value
from fogproof.scene.phase import AnyPhase, PhaseFunction, Ramp, VaryingPhase


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
    share = _share(phase, x.T)
    return (1 - share) * phase_value(phase.first, mu) + share * phase_value(phase.second, mu)


def _share(phase: VaryingPhase, x: np.ndarray) -> np.ndarray:
    """Return the part of the second phase function at points x (n, 3)."""
    if not isinstance(phase.share, Ramp):
        return np.asarray(phase.share(x))
    way = phase.share.end - phase.share.start
    return np.clip((x - phase.share.start) @ way / (way @ way), 0.0, 1.0)
