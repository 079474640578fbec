"""A module that takes its time: what `check_its_module_is_imported_fast_and_quietly` has to find."""

import time

time.sleep(0.6)
