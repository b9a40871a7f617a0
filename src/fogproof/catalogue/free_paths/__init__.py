"""Cases of free paths."""
