"""Cases of transmittance and fog."""
