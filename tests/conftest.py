"""Profiles of hypothesis: the default run is short, ``--hypothesis-profile=thorough`` searches long.

Each worker gets one thread for linear algebra: two workers with as many threads each as there are cores only wait for
each other.

A quick run imports only files that have quick tests: importing all would take longer than its tests.
"""

import os
import signal

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from hypothesis import settings

# a shell starts its jobs in the background with SIGINT ignored, and what tests start would ignore it too
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("short", max_examples=40)
settings.register_profile("thorough", max_examples=1000)
settings.load_profile("short")


def pytest_ignore_collect(collection_path, config):
    """Leave out files without a quick test where nothing but quick tests is asked for."""
    asked = config.option.markexpr == "quick" and collection_path.suffix == ".py"
    return True if asked and "pytest.mark.quick" not in collection_path.read_text(encoding="utf-8") else None
