"""Write the tables of docs/trust/reproduction.rst that need no calibration; each build of the docs draws the figures.

Every scene is run as shipped, with the oil data as they stand; only what a column names is changed.

- reproduction_contact.csv, fig1_contact.svg: friction of one inner contact, 30 degC, 300 N and 518 N (Fig. 1);
- reproduction_effective.csv, fig2_effective.svg: effective friction of both raceways, 70 degC and 3415 N (Fig. 2) and
  50 degC and 1037 N (Fig. 3), for every closure, profile and traction law;
- fig3_rollers.svg: single rollers and the raceway (Fig. 3);
- sensitivity.csv: what else moves the critical cage slip of Fig. 2, one change at a time;
- logarithm.csv: effective friction with log(2 sigma) in place of asinh(sigma).
"""

import itertools

import attrs
import numpy as np
from output import BLUE, GREEN, ORANGE, coefficient, figure, percent, save_figure, write_table

from rollslip import Chain, evolve, load_scene, run
from rollslip.bearing.assembly import assemble
from rollslip_plugins.traction.eyring import Muraki
from rollslip_studies.effective_friction.study import EffectiveFriction

CLOSURES = ("epicyclic", "free-roller", "outer-rolling")
PROFILES = ("iso16281", "none")
TRACTIONS = ("muraki", "maxwell-eyring")
FIGURES = {"Fig. 2": "1032930-70C", "Fig. 3": "1032930-50C"}
TRACTION = "models.traction.hydrodynamic"
PROFILE = "bearing.profile"
COLOURS = dict(zip(CLOSURES, (BLUE, GREEN, ORANGE), strict=True))


def contact_curves():
    """Fig. 1: draw the friction of one contact, and return header and rows on where it is largest."""
    rows = []
    (made, axes) = figure(2, sharey=True)
    study = {"study.friction-curve.max_slip": 1.0, "study.friction-curve.points": 101}
    for profile, traction in itertools.product(PROFILES, TRACTIONS):
        scene = evolve(
            load_scene("1032930-30C"), {PROFILE: profile, TRACTION: traction, **study}, si=True
        )
        data = run(scene, "friction-curve")
        for force, colour in zip(data.normal_force.values, (BLUE, ORANGE), strict=True):
            one = data.sel(normal_force=force)
            at = [coefficient(float(one.friction.interp(slip=s))) for s in (0.05, 0.1, 0.3)]
            critical = percent(float(one.critical_slip)), coefficient(float(one.critical_friction))
            rows.append(
                (
                    profile,
                    traction,
                    f"{force:.0f}",
                    *critical,
                    *at,
                    f"{float(one.load_parameter):.2f}",
                )
            )
            axis = axes[PROFILES.index(profile)]
            style = "-" if traction == "muraki" else "--"
            axis.plot(
                100 * one.slip,
                one.friction,
                style,
                color=colour,
                label=f"{force:.0f} N, {traction}",
            )
    header = "profile,traction,force_N,critical_slip_percent,friction,at_5_percent,at_10_percent,at_30_percent,moes_M"
    for axis, profile in zip(axes, PROFILES, strict=True):
        axis.set(
            title=f"profile {profile}",
            xlabel="slide-roll ratio V/u [%]",
            xlim=(0, 60),
            ylim=(0, None),
        )
    axes[0].set_ylabel("friction coefficient")
    made.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper")
    save_figure(made, "fig1_contact")
    return header.split(","), rows


def is_drawn(name, profile, traction, closure):
    """Whether a curve stands in Fig. 2 or 3."""
    return traction == "muraki" and (
        name == "Fig. 2" or (profile, closure) == ("iso16281", "epicyclic")
    )


