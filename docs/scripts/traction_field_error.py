"""Write the tables and figures of docs/trust/traction_reference.rst: closed forms against the integrated field.

- traction_field_reference.csv: the field against the method of lines of tools/references/traction_field.py;
- traction_field_grid.csv: friction on one grid after the other;
- traction_field_cases.csv: contacts of the paper's bearing, and their groups;
- traction_field_parts.csv, traction_field.svg: what each simplification alone changes there, and the closed forms;
- traction_field_critical.csv: where their friction is largest;
- traction_field_map.csv, traction_field_map.svg: error of the closed forms over the groups;
- traction_field_inside.svg: stress and temperature inside one contact.
"""

import csv
import itertools
from pathlib import Path

import attrs
import numpy as np
from output import (
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    coefficient,
    figure,
    percent,
    save_figure,
    write_table,
)
from scipy.optimize import brentq

from rollslip import Chain, Conditions, Slices, get_model, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.regimes import moes_groups
from rollslip_kernels.slices import COLUMNS
from rollslip_plugins.pressure_viscosity import Barus
from rollslip_plugins.traction.field import (
    GRIDS,
    OIL_HEAT_CAPACITY,
    solve_field,
    solve_friction,
    stress_on_grid,
)
from rollslip_plugins.traction.heating import FLASH

#: The models that are compared with the field.
MODELS = ("muraki", "maxwell-eyring", "eyring")
STYLES = {"muraki": (BLUE, "-"), "maxwell-eyring": (ORANGE, "-"), "eyring": (GREEN, ":")}
REFERENCE = Path(__file__).parents[2] / "tools" / "references" / "traction_field.csv"
ACCURACY = 1e-5

# The method of lines -------------------------------------------------------------------------------------------------


def against_the_method_of_lines():
    rows = []
    with REFERENCE.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            values = {name: float(text) for name, text in row.items()}
            shared = {f.name: values[f.name] for f in attrs.fields(Conditions) if f.name in values}
            columns = {
                name: values[name]
                for name in Slices.__slots__
                if name in values and name != "friction"
            }
            slices = Slices(1, Conditions(**shared), **columns)
            cells = [
                f"{1e6 * values['film_thickness']:g}",
                f"{values['rolling_speed']:g}",
                f"{values['sliding_speed']:g}",
                f"{1e-6 * values['pressure']:g}",
                f"{values['friction']:.7f}",
                row["error"],
            ]
            for accuracy in (1e-4, 1e-6):
                friction, error = solve_friction(
                    slices, heat_capacity=values["heat_capacity"], accuracy=accuracy
                )
                cells += [f"{abs(friction[0] / values['friction'] - 1):.1e}", f"{error[0]:.1e}"]
            rows.append(cells)
    header = "h_um,u_m/s,V_m/s,p_MPa,lines,lines_error,off_at_1e-4,estimate_at_1e-4,off_at_1e-6,estimate_at_1e-6"
    write_table("traction_field_reference", header.split(","), rows)


# The paper's bearing -------------------------------------------------------------------------------------------------

#: Case -> scene, force on the roller [N].
CASES = {
    "30 °C, 300 N": ("1032930-30C", 300.0),
    "30 °C, 518 N": ("1032930-30C", 518.0),
    "70 °C, 518 N": ("1032930-70C", 518.0),
}
ROLLING_SPEED = 29.8
SLIPS = (0.001, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5)
#: What one simplification alone is called -> how the field is told.
PARTS = {
    "mean pressure": {"pressure": "mean"},
    "conducting film": {"heat_capacity": OIL_HEAT_CAPACITY / 1e4},
    "uniform heating": {"heating": "local-stress"},
    (MEAN := "mean stress"): {},
    "no heating": {"heating": "none"},
}


def contact(case, slip):
    """Return slices of an inner contact of the paper's bearing, with film and viscosity filled."""
    scene, force = CASES[case]
    assembly = assemble(load_scene(scene))
    speed = ROLLING_SPEED * np.asarray(slip, dtype=float)
    shared = assembly.inner.conditions
    slices = Slices(
        speed.size,
        shared,
        load=force / shared.length,
        rolling_speed=ROLLING_SPEED,
        sliding_speed=speed,
    )
    Chain(assembly.contact, assembly.film, assembly.lubricant.pressure_viscosity_law)(slices)
    return slices


