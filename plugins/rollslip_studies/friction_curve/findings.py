"""Account of study friction-curve."""

from collections.abc import Mapping
from typing import ClassVar, Final

import attrs

from rollslip.results.accounts import PlainAccount
from rollslip.results.answer import Answer
from rollslip.results.dataset import xr
from rollslip_studies.steady_slip.findings import next_of_others


class FrictionCurveAccount(PlainAccount):
    """Account of study friction-curve, by its curves."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "ring": ("ring", ""),
        "rolling_speed": ("entrainment speed", "m/s"),
    }

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the critical values of the curves, and the command for the slip of the cage."""
        return attrs.evolve(PlainAccount.answer(dataset), commands=next_of_others(dataset))

    figures_function = ".figures:figures"


ACCOUNT: Final = FrictionCurveAccount("friction-curve")
