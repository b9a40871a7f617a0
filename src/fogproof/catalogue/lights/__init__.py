"""Lights with extent: single scattering, one module a kind."""