def friction_of_mean_stress(slices):
    """Return the friction where the mean stress warms film and surfaces uniformly: theta = zeta mean(tau) V."""
    oil = slices.conditions
    zeta = FLASH * np.sqrt(slices.half_width / (np.pi * slices.rolling_speed)) / oil.effusivity
    zeta += slices.film_thickness / (12 * oil.conductivity)
    heating = zeta * slices.pressure * slices.sliding_speed
    columns = {name: getattr(slices, name) for name in COLUMNS if hasattr(slices, name)}

    def at_temperature(rise, k):
        """Return the friction of slice k at a temperature above the inlet's, after Barus's law."""
        warm = attrs.evolve(
            oil,
            viscosity=oil.viscosity * np.exp(-oil.thermoviscosity * rise),
            pressure_viscosity=oil.pressure_viscosity - oil.pressure_thermoviscosity * rise,
        )
        single = Slices.of_columns(warm, {name: values[[k]] for name, values in columns.items()})
        # the finest grid leaves an error of up to 2e-5, below the last digit of the tables
        return solve_friction(single, heating="none", accuracy=ACCURACY)[0][0]

    def rise(k):
        """Return the temperature of slice k above the inlet's."""
        return brentq(
            lambda theta: heating[k] * at_temperature(theta, k) - theta,
            0.0,
            heating[k] * at_temperature(0.0, k),
            rtol=ACCURACY,
        )

    return np.array([at_temperature(rise(k), k) for k in range(heating.size)])


def friction(slices, name, **told):
    """Return the friction after a model, or after the field, told something or not."""
    if name in MODELS:
        Chain(get_model("traction", name))(slices)
        return slices.friction.copy()
    if name == MEAN:
        return friction_of_mean_stress(slices)
    value, error = solve_friction(slices, accuracy=ACCURACY, **told)
    if np.any(error > ACCURACY):
        raise ValueError(f"{name} {told}: the field did not settle, {error.max():.1e}")
    return value


def cases():
    """The groups of the paper's contacts."""
    rows = []
    for case in CASES:
        slices = contact(case, [0.1])
        c = slices.conditions
        h = slices.film_thickness[0]
        b = slices.half_width[0]
        u = ROLLING_SPEED
        p = slices.pressure[0]
        eta = slices.film_viscosity[0]
        beta = slices.film_thermoviscosity[0]
        zeta = 0.97 * np.sqrt(b / (np.pi * u)) / c.effusivity + h / (12 * c.conductivity)
        values = (
            f"{1e6 * h:.2f}",
            f"{1e-6 * p:.0f}",
            f"{moes_groups(slices)[0][0]:.1f}",
            f"{c.pressure_viscosity * p:.1f}",
            f"{eta * slices.sliding_speed[0] / (c.eyring_stress * h):.3f}",
            f"{eta * u / (c.shear_modulus * b):.1e}",
            f"{beta * zeta * c.eyring_stress**2 * h / eta:.2f}",
            f"{100 * h / (12 * c.conductivity) / zeta:.0f}",
            f"{OIL_HEAT_CAPACITY * u * h**2 / (c.conductivity * b):.1f}",
        )
        rows.append((case, *values))
    header = "case,h_um,p_MPa,M,alpha_p,sigma_at_10_%,D,Phi,film's_share_of_zeta_%,C"
    write_table("traction_field_cases", header.split(","), rows)


