"""A phase function that varies in space, for compiled kernels."""

from __future__ import annotations

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.kernels.path_data import BlendLobe
from fogproof.estimators.phase.functions import kernel_lobe
from fogproof.scene.phase import Ramp, VaryingPhase


def lobe(phase: VaryingPhase) -> BlendLobe:
    """Return it for compiled kernels."""
    if not isinstance(phase.share, Ramp):
        raise UnsupportedError(
            "a share that is a Python function cannot enter a compiled kernel; give a Ramp", "medium.phase"
        )
    way = phase.share.end - phase.share.start
    way = way / np.sum(way * way)
    return BlendLobe(kernel_lobe(phase.first), kernel_lobe(phase.second), *phase.share.start.tolist(), *way.tolist())
