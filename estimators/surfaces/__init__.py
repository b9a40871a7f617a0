"""What the estimators know of each kind of place of a surface: `wall`, for kernels. One module a kind, found by name."""
