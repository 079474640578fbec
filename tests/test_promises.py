"""What strangers import stays where it is: modules with their names, entry points, hooks and headers."""

import importlib
import re
from importlib.metadata import distribution
from pathlib import Path
from typing import get_type_hints

import pytest
import xarray as xr

import rollslip
from rollslip import hookspecs
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip.results.figures import Result

pytestmark = pytest.mark.quick

PAGE = (Path(__file__).parents[1] / "docs" / "reference" / "stability.rst").read_text(
    encoding="utf-8"
)
#: Module -> names that version 0.1 offered there.
PROMISED = {
    "rollslip": """Chain Conditions RollslipDeprecationWarning Slices available compare evolve explore fit
        get_include get_model limit load_distribution load_scene model open_result pareto plan plot register
        run sweep uncertainty""",
    "rollslip.cli": "main",
    "rollslip.datasets": "BearingData Family SceneData",
    "rollslip.engine": "Engine cores",
    "rollslip.errors": """BusyError ConvergenceError DomainError EngineError OutputError PluginError
        RollslipDeprecationWarning RollslipError SceneError""",
    "rollslip.fields": "FieldError at_least field in_range non_negative choice_of parameter positive",
    "rollslip.foreign": "EVALUATE NumbaSlices SlicesStruct capsule_from_address numba_slices",
    "rollslip.hookspecs": """accounts bearings campaigns contact_models damage_models drag_models engines film_models
        hookimpl hookspec integrator_models life_models loss_models lubricants measurements pressure_models rib_models
        pressure_viscosity_laws ring_models scene_formats scenes studies thermal_models torque_formulas
        traction_models""",
    "rollslip.lubricant": """Andrade Constant Exponential Hyperbola Lubricant OilPoint OilState OilTable
        PowerOfViscosity Scatter Table TemperatureLaw Vogel Walther fit_vogel fit_walther lubricant_from_table""",
    "rollslip.lubricant.pressure": "PressureViscosity",
    "rollslip_campaigns.measurement": "Measurement load_measurement",
    "rollslip.models": """ContactModel Domain Drag DragModel FINITE FilmModel IntegratorModel NON_NEGATIVE NO_LIMITS
        POSITIVE PocketFriction PressureModel ResistanceModel RibContact RibModel SCENE_VALUES SliceModel
        TractionModel Validity evaluate_arrays from_scene in_unit
        interval left_to_scene submodel""",
    "rollslip.references": "Citation Reference as_bibtex",
    "rollslip.rings": "RingModel RingShapes Stops",
    "rollslip.scene": """Accuracy Bearing FrozenTable LubricantTable Material ModelChoice Models Operation Plugins
        Profile Scene Surface resolved scene_hash""",
    "rollslip.studies.rating_life.model": "LifeDuty LifeModel RatedLife",
    "rollslip.studies.steady_slip.loss": "LossModel",
    "rollslip.studies.steady_slip.torque": "Duty TorqueFormula",
    "rollslip.studies.surface_damage.model": "Contacts DamageModel",
    "rollslip.studies.thermal_balance.model": "PLACES ROLES ThermalModel",
    "rollslip.testing": """Conformance Finding Nonconformance all_checks as_dict check_in_subprocess checks_of
        conformance format_findings rule""",
    "rollslip.units": "UnitError as_written check_unit evenly expectation format_quantity quantity",
    "rollslip_kernels.slices": "COLUMNS CONDITIONS Conditions Slices",
}


@pytest.mark.parametrize(("module", "names"), PROMISED.items(), ids=PROMISED)
def test_a_promised_module_has_the_names_that_it_had(module, names):
    offered = importlib.import_module(module)
    assert [name for name in names.split() if getattr(offered, name, None) is None] == []
    if hasattr(offered, "__all__"):
        assert set(names.split()) <= set(offered.__all__)


def test_names_of_the_package_are_loaded_when_they_are_used():
    assert all(getattr(rollslip, name) is not None for name in dir(rollslip))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = rollslip.nothing


def test_types_of_every_public_function_are_known():
    functions = [
        value for name in dir(rollslip) if not isinstance(value := getattr(rollslip, name), type)
    ]
    returned = {
        value.__name__: get_type_hints(value)["return"] for value in functions if callable(value)
    }
    assert (returned["run"], returned["open_result"]) == (Result, xr.Dataset)
    assert {"answer", "info", "plan", "report", "table", "sweep", "new"} <= returned.keys()


def test_every_hook_is_promised():
    hooks = {name for name, thing in vars(hookspecs).items() if hasattr(thing, "rollslip_spec")}
    assert hooks == {*PROMISED["rollslip.hookspecs"].split()} - {"hookimpl", "hookspec"}
    assert {get_kind(kind).hook for kind in kinds()} == hooks


def test_page_and_program_agree_on_what_things_derive_from():
    rows = re.findall(
        r"^   \* - (.+)\n     - ``([\w.]+)\.(\w+)``\n     - (promised|provisional)$",
        PAGE,
        re.MULTILINE,
    )
    found = {of: getattr(importlib.import_module(module), name) for of, module, name, _ in rows}
    assert {kind: get_kind(kind).base for kind in kinds()} == {
        kind: found[kind] for kind in kinds()
    }
    assert len(found) == len(rows) == PAGE.count("   * - ") - 1
    for of, module, name, promise in rows:
        assert (name in PROMISED.get(module, "").split()) == (promise == "promised"), of
    assert {name for *_, name, promise in rows if promise == "provisional"} >= {
        "Study",
        "Output",
        "Assembly",
    }


def test_promised_entry_points_are_there():
    points = distribution("rollslip").entry_points
    assert {
        "contact",
        "film",
        "traction",
        "drag",
        "integrator",
        "engine",
        "lubricant",
        "bearing",
    } <= {point.group.removeprefix("rollslip.") for point in points}
    [command] = points.select(group="console_scripts", name="rollslip")
    assert command.value == "rollslip.cli:main"


def test_the_headers_for_strangers_are_where_get_include_says():
    headers = {path.name for path in Path(rollslip.get_include()).iterdir()}
    assert {
        "rollslip.h",
        "rollslip_math.h",
        "rollslip_abi.pxd",
        "rollslip_stage.pxd",
        "rollslip_drag.pxd",
    } <= headers
