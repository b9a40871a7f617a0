"""Cases of single scattering."""
