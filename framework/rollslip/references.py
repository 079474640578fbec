"""The paper that rollslip follows, as it is cited."""

from typing import Final

KLEBANOV: Final = (
    "Klebanov I.M., Polyakov K.A., Petrov V.R., Pankratova N.A. Slip in roller bearings under hydrodynamic contact "
    "friction. J. Frict. Wear 43, 2022. doi:10.3103/S1068366622010068"
)
