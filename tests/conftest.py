"""Property-based tests take as long as the machine needs: how slow an example is says nothing about whether it is right."""

from hypothesis import HealthCheck, settings

settings.register_profile("fogproof", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("fogproof")
