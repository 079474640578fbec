"""What the tests of chains share: a contact, an error of a stage, and threads that start at once."""

import threading

from rollslip import Conditions

BEARING = Conditions(
    length=0.015,
    radius=0.006875,
    modulus=2.2857e11,
    roughness=2.3e-7,
    effusivity=1.3e4,
    temperature=323.15,
    viscosity=8.58e-3,
    pressure_viscosity=10.74e-9,
    thermoviscosity=0.0284,
    pressure_thermoviscosity=0.93e-10,
    conductivity=0.1425,
    eyring_stress=4e6,
    shear_modulus=3e8,
)


class OwnError(BaseException):
    """Not even an Exception: nothing may be swallowed."""


def run_together(task, count=8):
    """Run ``task(k)`` in threads that start at once; return what they return or raise."""
    answers = [None] * count
    start = threading.Barrier(count)

    def run(k):
        start.wait()
        try:
            answers[k] = task(k)
        except BaseException as error:
            answers[k] = error

    threads = [threading.Thread(target=run, args=(k,)) for k in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return answers
