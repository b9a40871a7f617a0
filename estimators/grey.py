"""Estimators that follow one colour channel say so through this."""

from __future__ import annotations

from fogproof.errors import UnsupportedError
from fogproof.validate import Channels


def grey(name: str, value: Channels) -> float:
    """Return a grey value, or say that the estimator has no channels."""
    if isinstance(value, tuple):
        raise UnsupportedError(
            f"{name} has {len(value)} channels; this estimator follows one: run it once a channel", name
        )
    return value
