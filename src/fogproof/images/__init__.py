"""Images of other renderers: read, compared with the oracle or with each other, and explained."""
