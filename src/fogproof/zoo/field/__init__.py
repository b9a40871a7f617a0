"""Bugs that shipped somewhere, as subjects that have them; each cites where it was reported."""
