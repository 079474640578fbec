"""The catalogue of cylindrical roller bearings: names, boundary dimensions, and what is estimated of the inside."""

import statistics
import sys
from pathlib import Path

import pytest

from rollslip import plan
from rollslip.catalogue.discovery import find, get_class
from rollslip.cli.models import kinds_of
from rollslip.datasets import BearingData, Family
from rollslip.errors import UnknownNameError
from rollslip.planning.plausibility import implausible
from rollslip.scene.reading import parse_scene
from rollslip_plugins.data.cylindrical import CATALOGUE, RULES, clearance
from rollslip_studies.variation.scatter import with_scatter
from tabled import REFERENCES, rows_of

TABLE = Path(__file__).parents[2] / "docs" / "tables" / "bearing_catalogue.csv"
sys.path.insert(0, str(REFERENCES))
from catalogue_ratings import ratios  # noqa: E402


def lines(name):
    """The lines of a text file beside this one, each in its parts."""
    text = Path(__file__).with_name(name).read_text(encoding="utf-8")
    rows = [line.split("|") for line in text.splitlines() if not line.startswith("#")]
    return [
        [*(part.strip() for part in parts), one.strip()]
        for *parts, every in rows
        for one in every.split(";")
    ]


def scene(bearing, load="2 kN"):
    return parse_scene(
        f"[bearing]\n{bearing}\n[lubricant]\nname = 'ISO VG 68'\n[operation]\n"
        f"inner_speed = '3000 rpm'\nradial_load = '{load}'\ntemperature = '70 degC'\n",
        "scene.toml",
    )


def test_every_name_is_a_bearing_in_all_groups_of_clearance():
    assert len(CATALOGUE.names) == len(set(CATALOGUE.names)) > 400
    for name in CATALOGUE.names:
        assert CATALOGUE.canonical_name(name) == name
        made = CATALOGUE[name]
        assert made.name == name
        tighter, looser = (
            CATALOGUE[f"{name}-{group}"].bearing.radial_clearance for group in ("C2", "C3")
        )
        assert (
            tighter
            < made.bearing.radial_clearance
            < looser
            < CATALOGUE[f"{name}-C4"].bearing.radial_clearance
        )
        filled = made.bearing.rollers * made.bearing.roller_diameter
        assert (
            0.5
            < filled
            / (
                1.5707963
                * (made.bearing.inner_raceway_diameter + made.bearing.outer_raceway_diameter)
            )
            < 0.9
        )


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("NU2210", "NU2210E"),
        ("NU 2210 E", "NU2210E"),
        ("nu2210ecp", "NU2210E"),
        ("NU 2210 ECP/C3", "NU2210E-C3"),
        ("NJ206-E-XL-TVP2", "NJ206E"),
        ("n 312 ecm c4", "N312E-C4"),
        ("NU210-old", "NU210-old"),
        ("NU 1010 ML", "NU1010"),
        ("NU410/CN", "NU410"),
    ],
)
def test_designations_are_read_as_makers_write_them(written, meant):
    assert find("bearing", written).name == meant
    assert get_class("bearing", written) == CATALOGUE[meant]


@pytest.mark.parametrize("written", ["NU2199", "NU2210ZZ", "N1010-old", "6210", "NU", ""])
def test_what_is_no_designation_is_refused(written):
    assert CATALOGUE.canonical_name(written) is None
    with pytest.raises(UnknownNameError, match="no bearing is called"):
        find("bearing", written)


def test_designations_as_people_write_them_are_read_with_cage_and_class_of_clearance():
    every = lines("designations.txt")
    assert len(every) > 400
    for name, cage, written in every:
        assert find("bearing", written).name == name, written
        own = CATALOGUE.cage(written)
        assert (f"{own.make} {own.guidance}" if own.letters else "-") == cage, written
        requested = CATALOGUE.clearance_class(name)
        said = CATALOGUE.clearance_class(written)
        assert said == requested or (said == "CN" and requested is None), written


