"""How every property of this folder is tried: each input has ten seconds, and none is kept for another time."""

from datetime import timedelta

from hypothesis import HealthCheck, Phase, settings

settings.register_profile(
    "ten-seconds",
    deadline=timedelta(seconds=10),
    suppress_health_check=[*HealthCheck],
    phases=[Phase.explicit, Phase.generate],
    database=None,
)
