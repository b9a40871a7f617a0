"""The statistical tests, one a file."""