@pytest.mark.parametrize(
    ("written", "part"),
    [
        ("NU2210ECP/\u04213", "what 'ECP\u04213' behind that means is not known here"),  # Cyrillic
        ("NU2210 \u041c\u0410", "what '\u041c\u0410' behind"),
        ("NU2210ECP/C3NA", "what 'ECPC3NA' behind"),
        ("NU2210ECP/R40", "what 'ECPR40' behind"),
        (
            "NU2210ECP/HC5",
            "NU2210 with ceramic rollers (HC5), or with PEEK and C5, which is written PH/C5",
        ),
        ("NU2210ECPHC5", "with ceramic rollers (HC5), or with PEEK"),
    ],
)
def test_what_would_be_read_wrongly_is_refused(written, part):
    with pytest.raises(UnknownNameError) as error:
        find("bearing", written)
    assert part in str(error.value)


def test_a_group_before_a_cage_and_a_half_of_a_group_are_told_apart():
    cage, half = "NU 2210 E C4 M", "NU2210EC4M"
    assert (CATALOGUE.clearance_class(cage), CATALOGUE.cage(cage).make) == ("C4", "brass")
    assert (CATALOGUE.clearance_class(half), CATALOGUE.cage(half).letters) == ("C4M", "")


def test_letters_without_effect_are_listed():
    for written, ignored in (
        ("NU2210ECP/P63S1", "P6 S1"),
        ("NU2210ECPH/C5", "PH"),
        ("NU2210ECP", ""),
    ):
        told = [
            text
            for text in implausible(scene(f"name = '{written}'"))
            if "has no effect here" in text
        ]
        assert told == [
            f"scene.toml:2: bearing.name: {ignored} of {written!r} has no effect here"
        ] * bool(ignored)


def test_other_bearings_are_called_what_they_are():
    every = lines("other_bearings.txt")
    assert len(every) > 140
    for what, written in every:
        with pytest.raises(UnknownNameError) as error:
            find("bearing", written)
        assert f" {what}" in str(error.value), written
        assert "did you mean" not in str(error.value)
        assert "rollslip is for cylindrical and tapered rollers in one row" in str(error.value)


def test_a_full_complement_bearing_without_the_letter_of_one_is_asked_for():
    with pytest.raises(UnknownNameError, match=r"full complement .*; did you mean 'NCF3010V'\?"):
        find("bearing", "NCF 3010")


def test_the_list_of_models_tells_of_other_bearings_too():
    with pytest.raises(
        UnknownNameError, match="nothing is called '6205': this is a deep groove ball bearing"
    ):
        kinds_of("6205")
    assert kinds_of("SKF NU 205 ECP") == ["bearing"]


def test_a_cage_that_no_letter_tells_is_the_one_that_makers_put_in():
    # by the letters of NKE's designations: TVP3 up to 130 mm of bore, M6 above, MPA in series 10, M in series 4
    for written, make, guidance in (
        ("NU2210", "polyamide", "roller"),
        ("NU226", "polyamide", "roller"),
        ("NU228", "brass", "roller"),
        ("NU1010E", "brass", "outer"),
        ("N1010", "brass", "inner"),
        ("NU410", "brass", "roller"),
    ):
        assert CATALOGUE.cage(written) == (make, guidance, "")
    assert CATALOGUE.cage("6205") is None


def test_classes_of_clearance_are_those_of_the_standard():
    # ISO 5753-1, bore over 24 to 30 mm, as makers print it: C2 0-25, CN 20-45, C3 35-60, C4 50-75
    middle = {
        "C2": 12.5,
        "CN": 32.5,
        "C3": 47.5,
        "C4": 62.5,
        "CNL": 26.25,
        "CNH": 38.75,
        "CNM": 32.5,
    }
    for group, value in middle.items():
        assert CATALOGUE[f"NU205E-{group}"].bearing.radial_clearance == pytest.approx(1e-6 * value)
    for group, width in {"CN": 25.0, "CNL": 12.5, "CNM": 12.5, "CNH": 12.5}.items():
        mounting = CATALOGUE[f"NU205E-{group}"].bearing.mounting
        assert mounting.initial_tolerance == pytest.approx(1e-6 * width)
    # over 250 to 280 mm: CN 125-195
    assert CATALOGUE["NU252E"].bearing.radial_clearance == pytest.approx(160e-6)
    assert CATALOGUE["NU252E"].grades["radial_clearance"] == "C"