def effective_friction(kept=lambda *_: True):
    """Fig. 2 and 3: draw effective friction of the raceways, and return header and rows for what is kept."""
    rows = []
    (made, axes) = figure(2, sharey=True)
    for name, shipped in FIGURES.items():
        base = evolve(load_scene(shipped), {"study.effective-friction.map_points": 0})
        for profile, traction, closure in itertools.product(PROFILES, TRACTIONS, CLOSURES):
            if not kept(name, profile, traction, closure):
                continue
            changes = {"closure": closure, "points": 41, "per_roller": True}
            changes = {f"study.effective-friction.{key}": value for key, value in changes.items()}
            data = run(
                evolve(base, {PROFILE: profile, TRACTION: traction, **changes}, si=True),
                "effective-friction",
            )
            inner, outer = (data.sel(ring=ring) for ring in ("inner", "outer"))
            loaded = inner.roller_friction.isel(roller=int(inner.normal_force.values.argmax()))
            rows.append(
                (
                    name,
                    profile,
                    traction,
                    closure,
                    percent(float(inner.critical_cage_slip)),
                    coefficient(float(inner.critical_friction)),
                    percent(float(outer.critical_cage_slip)),
                    coefficient(float(abs(outer.effective_friction).max())),
                    coefficient(float(loaded.max())),
                )
            )
            if name == "Fig. 2" and traction == "muraki":
                axis = axes[PROFILES.index(profile)]
                slip = 100 * data.cage_slip
                axis.plot(
                    slip,
                    inner.effective_friction,
                    color=COLOURS[closure],
                    label=f"inner, {closure}",
                )
                axis.plot(
                    slip,
                    outer.effective_friction,
                    ":",
                    color=COLOURS[closure],
                    label=f"outer, {closure}",
                )
            if name == "Fig. 3" and is_drawn(name, profile, traction, closure):
                single_rollers(data)
    header = (
        "figure,profile,traction,closure,critical_inner_percent,friction_inner,critical_outer_percent,"
        "largest_friction_outer,largest_friction_of_most_loaded_roller"
    )
    for axis, profile in zip(axes, PROFILES, strict=True):
        axis.axvline(11, color="0.6", linewidth=0.8)
        axis.set(title=f"profile {profile}", xlabel="cage slip [%]", xlim=(0, 95))
        axis.text(12, 0.0003, "11 %, the paper", color="0.4", fontsize=7)
    axes[0].set_ylabel("effective friction coefficient")
    made.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper")
    save_figure(made, "fig2_effective")
    return header.split(","), rows


def plot():
    """Draw fig1_contact.svg, fig2_effective.svg and fig3_rollers.svg."""
    contact_curves()
    effective_friction(kept=is_drawn)


def single_rollers(data):
    """Fig. 3: the raceway beside single rollers."""
    made, axis = figure(1, width=5.2)
    inner = data.sel(ring="inner")
    half = data.angle.values % (2 * np.pi) <= np.pi  # both halves are alike
    loaded = [
        k for k in np.argsort(-inner.normal_force.values) if inner.normal_force[k] > 0 and half[k]
    ]
    for k, tone in zip(loaded, np.linspace(0.2, 0.8, len(loaded)), strict=True):
        label = f"roller with {float(inner.normal_force[k]):.0f} N"
        axis.plot(
            100 * data.cage_slip,
            inner.roller_friction[k],
            color=str(tone),
            linewidth=0.9,
            label=label,
        )
    axis.plot(100 * data.cage_slip, inner.effective_friction, color=BLUE, label="raceway")
    axis.set(xlabel="cage slip [%]", ylabel="friction coefficient", xlim=(0, 95), ylim=(0, None))
    made.legend(loc="outside right upper")
    save_figure(made, "fig3_rollers")


