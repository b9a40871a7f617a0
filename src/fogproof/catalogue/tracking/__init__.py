"""Cases of trackers."""
