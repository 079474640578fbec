"""Studies that break a rule of the kit each, made from one that breaks none."""

import itertools
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np

from rollslip.errors import ConvergenceError
from rollslip.fields import parameter
from rollslip.studies.answers import Output
from rollslip.studies.friction_curve.study import FrictionCurve
from rollslip.studies.study import Study


@attrs.frozen(kw_only=True)
class HeaviestForce(Study):
    """The largest normal force of a ring: a study as small as can be, and a right one."""

    name: ClassVar[str] = "heaviest-force"
    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            "force": Output("ring", "N", "largest normal force", default=True),
            "margin": Output("", "1", "share of unloaded rollers", status="margin_status"),
            "margin_status": Output("", "1", "what was found of them"),
        }
    )
    judged: ClassVar[Mapping[str, str]] = MappingProxyType({"friction": "force"})
    acts: ClassVar[frozenset[str]] = frozenset({"slices"})
    factor: float = parameter(default=1.0, unit="1", doc="factor")

    def run(self, assembly, keep=None):
        """Return the result."""
        import xarray as xr

        variables = self.values(assembly)
        self.change(variables, assembly)
        return xr.Dataset(variables, attrs=self.attributes)

    def values(self, assembly):
        """Return the variables."""
        loads = assembly.load_distribution(1)
        force = self.factor * np.array([loads.inner_force.max(), loads.outer_force.max()])
        return self.variables(force=force, margin=np.nan, margin_status="not looked for")

    def change(self, variables, assembly):
        """Break a rule."""


@attrs.frozen(kw_only=True)
class Undeclared(HeaviestForce):
    def change(self, variables, assembly):
        variables["extra"] = ((), 1.0, {"units": "1", "long_name": "extra"})


@attrs.frozen(kw_only=True)
class OtherUnit(HeaviestForce):
    def change(self, variables, assembly):
        variables["force"][2]["units"] = "kN"


@attrs.frozen(kw_only=True)
class OtherDims(HeaviestForce):
    def change(self, variables, assembly):
        variables["force"] = (("raceway",), *variables["force"][1:])


@attrs.frozen(kw_only=True)
class Unsaid(HeaviestForce):
    def change(self, variables, assembly):
        variables["force"][1][0] = np.nan


@attrs.frozen(kw_only=True)
class Infinite(HeaviestForce):
    def change(self, variables, assembly):
        variables["margin"] = ((), np.inf, variables["margin"][2])


@attrs.frozen(kw_only=True)
class EmptyStatus(HeaviestForce):
    def change(self, variables, assembly):
        variables["margin_status"] = ((), "", variables["margin_status"][2])


@attrs.frozen(kw_only=True)
class JudgesNothing(HeaviestForce):
    judged: ClassVar[Mapping[str, str]] = MappingProxyType({"friction": "pull"})


@attrs.frozen(kw_only=True)
class ActsUnknown(HeaviestForce):
    acts: ClassVar[frozenset[str]] = frozenset({"slices", "weather"})


_COUNT = itertools.count(1)


@attrs.frozen(kw_only=True)
class Counting(HeaviestForce):
    def change(self, variables, assembly):
        variables["force"][1][0] += next(_COUNT)


@attrs.frozen(kw_only=True)
class ActsInSecret(HeaviestForce):
    def change(self, variables, assembly):
        variables["force"][1][0] *= assembly.resolution.table_tolerance


@attrs.frozen(kw_only=True)
class LeavesOutTooMuch(HeaviestForce):
    def without(self, outputs):
        return attrs.evolve(self, factor=2.0 * self.factor)


@attrs.frozen(kw_only=True)
class WrongShortWay(HeaviestForce):
    def only(self, assembly, outputs):
        dims, values, said = self.values(assembly)["force"]
        return {"force": (dims, 2.0 * values, said)}, {"ring": ("ring", np.array(["inner", "outer"]), {})}


@attrs.frozen(kw_only=True)
class NegativeCost(HeaviestForce):
    def cost(self, assembly):
        return {"run": -1.0}


@attrs.frozen(kw_only=True)
class HiddenCost(HeaviestForce):
    def parts(self, assembly, estimated, costs):
        return super().parts(assembly, estimated, {})


@attrs.frozen(kw_only=True)
class NoEstimate(HeaviestForce):
    def estimate(self, assembly, *, cheaper_laws=True):
        raise ConvergenceError("it never ends")


@attrs.frozen(kw_only=True)
class StructuredAttribute(HeaviestForce):
    def run(self, assembly, keep=None):
        return super().run(assembly).assign_attrs(settings={"factor": self.factor})


@attrs.frozen(kw_only=True)
class SaysNothing(HeaviestForce):
    def run(self, assembly, keep=None):
        return super().run(assembly).drop_vars(["force", "margin", "margin_status"])


@attrs.frozen(kw_only=True)
class CurvesWithoutFilm(FrictionCurve):
    def run(self, assembly, keep=None):
        return super().run(assembly).drop_vars("film_parameter")


@attrs.frozen(kw_only=True)
class CurvesWithoutSlices(FrictionCurve):
    def evaluated(self, assembly, dataset):
        return iter(())


#: Broken study -> the check that must catch it.
BROKEN = {
    Undeclared(): "check_its_result_has_the_outputs_it_declares",
    OtherUnit(): "check_its_result_has_the_outputs_it_declares",
    OtherDims(): "check_its_result_has_the_outputs_it_declares",
    Unsaid(): "check_what_may_be_missing_has_a_status_in_words",
    Infinite(): "check_what_may_be_missing_has_a_status_in_words",
    EmptyStatus(): "check_what_may_be_missing_has_a_status_in_words",
    JudgesNothing(): "check_what_is_judged_is_an_output",
    ActsUnknown(): "check_what_is_judged_is_an_output",
    Counting(): "check_it_gives_the_same_bits_twice",
    ActsInSecret(): "check_what_does_not_act_changes_nothing",
    LeavesOutTooMuch(): "check_leaving_outputs_out_changes_no_other",
    WrongShortWay(): "check_short_ways_give_what_a_run_gives",
    NegativeCost(): "check_it_is_planned",
    HiddenCost(): "check_it_is_planned",
    NoEstimate(): "check_it_is_planned",
    StructuredAttribute(): "check_its_results_can_be_stored",
    SaysNothing(): "check_its_result_is_told",
    CurvesWithoutFilm(points=5): "check_its_curves_can_be_compared",
    CurvesWithoutSlices(points=5): "check_its_curves_can_be_compared",
}
