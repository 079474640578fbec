"""A module that takes its time: what `check_its_module_is_imported_fast_and_quietly` has to find."""

import time

STARTED = time.process_time()
while time.process_time() < 0.6 + STARTED:
    pass
