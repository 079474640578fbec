"""Profiles of hypothesis: the default run is short, ``--hypothesis-profile=thorough`` searches long.

Each worker gets one thread for linear algebra: two workers with as many threads each as there are cores only wait for
each other.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from hypothesis import settings

settings.register_profile("short", max_examples=40)
settings.register_profile("thorough", max_examples=1000)
settings.load_profile("short")
