"""Study friction-curve: friction of one contact against its slide-roll ratio, for given normal forces."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from rollslip.assembly import Array, Assembly, Raceway
from rollslip.critical import locate
from rollslip.errors import DomainError
from rollslip.fields import at_least, one_of, parameter, positive
from rollslip.regimes import NAMES, film_by_regime, groups, moes_groups

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_kernels.slices import Slices


@attrs.frozen(kw_only=True)
class FrictionCurve:
    """Settings of the study."""

    normal_force: tuple[float, ...] = parameter(
        default=(300.0,),
        unit="N",
        doc="normal forces of the contact",
        validator=attrs.validators.deep_iterable(positive),
    )
    ring: str = parameter(default="inner", doc="ring of the contact", validator=one_of("inner", "outer"))
    max_slip: float = parameter(default=0.3, unit="1", doc="largest slide-roll ratio V/u", validator=positive)
    points: int = parameter(default=201, doc="points of the curve, denser towards zero", validator=at_least(5))

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate."""
        return len(self.normal_force) * self.points * assembly.slices

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        return self.max_slip

    @property
    def averaged(self) -> bool:
        """Whether the curves are means over the instants of a pitch."""
        return False

    def curves(self, assembly: Assembly, slip: Array, instants: Sequence[int]) -> Array:
        """Return friction for each normal force, which no instant changes, (k, forces, n)."""
        raceway, u = self._contact(assembly)
        loads = contact_loads(assembly, raceway, np.array(self.normal_force))
        found = [_friction(raceway, *load, u, slip)[1] for load in loads]
        return np.broadcast_to(found, (len(instants), len(found), slip.size))

    def _contact(self, assembly: Assembly) -> tuple[Raceway, float]:
        """The raceway and its entrainment speed [m/s] without slip."""
        speeds = assembly.kinematics.surface_speeds(0.0, 0.0)
        if self.ring == "inner":
            return assembly.inner, float(speeds.inner_rolling)
        return assembly.outer, float(speeds.outer_rolling)

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return nothing: contacts are all there is."""
        return ()

    def run(self, assembly: Assembly) -> "xr.Dataset":
        """Return the curves.

        The contact rolls at the entrainment speed of the bearing without slip and is loaded evenly but for the
        roller's profile; film, pressure and regime are those of its most loaded slice.

        Returns
        -------
        xarray.Dataset
            Dimensions (normal_force, slip): friction, film_thickness, film_parameter, regime; per normal force
            half_width, pressure, critical_slip with critical_friction and critical_status.
        """
        import xarray as xr

        raceway, u = self._contact(assembly)
        slip = slip_grid(self.max_slip, self.points)
        forces = np.array(self.normal_force)
        rows = [_curve(assembly, raceway, *loads, u, slip) for loads in contact_loads(assembly, raceway, forces)]

        def stacked(name: str) -> Array:
            return np.stack([row[name] for row in rows])

        critical = [row["critical"] for row in rows]
        both, force = ("normal_force", "slip"), ("normal_force",)
        return xr.Dataset(
            {
                "friction": (both, stacked("friction"), about("1", "friction coefficient")),
                "film_thickness": (
                    both,
                    stacked("film_thickness"),
                    about("m", f"film thickness, {assembly.film.location}"),
                ),
                "film_parameter": (both, stacked("film_parameter"), about("1", "film parameter Lambda")),
                "regime": (
                    both,
                    stacked("regime"),
                    about("1", "film regime") | {"flag_values": [0, 1, 2, 3], "flag_meanings": " ".join(NAMES)},
                ),
                "half_width": (force, stacked("half_width"), about("m", "Hertz half width")),
                "pressure": (force, stacked("pressure"), about("Pa", "mean Hertz pressure")),
                "load_parameter": (force, stacked("M"), about("1", "Moes load parameter M")),
                "lubricant_parameter": (force, stacked("L"), about("1", "Moes lubricant parameter L")),
                "critical_slip": (
                    force,
                    np.array([c.slip for c in critical]),
                    about("1", "slide-roll ratio of the largest friction"),
                ),
                "critical_friction": (
                    force,
                    np.array([c.friction for c in critical]),
                    about("1", "largest friction coefficient"),
                ),
                "critical_status": (
                    force,
                    np.array([c.status for c in critical]),
                    about("1", "what was found of the critical slip"),
                ),
            },
            coords={
                "normal_force": ("normal_force", forces, about("N", "normal force of the contact")),
                "slip": ("slip", slip, about("1", "slide-roll ratio V/u")),
            },
            attrs={"study": "friction-curve", "ring": self.ring, "rolling_speed": u},
        )


def slip_grid(largest: float, points: int) -> Array:
    """Return slips from 0 to the largest, quadratically denser towards 0, where friction rises steeply."""
    return np.asarray(largest * np.linspace(0.0, 1.0, points) ** 2)


def about(unit: str, long_name: str) -> dict[str, Any]:
    """Return the attributes that every variable of a result has."""
    return {"units": unit, "long_name": long_name}


def contact_loads(assembly: Assembly, raceway: Raceway, forces: Array) -> list[tuple[Array, Array]]:
    """Loads per length [N/m] and forces [N] of the loaded slices of an aligned contact, for each normal force."""
    if assembly.slices == 1:
        return [(force / assembly.scene.bearing.roller_length, force) for force in forces[:, None]]
    drop = (
        assembly.drop - assembly.drop.min()
    )  # approaches are measured from the first touch, else small ones round off
    rows = []
    for force in forces:
        row = _balanced(lambda approach: assembly.deflect(approach - drop, raceway.ring), assembly.widths, force)
        if not np.any(row > 0.0):
            raise DomainError(
                f"a normal force of {force:g} N is lost along a roller of {assembly.scene.bearing.roller_length:g} m: "
                "its load per length is below all floats; give more of it"
            )
        rows.append((row[row > 0.0], (row * assembly.widths)[row > 0.0]))
    return rows


def _balanced(deflection: Callable[[float], tuple[Array, Array]], widths: Array, force: float) -> Array:
    """Loads that carry a force: Newton's method over the approach, which bisection keeps within its bracket."""
    low, high, approach = 0.0, np.inf, 1e-6
    while True:
        load, stiffness = deflection(approach)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # far above a tiny force
            excess = float((load * widths / force).sum()) - 1.0
            step = excess / float((stiffness * widths / force).sum())
        low, high = (low, approach) if excess > 0.0 else (approach, high)
        guess = approach - step
        if not low < guess < high:
            guess = 0.5 * (low + high) if high < np.inf else 2.0 * approach
        if abs(guess - approach) <= 4e-15 * approach or excess == 0.0 or not low < guess < high:
            return load
        approach = guess


def _friction(raceway: Raceway, load: Array, force: Array, u: float, slip: Array) -> "tuple[Slices, Array]":
    """Evaluated slices and friction coefficient at some slide-roll ratios."""
    slices = raceway.evaluate(np.tile(load, slip.size), u, np.repeat(slip, load.size) * u)
    return slices, slices.friction.reshape(slip.size, load.size) @ force / force.sum()


def _curve(assembly: Assembly, raceway: Raceway, load: Array, force: Array, u: float, slip: Array) -> dict[str, Any]:
    slices, friction = _friction(raceway, load, force, u, slip)
    most = int(np.argmax(load)) + load.size * np.arange(slip.size)
    M, L = moes_groups(slices)
    return {
        "friction": friction,
        "film_thickness": slices.film_thickness[most],
        "film_parameter": slices.film_thickness[most] / raceway.conditions.roughness,
        "regime": film_by_regime(*groups(slices))[1][most].astype(np.int8),
        "half_width": slices.half_width[most[0]],
        "pressure": slices.pressure[most[0]],
        "M": M[most[0]],
        "L": L[most[0]],
        "critical": locate(
            lambda s: float(_friction(raceway, load, force, u, np.array([s]))[1][0]), slip, friction, "max_slip"
        ),
    }
