"""Study friction-curve: friction of one contact over its slide-roll ratio, for given normal forces.

The load over an aligned contact follows from its approach: Newton's method with bisection as a safeguard, to the
rounding error (`balanced_load`). Friction is the mean over the slices by force; its maximum is searched on the
continuous curve (`bearing.critical`).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from types import MappingProxyType
from typing import Any, ClassVar, Final, TypeAlias

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import PURE_SLIDING, Critical, Curve, find_critical_slips, slip_grid
from rollslip.bearing.raceway import Array, LoadedContacts, Raceway, mean_friction
from rollslip.bearing.regimes import NAMES, film_by_regime, groups, moes_groups
from rollslip.errors import DomainError, SceneError
from rollslip.fields import at_least, choice_of, not_empty, parameter, positive
from rollslip.results.curves import FIRST, Curves
from rollslip.results.dataset import about, xr
from rollslip.scene.relations import impossible_pressure
from rollslip.structure import Location
from rollslip.studies.answers import LoadedSlices, Output, PartialResult, RunContext
from rollslip.studies.study import N_VALIDITY_SLIPS, Study
from rollslip.studies.timing import POINTS, extrapolate_line, processor_time
from rollslip.units import format_quantity

#: Dimensions of curves.
_OF_CURVE: Final = "normal_force slip"
#: Dimension of values of a curve.
_OF_FORCE: Final = "normal_force"
#: A contact, its entrainment speed [m/s], and slide-roll ratios.
_Curve: TypeAlias = tuple[LoadedContacts, float, Array]
#: Angle [rad] and number of the roller of the contact, for laws that depend on these: the one in the line of load.
_FIRST: Final = np.zeros(1), np.zeros(1)
#: Relative tolerance of the approach, 18 units of rounding, below which steps are noise. Newton's method converges
#: quadratically, so that twice as much saves no step. Chosen.
_APPROACH_TOLERANCE: Final = 4e-15
#: Variables of the study by name.
OUTPUTS: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "friction": Output(_OF_CURVE, "1", "friction coefficient"),
        "critical_slip": Output(
            _OF_FORCE,
            "1",
            "slide-roll ratio of the largest friction",
            status="critical_status",
            default=True,
        ),
        "critical_friction": Output(
            _OF_FORCE, "1", "largest friction coefficient", status="critical_status", default=True
        ),
        "critical_status": Output(_OF_FORCE, "1", "what was found of the slip at largest traction"),
        "critical_slip_bound": Output(
            _OF_FORCE,
            "1",
            "lower bound of the slip at largest traction: that slip, or the end of the range",
            status="critical_status",
            default=True,
        ),
        "first_maximum_slip": Output(
            _OF_FORCE,
            "1",
            "slide-roll ratio from which friction first falls",
            status="critical_status",
        ),
        "first_maximum_friction": Output(
            _OF_FORCE, "1", "friction coefficient there", status="critical_status"
        ),
        "film_thickness": Output(_OF_CURVE, "m", "film thickness"),
        "film_parameter": Output(_OF_CURVE, "1", "film parameter Lambda"),
        "regime": Output(_OF_CURVE, "1", "film regime"),
        "half_width": Output(
            _OF_FORCE,
            "m",
            "half width that carries the load, Hertz's or the film's (models.pressure)",
        ),
        "pressure": Output(
            _OF_FORCE, "Pa", "mean pressure, Hertz's or the film's (models.pressure)"
        ),
        "load_parameter": Output(_OF_FORCE, "1", "Moes load parameter M"),
        "lubricant_parameter": Output(_OF_FORCE, "1", "Moes lubricant parameter L"),
    }
)


@attrs.frozen(kw_only=True)
class FrictionCurve(Study):
    """Friction of one contact over its slide-roll ratio, for given normal forces."""

    name: ClassVar[str] = "friction-curve"
    curves_of: ClassVar[Curves] = Curves(
        variable="friction", over="normal_force", slip="slip", critical="critical_slip"
    )
    outputs: ClassVar[Mapping[str, Output]] = OUTPUTS
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"friction": "friction", "critical_slip": "critical_slip"}
    )
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "friction": "the models of a contact on every loaded slice, over the slips and in search of the largest"
        }
    )
    bearing_loads: ClassVar[bool] = False

    normal_force: tuple[float, ...] = parameter(
        default=(300.0,),
        unit="N",
        doc="normal forces of the contact",
        validator=attrs.validators.and_(not_empty, attrs.validators.deep_iterable(positive)),
        usual=(0, 1e6),
        possible=(0, 1e9),
    )
    ring: str = parameter(
        default="inner", doc="ring of the contact", validator=choice_of("inner", "outer")
    )
    max_slip: float = parameter(
        default=0.3, unit="1", doc="largest slide-roll ratio V/u", validator=positive
    )
    points: int = parameter(
        default=201, doc="points of the curve, denser towards zero", validator=at_least(5)
    )

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate."""
        half = -(-assembly.slices // 2)  # the other half has the same load
        return len(self.normal_force) * self.points * (half + 1)

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return how many numbers the curves have at least."""
        return {"points": 10.0 * self.points * len(self.normal_force)}

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        return self.max_slip

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return friction for each normal force, the same for all numbers of positions, (k, forces, n)."""
        found = _friction(
            [(loaded, self.rolling_speed(assembly), slip) for loaded in self.contacts(assembly)]
        )
        return np.broadcast_to(found, (len(n_positions), len(found), slip.size))

    def rolling_speed(self, assembly: Assembly) -> float:
        """Return the entrainment speed of the contact [m/s], that of the bearing without slip."""
        return assembly.kinematics.roller_radius * assembly.kinematics.epicyclic_roller_speed

    def contacts(self, assembly: Assembly) -> list[LoadedContacts]:
        """Return the loaded slices of the contact, for each normal force."""
        raceway: Raceway = getattr(assembly, self.ring)
        c = raceway.conditions
        where = Location(assembly.scene.origins, ("study", self.name, "normal_force"))
        if faults := [
            where.at(k).message(f"{format_quantity(force, 'N')} is {fault}")
            for k, force in enumerate(self.normal_force)
            if (fault := impossible_pressure(force / c.length, c.radius, c.modulus))
        ]:
            raise SceneError(faults)

        def loaded(force: float) -> LoadedContacts:
            load = balanced_load(assembly, raceway, force)[None]
            return LoadedContacts(
                raceway, load, assembly.widths, 1.0, places=assembly.places(raceway.ring, *_FIRST)
            )

        return [
            assembly.cached_by_loads(("contact", self.ring, force), 1, partial(loaded, force)).on(
                raceway
            )
            for force in self.normal_force
        ]

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] of the curves, measured with few points."""
        times = [
            processor_time(partial(attrs.evolve(self, points=n).run, assembly)) for n in POINTS
        ]
        return {"friction": extrapolate_line(POINTS, times, self.points)}

    def loaded_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> Iterator[LoadedSlices]:
        """Yield the slices of each normal force, slip by slip."""
        yield from self._evaluated(
            assembly, dataset.attrs["rolling_speed"], dataset["slip"].to_numpy()
        )

    def expected_slices(self, assembly: Assembly) -> tuple[str, list[LoadedSlices]]:
        """Return the slices of each normal force at a few slips of the curves."""
        slips = np.linspace(self.max_slip / N_VALIDITY_SLIPS, self.max_slip, N_VALIDITY_SLIPS)
        return "over the curves", [*self._evaluated(assembly, self.rolling_speed(assembly), slips)]

    def _evaluated(self, assembly: Assembly, u: float, slips: Array) -> Iterator[LoadedSlices]:
        """Yield the slices of each normal force at an entrainment speed [m/s] and slide-roll ratios."""
        for k, contacts in enumerate(self.contacts(assembly)):
            for slip in slips:
                yield LoadedSlices(
                    k,
                    contacts.raceway.ring,
                    contacts.slices.load,
                    u,
                    slip * u,
                    contacts.force,
                    contacts.places,
                )

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the curves.

        The entrainment speed is that of the bearing without slip. The load is even except for the profile of the
        roller. Film, pressure and regime are those of the most loaded slice.

        Returns
        -------
        xarray.Dataset
            Dimensions (normal_force, slip): friction, film_thickness, film_parameter, regime; per normal force
            half_width, pressure, critical_slip with critical_friction and critical_status, first_maximum_slip and
            first_maximum_friction.
        """
        slip = slip_grid(self.max_slip, self.points)
        u = self.rolling_speed(assembly)
        contacts = self.contacts(assembly)
        curves = [(loaded, u, slip) for loaded in contacts]
        friction = _friction(curves)
        found, coords = self._curve_variables(slip, friction, self._critical(curves, friction))
        rows = [_heaviest_slice(loaded, u, slip) for loaded in contacts]
        variables = {"friction": found["friction"]} | self.variables(
            **{name: np.stack([row[name] for row in rows]) for name in rows[0]}
        )
        variables["film_thickness"][2]["long_name"] += f", {assembly.film.location}"
        variables["regime"][2].update(flag_values=[0, 1, 2, 3], flag_meanings=" ".join(NAMES))
        return xr.Dataset(
            variables | found,
            coords,
            attrs=self.attributes | {"ring": self.ring, "rolling_speed": u},
        )

    @classmethod
    def run_batch(
        cls, cases: "Sequence[tuple[FrictionCurve, Assembly]]", outputs: frozenset[str]
    ) -> list[PartialResult] | None:
        """Return curves and critical slips of several contacts by one evaluation; None for other outputs.

        Parameters
        ----------
        cases : sequence of tuple of FrictionCurve and Assembly
            Studies and bearings.
        outputs : frozenset of str
            Names of the requested outputs.
        """
        if not outputs <= {
            "friction",
            "critical_slip",
            "critical_friction",
            "critical_status",
            "critical_slip_bound",
            *FIRST,
        }:
            return None
        curves = list[_Curve]()
        grid = cache(slip_grid)
        for study, assembly in cases:
            slip = grid(study.max_slip, study.points)
            u = study.rolling_speed(assembly)
            curves += [(contact, u, slip) for contact in study.contacts(assembly)]
        friction = _friction(curves)
        critical = cls._critical(curves, friction)
        results = list[PartialResult]()
        first = 0
        for study, _ in cases:
            own = slice(first, first + len(study.normal_force))
            known = friction[own] if "friction" in outputs else None
            results.append(study._curve_variables(curves[first][2], known, critical[own]))
            first = own.stop
        return results

    @classmethod
    def _critical(cls, curves: Sequence[_Curve], friction: Sequence[Array]) -> list[Critical]:
        """Return the critical slips of curves, the slips of the largest friction."""
        key = f"study.{cls.name}.max_slip"
        return find_critical_slips(
            [
                Curve(slip, known, key, max_slip=PURE_SLIDING)
                for (*_, slip), known in zip(curves, friction, strict=True)
            ],
            lambda requested: _friction([(*curves[k][:2], slip) for k, slip in requested]),
        )

    def _curve_variables(
        self, slip: Array, friction: Sequence[Array] | None, critical: Sequence[Critical]
    ) -> PartialResult:
        """Return variables and coordinates of the maxima of curves, and of curves whose friction is known."""
        curves = {} if friction is None else self.variables(friction=np.stack(friction))
        columns = map(np.array, zip(*map(attrs.astuple, critical), strict=True))
        # in the order of the fields of `Critical`
        names = (
            "critical_slip",
            "critical_friction",
            "critical_status",
            *FIRST,
            "critical_slip_bound",
        )
        return curves | self.variables(**dict(zip(names, columns, strict=True))), {
            "normal_force": (
                "normal_force",
                np.array(self.normal_force),
                about("N", "normal force of the contact"),
            ),
            "slip": ("slip", slip, about("1", "slide-roll ratio V/u")),
        }


