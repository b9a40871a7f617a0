"""The phase function of several media for compiled kernels: a lobe of the first and one of the rest, by what scatters."""

from __future__ import annotations

from typing import Any

from fogproof.errors import UnsupportedError
from fogproof.estimators.kernels.path_data import MediaLobe
from fogproof.estimators.media import ROOM
from fogproof.estimators.phase.functions import kernel_lobe
from fogproof.scene.kinds import given
from fogproof.scene.phase import PhaseOfMedia


def lobe(phase: PhaseOfMedia) -> Any:
    """Return it for compiled kernels."""
    if phase.medium.channels is not None:
        what = "media whose phase functions differ are followed in one channel"
        raise UnsupportedError(f"{what}; trace each with PathTracer", "medium.phase")
    data = given(phase.medium, ROOM, "kernel_data")(phase.medium)
    if data is None:
        raise UnsupportedError("a phase function by array functions cannot enter a compiled kernel", "medium.phase")
    lobes = [kernel_lobe(one.phase) for one in phase.medium.media]
    return _chain(lobes, data)


def _chain(lobes: list[Any], data: Any) -> Any:
    return lobes[0] if len(lobes) == 1 else MediaLobe(lobes[0], _chain(lobes[1:], data.rest), data)
