"""The estimators that a study can name, one family a file."""
