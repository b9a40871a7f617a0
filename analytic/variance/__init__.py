"""Second moments: the exact variance and cost of the usual estimators."""
