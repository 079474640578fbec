"""The rule by which a number in JSON has a unit, as docs/reference/commands.rst gives it."""


def without_units(value, around=()):
    """Give what leads to each number without a unit; `around` are the tables that it stands in, each with a key."""
    if isinstance(value, dict):
        for key in value.keys() - {"units"}:
            yield from without_units(value[key], (*around, (value, key)))
    elif isinstance(value, list):
        for one in value:
            yield from without_units(one, around)
    elif isinstance(value, int | float) and not isinstance(value, bool) and unit_of(around) is None:
        yield "/".join(key for _, key in around)


def unit_of(around):
    """The rule: the nearest table with ``units`` for a key on the way to the number, or with ``unit``."""
    keys = [key for _, key in around]
    for depth in reversed(range(len(around))):
        table = around[depth][0]
        for key in reversed(keys[depth:]):
            if key in table.get("units", {}):
                return table["units"][key]
        if "unit" in table:
            return table["unit"]
    return None
