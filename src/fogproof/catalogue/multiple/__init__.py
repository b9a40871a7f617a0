"""Cases of multiple scattering."""
