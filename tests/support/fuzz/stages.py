"""Compiled stages fed with any bits: the stages there are, one table after another, each column in memory of its own.

- Through a chain, a stage gives finite results or is refused, and touches no column that is not its to write.
- Called directly, as no chain would, a stage comes back with a status whatever the bits are.
- The rows of a table of slices adjoin, so that an overrun of one lands in the next and no sanitizer sees it.
  `call_apart` gives each column an allocation of its own, whose ends AddressSanitizer guards.
"""

import ctypes
import math
import struct
from functools import cache

import numpy as np

from foreign_stages import EVALUATE, NAME, RsModel, RsSlices
from rollslip import Chain, Conditions, Slices, available, get_model
from rollslip.bearing.chain import stage
from rollslip.errors import DomainError
from rollslip.testing.samples import MAGNITUDES
from rollslip_kernels.slices import COLUMNS, CONDITIONS
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi

#: 5P4E after Ehret, Dowson and Taylor (1998); the other laws have no constants.
YASUTOMI = Yasutomi(
    glass_temperature=244.95, a1=134.2, a2=1.929e-9, b1=4.815, b2=0.160e-9, c1=16.01, c2=20.69
)
LAWS = [Barus(), Roelands(), YASUTOMI]


def compiled(kind):
    """Return the models of a kind that have a kernel, with their defaults."""
    models = [get_model(kind, name) for name in available(kind)]
    return [model for model in models if model.kernel() is not None]


@cache
def stages():
    """Return all compiled stages one by one, and by kind: contacts, films, tractions."""
    contacts, films, tractions = (compiled(kind) for kind in ("contact", "film", "traction"))
    single = [*contacts, *(contact.deflection() for contact in contacts), *films, *LAWS, *tractions]
    return single, contacts, films, tractions


@cache
def _chain(*choice):
    single, contacts, films, tractions = stages()
    if choice[0] % 2:
        kinds = contacts, films, LAWS, tractions
        models = [kind[i // 2 % len(kind)] for kind, i in zip(kinds, choice, strict=True)]
    else:
        models = [single[choice[1] % len(single)]]
    return Chain(*models)


# Direct calls --------------------------------------------------------------------------------------------------------

_libc = ctypes.CDLL(None)
_libc.malloc.restype = ctypes.c_void_p
_libc.malloc.argtypes = [ctypes.c_size_t]
_libc.free.argtypes = [ctypes.c_void_p]
_pointer_in = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
    ("PyCapsule_GetPointer", ctypes.pythonapi)
)


def call_apart(capsule, slices):
    """Return the status of a kernel called directly, with every column in an allocation of exactly its size."""
    model = RsModel.from_address(_pointer_in(capsule, NAME))
    n = len(slices)
    given = RsSlices(n=n, **{name: getattr(slices.conditions, name) for name in CONDITIONS})
    blocks = {name: _libc.malloc(8 * n) for name in COLUMNS}
    try:
        for name, block in blocks.items():
            ctypes.memmove(block, getattr(slices, name).ctypes.data, 8 * n)
            setattr(given, name, ctypes.cast(block, ctypes.POINTER(ctypes.c_double)))
        return EVALUATE(model.evaluate)(ctypes.byref(given), model.params)
    finally:
        for block in blocks.values():
            _libc.free(block)


# Fuzzing -------------------------------------------------------------------------------------------------------------

#: Bytes at the beginning of an input, which choose the chain.
_HEAD = 4
#: Bytes of a double.
_DOUBLE = 8
_ODD = [
    *(
        0.0,
        -0.0,
        1.0,
        -1.0,
        5e-324,
        -5e-324,
        2.2250738585072014e-308,
        1.7976931348623157e308,
        -1.7976931348623157e308,
    ),
    *(
        math.inf,
        -math.inf,
        math.nan,
        -math.nan,
        1e-300,
        1e300,
        -1e300,
        1e-160,
        1e160,
        1e-30,
        1e30,
        2.0**53,
        2.0**63,
    ),
]


def _doubles(data):
    return np.frombuffer(data[_HEAD : len(data) - (len(data) - _HEAD) % _DOUBLE])


def table(data):
    """Return the slices that bytes make: a head, the conditions, the columns; what is left over is not used."""
    values = _doubles(data)
    n = (len(values) - len(CONDITIONS)) // len(COLUMNS)
    columns = values[len(CONDITIONS) :][: n * len(COLUMNS)].reshape(len(COLUMNS), n)
    conditions = Conditions(**dict(zip(CONDITIONS, values.tolist(), strict=False)))
    return Slices(n, conditions, **dict(zip(COLUMNS, columns, strict=True)))


def run(data):
    """A table of any bits: finite results in the columns that are the stages' own, or a refusal."""
    if len(data) < _HEAD + _DOUBLE * (len(CONDITIONS) + len(COLUMNS)):
        return
    slices = table(data)
    given = table(data)
    chain = _chain(*data[:_HEAD])
    for model in chain.models:
        status = call_apart(stage(model), slices)
        assert 0 <= status <= len(slices), f"{model.name}: status {status}"
    written = frozenset().union(*(model.writes for model in chain.models))
    refusal = None
    try:
        chain(slices)
    except DomainError as error:
        refusal = str(error)
    if refusal is None:
        assert all(np.isfinite(getattr(slices, name)).all() for name in written)
    else:
        assert any(model.name in refusal for model in chain.models), refusal
    for name in COLUMNS.keys() - written:
        assert getattr(slices, name).tobytes() == getattr(given, name).tobytes(), (
            f"{name} was overwritten"
        )


def _changed(random, value):
    kind = random.randrange(6)
    if kind < 3:
        return (
            value * 10.0 ** random.gauss(0.0, (0.5, 5.0, 60.0)[kind])
            if random.random() < 0.9
            else -value
        )
    if kind < 5:
        return random.choice(_ODD)
    return struct.unpack("<d", random.randbytes(8))[0]


def changed(random, data):
    """Return a table with values moved by decades, taken to edges, or made of any bits."""
    head = random.randbytes(_HEAD)
    values = _doubles(data).tolist() or [0.0]
    for _ in range(random.choice((0, 1, 2, 4, len(values)))):
        at = random.randrange(len(values))
        try:
            values[at] = _changed(random, values[at])
        except OverflowError:
            values[at] = math.inf
    return head + struct.pack(f"<{len(values)}d", *values)


def typical(n):
    """Return a table of what bearings give."""
    spread = np.geomspace(0.1, 1.0, n) if n > 1 else np.ones(1)
    conditions = [MAGNITUDES[name][1] for name in CONDITIONS]
    columns = [MAGNITUDES[name][1] * spread for name in COLUMNS]
    return bytes(_HEAD) + np.concatenate([conditions, *columns]).tobytes()


SEEDS = [typical(n) for n in (1, 3, 257)]
