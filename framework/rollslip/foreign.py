"""Kernels from other languages: the struct of ``rollslip.h`` for ctypes and Numba, and a capsule from an address.

- The struct is derived from the columns, the conditions and the offsets of the C compiler, so that it always agrees.
- The caller is responsible for an address: a function of another signature cannot be detected.
"""

import ctypes
import importlib
from typing import Any, NamedTuple

from rollslip_kernels.chain import python_stage
from rollslip_kernels.layout import layout
from rollslip_kernels.slices import CONDITIONS

__all__ = ["EVALUATE", "NumbaSlices", "SlicesStruct", "capsule_from_address", "numba_slices"]

#: Member of ``rs_slices`` -> its offset [bytes] by the C compiler.
_OFFSETS = layout()[1]
#: The members in the order of the struct.
_MEMBERS = sorted(_OFFSETS, key=_OFFSETS.__getitem__)
#: Types of the members that are not columns.
_TYPES: dict[str, Any] = {"n": ctypes.c_size_t} | dict.fromkeys(CONDITIONS, ctypes.c_double)


class SlicesStruct(ctypes.Structure):
    """``rs_slices``: ``n``, a double for each condition, and a pointer to ``n`` doubles for each column."""

    _fields_ = [(name, _TYPES.get(name, ctypes.POINTER(ctypes.c_double))) for name in _MEMBERS]


#: ``rs_evaluate`` for ctypes: a function of a pointer to `SlicesStruct` and of the parameters.
EVALUATE = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(SlicesStruct), ctypes.c_void_p)


class _Model(ctypes.Structure):
    _fields_ = [
        ("abi", ctypes.c_uint32),
        ("size", ctypes.c_uint32),
        ("evaluate", ctypes.c_void_p),
        ("params", ctypes.c_void_p),
    ]


_name_of = ctypes.PYFUNCTYPE(ctypes.c_char_p, ctypes.py_object)(
    ("PyCapsule_GetName", ctypes.pythonapi)
)
_pointer_in = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
    ("PyCapsule_GetPointer", ctypes.pythonapi)
)


def capsule_from_address(
    evaluate_address: int, params_address: int = 0, owner: object = None
) -> object:
    """Return the capsule of a C function at an address, as ``kernel()`` of a model returns it.

    Parameters
    ----------
    evaluate_address : int
        Address of an ``rs_evaluate``: ``int f(const rs_slices *slices, const void *params)``, re-entrant, called
        without the GIL.
    params_address : int
        Address that is passed to it as ``params``.
    owner : object
        Object that must exist as long as the capsule: the library, the compiled function, the memory of the parameters.

    Examples
    --------
    >>> import ctypes
    >>> def no_friction(slices, params):
    ...     s = slices.contents
    ...     ctypes.memset(s.friction, 0, 8 * s.n)
    ...     return 0
    >>> function = EVALUATE(no_friction)
    >>> capsule_from_address(ctypes.cast(function, ctypes.c_void_p).value, owner=function)  # doctest: +ELLIPSIS
    <capsule object "rollslip.slice_model.v1" at 0x...>
    """
    # The capsule of a Python stage has the right ABI and size, owns its callee, and is freed in C. Here its function
    # and parameters are replaced, and its callee, which is never called, is the owner.
    capsule: Any = python_stage(owner, ())  # type: ignore[arg-type]
    table = _Model.from_address(_pointer_in(capsule, _name_of(capsule)))
    table.evaluate = evaluate_address
    table.params = params_address
    return capsule


class NumbaSlices(NamedTuple):
    """Signature and helper function of a kernel in Numba, see `numba_slices`."""

    signature: Any
    column: Any


def numba_slices() -> NumbaSlices:
    """Return the signature of a ``numba.cfunc`` that is a kernel, and a function that converts a member to a column.

    ::

        from numba import carray, cfunc
        from rollslip.foreign import capsule_from_address, numba_slices

        signature, column = numba_slices()

        @cfunc(signature)
        def ramp(slices, params):
            s = carray(slices, 1)[0]
            V, u, mu = column(s.sliding_speed), column(s.rolling_speed), column(s.friction)
            for i in range(s.n):
                mu[i] = 0.05 * V[i] / u[i]
            return 0

    and in the model ``kernel()`` returns ``capsule_from_address(ramp.address, owner=ramp)``. Conditions are read as
    ``s.viscosity``; ``carray(column(s.load), s.n)`` is a NumPy array.

    Raises
    ------
    ImportError
        If Numba is not installed; rollslip does not need it.
    """
    types = importlib.import_module("numba").types
    pointer = types.CPointer(types.float64)
    kinds = {"n": types.uintp} | dict.fromkeys(CONDITIONS, types.float64)
    # a record of Numba has numbers only: columns are addresses in it
    record = types.Record.make_c_struct([(name, kinds.get(name, types.uintp)) for name in _MEMBERS])

    def column(typing: Any, address: Any) -> Any:
        def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

        return pointer(address), generated

    intrinsic = importlib.import_module("numba.extending").intrinsic
    return NumbaSlices(types.int32(types.CPointer(record), types.voidptr), intrinsic(column))
