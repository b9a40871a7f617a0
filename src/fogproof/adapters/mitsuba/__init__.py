"""Mitsuba 3's plugins and warps as samplers (single precision; mitsuba-renderer.org): a module a family of them."""

from fogproof.adapters.mitsuba.bsdf import MitsubaBSDF
from fogproof.adapters.mitsuba.emitter import MitsubaEmitter, MitsubaRays
from fogproof.adapters.mitsuba.medium import MitsubaFreePath, MitsubaTransmittance
from fogproof.adapters.mitsuba.phase import MitsubaPhase
from fogproof.adapters.mitsuba.runtime import ANYWHERE, installed, load, vectorised
from fogproof.adapters.mitsuba.warp import MitsubaWarp

__all__ = [
    "ANYWHERE",
    "MitsubaBSDF",
    "MitsubaEmitter",
    "MitsubaFreePath",
    "MitsubaPhase",
    "MitsubaRays",
    "MitsubaTransmittance",
    "MitsubaWarp",
    "installed",
    "load",
    "vectorised",
]
