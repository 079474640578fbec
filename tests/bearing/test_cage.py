"""The cage of a scene: its table, what is estimated, what drags take from the scene, and faults in words."""

import attrs
import numpy as np
import pytest

from rollslip import evolve, load_scene, plan, register, sweep
from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import Cage, estimated_inertia
from rollslip.bearing.drags import Drags, TotalResistance, torque_capsule
from rollslip.catalogue import discovery
from rollslip.errors import PluginError, SceneError
from rollslip.models import DragModel
from rollslip.planning.plausibility import implausible
from rollslip.scene import resolved, scene_hash
from rollslip.scene.reading import parse_scene
from rollslip.scene.supply import DENSITY
from rollslip.studies.quantities import quantities
from rollslip_kernels.stages import drag as compiled
from rollslip_plugins.drag.rolling import Hysteresis, RollingResistance
from rollslip_plugins.drag.torques import Churning, ConstantTorque, CoulombPocket, PetroffLand
from without_bands import run

pytestmark = pytest.mark.quick

SCENE = load_scene("1032930-50C")
#: The same without a cage.
BARE = SCENE.text.partition("[cage]")[0] + "[operation]" + SCENE.text.partition("[operation]")[2]
WEIGHT = {"mass": "0.4 kg", "inertia": "0.0033 kg m2"}


def bearing(*drag, scene=SCENE, **table):
    """The bearing with a cage that nothing drags but what is named."""
    return assemble(evolve(scene, {"cage": WEIGHT | table | {"drag": list(drag)}}, si=True))


def faults(scene=None, /, **table):
    with pytest.raises(SceneError) as caught:
        _ = assemble(evolve(scene or SCENE, {"cage": table}, si=True)).cage
    return [problem.removeprefix("changes: ") for problem in caught.value.problems]


# The table -----------------------------------------------------------------------------------------------------------


def test_a_cage_is_read_with_its_units():
    cage = bearing(
        pocket_clearance="0.3 mm",
        pocket_stiffness="1e8 N/m",
        pocket_damping="0.5 s/m",
        pocket_contact="film",
        guidance="outer",
        land_radius="94 mm",
        land_width="8 mm",
        land_clearance="0.2 mm",
        unbalance="20 g mm",
    ).cage
    assert cage == Cage(
        mass=0.4,
        inertia=0.0033,
        pocket_clearance=3e-4,
        pocket_stiffness=1e8,
        pocket_damping=0.5,
        pocket_contact="film",
        guidance="outer",
        land_radius=0.094,
        land_width=0.008,
        land_clearance=2e-4,
        unbalance=2e-5,
    )
    assert not cage.drags


def test_what_is_silent_is_estimated_from_the_bearing():
    free, inner, outer = (
        bearing(guidance=guidance).cage for guidance in ("roller", "inner", "outer")
    )
    assert bearing().cage == free
    assert free.pocket_clearance == pytest.approx(0.225e-3, rel=1e-12)
    assert free.pocket_contact == "film"
    assert (free.land_radius, free.land_width, free.land_clearance) == (None, None, None)
    # the shoulder stands 3 mm over the raceway, of 82.5 and 97.5 mm
    assert inner.land_radius == pytest.approx(0.0855, rel=1e-12)
    assert outer.land_radius == pytest.approx(0.0945, rel=1e-12)
    assert outer.land_width == pytest.approx(0.0075, rel=1e-12)
    assert outer.land_clearance == pytest.approx(0.0025 * 0.0945, rel=1e-12)
    assert bearing(guidance="inner", land_radius="90 mm").cage.land_clearance == pytest.approx(
        2.25e-4, rel=1e-12
    )


def test_the_proposed_inertia_is_in_the_range_for_the_bearing():
    """0.35 to 0.45 kg and 3 to 3.6e-3 kg m2 for a cage of bronze in the 1032930."""
    mass, inertia = estimated_inertia(SCENE.bearing)
    assert 0.35 < mass < 0.45
    assert 3e-3 < inertia < 3.6e-3
    # as many rollers as fit, and few, leave some cage
    for rollers in (3, 37):
        assert estimated_inertia(attrs.evolve(SCENE.bearing, rollers=rollers))[0] > 0


