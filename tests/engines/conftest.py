"""Hypothesis made repeatable."""

from hypothesis import HealthCheck, settings

# Drawing a whole robot is a lot of draws, and judging one takes a while.
settings.register_profile(
    "repeatable robots",
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example],
)
settings.load_profile("repeatable robots")
