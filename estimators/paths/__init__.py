"""Path tracers and random walks."""
