"""Enclosures by ball arithmetic, and the golden tables made with them."""
