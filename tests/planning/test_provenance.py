"""What results say of the packages behind them."""

import json
from typing import ClassVar

import attrs
import pytest

from rollslip import evolve, load_scene, run
from rollslip.catalogue import discovery
from rollslip.catalogue.installed import THIS_PROCESS
from rollslip.planning.provenance import origin
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_plugins.torque import Palmgren
from rollslip_studies.friction_curve.study import FrictionCurve


@attrs.frozen(kw_only=True)
class OtherTorque(Palmgren):
    name: ClassVar[str] = "other-torque"


@attrs.frozen(kw_only=True)
class OtherCurve(FrictionCurve):
    name: ClassVar[str] = "other-curve"


@pytest.fixture(autouse=True)
def only_built_in(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})


@pytest.mark.parametrize(
    ("kind", "model", "key", "study"),
    [
        ("torque", OtherTorque, "models.torque", "friction-curve"),
        ("study", OtherCurve, "", "other-curve"),
    ],
)
def test_packages_of_torque_formulas_and_studies_are_named(kind, model, key, study):
    changes = {"accuracy.slices": 5, "models.torque": []}
    built_in = run(evolve(load_scene("gearbox"), changes, si=True), "friction-curve")
    assert THIS_PROCESS not in json.loads(built_in.attrs["packages"])
    discovery.add(kind, model)
    if key:
        changes[key] = [model.name]
    scene = evolve(load_scene("gearbox"), changes, si=True)
    assert THIS_PROCESS in json.loads(run(scene, study).attrs["packages"])
    sweep = plan_sweep(scene, {"operation.radial_load": ["1 kN", "2 kN"]}, study=study)
    assert f"{kind} {model.name}" in sweep.local


def test_the_package_of_a_campaign_is_named():
    facts = origin(study="limit", packages={"numpy": "2.0"})
    assert {"rollslip", "numpy"} == json.loads(facts["packages"]).keys()
