"""Tapered rollers: geometry of cones with a common apex, and the equilibrium under combined load."""

import csv
import math
from itertools import groupby
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rollslip.bearing.chain import Chain
from rollslip.bearing.equilibrium import LoadCase, angular_positions, solve_equilibrium
from rollslip.bearing.kinematics import Kinematics
from rollslip.geometry.axial import ContactAngles, raceway_diameters
from rollslip.models.profile import profile_drop, slice_positions
from rollslip_kernels.slices import Conditions
from rollslip_plugins.contact import Palmgren

#: Rollers of the bearing 32216 of Wingertszahn and others (2023).
Z = 16
#: Their diameter at the middle [m].
DIAMETER = 0.017
#: Their effective length [m].
LENGTH = 0.0207
#: Pitch diameter [m].
PITCH = 0.1085
#: Contact angle from e = 0.42 [rad].
ANGLE = math.radians(15.64)
ANGLES = ContactAngles.with_common_apex(ANGLE, DIAMETER / PITCH)

# Geometry -------------------------------------------------------------------------------------------------------------


def test_cones_have_a_common_apex() -> None:
    """R/r is the same at both ends and at the middle of a roller, for both raceways, so that nothing slides."""
    axis = np.array([math.sin(ANGLES.middle), math.cos(ANGLES.middle)])
    across = np.array([math.cos(ANGLES.middle), -math.sin(ANGLES.middle)])
    t = np.array([-0.5, 0.0, 0.5]) * LENGTH
    roller = DIAMETER / 2 + t * math.sin(ANGLES.half)
    for side, diameter in zip((-1.0, 1.0), raceway_diameters(PITCH, DIAMETER, ANGLES), strict=True):
        ring = PITCH / 2 + t * math.cos(ANGLES.half) * axis[0] + side * roller * across[0]
        assert ring[1] == pytest.approx(diameter / 2, rel=1e-14)
        assert ring / roller == pytest.approx(np.full(3, ring[1] / roller[1]), rel=1e-14)


def test_curvatures_are_those_of_cones() -> None:
    """The curvature of a cone across its generator is the cosine of its half angle over its radius."""
    inner, outer = (d / 2 for d in raceway_diameters(PITCH, DIAMETER, ANGLES))
    bearing = Kinematics(inner, outer, DIAMETER / 2, 209.4, 0.0, ANGLES.cosines)
    roller = math.cos(ANGLES.half) / (DIAMETER / 2)
    for radius, other in (
        (bearing.inner_equivalent_radius, math.cos(ANGLES.inner) / inner),
        (bearing.outer_equivalent_radius, -math.cos(ANGLES.outer) / outer),
    ):
        assert 1.0 / radius == pytest.approx(roller + other, rel=1e-14)
    assert bearing.orbit_radius == pytest.approx(PITCH / 2, rel=1e-14)


# Equilibrium ----------------------------------------------------------------------------------------------------------


def case(
    angle: float = ANGLE,
    slices: int = 60,
    turn: float = 0.0,
    rollers: int = Z,
    **changes: object,
) -> LoadCase:
    """A row of the rollers of the 32216 with the profile that is printed for it."""
    factor = 0.0005 / 0.00035
    drop = factor * profile_drop("iso16281", slice_positions(LENGTH, slices), LENGTH, DIAMETER)
    values = {"radial_clearance": 0.0, "radial_load": 0.0, "contact_angle": angle} | changes
    values["half_angle"] = ANGLES.half if angle else 0.0
    values.setdefault("drop", drop)
    psi = angular_positions(rollers, 1) + 2.0 * np.pi / rollers * turn
    return LoadCase(psi, LENGTH, **values)


def contacts() -> tuple[SimpleNamespace, SimpleNamespace]:
    """Contacts of both rings by Palmgren's law."""
    ring = SimpleNamespace(
        conditions=Conditions(length=LENGTH), deflection=Chain(Palmgren().deflection())
    )
    return ring, ring