def weights(density, thickness, b):
    """Mass and inertia of a ring with pockets in plain numbers: 1.6 roller lengths wide, on the orbit."""
    orbit = (b.inner_raceway_diameter + b.outer_raceway_diameter) / 4
    ring = (
        2 * np.pi * orbit * 1.6 * b.roller_length - b.rollers * b.roller_diameter * b.roller_length
    )
    mass = density * thickness * b.roller_diameter * ring
    return mass, mass * orbit**2


@pytest.mark.parametrize(
    ("make", "density", "thickness", "guidance", "clearance", "stiffness"),
    [
        ("brass", 8600, 0.4, "outer", 0.015, 5e7),
        ("steel", 7850, 0.12, "roller", 0.02, 5e7),
        ("polyamide", 1320, 0.4, "roller", 0.025, 5e6),
    ],
)
def test_all_of_a_cage_follows_from_its_make_and_the_bearing(
    make, density, thickness, guidance, clearance, stiffness
):
    cage = assemble(evolve(SCENE, {"cage": {"make": make}}, si=True)).cage
    assert (cage.mass, cage.inertia) == pytest.approx(
        weights(density, thickness, SCENE.bearing), rel=1e-12
    )
    assert (cage.guidance, cage.pocket_stiffness) == (guidance, stiffness)
    assert cage.pocket_clearance == pytest.approx(clearance * 0.015, rel=1e-12)


def test_a_scene_without_a_cage_has_the_one_of_its_bearing():
    cage = assemble(parse_scene(BARE, "mine.toml")).cage
    assert (cage.make, cage.guidance) == ("brass", "roller")
    assert [drag.name for drag in cage.drags] == ["churning", "rolling-resistance", "hysteresis"]
    assert cage.mass == pytest.approx(weights(8600, 0.4, SCENE.bearing)[0], rel=1e-12)
    # a stated mass sets the inertia with it
    heavy = assemble(evolve(SCENE, {"cage": {"mass": "2 kg"}})).cage
    assert heavy.inertia == pytest.approx(2 * 0.09**2, rel=1e-12)
    assert heavy.drags == cage.drags


NAMED = """[bearing]
name = "NU 2312 MA"
[lubricant]
name = "iso-vg-68"
[operation]
inner_speed = "3000 rpm"
radial_load = "3 kN"
temperature = "70 degC"
"""


@pytest.mark.parametrize(
    ("name", "make", "guidance"),
    [
        ("NU 2312 ECP", "polyamide", "roller"),
        ("NU2312-E-TVP2-C3", "polyamide", "roller"),
        ("NU 2312 ECM", "brass", "roller"),
        ("NU 2312 ECMB", "brass", "inner"),
        ("NU 2312 ECJ", "steel", "roller"),
        ("NU 2312", "polyamide", "roller"),
        ("NU 2332", "brass", "roller"),
    ],
)
def test_the_cage_follows_the_name_whichever_way_it_is_given(name, make, guidance):
    first = parse_scene(NAMED, "mine.toml")
    written = parse_scene(NAMED.replace("NU 2312 MA", name), "mine.toml")
    changed = evolve(first, {"bearing.name": name})
    once_more = evolve(written, {"bearing.name": "NU 2312 MA"})
    cages = [assemble(scene).cage for scene in (written, changed)]
    assert cages[0] == cages[1]
    assert (cages[0].make, cages[0].guidance) == (make, guidance)
    assert changed == written
    assert scene_hash(changed) == scene_hash(written) != scene_hash(first)
    assert assemble(once_more).cage == assemble(first).cage
    assert assemble(first).cage.guidance == "outer"