def balanced_load(assembly: Assembly, raceway: Raceway, force: float) -> Array:
    """Return the load per length [N/m] of the slices of an aligned contact with a normal force [N], (slices,)."""
    if assembly.slices == 1:
        return np.array([force / assembly.scene.bearing.roller_length])
    # approaches are measured from the first contact, else small ones are lost in rounding errors
    drop = assembly.drop - assembly.drop.min()
    load = _balanced(
        lambda approach: assembly.deflect(approach - drop, raceway.ring), assembly.widths, force
    )
    if not np.any(load > 0.0):
        raise DomainError(
            f"a normal force of {force:g} N is lost along a roller of "
            f"{format_quantity(assembly.scene.bearing.roller_length, 'm')}: its load per length is below all floats; "
            "give more of it"
        )
    return load


def _balanced(
    deflection: Callable[[float], tuple[Array, Array]], widths: Array, force: float
) -> Array:
    """Return the loads that carry a force, by Newton's method over the approach with bisection as a safeguard."""
    low = 0.0
    high = np.inf
    approach = 1e-6
    while True:
        load, stiffness = deflection(approach)
        # far above the root of a tiny force the load overflows
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            excess = float((load * widths / force).sum()) - 1.0
            step = excess / float((stiffness * widths / force).sum())
        if excess > 0.0:
            high = approach
        else:
            low = approach
        guess = approach - step
        if not low < guess < high:  # also where the step is NaN
            guess = 0.5 * (low + high) if high < np.inf else 2.0 * approach
        if (
            abs(guess - approach) <= _APPROACH_TOLERANCE * approach
            or excess == 0.0
            or not low < guess < high
        ):
            return load
        approach = guess


def _friction(cases: Sequence[tuple[LoadedContacts, float, Array]]) -> list[Array]:
    """Return friction of contacts at their entrainment speeds [m/s] and slide-roll ratios, (n,) each."""
    return mean_friction(
        [(contacts, np.full(slip.size, u), slip * u) for contacts, u, slip in cases]
    )


def _heaviest_slice(contacts: LoadedContacts, u: float, slip: Array) -> dict[str, Any]:
    """Return film, pressure and regime of the most loaded slice at slide-roll ratios, (n,)."""
    at = int(np.argmax(contacts.load))
    place = {name: column[at] for name, column in contacts.places.items()}
    slices = contacts.raceway.evaluate(np.full(slip.size, contacts.load[at]), u, slip * u, **place)
    M, L = moes_groups(slices)
    return {
        "film_thickness": slices.film_thickness,
        "film_parameter": slices.film_thickness / contacts.raceway.conditions.roughness,
        "regime": film_by_regime(*groups(slices))[1].astype(np.int8),
        "half_width": slices.half_width[0],
        "pressure": slices.pressure[0],
        "load_parameter": M[0],
        "lubricant_parameter": L[0],
    }