def reference_cases() -> list[list[dict[str, float]]]:
    path = Path(__file__).parents[2] / "tools" / "references" / "tapered_row.csv"
    with path.open(newline="", encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    loads = ("axial [N]", "radial [N]", "centrifugal [N]", "turn")
    return [list(group) for _, group in groupby(rows, lambda row: [row[name] for name in loads])]


@pytest.mark.parametrize("rows", reference_cases(), ids=lambda rows: str([*rows[0].values()][:4]))
def test_forces_are_near_those_of_a_model_with_ribs(rows: list[dict[str, float]]) -> None:
    """One direction for both contacts and no rib, against all three coordinates of a roller (tools/references)."""
    first = rows[0]
    found = solve_equilibrium(
        case(
            turn=first["turn"],
            radial_load=first["radial [N]"],
            axial_load=first["axial [N]"],
            centrifugal_force=first["centrifugal [N]"],
        ),
        contacts(),
    )
    outer = np.array([row["outer [N]"] for row in rows])
    inner = np.array([row["inner [N]"] for row in rows])
    rib = np.array([row["rib [N]"] for row in rows])
    assert found.outer_force[0] == pytest.approx(outer, abs=1e-3 * outer.max())
    assert found.inner_force[0] == pytest.approx(inner, abs=4e-3 * outer.max())
    assert found.rib_force[0] == pytest.approx(rib, abs=0.003 * rib.max())


def test_forces_balance_the_loads() -> None:
    """Anew from forces and geometry, with centrifugal and body forces."""
    c = case(
        turn=0.3,
        radial_load=6500.0,
        axial_load=6000.0,
        centrifugal_force=40.0,
        body_force=(3.0, 2.0),
    )
    s = solve_equilibrium(c, contacts())
    psi = s.psi[0]
    width = LENGTH / c.drop.size
    outward = 40.0 + 3.0 * np.cos(psi) + 2.0 * np.sin(psi)
    assert np.sum(s.inner_force[0] * np.cos(psi)) * math.cos(ANGLE) == pytest.approx(
        6500.0, rel=1e-12
    )
    assert np.sum(s.inner_force[0] * np.sin(psi)) == pytest.approx(0.0, abs=1e-9)
    assert np.sum(s.outer_force[0]) * math.sin(ANGLE) == pytest.approx(6000.0, rel=1e-12)
    assert s.outer_force[0] == pytest.approx(
        s.inner_force[0] + outward / math.cos(ANGLE), rel=1e-12
    )
    dx, dy = s.displacement[0]
    gap = (dx * np.cos(psi) + dy * np.sin(psi)) * math.cos(ANGLE)
    gap = gap + s.axial_displacement[0] * math.sin(ANGLE)
    stiffness = (1e3 * (1e3 * LENGTH) ** 0.8 / 3.84e-5) ** (10 / 9) / LENGTH
    for approach, load in (
        (gap - s.roller_shift[0], s.inner_load[0]),
        (s.roller_shift[0], s.outer_load[0]),
    ):
        closed = np.maximum(approach[:, None] - c.drop, 0.0)
        assert stiffness * closed ** (10 / 9) == pytest.approx(load, rel=1e-9)
        assert load.sum(axis=1) * width == pytest.approx(
            stiffness * (closed ** (10 / 9)).sum(axis=1) * width
        )


def test_hardly_tapered_rollers_carry_as_cylindrical_ones() -> None:
    """At an angle of 1e-7 the sum of the outer forces of the cylindrical row is what the axial load has to be."""
    angle = 1e-7
    plain = solve_equilibrium(
        case(0.0, radial_load=5000.0, radial_clearance=3e-5, centrifugal_force=20.0), contacts()
    )
    axial = float(plain.outer_force.sum()) * math.sin(angle)
    tapered = solve_equilibrium(
        case(
            angle,
            radial_load=5000.0,
            radial_clearance=3e-5,
            centrifugal_force=20.0,
            axial_load=axial,
        ),
        contacts(),
    )
    scale = plain.inner_force.max()
    assert tapered.inner_force == pytest.approx(plain.inner_force, abs=1e-6 * scale)
    assert tapered.outer_load == pytest.approx(plain.outer_load, abs=1e-6 * plain.outer_load.max())


def sjovall(epsilon: float, exponent: float) -> tuple[float, float, float]:
    """F_r tan(alpha)/F_a, J_r and J_a of a row between rigid rings, by Sjovall's integrals."""
    end = math.pi if epsilon >= 1.0 else math.acos(1.0 - 2.0 * epsilon)
    x, w = np.polynomial.legendre.leggauss(400)
    psi = (x + 1.0) * end / 2.0
    q = (
        np.maximum(1.0 - (1.0 - np.cos(psi)) / (2.0 * epsilon), 0.0) ** exponent
        * w
        * end
        / 2.0
        / math.pi
    )
    radial = float((q * np.cos(psi)).sum())
    axial = float(q.sum())
    return radial / axial, radial, axial


#: Fraction of the loaded zone: F_r tan(alpha)/F_a, J_r, J_a of line contacts with the exponent 1.1, as T. A. Harris,
#: Rolling Bearing Analysis, prints them (recalled).
HARRIS = {
    0.1: (0.9613, 0.1268, 0.1319), 0.3: (0.8805, 0.2055, 0.2334), 0.5: (0.7939, 0.2453, 0.3090),
    0.7: (0.6999, 0.2636, 0.3766), 1.0: (0.5238, 0.2523, 0.4817), 1.25: (0.3598, 0.2078, 0.5775),
    2.5: (0.1372, 0.1075, 0.7837),
}  # fmt: skip


@pytest.mark.parametrize("epsilon", HARRIS)
def test_row_follows_the_integrals_of_sjovall(epsilon: float) -> None:
    assert sjovall(epsilon, 1.1) == pytest.approx(HARRIS[epsilon], abs=5e-4)
    ratio, _, axial_integral = sjovall(epsilon, 10 / 9)
    axial = 6000.0
    found = solve_equilibrium(
        case(
            rollers=2400,
            drop=np.zeros(1),
            radial_load=ratio * axial / math.tan(ANGLE),
            axial_load=axial,
        ),
        contacts(),
    )
    largest = axial / (2400 * math.sin(ANGLE) * axial_integral)
    assert found.outer_force.max() == pytest.approx(largest, rel=2e-5)


def test_half_loaded_row_has_the_ratios_that_nsk_prints() -> None:
    """NSK, Rolling Bearings, E728g, section 5.1: F_a = 1.260 F_r tan(alpha), Q_max = 4.08 F_r/(Z cos(alpha))."""
    ratio, radial_integral, _ = sjovall(0.5, 1.1)
    assert 1.0 / ratio == pytest.approx(1.260, rel=1e-3)
    assert 1.0 / radial_integral == pytest.approx(4.08, rel=1e-3)
    found = solve_equilibrium(
        case(
            rollers=240,
            drop=np.zeros(1),
            radial_load=1000.0,
            axial_load=1.260 * 1000.0 * math.tan(ANGLE),
        ),
        contacts(),
    )
    # the row has the exponent 10/9, not 1.1, which changes the ratios by less than 0.4 %
    assert found.outer_force.max() * 240 * math.cos(ANGLE) / 1000.0 == pytest.approx(4.08, rel=4e-3)
    assert np.count_nonzero(found.inner_force) == pytest.approx(120, abs=3)


@given(
    rollers=st.integers(5, 40),
    angle=st.floats(5.0, 35.0).map(math.radians),
    ratio=st.floats(0.0, 0.97),
    axial=st.floats(1.0, 5.0).map(lambda exponent: 10.0**exponent),
    centrifugal=st.one_of(st.just(0.0), st.floats(0.0, 3.0).map(lambda exponent: 10.0**exponent)),
    turn=st.floats(0.0, 1.0),
    slices=st.sampled_from([3, 12]),
)
def test_any_tapered_bearing_balances(
    rollers: int,
    angle: float,
    ratio: float,
    axial: float,
    centrifugal: float,
    turn: float,
    slices: int,
) -> None:
    # the axial component of the centrifugal forces is not available for the radial load
    available = axial - rollers * centrifugal * math.tan(angle)
    assume(available > 0.03 * axial)
    radial = ratio * available / math.tan(angle) * math.cos(math.pi / rollers)
    c = case(
        angle,
        slices,
        turn,
        rollers,
        radial_load=radial,
        axial_load=axial,
        centrifugal_force=centrifugal,
    )
    s = solve_equilibrium(c, contacts())
    scale = max(axial, radial, centrifugal, s.outer_force.max())
    assert np.sum(s.outer_force) * math.sin(angle) == pytest.approx(axial, abs=1e-9 * scale)
    along = np.sum(s.inner_force * np.cos(s.psi)) * math.cos(angle)
    assert along == pytest.approx(radial, abs=1e-9 * scale)
    assert s.iterations < 100
