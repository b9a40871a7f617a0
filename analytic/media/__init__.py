"""What a medium is along a ray: its coefficients, its optical thickness, where it breaks."""