def test_what_a_scene_states_of_its_cage_stays_and_is_questioned():
    first = parse_scene(
        NAMED + "[cage]\nmass = '453 g'\nguidance = 'outer'\ndrag = ['churning']\n", "mine.toml"
    )
    assert not implausible(first)
    other = evolve(first, {"bearing.name": "NU 2312 ECP"})
    cage = assemble(other).cage
    assert (cage.mass, cage.make, cage.guidance) == (0.453, "polyamide", "outer")
    told = implausible(other)
    assert len(told) == 2
    assert "cage.guidance: 'outer', but P of NU 2312 ECP says 'roller'" in told[0]
    mass = weights(1320, 0.4, other.bearing)[0]
    assert (
        f"cage.mass: 453 g is {0.453 / mass:.3g} times that of a cage of polyamide in this bearing"
        in told[1]
    )


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ({"make": "steel"}, "cage.make: 'steel', but MA of NU 2312 MA says 'brass'"),
        (
            {"land_radius": "70 mm"},
            "cage.land_radius: 70 mm, but the shoulder of the outer ring ends between",
        ),
        (
            {"land_radius": "40 mm"},
            "cage.land_radius: 40 mm, but the shoulder of the outer ring ends between",
        ),
        (
            {"pocket_clearance": "3 mm"},
            "cage.pocket_clearance: 3 mm is 0.158 times the roller diameter, 19 mm",
        ),
        (
            {"pocket_clearance": "3 um"},
            "cage.pocket_clearance: 3 um is 0.000158 times the roller diameter",
        ),
        ({"inertia": "0.01 kg m2"}, "cage.inertia: 0.01 kg m2 is"),
    ],
)
def test_a_cage_that_cannot_be_the_bearings_is_questioned(table, sentence):
    (told,) = implausible(evolve(parse_scene(NAMED, "mine.toml"), {"cage": table}, si=True))
    assert told.startswith(f"changes: {sentence}")


def test_the_plan_says_what_of_the_cage_is_estimated():
    scene = parse_scene(
        NAMED + '[study.steady-slip]\npockets = "set"\n[accuracy]\ntolerance = 0.05\nslices = 3\n'
        '[models]\napproach = "dry"\ntraction = "muraki"\n',
        "mine.toml",
    )
    (part,) = (part for part in plan(scene).parts if part.part == "cage")
    assert part.choice == "brass, 457 g, guided by the outer ring"
    assert part.reason.startswith(
        "MA of NU 2312 MA says so; estimated (D): mass, inertia, pocket_clearance"
    )
    (note,) = (text for text in plan(scene).cost_sentences if text.startswith("the cage"))
    assert "MA of NU 2312 MA says so" in note
    bare = plan(evolve(scene, {"bearing.name": "NU 2312"})).cost_sentences
    assert any(
        "the make is assumed, as most makers have it in NU 2312; state cage.make where" in text
        for text in bare
    )
    stated = evolve(scene, {"cage.mass": "450 g"})
    assert not any(text.startswith("the cage") for text in plan(stated).cost_sentences)


def test_what_is_estimated_of_a_land_can_be_sampled():
    scene = parse_scene(NAMED, "mine.toml")
    cage = assemble(scene).cage
    assert quantities(assemble(scene), {})["cage.land_clearance"].value == cage.land_clearance
    assert (
        assemble(evolve(scene, {"cage.land_clearance": cage.land_clearance}, si=True)).cage == cage
    )
    for factor in (0.5, 2.0):
        other = evolve(scene, {"cage.land_clearance": factor * cage.land_clearance}, si=True)
        assert assemble(other).cage.land_clearance == pytest.approx(factor * cage.land_clearance)


def test_all_faults_are_found_at_once():
    found = faults(
        mass="0.4 K",
        inertia=-1,
        pocket_contact="rubber",
        guidance="outer",
        land_width="-1 mm",
        lande=3,
        drag=[{"model": "churning", "rollers": "3 m"}, 7, {"model": "hysteresis", "los": 1}],
    )
    expected = [
        "cage.mass: '0.4 K' is a temperature, here a mass is expected",
        "cage.inertia: must be above 0",
        "cage.pocket_contact: must be one of 'metal', 'film', not 'rubber'",
        "cage.land_width: must be above 0",
        "cage.lande: unknown key; known are drag, guidance",
        "cage.drag[0].rollers: '3 m' is a length, here a plain number is expected",
        "cage.drag[1]: a drag model is expected: its name, or a table with model = 'NAME'",
        "cage.drag[2].los: unknown key, did you mean 'loss'?",
    ]
    for sentence in expected:
        assert any(problem.startswith(sentence) for problem in found), (sentence, found)
    assert len(found) == len(expected)


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        (
            {"guidance": "outside"},
            "cage.guidance: must be one of 'roller', 'inner', 'outer', not 'outside'",
        ),
        ({"guidance": ["outer"]}, "cage.guidance: a text is expected, not a list"),
        ({"guidance": "outer", "land_radius": "94"}, "cage.land_radius: '94' has no unit"),
        (
            {"land_width": "8 mm"},
            "cage.land_width: only read for guidance = 'inner' or 'outer', not for 'roller'",
        ),
        ({"drag": "churning"}, "cage.drag: a list is expected, not 'churning'; put it in [ ]"),
        ({"drags": []}, "cage.drags: unknown key, did you mean 'drag'?"),
        ({"pocket_clearance": "-0.1 mm"}, "cage.pocket_clearance: must be at least 0, not -0.1 mm"),
        (
            {"drag": ["pocket-friction", {"model": "pocket-friction", "coefficient": 0.2}]},
            "cage.drag: a pocket has one friction, here are pocket-friction, pocket-friction",
        ),
        ({"drag": ["hysteresis"] * 9}, "cage.drag: at most 8 of a sort can be added, here are 9"),
    ],
)
def test_a_fault_is_one_sentence(table, sentence):
    (found,) = faults(**WEIGHT, **table)
    assert found.startswith(sentence)