def test_clearances_are_those_of_a_second_list():
    printed = (
        Path(__file__).with_name("clearances.txt").read_text(encoding="utf-8").splitlines()[2:]
    )
    assert len(printed) == 20
    for bore, *ends in (map(int, line.split()) for line in printed):
        found = [clearance(bore, group) for group in ("C2", "CN", "C3", "C4", "C5")]
        assert [end for pair in found for end in pair] == ends, bore


def test_printed_static_ratings_are_met_series_by_series():
    def bearing_of(name):
        called = CATALOGUE.canonical_name(name)
        return None if called is None else CATALOGUE[called].bearing

    found = ratios(REFERENCES / "catalogue_ratings.csv", bearing_of)
    assert found.keys() == {"2E", "22E", "3E", "23E", "10E", "4", "10"}
    for series, of in found.items():
        assert statistics.mean(of.values()) == pytest.approx(1, abs=0.04), series
        assert statistics.pstdev(of.values()) < 0.09, series


@pytest.mark.parametrize(
    ("written", "bore", "outside", "width"),
    [
        ("NU202", 15, 35, 11),
        ("NU2203", 17, 40, 16),
        ("NU303", 17, 47, 14),
        ("NU264", 320, 580, 92),
        ("NU356", 280, 580, 108),
        ("NU2328", 140, 300, 102),
        ("NU2352", 260, 540, 165),
        ("NU1044", 220, 340, 56),
        ("NU1096", 480, 700, 100),
    ],
)
def test_boundary_dimensions_are_those_that_makers_print(written, bore, outside, width):
    assert f", {bore} x {outside} x {width} mm;" in get_class("bearing", written).description


def test_the_family_itself_is_no_bearing():
    with pytest.raises(UnknownNameError, match="no bearing is called 'cylindrical-roller'"):
        find("bearing", CATALOGUE.name)
    assert isinstance(CATALOGUE, Family)


@pytest.mark.parametrize(
    ("name", "rollers", "diameter", "pitch"),
    [
        ("N204", 11, 7.5, 34.0),  # data set UOS, printed
        ("NU2205", 13, 7.5, 39.0),  # data set Lenze-MB, printed
        ("NU206", 13, 9.0, 46.5),  # data set of Saarland University, from its orders of faults
        ("NU406", 9, 14.0, 59.0),  # Huddersfield, recalled
        ("NU209-old", 14, 10.0, 65.0),  # the bearing 209 of Harris's book
        ("NU228", None, 28.0, 197.0),  # raceways of 169 and 225 mm in makers' catalogues
        (
            "NU2220",
            17,
            22.0,
            141.0,
        ),  # raceways of 119 and 163 mm in NSK's catalogue, number from its C0
    ],
)
def test_insides_that_others_print_are_met_within_one_roller(name, rollers, diameter, pitch):
    bearing = get_class("bearing", name).bearing
    assert rollers is None or abs(bearing.rollers - rollers) <= 1
    assert bearing.roller_diameter == pytest.approx(1e-3 * diameter, rel=0.06)
    middle = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 2
    assert middle == pytest.approx(
        1e-3 * pitch, rel=0.02
    )  # of series 4 the worst errs by 3 %, of others by 1.4 %


