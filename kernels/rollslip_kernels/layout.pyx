"""The members of ``rs_slices``: as rollslip.h lists them, and where the C compiler put them."""

cdef extern from *:
    """
    #include "rollslip.h"
    typedef struct { const char *name, *unit, *meaning; size_t offset; } rs_member;
    #define RS_MEMBER(name, unit, meaning) {#name, unit, meaning, offsetof(rs_slices, name)},
    static const rs_member RS_CONDITIONS[] = {ROLLSLIP_CONDITIONS(RS_MEMBER)};
    static const rs_member RS_COLUMNS[] = {ROLLSLIP_COLUMNS(RS_MEMBER)};
    enum { RS_N_CONDITIONS = sizeof RS_CONDITIONS / sizeof *RS_CONDITIONS };
    """
    ctypedef struct rs_member:
        const char *name
        const char *unit
        const char *meaning
        size_t offset

    const rs_member *RS_CONDITIONS
    const rs_member *RS_COLUMNS
    enum:
        RS_N_CONDITIONS

from rollslip_abi cimport ROLLSLIP_N_ALWAYS, ROLLSLIP_N_COLUMNS, rs_slices


cdef dict _described(const rs_member *members, int count):
    return {members[k].name.decode(): (members[k].unit.decode(), members[k].meaning.decode()) for k in range(count)}


cdef dict _placed(const rs_member *members, int count):
    return {members[k].name.decode(): members[k].offset for k in range(count)}


#: Condition -> (SI unit, meaning).
CONDITIONS: Final[Mapping[str, tuple[str, str]]] = _described(RS_CONDITIONS, RS_N_CONDITIONS)
#: Column -> (SI unit, meaning).
COLUMNS: Final[Mapping[str, tuple[str, str]]] = _described(RS_COLUMNS, ROLLSLIP_N_COLUMNS)
#: Columns that are there only where a stage reads one of them.
PLACES: Final[tuple[str, ...]] = tuple(COLUMNS)[ROLLSLIP_N_ALWAYS:]


def layout() -> tuple[int, dict[str, int]]:
    """Return the size of ``rs_slices`` and the offset of every member, in their order."""
    offsets = _placed(RS_CONDITIONS, RS_N_CONDITIONS) | _placed(RS_COLUMNS, ROLLSLIP_N_COLUMNS)
    return sizeof(rs_slices), {"n": 0} | offsets