def test_as_many_drags_of_a_sort_as_are_allowed_are_added():
    drags = bearing(*["hysteresis"] * 8, *["constant-torque"] * 8).cage.drags
    assert len(drags.resistance.terms) == len(drags.torques) == 8


def test_a_torque_of_python_gets_the_speeds_of_cage_inner_and_outer_ring():
    @attrs.frozen(kw_only=True)
    class Between(DragModel):
        name = "between"

        def torque(self, cage_speed, inner_speed, outer_speed):
            return 1e-3 * (100.0 * cage_speed + 10.0 * inner_speed + outer_speed)

    capsule = torque_capsule(Between())
    assert compiled.torque(capsule, 3.0, 2.0, 1.0) == pytest.approx(0.321, rel=1e-12)
    assert Drags(torques=(Between(),)).torque(3.0, 2.0, 1.0) == pytest.approx(0.321, rel=1e-12)


def test_a_fault_names_file_and_line():
    text = BARE + '\n[cage]\nmass = "0.4 kg"\ninertia = "0.0033 kg m2"\ndrag = ["petroff-land"]\n'
    line = text.splitlines().index('drag = ["petroff-land"]') + 1
    with pytest.raises(SceneError) as caught:
        _ = assemble(parse_scene(text, "mine.toml")).cage
    assert caught.value.problems[0] == (
        f"mine.toml:{line}: cage.drag[0].ring: drag 'petroff-land' needs it, and the scene gives no ring whose land "
        "guides the cage; give one here or in cage.guidance"
    )
    with pytest.raises(
        PluginError,
        match=rf"mine.toml:{line}: cage.drag\[0\]: no drag is called 'petrof'; did you mean",
    ):
        _ = assemble(parse_scene(text.replace("petroff-land", "petrof"), "mine.toml")).cage


def test_only_who_asks_for_the_cage_reads_it():
    wrong = assemble(evolve(SCENE, {"cage": {"colour": "green"}}))
    assert wrong.inner.chain is not None
    with pytest.raises(SceneError, match=r"cage\.colour: unknown key"):
        _ = wrong.cage
    right = bearing()
    assert right.cage is right.cage


def test_a_resolved_cage_reads_as_the_same():
    cage = bearing("pocket-friction", guidance="inner").cage
    table = resolved(cage)
    assert "drags" not in table
    assert assemble(evolve(SCENE, {"cage": table}, si=True)).cage == cage


# What drags take from the scene --------------------------------------------------------------------------------------


def test_a_drag_takes_from_the_scene_what_it_is_not_given():
    a = bearing(
        "petroff-land",
        {"model": "churning", "density": "930 kg/m3", "rollers": 14},
        guidance="outer",
    )
    land, rollers = a.cage.drags.torques
    assert land == PetroffLand(
        ring="outer",
        viscosity=a.lubricant.at(323.15).viscosity,
        radius=a.cage.land_radius,
        width=a.cage.land_width,
        clearance=a.cage.land_clearance,
    )
    # a bath of 7.5 mm in rings of 150 and 210 mm: 0.4 7.5/60, and what thick oil adds to that
    nu = a.lubricant.at(323.15).viscosity / a.lubricant.density(323.15)
    thick = 1 + (2.6e5 * 1e6 * nu / (6371 * 180**2)) ** 1.38
    assert rollers.oil_fraction == pytest.approx(0.05 * thick, rel=1e-12)
    assert attrs.evolve(rollers, oil_fraction=0.1) == Churning(
        density=930.0,
        oil_fraction=0.1,
        rollers=14.0,
        roller_diameter=0.015,
        roller_length=0.015,
        orbit_radius=0.09,
    )
    own = bearing(
        {"model": "petroff-land", "viscosity": "2 mPa s", "ring": "inner"}, guidance="outer"
    ).cage.drags.torques[0]
    assert (own.viscosity, own.ring) == (2e-3, "inner")


