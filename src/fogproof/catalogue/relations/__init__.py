"""Relations that hold whatever the scene, kept by our own path tracer."""