def test_the_scatter_of_each_rule_is_that_of_the_table_of_errors():
    rows = {row["series"]: row for row in rows_of(TABLE)}
    assert rows.keys() == RULES.keys()
    for series, rule in RULES.items():
        deviation = float(rows[series]["scatter, %"])
        assert 100 * rule.scatter == pytest.approx(deviation, abs=0.7)
        assert int(rows[series]["names"]) == sum(
            CATALOGUE.series(name) == series for name in CATALOGUE.names
        )


def test_a_scene_with_a_name_of_the_catalogue_is_planned_and_cites_the_standards():
    read = scene("name = 'NU 2210 ECP/C3'\nrollers = 16")
    assert read.bearing.rollers == 16
    # 65 um of C3, less k5 (2 to 13 um on a bore of 0 to -12 um) at a raceway of 59.5 mm, less 5 K; speed takes 0.03 um
    left = 65e-6 - 0.8 * 13.5e-6 * 50.0 / 59.5 - 12e-6 * 5.0 * read.bearing.outer_raceway_diameter
    assert read.bearing.inner_raceway_diameter == pytest.approx(59.5e-3)
    assert read.bearing.radial_clearance == pytest.approx(left, abs=5e-8)
    assert read.surface.roller_roughness == 1e-7
    made = plan(read)
    assert made.scene is read


def test_its_scatter_is_taken_where_the_scene_says_nothing_of_it():
    made, said = with_scatter(scene("name = 'NU2210'"))
    # class 30 to 60 um, k5 11 um and bore 12 um wide, each even
    left = ((30.0**2 + (0.8 * 50.0 / 59.5) ** 2 * (11.0**2 + 12.0**2)) / 12.0) ** 0.5
    table = made.uncertainty["bearing.mounting.clearance_deviation"]
    assert table == {"distribution": "normal", "mean": "0 um", "deviation": f"{left:.3g} um"}
    assert made.uncertainty["bearing.roller_length"]["scatter"] == RULES["22E"].scatter
    assert any(text.startswith("bearing.roller_length (D): ") for text in said)
    known, _ = with_scatter(scene("name = 'NU2210'\nmounting.initial_clearance = '40 um'"))
    seats = (0.8 * 50.0 / 59.5) * ((11.0**2 + 12.0**2) / 12.0) ** 0.5
    assert (
        known.uncertainty["bearing.mounting.clearance_deviation"]["deviation"] == f"{seats:.3g} um"
    )
    own, _ = with_scatter(scene("name = 'NU2210'\nradial_clearance = '20 um'"))
    assert [key for key in own.uncertainty if key.startswith("bearing.")] == [
        "bearing.roller_length",
        "bearing.profile.depth_factor",
    ]
    for profile in ("'iso16281'", "{ depth_factor = 0.7 }"):
        stated, _ = with_scatter(scene(f"name = 'NU2210'\nprofile = {profile}"))
        assert "bearing.profile.depth_factor" not in stated.uncertainty


def test_less_than_the_least_load_of_skf_is_told():
    # k_r 0.2, 6 kN at rest, pitch circle of 70.5 mm
    least = 0.2 * 6.0 * 0.705**2
    (told,) = implausible(scene("name = 'NU2210'", "300 N"))
    assert told.startswith("scene.toml:7: operation.radial_load: 300 N is ")
    assert f"{100 * 0.3 / least:.3g} % of SKF's catalogue minimum load" in told
    assert not implausible(scene("name = 'NU2210'", "600 N"))
    # general catalogue: 0.1 of series 10, 0.15 of 2, 3 and 4, 0.2 of 22, 0.25 of 23
    factors = {"10": 0.1, "2": 0.15, "3": 0.15, "4": 0.15, "22": 0.2, "23": 0.25}
    assert {series: rule.minimum_load for series, rule in RULES.items()} == {
        series: factors[series.removesuffix("E")] for series in RULES
    }


def test_all_that_is_estimated_says_so():
    for made in map(CATALOGUE.__getitem__, CATALOGUE.names[::40]):
        assert isinstance(made, BearingData)
        assert "estimated (D)" in made.description
        assert made.grades["rollers"] == made.grades["roller_length"] == "D"