@pytest.mark.parametrize(
    ("table", "guidance", "named"),
    [
        ({}, "roller", ["churning", "rolling-resistance", "hysteresis"]),
        ({}, "outer", ["churning", "petroff-land", "rolling-resistance", "hysteresis"]),
        ({"supply": "grease"}, "inner", ["churning", "rolling-resistance", "hysteresis"]),
        (
            {"supply": "mist"},
            "inner",
            ["churning", "petroff-land", "rolling-resistance", "hysteresis"],
        ),
    ],
)
def test_a_cage_whose_drags_are_not_stated_has_those_of_its_supply(table, guidance, named):
    cage = assemble(
        evolve(SCENE, {"cage": WEIGHT | {"guidance": guidance}, "lubrication": table}, si=True)
    ).cage
    assert [drag.name for drag in cage.drags] == named
    whole = assemble(evolve(SCENE, {"cage": WEIGHT | {"guidance": guidance}}, si=True)).cage.drags
    fraction = {"grease": 0.0, "mist": 0.01 / whole.torques[0].oil_fraction}.get(
        table.get("supply"), 1.0
    )
    assert cage.drags.torques[0].torque(300.0, 667.0, 0.0) == pytest.approx(
        fraction * whole.torques[0].torque(300.0, 667.0, 0.0), rel=1e-12
    )
    if len(cage.drags.torques) > 1 and table:
        assert cage.drags.torques[1].width == pytest.approx(whole.torques[1].width / 4, rel=1e-12)


def test_drags_that_are_stated_stay_what_they_are():
    assert not bearing().cage.drags
    stated = bearing(
        {"model": "churning", "oil_fraction": 0.3},
        scene=evolve(SCENE, {"lubrication": "grease"}),
    )  # fmt: skip
    assert stated.cage.drags.torques[0].oil_fraction == 0.3


def test_the_oil_of_a_drag_has_the_temperature_of_the_scene():
    cold, warm = (
        bearing(
            "petroff-land",
            guidance="inner",
            scene=evolve(SCENE, {"operation.temperature": T}, si=True),
        ).cage.drags.torques[0]
        for T in ("40 degC", "100 degC")
    )
    # MIL-L-7808: 11.6 and 2.87 mPa s
    assert cold.viscosity == pytest.approx(11.60e-3, rel=1e-3)
    assert warm.viscosity == pytest.approx(2.87e-3, rel=2e-3)


def test_density_is_that_of_the_oil():
    oil = {
        "viscosity_law": "vogel",
        "points": [
            {"temperature": "40 degC", "viscosity": "12 mPa s"},
            {"temperature": "70 degC", "viscosity": "5.2 mPa s"},
            {"temperature": "100 degC", "viscosity": "2.9 mPa s"},
        ],
        "pressure_viscosity": "11 1/GPa",
        "conductivity": "0.14 W/(m K)",
        "eyring_stress": "4 MPa",
        "shear_modulus": "0.3 GPa",
    }
    own = evolve(SCENE, {"lubricant": oil | {"density": "950 kg/m3"}}, si=True)
    assert bearing("churning", scene=own).cage.drags.torques[0].density == 950.0
    falling = {"temperature": ["40 degC", "60 degC"], "value": ["900 kg/m3", "880 kg/m3"]}
    over = evolve(
        SCENE, {"lubricant.density": falling, "operation.temperature": "40 degC"}, si=True
    )
    assert bearing("churning", scene=over).cage.drags.torques[0].density == pytest.approx(
        900.0, rel=1e-15
    )
    named = evolve(
        SCENE, {"operation.temperature": "15 degC"}
    )  # read from the chart, see the oil's source
    assert bearing("churning", scene=named).cage.drags.torques[0].density == pytest.approx(
        920.6, rel=1e-12
    )
    of_none = evolve(SCENE, {"lubricant": oil}, si=True)  # as everywhere where an oil has none
    assert bearing("churning", scene=of_none).cage.drags.torques[0].density == DENSITY


