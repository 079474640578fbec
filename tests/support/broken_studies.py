"""Studies that break a rule of the kit each, made from one that breaks none."""

import itertools
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np

from rollslip.datasets import SceneData
from rollslip.errors import ConvergenceError
from rollslip.fields import parameter
from rollslip.studies.answers import Output
from rollslip.studies.study import Study
from rollslip_studies.friction_curve.study import FrictionCurve


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
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({"friction": "force"})
    affected_by: ClassVar[frozenset[str]] = frozenset({"slices"})
    factor: float = parameter(default=1.0, unit="1", doc="factor")

    def run(self, assembly, context=None):
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
    """A variable of the result is not declared."""

    def change(self, variables, assembly):
        variables["extra"] = ((), 1.0, {"units": "1", "long_name": "extra"})


@attrs.frozen(kw_only=True)
class OtherUnit(HeaviestForce):
    """A variable is in another unit than declared."""

    def change(self, variables, assembly):
        variables["force"][2]["units"] = "kN"


@attrs.frozen(kw_only=True)
class OtherDims(HeaviestForce):
    """A variable has other dimensions than declared."""

    def change(self, variables, assembly):
        variables["force"] = (("raceway",), *variables["force"][1:])


@attrs.frozen(kw_only=True)
class Unsaid(HeaviestForce):
    """A value is missing, and no output says why."""

    def change(self, variables, assembly):
        variables["force"][1][0] = np.nan


@attrs.frozen(kw_only=True)
class Infinite(HeaviestForce):
    """A value is infinite where there is none."""

    def change(self, variables, assembly):
        variables["margin"] = ((), np.inf, variables["margin"][2])


@attrs.frozen(kw_only=True)
class EmptyStatus(HeaviestForce):
    """A value is missing, and its status is empty."""

    def change(self, variables, assembly):
        variables["margin_status"] = ((), "", variables["margin_status"][2])


@attrs.frozen(kw_only=True)
class JudgesNothing(HeaviestForce):
    """What is held against a tolerance is no output."""

    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({"friction": "pull"})


@attrs.frozen(kw_only=True)
class JudgesZero(HeaviestForce):
    """What is held against a tolerance is 0, and nothing says what size is none."""

    def change(self, variables, assembly):
        variables["force"][1][:] = 0.0


@attrs.frozen(kw_only=True)
class ActsUnknown(HeaviestForce):
    """A choice that nobody can make is said to act."""

    affected_by: ClassVar[frozenset[str]] = frozenset({"slices", "weather"})


_COUNT = itertools.count(1)


@attrs.frozen(kw_only=True)
class Counting(HeaviestForce):
    """The result depends on how often it was asked for."""

    def change(self, variables, assembly):
        variables["force"][1][0] += next(_COUNT)


@attrs.frozen(kw_only=True)
class ActsInSecret(HeaviestForce):
    """A numerical choice acts that is said to do nothing."""

    def change(self, variables, assembly):
        variables["force"][1][0] *= assembly.resolution.table_tolerance


@attrs.frozen(kw_only=True)
class LeavesOutTooMuch(HeaviestForce):
    """Leaving outputs out changes another one."""

    def without_outputs(self, outputs):
        return attrs.evolve(self, factor=2.0 * self.factor)


@attrs.frozen(kw_only=True)
class WrongShortWay(HeaviestForce):
    """The short way to an output leads to another value."""

    def partial_result(self, assembly, outputs):
        dims, values, said = self.values(assembly)["force"]
        return {"force": (dims, 2.0 * values, said)}, {
            "ring": ("ring", np.array(["inner", "outer"]), {})
        }


@attrs.frozen(kw_only=True)
class Complex(HeaviestForce):
    """A value is complex, which a sweep would store as text."""

    def change(self, variables, assembly):
        variables["margin"] = ((), 1.0 + 2.0j, variables["margin"][2])


@attrs.frozen(kw_only=True)
class Huge(HeaviestForce):
    """A number has more digits than a double."""

    def change(self, variables, assembly):
        variables["margin"] = ((), 2**53 + 1, variables["margin"][2])


