"""Property-based tests take as long as the machine needs: how slow an example is says nothing about whether it is right.

One that fails is made simpler for half a minute, not for the five that Hypothesis would take: a failure must be told soon.
"""

from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import engine

engine.MAX_SHRINKING_SECONDS = 30
settings.register_profile("fogproof", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("fogproof")
