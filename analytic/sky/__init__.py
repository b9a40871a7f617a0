"""The Rayleigh sky and its colours."""
