"""Registrations of a test, which no other test may find."""

from collections.abc import Iterator
from contextlib import contextmanager

from rollslip.catalogue import discovery


@contextmanager
def registrations_rolled_back() -> Iterator[None]:
    """Forget at the end what is registered in this process meanwhile."""
    before = dict(discovery._registered)
    try:
        yield
    finally:
        discovery._registered.clear()
        discovery._registered.update(before)
