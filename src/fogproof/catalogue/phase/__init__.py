"""Cases of phase functions."""
