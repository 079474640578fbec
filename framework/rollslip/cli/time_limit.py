"""The time limit of a run.

At the limit the run is interrupted, as by Ctrl+C: studies keep what they can. Compiled code that does not return to
Python hears no interrupt. So a second process waits as long again, and then ends the run.
"""

import ctypes
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from rollslip.errors import ConvergenceError
from rollslip.units import UnitError, quantity

#: Time [s], in addition to twice the limit, after which a run is ended from outside. Results are stored within it after
#: an interrupt; with half of it a slow disk could lose them. Chosen, as of the workers of a sweep.
_GRACE_PERIOD: Final = 10.0
#: What the second process does: it ends where the pipe to its input is closed, which is when the run ends.
_GUARD: Final = """
import os, signal, sys, threading
def end():
    os.write(2, sys.argv[3].encode())
    os.kill(int(sys.argv[1]), getattr(signal, "SIGKILL", signal.SIGTERM))
    os._exit(0)
timer = threading.Timer(float(sys.argv[2]), end)
timer.daemon = True
timer.start()
sys.stdin.buffer.read()
"""


class TimeLimit:
    """The time limit of a run.

    Parameters
    ----------
    given : str or None
        The limit with its unit, such as "60 s"; None for none.
    """

    def __init__(self, given: str | None) -> None:
        try:
            self._seconds = None if given is None else quantity(given, "s")
        except UnitError as error:
            raise UnitError(f"--time-limit: {error}") from None
        self.is_reached = False
        self._has_ended = False
        self._lock = threading.Lock()

    def error(self) -> ConvergenceError:
        """Return the error of what was ended."""
        return ConvergenceError(f"took longer than {self._seconds:g} s; raise --time-limit")

    @contextmanager
    def watch(self) -> Iterator[None]:
        """Interrupt the block at the limit, and end the process where that does not stop it."""
        if self._seconds is None:
            yield
            return
        end = 2.0 * self._seconds + _GRACE_PERIOD
        message = f"ended, because it did not stop: {self.error()}\n"
        arguments = ["-I", "-S", "-c", _GUARD, str(os.getpid()), str(end), message]
        timer = threading.Timer(self._seconds, self._interrupt)
        timer.daemon = True
        # at its end the block closes the pipe, and waits for the second process
        with subprocess.Popen([sys.executable, *arguments], stdin=subprocess.PIPE):
            try:
                timer.start()
                yield
            except KeyboardInterrupt:
                if not self.is_reached:
                    raise
                raise self.error() from None
            finally:
                with self._lock:
                    self._has_ended = True
                timer.cancel()

    def _interrupt(self) -> None:
        """Raise `KeyboardInterrupt` in the main thread, unless the block has ended."""
        main = ctypes.c_ulong(threading.main_thread().ident or 0)
        with self._lock:
            if not self._has_ended:
                self.is_reached = True
                ctypes.pythonapi.PyThreadState_SetAsyncExc(
                    main, ctypes.py_object(KeyboardInterrupt)
                )
