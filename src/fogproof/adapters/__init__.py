"""Adapters that make other renderers' code look like a `Sampler` or an `Estimator`."""

from fogproof.adapters.mitsuba import MitsubaPhase

__all__ = ["MitsubaPhase"]
