"""A compiled law that breaks the contract, in C, one way at a time: which rule of the kit refuses it."""

import ctypes

import attrs
import pytest

from foreign_stages import NAME, SIZE, RsModel, _new_capsule, compiled, compiled_capsule
from rollslip import Chain
from rollslip.errors import PluginError
from rollslip.testing import checks_of
from rollslip.testing.findings import run_check
from strangers_laws import LIMITED_EYRING, LimitedEyring

SHEAR = "const double rate = s->film_viscosity[i] * s->sliding_speed[i]"
FILLED = "s->friction[i] = copysign(stress, rate) / s->pressure[i];"
COUNTED = "static int calls;\nint evaluate"
#: What is wrong -> what stands in the law, what is put in its place, and a rule that refuses it.
WAYS = {
    "what it reads changed": (
        FILLED, FILLED + " s->sliding_speed[i] *= 1.0000001;", "check_complies_with_its_declarations"
    ),
    "another column filled": (FILLED, FILLED + " s->half_width[i] = 1.0;", "check_complies_with_its_declarations"),
    "one slice too few": ("i < s->n;", "i + 1 < s->n;", "check_complies_with_its_declarations"),
    "no number": (FILLED, FILLED + " if (rate > 10.0) s->friction[i] = NAN;", "check_is_odd_in_slip"),
    "an infinity": (FILLED, FILLED + " if (rate > 10.0) s->friction[i] = HUGE_VAL;", "check_is_odd_in_slip"),
    "a state": ("return 0;", "if (s->n) s->friction[0] *= 1.0 + 1e-9 * (calls++ % 2);\n    return 0;",
                "check_has_no_hidden_state"),
    "a neighbour": ("s->sliding_speed[i]", "s->sliding_speed[i ? i - 1 : 0]",
                    "check_does_not_depend_on_the_order_of_slices"),
    "single precision": ("asinh(fabs(rate))", "(double)asinhf((float)fabs(rate))", "check_compiled_equals_numpy"),
    "MPa": ("limit * s->pressure[i]", "limit * 1e-6 * s->pressure[i]", "check_compiled_equals_numpy"),
    "no sign": ("copysign(stress, rate)", "stress", "check_is_odd_in_slip"),
    "no declaration": (SHEAR, SHEAR + " * (1.0 + s->rolling_speed[i] * 1e-9)", "check_compiled_equals_numpy"),
    "a status of no slice": ("return 0;", "return (int)s->n + 1;", "check_compiled_equals_numpy"),
    "an error without one": ("return 0;", "return -1;", "check_compiled_equals_numpy"),
}  # fmt: skip


@attrs.frozen(kw_only=True)
class Broken(LimitedEyring):
    """The law with one of its faults."""

    way: str = "no sign"

    def kernel(self):
        old, new, _ = WAYS[self.way]
        source = LIMITED_EYRING.replace(old, new).replace("int evaluate", COUNTED)
        return compiled_capsule(source, self.stress, self.limit)


@pytest.mark.parametrize("way", WAYS)
def test_a_compiled_law_that_breaks_the_contract_is_refused(way):
    assert WAYS[way][0] in LIMITED_EYRING
    model = Broken(way=way)
    finding, _ = run_check(
        model, next(check for check in checks_of(model) if check.__name__ == WAYS[way][2])
    )
    assert finding.status == "failed"
    assert len(finding.message) > 20


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        (
            {"name": b"rollslip.drag.v1"},
            "must return None or a capsule named 'rollslip.slice_model.v1'",
        ),
        ({"abi": 2}, "was built for ABI 2 of rollslip.h, this is 1"),
        ({"size": 64}, "reads 64 bytes of rs_slices, which never had less than"),
        ({"size": SIZE + 8}, "bytes"),
        ({"address": None}, "NULL"),
    ],
    ids=lambda of: of if isinstance(of, str) else next(iter(of)),
)
def test_a_table_that_breaks_the_contract_is_not_bound(changed, sentence):
    made = {
        "name": NAME,
        "abi": 1,
        "size": SIZE,
        "address": ctypes.cast(compiled(LIMITED_EYRING), ctypes.c_void_p).value,
    }
    made |= changed
    values = (ctypes.c_double * 2)(5e6, 0.06)
    table = RsModel(made["abi"], made["size"], made["address"], ctypes.addressof(values))
    capsule = _new_capsule(ctypes.addressof(table), made["name"], None)

    @attrs.frozen(kw_only=True)
    class Table(LimitedEyring):
        def kernel(self):
            return capsule

    with pytest.raises(PluginError, match=sentence):
        Chain(Table())
