"""The theory in pictures."""
