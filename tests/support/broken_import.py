"""A module that changes a built-in law, to what it was, so that other tests go on."""

import attrs

from broken_models import Film
from rollslip_plugins.film.formulas import Martin

Martin.equation = "".join([Martin.equation[:1], Martin.equation[1:]])


@attrs.frozen(kw_only=True)
class ChangesAnother(Film):
    """Its module puts something of its own into a built-in law."""


BROKEN = [("check_import_does_not_change_rollslip", ChangesAnother())]
