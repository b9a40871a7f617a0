"""What the estimators know of each kind of occluder: `meets`, whether straight ways meet it. One module a kind, found by name."""
