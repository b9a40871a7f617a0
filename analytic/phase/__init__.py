"""Phase functions: density, distribution, quantile, mean cosine."""
