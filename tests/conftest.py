"""Profiles of hypothesis: the default run is short, ``--hypothesis-profile=thorough`` searches long."""

from hypothesis import settings

settings.register_profile("short", max_examples=40)
settings.register_profile("thorough", max_examples=1000)
settings.load_profile("short")
