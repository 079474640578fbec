"""Parameters that laws take from a scene: of a contact, a film, a pressure, a traction and a drag, or refused."""

from types import MappingProxyType

import attrs
import pytest

from registrations import registrations_rolled_back
from rollslip import evolve, get_model, load_scene, register
from rollslip.bearing.assembly import assemble
from rollslip.errors import PluginError, SceneError
from rollslip.models import POSITIVE, DragModel, IntegratorModel, TractionModel, from_scene

PAPER = load_scene("1032930-70C")


@attrs.frozen
class Starved(TractionModel):
    """Friction that knows how many rollers pass, and the temperature of the operation."""

    name = "starved"
    equation = "mu = c Z T"
    references = ("an example",)
    reads = frozenset({"sliding_speed"})
    domain = MappingProxyType({"sliding_speed": POSITIVE})
    rollers: float = from_scene("rollers", doc="rollers")
    temperature: float = from_scene("temperature", doc="temperature")
    load: float = from_scene("radial_load", doc="load")

    def evaluate(self, slices):
        slices.friction[:] = 1e-6 * self.rollers * self.temperature


@attrs.frozen
class Flange(DragModel):
    """A drag that rises with the load of the bearing."""

    name = "flange"
    equation = "T = -c F"
    references = ("an example",)
    load: float = from_scene("radial_load", doc="load")

    def torque(self, cage_speed, inner_speed, outer_speed):
        return -1e-6 * self.load


def test_a_law_of_a_contact_has_what_the_scene_gives():
    with registrations_rolled_back():
        register(Starved)
        scene = evolve(PAPER, {"models.traction": {"model": "starved", "load": "5 N"}})
        found = assemble(scene).traction
        assert (found.rollers, found.temperature, found.load) == (28.0, 343.15, 5.0)
        within = {"model": "lambda-blend", "hydrodynamic": "starved"}
        assert (
            assemble(evolve(PAPER, {"models.traction": within}, si=True)).traction.hydrodynamic.load
            == 3415.0
        )


def test_a_bearing_that_is_put_together_like_another_takes_its_own():
    with registrations_rolled_back():
        register(Starved)
        cold = evolve(PAPER, {"models.traction": "starved"})
        warm = evolve(cold, {"operation.temperature": "90 degC"})
        assert assemble(warm, like=assemble(cold)).traction.temperature == pytest.approx(
            363.15, rel=1e-15
        )


def test_a_drag_knows_the_load():
    with registrations_rolled_back():
        register(Flange)
        (drag,) = assemble(evolve(PAPER, {"cage.drag": ["flange"]})).cage.drags.torques
        assert drag.torque(300.0, 700.0, 0.0) == pytest.approx(-3415e-6, rel=1e-15)


def test_under_another_load_a_law_and_a_drag_know_it():
    with registrations_rolled_back():
        register(Starved)
        register(Flange)
        for changes in ({"models.traction": "starved"}, {"cage.drag": ["flange"]}):
            found = assemble(evolve(PAPER, changes, si=True)).with_resistance().at_load(500.0)
            given = [found.traction] if "models.traction" in changes else found.cage.drags.torques
            assert [one.load for one in given] == [500.0]


def test_what_a_scene_does_not_give_a_law_of_a_contact_is_said():
    @attrs.frozen
    class OnLand(Starved):
        """Friction that asks for a land."""

        name = "on-land"
        width: float = from_scene("land_width", doc="land")

    with registrations_rolled_back():
        register(OnLand)
        with pytest.raises(
            SceneError,
            match="traction 'on-land' needs it, and the scene gives no width of that land",
        ):
            assemble(evolve(PAPER, {"models.traction": "on-land"}))


def test_a_kind_that_takes_nothing_of_a_scene_is_refused_with_such_a_parameter():
    @attrs.frozen
    class Counting(type(get_model("integrator", "lsoda"))):
        """An integrator that asks for rollers."""

        name = "counting"
        rollers: float = from_scene("rollers", doc="rollers")

    assert issubclass(Counting, IntegratorModel)
    with pytest.raises(
        PluginError, match="class Counting: models of kind 'integrator' take nothing from a scene"
    ):
        register(Counting)