@attrs.frozen(kw_only=True)
class NoDefaults(HeaviestForce):
    """A sweep that names no outputs would store none."""

    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            name: attrs.evolve(output, default=False)
            for name, output in HeaviestForce.outputs.items()
        }
    )


@attrs.frozen(kw_only=True)
class OfSamples(HeaviestForce):
    """A dimension is that of the samples of a sweep."""

    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            **HeaviestForce.outputs,
            "force": Output("sample", "N", "largest normal force", default=True),
        }
    )


@attrs.frozen(kw_only=True)
class NegativeCost(HeaviestForce):
    """A part of the plan costs less than nothing."""

    def cost(self, assembly):
        return {"run": -1.0}


@attrs.frozen(kw_only=True)
class HiddenCost(HeaviestForce):
    """The plan does not show what the study costs."""

    def parts(self, assembly, estimated, costs):
        return super().parts(assembly, estimated, {})


@attrs.frozen(kw_only=True)
class NoEstimate(HeaviestForce):
    """There is no estimate of what it needs."""

    def choose_resolution(self, assembly, *, cheaper_laws=True):
        raise ConvergenceError("it never ends")


@attrs.frozen(kw_only=True)
class StructuredAttribute(HeaviestForce):
    """An attribute is a structure that no file holds."""

    def run(self, assembly, context=None):
        return super().run(assembly).assign_attrs(settings={"factor": self.factor})


@attrs.frozen(kw_only=True)
class SaysNothing(HeaviestForce):
    """The result has nothing that can be said."""

    def run(self, assembly, context=None):
        return super().run(assembly).drop_vars(["force", "margin", "margin_status"])


@attrs.frozen(kw_only=True)
class CurvesWithoutFilm(FrictionCurve):
    """Curves come without the film that comparisons show."""

    def run(self, assembly, context=None):
        return super().run(assembly).drop_vars("film_parameter")


@attrs.frozen(kw_only=True)
class CurvesWithoutSlices(FrictionCurve):
    """Curves come without the slices that they are means of."""

    def loaded_slices(self, assembly, dataset):
        return iter(())


class NoFile(SceneData):
    """It names a file that its package does not have."""


#: Rule -> the study or the scene that breaks it.
BROKEN = [
    (
        "check_a_scene_is_read_and_its_bearing_put_together",
        NoFile("nowhere", "rollslip_plugins.scenes"),
    ),
    ("check_its_result_has_the_outputs_it_declares", Undeclared()),
    ("check_its_result_has_the_outputs_it_declares", OtherUnit()),
    ("check_its_result_has_the_outputs_it_declares", OtherDims()),
    ("check_missing_outputs_have_a_status", Unsaid()),
    ("check_missing_outputs_have_a_status", Infinite()),
    ("check_missing_outputs_have_a_status", EmptyStatus()),
    ("check_compared_quantity_is_an_output", JudgesNothing()),
    ("check_compared_quantity_is_an_output", JudgesZero()),
    ("check_compared_quantity_is_an_output", ActsUnknown()),
    ("check_it_gives_the_same_bits_twice", Counting()),
    ("check_what_does_not_act_changes_nothing", ActsInSecret()),
    ("check_leaving_outputs_out_changes_no_other", LeavesOutTooMuch()),
    ("check_short_ways_give_what_a_run_gives", WrongShortWay()),
    ("check_a_sweep_returns_its_outputs", Complex()),
    ("check_a_sweep_returns_its_outputs", Huge()),
    ("check_a_sweep_returns_its_outputs", NoDefaults()),
    ("check_a_sweep_returns_its_outputs", OfSamples()),
    ("check_it_is_planned", NegativeCost()),
    ("check_it_is_planned", HiddenCost()),
    ("check_it_is_planned", NoEstimate()),
    ("check_its_results_can_be_stored", StructuredAttribute()),
    ("check_result_is_described", SaysNothing()),
    ("check_its_curves_can_be_compared", CurvesWithoutFilm(points=5)),
    ("check_its_curves_can_be_compared", CurvesWithoutSlices(points=5)),
]