def bearing():
    """What each simplification costs in the paper's contacts."""
    rows = []
    critical = []
    (made, axes) = figure(len(CASES), sharey=False, width=2.6)
    dense = np.geomspace(0.003, 1.0, 40)
    told = {"field": {}, **PARTS, **{name: {} for name in MODELS}}
    for case, axis in zip(CASES, axes, strict=True):
        slices = contact(case, SLIPS)
        values = {name: friction(slices, name, **options) for name, options in told.items()}
        for k, slip in enumerate(SLIPS):
            off = [
                # the mean stress has a meaning for uniform heating only: it is compared with that
                f"{100 * (values[name][k] / values['uniform heating' if name == MEAN else 'field'][k] - 1):+.1f}"
                for name in told
                if name != "field"
            ]
            rows.append((case, percent(slip), f"{values['field'][k]:.6f}", *off))
        slices = contact(case, dense)
        for name, options in told.items():
            curve = friction(slices, name, **options)
            top = int(np.argmax(curve))
            inside = 0 < top < dense.size - 1
            if inside:  # a parabola through the three largest, even in the logarithm of the slip
                bend = curve[top - 1] - 2 * curve[top] + curve[top + 1]
                shift = (curve[top - 1] - curve[top + 1]) / (2 * bend)
                best = dense[top] * (dense[1] / dense[0]) ** shift
                largest = curve[top] - bend * shift**2 / 2
                critical.append((case, name, percent(best), coefficient(largest)))
            else:
                critical.append((case, name, "none", coefficient(np.nan)))
            if name in MODELS:
                colour, style = STYLES[name]
                axis.plot(100 * dense, curve, style, color=colour, label=name)
            elif name in ("field", "mean pressure", "conducting film"):
                style = {"field": "-", "mean pressure": ":", "conducting film": "--"}[name]
                label = name if name == "field" else f"field, {name}"
                axis.plot(100 * dense, curve, style, color="black", label=label)
        axis.set(title=case, xlabel="slide-roll ratio V/u [%]", xlim=(0, 100), ylim=(0, None))
    axes[0].set_ylabel("friction coefficient")
    made.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper")
    save_figure(made, "traction_field")
    header = (
        "case",
        "slip_percent",
        "field",
        *(name.replace(" ", "_") for name in told if name != "field"),
    )
    write_table("traction_field_parts", header, rows)
    write_table(
        "traction_field_critical",
        ("case", "model", "critical_slip_percent", "largest_friction"),
        critical,
    )


def grid():
    """How friction settles as the grid is doubled."""
    rows = []
    for case, slip in (("30 °C, 518 N", 0.01), ("30 °C, 518 N", 0.3)):
        slices = contact(case, [slip])
        scale = slices.conditions.eyring_stress / slices.pressure[0]
        values = [scale * stress_on_grid(slices, cells, 16)[0] for cells, _ in GRIDS]
        last = 0.0
        for (cells, _), value, before in zip(GRIDS, values, [np.nan, *values], strict=False):
            change = value - before
            order = "" if np.isnan(last / change) or last == 0 else f"{np.log2(last / change):.2f}"
            extrapolated = value + change / 3
            rows.append(
                (
                    case,
                    percent(slip),
                    cells,
                    f"{value:.9f}",
                    "" if np.isnan(change) else f"{change:.2e}",
                    order,
                    "" if np.isnan(change) else f"{extrapolated:.9f}",
                )
            )
            last = 0.0 if np.isnan(change) else change
    header = ("case", "slip_percent", "cells", "friction", "change", "order", "extrapolated")
    write_table("traction_field_grid", header, rows)


