"""Fits of ISO 286 with bearings of class Normal: against printed limits, the standard's formula, and rules of it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip.scene.clearance import interference, tolerance_classes
from tabled import REFERENCES, rows_of

PRINTED = [
    (row["class"], int(row["to_mm"]), float(row["lower_um"]), float(row["upper_um"]))
    for row in rows_of(REFERENCES / "iso_286.csv")
]
#: Upper bounds of the steps of nominal diameter in ISO 286 up to 1 m [mm].
STEPS = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000)
CLASSES = tolerance_classes()
FITS = [*CLASSES][2:]
ENDS = [*map(int, CLASSES["m5"])]


def deviations(name, diameter):
    """Lower and upper deviation [um] at a diameter [mm]; None where there is none."""
    end = next(end for end in ENDS if diameter <= end)
    return tuple(map(float, CLASSES[name][str(end)].split())) or None


def width(name, diameter):
    low, high = deviations(name, diameter)
    return high - low


@pytest.mark.parametrize("name", sorted({name for name, *_ in PRINTED} - {"bore", "outside"}))
def test_limits_are_those_that_are_printed(name):
    printed = [row[1:] for row in PRINTED if row[0] == name]
    assert [(to, *deviations(name, to)) for to, *_ in printed] == printed


@pytest.mark.parametrize("what", ["bore", "outside"])
def test_tolerances_of_bearings_are_those_that_are_printed(what):
    printed = {to: (low, high) for name, to, low, high in PRINTED if name == what}
    assert {to: (float(CLASSES[what][str(to)]), 0) for to in printed} == printed


@pytest.mark.parametrize("grade", [5, 6, 7, 8])
def test_grades_follow_the_formula_of_the_standard_within_its_rounding(grade):
    times = {5: 7, 6: 10, 7: 16, 8: 25}[grade]
    tolerances = [width("H8" if grade == 8 else f"h{grade}", step) for step in STEPS]
    for low, high, tolerance in zip(STEPS, STEPS[1:], tolerances[1:], strict=False):
        if grade == 5 and high > 500:  # grades 1 to 5 of large diameters are not by the formula
            continue
        D = (low * high) ** 0.5
        unit = 0.45 * D ** (1 / 3) + 0.001 * D if high <= 500 else 0.004 * D + 2.1
        assert tolerance == pytest.approx(
            times * unit, rel=0.04, abs=0.9
        )  # rounded, above 60 um to fives


@pytest.mark.parametrize("name", [name for name in FITS if name[0] in "FGHKMNPR"])
def test_holes_follow_from_shafts_by_the_rule_of_the_standard(name):
    shaft = name.lower()
    grade = int(name[-1])
    wider = {7: "h6", 8: "h7", 6: "h5"}[grade]
    for end in ENDS:
        low, high = deviations(shaft if shaft in FITS else f"{shaft[0]}7", end)
        if name[0] in "FGH":
            assert deviations(name, end) == (-high, width(name, end) - high)
        elif (name, end) not in {("M6", 280), ("M6", 315)}:  # an exception of the standard
            more = width(name, end) - width(wider, end) if 3 < end <= 500 else 0.0
            assert deviations(name, end) == (more - low - width(name, end), more - low)


@pytest.mark.parametrize(
    ("name", "diameter", "limits"),
    [
        # recalled limits beyond what was read: 315 to 1000 mm, and what differs from its neighbours
        ("M6", 300, (-41, -9)),  # the exception of the standard
        ("K7", 450, (-45, 18)),
        ("P7", 480, (-108, -45)),
        ("H7", 1000, (0, 90)),
        ("n6", 900, (56, 112)),
        ("m6", 600, (26, 70)),
        ("M7", 700, (-110, -30)),  # no Delta above 500 mm
        ("K7", 2, (-10, 0)),  # nor up to 3 mm
        ("j6", 600, None),
    ],
)
def test_limits_at_the_ends_of_the_tables(name, diameter, limits):
    assert deviations(name, diameter) == limits


@given(st.sampled_from(FITS), st.floats(1.0, 1000.0))
def test_every_fit_is_as_wide_as_its_grade_and_tighter_letters_press_more(name, diameter):
    if deviations(name, diameter) is None:
        assert name.rstrip("5678") in ("j", "J")
        return
    mean, deviation = interference(name, 1e-3 * diameter)
    assert deviation > 0.0
    assert width(name, diameter) == width(f"{'h' if name[-1] < '8' else 'H'}{name[-1]}", diameter)
    letters = "ghkmnpr" if name.islower() else "GHKMNPR"
    if (letter := name[:-1]) in letters[:-1] and name[-1] in "67":
        tighter = interference(letters[letters.index(letter) + 1] + name[-1], 1e-3 * diameter)[0]
        # k and K fall back to the zero line of h and H at the ends of the tables
        assert tighter > mean or letter in "hH"
        assert tighter >= mean


def test_a_shaft_of_80_mm_by_hand():
    # m5 is +11 to +24, the bore of class Normal 0 to -15: 17.5 + 7.5, and the widths 13 and 15, even
    mean, deviation = interference("m5", 0.08)
    assert mean == pytest.approx(25e-6)
    assert deviation == pytest.approx(1e-6 * ((13**2 + 15**2) / 12) ** 0.5)
    # H7 of 140 mm is 0 to +40, the outside diameter 0 to -18: loose by 29
    assert interference("H7", 0.14)[0] == pytest.approx(-29e-6)
    with pytest.raises(ValueError, match="j6 is known up to 500 mm, not for 600 mm"):
        interference("j6", 0.6)