SENSITIVITY = {
    "as shipped": {},
    "alpha 25 % larger": {"lubricant.pressure_viscosity_factor": 1.25},
    "alpha 25 % smaller": {"lubricant.pressure_viscosity_factor": 0.75},
    "Eyring stress 1 MPa": {"lubricant.eyring_stress": "1 MPa"},
    "Eyring stress 10 MPa": {"lubricant.eyring_stress": "10 MPa"},
    "gamma 25 % larger": {"lubricant.pressure_thermoviscosity_factor": 1.25},
    "viscosity 20 % larger": {"lubricant.viscosity_factor": 1.2},
    "shear modulus 0.05 GPa": {"lubricant.shear_modulus": "0.05 GPa"},
    "radial clearance 20 um": {"bearing.radial_clearance": "20 um"},
    "radial clearance 100 um": {"bearing.radial_clearance": "100 um"},
    "misalignment 1 mrad": {"operation.misalignment": "1 mrad"},
    "straight rollers": {PROFILE: "none"},
    "film by regime (minimum)": {"models.film": "regime"},
    "film Dowson 1968 (minimum)": {"models.film": "dowson-1968"},
    "film Dowson-Toyoda (central)": {"models.film": "dowson-toyoda"},
    "contact ISO/TS 16281": {"models.contact": "iso16281"},
    "traction maxwell-eyring": {TRACTION: "maxwell-eyring"},
    "roller Ra 0.3 um": {"surface.roller_roughness": "0.3 um"},
}


def sensitivity():
    """What moves the critical cage slip of Fig. 2, one change at a time, closure epicyclic."""
    base = evolve(
        load_scene("1032930-70C"),
        {"study.effective-friction.map_points": 0, "study.effective-friction.points": 21},
    )
    rows = []
    for name, changes in SENSITIVITY.items():
        inner = run(evolve(base, changes, si=True), "effective-friction").sel(ring="inner")
        rows.append(
            (
                name,
                percent(float(inner.critical_cage_slip)),
                coefficient(float(inner.critical_friction)),
            )
        )
    write_table("sensitivity", ("change", "critical_cage_slip_percent", "largest_friction"), rows)


@attrs.frozen(kw_only=True)
class MurakiLogarithm(Muraki):
    """The closed form with log(2 sigma) in place of asinh(sigma); for this comparison only."""

    def dimensionless_stress(self, strain_rate, deborah, heating):
        sigma = np.abs(strain_rate)
        sign = np.sign(strain_rate)
        sigma = np.maximum(sigma, 1e-12)  # at no slip the logarithm has no value
        logarithm = np.log(2 * sigma)
        a = 1 + heating * sigma
        y = 2 * logarithm / (a + np.sqrt(np.maximum(a**2 - deborah * heating * logarithm, 0)))
        ramp = deborah * logarithm > sigma * (1 + a)
        return sign * np.where(
            ramp, sigma / np.maximum(deborah, 1e-300), y - deborah * y**2 / (4 * sigma)
        )

    def kernel(self):
        return None


def logarithm():
    """Effective friction of the inner ring with asinh(sigma) and with log(2 sigma)."""
    rows = []
    study = EffectiveFriction(closure="epicyclic", max_cage_slip=0.95, points=41, map_points=0)
    slips = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
    for name, shipped in FIGURES.items():
        assembly = assemble(load_scene(shipped))
        law = attrs.evolve(assembly.traction, hydrodynamic=MurakiLogarithm())
        chain = Chain(
            assembly.contact, assembly.film, assembly.lubricant.pressure_viscosity_law, law
        )
        with_log = attrs.evolve(
            assembly,
            traction=law,
            inner=attrs.evolve(assembly.inner, chain=chain),
            outer=attrs.evolve(assembly.outer, chain=chain),
        )
        for which, bearing in (("asinh(sigma)", assembly), ("ln(2 sigma)", with_log)):
            inner = study.run(bearing).sel(ring="inner")
            values = [
                coefficient(float(inner.effective_friction.interp(cage_slip=s))) for s in slips
            ]
            rows.append((name, which, percent(float(inner.critical_cage_slip)), *values))
    header = (
        "figure",
        "law",
        "critical_inner_percent",
        *(f"at_{100 * s:.0f}_percent" for s in slips),
    )
    write_table("logarithm", header, rows)


if __name__ == "__main__":
    write_table("reproduction_contact", *contact_curves())
    write_table("reproduction_effective", *effective_friction())
    sensitivity()
    logarithm()