def inside():
    """Stress and temperature along the contact and across the film."""
    made, (left, middle, right) = figure(3, width=2.6)
    for heat, style in ((OIL_HEAT_CAPACITY, "-"), (OIL_HEAT_CAPACITY / 1e4, "--")):
        field = solve_field(contact("30 °C, 518 N", [0.3]), heat_capacity=heat, accuracy=1e-6)
        x = field.position / field.position[-1]
        first = heat == OIL_HEAT_CAPACITY  # only solid lines are named
        left.plot(
            x, field.stress / 1e6, style, color=BLUE, label="field" if first else "conducting film"
        )
        curves = {"middle of the film": (field.film_temperature[:, field.height.size // 2], ORANGE)}
        curves["surfaces"] = (field.surface_temperature, GREEN)
        for name, (values, colour) in curves.items():
            middle.plot(x, values, style, color=colour, label=name if first else None)
        for place, colour in ((-0.5, BLUE), (0.0, ORANGE), (0.9, PURPLE)):
            k = int(np.argmin(np.abs(x - place)))
            label = f"x/b = {place:g}" if first else None
            right.plot(field.height, field.film_temperature[k], style, color=colour, label=label)
    left.set(xlabel="x/b", ylabel="shear stress [MPa]", ylim=(0, None))
    middle.set(xlabel="x/b", ylabel="temperature rise [K]", ylim=(0, 45))
    right.set(xlabel="z/h", ylabel="temperature rise [K]", xlim=(0, 1), ylim=(0, 45))
    for axis in (left, middle, right):
        axis.legend(loc="upper right")
    save_figure(made, "traction_field_inside")


# The groups ----------------------------------------------------------------------------------------------------------

SIGMA = (0.01, 1.0, 10.0, 100.0)
BARUS = (3.0, 6.0, 12.0)
#: (D, Phi, C): cold and ever more elastic; heated, with films that conduct at once and films that hardly conduct. No
#: oil has a large D and a large Phi at once: 12 D Phi/C is beta tau0^2/(Gamma rho_f c_f), 1e-3 to 1e-2.
FILMS = (
    (1e-3, 0.0, 1.0),
    (0.1, 0.0, 1.0),
    (1.0, 0.0, 1.0),
    (10.0, 0.0, 1.0),
    (1e-4, 0.1, 0.1),
    (1e-3, 0.1, 15.0),
    (1e-4, 1.0, 0.1),
    (1e-3, 1.0, 15.0),
)


def of_groups(sigma, deborah, heating, capacity, barus):
    """Return slices that have the groups, at a mean pressure of 0.4 GPa; the surfaces have 5 % of the heating."""
    eta = 1.0
    tau0 = 4e6
    p = 4e8
    b = 5e-5
    u = 30.0
    h = 1e-6
    k = 0.14
    zeta = h / (12 * k) / 0.95
    shared = Conditions(
        viscosity=eta * np.exp(-barus),
        pressure_viscosity=barus / p,
        thermoviscosity=heating * eta / (zeta * tau0**2 * h),
        pressure_thermoviscosity=0.0,
        conductivity=k,
        eyring_stress=tau0,
        shear_modulus=eta * u / (deborah * b),
        effusivity=0.97 * np.sqrt(b / (np.pi * u)) / (0.05 * zeta),
    )
    speed = np.asarray(sigma) * tau0 * h / eta
    columns = {
        "half_width": b,
        "pressure": p,
        "film_thickness": h,
        "rolling_speed": u,
        "sliding_speed": speed,
    }
    slices = Slices(speed.size, shared, **columns)
    Chain(Barus())(slices)
    return slices, capacity * k * b / (u * h**2)


def errors(sigma, film, barus):
    """Return the stress of the field over tau0, and the error of every closed form in percent."""
    slices, heat_capacity = of_groups(sigma, *film, barus)
    value, error = solve_friction(slices, heat_capacity=heat_capacity, accuracy=1e-4)
    value[error > 1e-4] = np.nan
    off = {name: 100 * (friction(slices, name) / value - 1) for name in MODELS}
    return value * slices.pressure / slices.conditions.eyring_stress, off


def group_map():
    rows = []
    for film, barus in itertools.product(FILMS, BARUS):
        stress, off = errors(SIGMA, film, barus)
        for k, sigma in enumerate(SIGMA):
            known = np.isfinite(stress[k])
            texts = [f"{off[name][k]:+.1f}" if known else "" for name in MODELS]
            groups = (f"{value:g}" for value in (*film, barus, sigma))
            rows.append((*groups, f"{stress[k]:.5g}" if known else "", *texts))
    write_table(
        "traction_field_map", ("D", "Phi", "C", "alpha_p", "sigma", "field_stress", *MODELS), rows
    )

    shown = {"cold, D = 0.001": FILMS[0], "Φ = 0.1, C = 0.1": FILMS[4], "Φ = 0.1, C = 15": FILMS[5]}
    made, axes = figure(len(shown), width=2.6, sharey=True)
    sigma = np.geomspace(0.01, 1000, 21)
    for (title, film), axis in zip(shown.items(), axes, strict=True):
        for barus, colour in zip(BARUS, (BLUE, ORANGE, PURPLE), strict=True):
            _, off = errors(sigma, film, barus)
            for name, style in (
                ("maxwell-eyring", "-"),
                ("muraki", "--"),
            ):  # eyring is as the former at these D
                axis.plot(sigma, off[name], style, color=colour, label=f"{name}, αp = {barus:g}")
        axis.axhline(0, color="0.7", linewidth=0.6)
        axis.set(xscale="log", xlabel="σ", title=title)
    axes[0].set(ylabel="error against the field [%]", ylim=(-100, 100))
    made.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper")
    save_figure(made, "traction_field_map")


if __name__ == "__main__":
    against_the_method_of_lines()
    grid()
    cases()
    bearing()
    inside()
    group_map()