def test_a_resistance_reads_what_the_oil_must_give():
    def without(scene):
        assembly = assemble(evolve(scene, {"cage": WEIGHT | {"drag": ["rolling-resistance"]}}))
        conditions = attrs.evolve(assembly.inner.conditions, pressure_viscosity=float("nan"))
        return attrs.evolve(assembly, inner=attrs.evolve(assembly.inner, conditions=conditions))

    with pytest.raises(
        SceneError, match=r"gives no pressure_viscosity .* which model 'rolling-resistance' needs"
    ):
        _ = without(SCENE).cage


# Bound ---------------------------------------------------------------------------------------------------------------


def test_the_drags_are_sorted():
    drags = bearing(
        {"model": "constant-torque", "size": "0.2 N m"},
        "rolling-resistance",
        "pocket-friction",
        "hysteresis",
    ).cage.drags
    assert drags == Drags(
        torques=(ConstantTorque(size=0.2),),
        resistance=TotalResistance(terms=(RollingResistance(oil_layer=5e-6), Hysteresis())),
        pocket_friction=CoulombPocket(),
    )
    assert [drag.name for drag in drags] == [
        "constant-torque",
        "rolling-resistance",
        "hysteresis",
        "pocket-friction",
    ]
    assert bearing("hysteresis").cage.drags.resistance == Hysteresis()
    assert list(bearing("hysteresis").cage.drags) == [Hysteresis()]
    assert bearing("constant-torque").cage.drags.torque(300.0, 667.0, 0.0) == pytest.approx(
        -0.1, rel=1e-5
    )


def test_resistance_runs_behind_the_friction():
    plain = bearing()
    with_both = bearing({"model": "goksem-hargreaves", "inlet_heating": "none"}, "hysteresis")
    assert plain.with_resistance() is plain
    resisting = with_both.with_resistance()
    loads = np.linspace(5e3, 5e4, 9)
    for before, after in zip(plain.raceways, resisting.raceways, strict=True):
        one = before.evaluate(loads, 29.8, 0.5)
        other = after.evaluate(loads, 29.8, 0.5)
        np.testing.assert_array_equal(other.friction, one.friction)
        assert np.all(np.isnan(one.resistance))
        c = after.conditions
        a = 2.0796226511 * np.sqrt(c.viscosity * 29.8 * loads)
        GU = c.pressure_viscosity * c.viscosity * 29.8 / c.radius
        b = (
            4.318
            * c.radius
            / c.pressure_viscosity
            * GU**0.658
            * (loads / (c.modulus * c.radius)) ** 0.0126
        )
        steel = 0.01 * loads * other.half_width / (3 * np.pi * c.radius)
        np.testing.assert_allclose(other.resistance, (a**-5 + b**-5) ** -0.2 + steel, rtol=1e-12)
    # the bearing itself stays as it is
    assert len(with_both.inner.chain.models) == len(resisting.inner.chain.models) - 1


def test_a_drag_of_this_process_is_taken(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})

    @attrs.frozen
    class Linear(DragModel):
        """A torque in proportion to the speed."""

        name = "linear"
        equation = "T = -w_c"
        references = ("Nobody.",)

        def torque(self, cage_speed, inner_speed, outer_speed):
            return -cage_speed

    register(Linear)
    assert bearing("linear").cage.drags.torque(3.0, 0.0, 0.0) == -3.0


@pytest.mark.slow
def test_sweeps_over_names_of_bearings_take_the_cage_of_each():
    scene = parse_scene(
        NAMED
        + '[study.steady-slip]\npockets = "set"\npoints = 9\n[accuracy]\ntolerance = 1e-2\nslices = 3\n'
        '[models]\napproach = "dry"\ntraction = "muraki"\n',
        "mine.toml",
    )
    names = ["NU 2312 ECP", "NU 2312 MA"]
    swept = sweep(
        scene,
        {"bearing.name": names},
        study="steady-slip",
        output=["friction_torque"],
        engine="serial",
    )
    alone = [
        run(evolve(scene, {"bearing.name": name}), "steady-slip").friction_torque[0]
        for name in names
    ]
    # a run plans for its own bearing, and a sweep for that of the scene: each keeps the tolerance
    assert swept.friction_torque.values.ravel() == pytest.approx(
        [float(one) for one in alone], rel=1e-2
    )
    assert alone[1] > 1.1 * alone[0]  # the cages tell them apart
