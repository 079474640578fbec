"""Study surface-damage: what slip does to the surfaces at the steady slip of a bearing, by ring and place of a roller.

- ``models.damage`` names one measure or several; where it names none, nothing is computed.
- Measures are taken on every loaded slice at all positions of the orbit. Told is the worst of the slices of a roller at
  each position, and the worst of all. How far that is off is seen on more slices and instants at once, at the steady
  slip that these lead to; between slices, the worst of the finer ones is that of a parabola.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, LoadedContacts
from rollslip.errors import DomainError
from rollslip.fields import at_least, in_range, parameter
from rollslip.results.dataset import about
from rollslip.studies.answers import (
    ComparedValues,
    LoadedSlices,
    Output,
    Part,
    ResolutionChoice,
    RunContext,
)
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip.studies.surface_damage.model import (
    DESCRIBED,
    OWN,
    Array,
    Contacts,
    DamageModel,
    damage_of,
    described,
    harm,
    named,
    parts,
    values_of,
)
from rollslip.studies.timing import processor_time
from rollslip_studies.motion.torque_balance import Orbit
from rollslip_studies.steady_slip.evaluated import (
    choose_by_torques,
    estimate_by_secant,
    evaluated_slices,
)
from rollslip_studies.steady_slip.study import SteadySlip

if TYPE_CHECKING:
    import xarray as xr

#: Share of the largest slip at which a motion is processor_time, and how many of them a steady slip takes.
_TRIED = 0.3
_ORBITS = 30
#: Parts of a resolution that change films and widths of contacts.
_OF_CONTACTS: Final = ("inlet_heating", "light_contacts")
#: What was found where everything was.
_FOUND: Final = "found"


@attrs.frozen(kw_only=True)
class SurfaceDamage(Study):
    """What slip does to the surfaces at the steady slip, and where it is worst."""

    name: ClassVar[str] = "surface-damage"
    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            "worst": Output(
                "measure ring",
                OWN,
                "worst value of all contacts",
                status="worst_status",
                default=True,
            ),
            "worst_angle": Output(
                "measure ring", "rad", "position of the roller there", status="worst_status"
            ),
            "worst_place": Output(
                "measure ring", "m", "place along the roller there", status="worst_status"
            ),
            "worst_status": Output("measure ring", "1", "what was found of the measure"),
            **DESCRIBED,
            "along": Output(
                "measure ring angle", OWN, "worst value on a roller", status="worst_status"
            ),
            "across": Output(
                "measure ring place", OWN, "value across the worst contact", status="worst_status"
            ),
            "slip": Output("", "1", "cage slip at which all this is so", status="status"),
            "status": Output("", "1", "what was found"),
        }
    )
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    with_cage: ClassVar[bool] = True
    with_damage: ClassVar[bool] = True
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"run": "the steady slip, and the measures there"}
    )

    cage_slip: float | None = parameter(
        default=None,
        unit="1",
        doc="cage slip at which damage is measured; by default the least steady one",
        validator=attrs.validators.optional(in_range(0.0, 1.0, open=True)),
    )
    places: int = parameter(
        default=81, doc="places across the worst contact that are kept", validator=at_least(3)
    )
    max_cage_slip: float = parameter(
        default=0.9, unit="1", doc="largest cage slip", validator=in_range(0.0, 1.0, open=True)
    )
    inertia: bool = parameter(
        default=True, doc="whether the spin of a roller has inertia along the orbit"
    )

    @property
    def _steady(self) -> SteadySlip:
        return SteadySlip(max_cage_slip=self.max_cage_slip, inertia=self.inertia)

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices, instants and laws as for the torques of a steady slip; nothing where nothing is measured.

        Nothing is left out of films and widths of contacts: measures see these where torques do not.
        """
        if not assembly.scene.models.damage:
            return ResolutionChoice(resolution=assembly.resolution)
        found = choose_by_torques(self._steady, assembly, cheaper_laws=cheaper_laws)
        whole = attrs.evolve(found.resolution, inlet_heating=True, light_contacts=True)
        if (
            assembly.scene.accuracy.slices is None
        ):  # which go closer to the end of a roller, where the worst often is
            whole = attrs.evolve(whole, quadrature="gauss")
        left = tuple(bound for bound in found.left_out if bound.reinstated(whole) != whole)
        errors = {part: some for part, some in found.errors.items() if part not in _OF_CONTACTS}
        return attrs.evolve(found, resolution=whole, left_out=left, errors=errors)

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags and the damage models; none where nothing is measured."""
        measures = damage_of(assembly)
        return (
            (*self._steady.models(assembly), *(("damage", model) for model in measures))
            if measures
            else ()
        )

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] from that of one motion of the rollers; measures take next to none."""
        if not assembly.scene.models.damage:
            return {"run": 0.0}
        there = assembly.with_resistance()
        slip = self.cage_slip or _TRIED * self.max_cage_slip
        one = processor_time(lambda: self._steady.balance(there).orbit(slip), 1)
        return {"run": one * (_ORBITS if self.cage_slip is None else 1)}

    def extra_parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: dict[str, float]
    ) -> list[Part]:
        """Return what is measured."""
        return parts(assembly.scene)

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the worst value of each measure on each ring."""
        return {
            f"worst {one['meaning'].item()}, {ring} ring": ComparedValues(
                [[float(one["worst"].sel(ring=ring))]],
                str(one["worst_status"].sel(ring=ring).item()),
            )
            for one in (dataset.isel(measure=k) for k in range(dataset.sizes["measure"]))
            for ring in RINGS
        }

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return by how much the steady slip and the worst value of each measure are off."""
        slip = float(dataset["slip"])
        measures = damage_of(finer)
        if not np.isfinite(slip):
            return {}
        balance = self._steady.balance(finer.with_resistance())

        def worst(orbit: Orbit) -> Array:
            found = np.full((len(measures), len(RINGS)), np.nan)
            for i, (ring, loaded) in enumerate(zip(RINGS, balance.evaluate_contacts(orbit), strict=True)):
                contacts = Contacts.of(finer, ring, loaded.slices)
                for k, model in enumerate(measures):
                    if loaded.total and dataset["worst_status"].values[k, i] == _FOUND:
                        found[k, i] = _worst_between(
                            model, values_of(model, contacts), loaded, finer.position
                        )
            return found

        off = dict[str, float]()
        at = None
        try:
            if self.cage_slip is None and not balance.rolls_freely:
                off["cage slip"], at = estimate_by_secant(balance, slip, worst)
            else:
                at = worst(balance.orbit(slip))
        except DomainError:
            return {f"worst {model.measure}": np.inf for model in measures}
        with np.errstate(all="ignore"):
            apart = np.where(at == dataset["worst"], 0.0, np.abs(dataset["worst"] / at - 1.0))
        for model, errors, known in zip(
            measures, apart, np.isfinite(dataset["worst"].values), strict=True
        ):
            if known.any():
                off[f"worst {model.measure}"] = float(
                    np.nan_to_num(errors[known], nan=np.inf).max()
                )
        return off

    @property
    def validity_state(self) -> str:
        """What state `validity_slices` are at."""
        return (
            "at the steady slip" if self.cage_slip is None else "at study.surface-damage.cage_slip"
        )

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the slices that were measured."""
        slip = float(dataset["slip"])
        if not np.isfinite(slip):
            return []
        balance = self._steady.balance(assembly)
        return evaluated_slices(balance, [balance.orbit(slip)])

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return all measures that the scene names.

        Returns
        -------
        xarray.Dataset
            Dimensions (measure, ring): worst, worst_angle, worst_place from the middle of the roller, worst_status;
            (measure,): limit, limit_source, unit, meaning, sense, scope; (measure, ring, angle): along, NaN where a
            roller is not loaded; (measure, ring, place): across, from the inlet at -1 to the outlet at 1, NaN where a
            measure has one value for a contact; scalars slip, status. Values are in the SI unit that `unit` names.
            Without a measure there is no row.

        Raises
        ------
        SceneError
            If the cage is wrong, or no roller is loaded on the inner ring.
        DomainError
            If a law has no value at the slip.
        """
        measures = damage_of(assembly)
        if not measures:
            return self._told(assembly, (), np.nan, "models.damage names no measure, so none was taken; name one or "
                              "several, 'rollslip models damage' lists them", None)  # fmt: skip
        there = assembly.with_resistance()
        if self.cage_slip is not None:
            balance = self._steady.balance(there)
            orbit = balance.orbit(self.cage_slip)
        else:
            balance, steady, status = self._steady.steady(there)
            if not steady:
                return self._told(assembly, measures, np.nan, status, None)
            orbit = balance.orbit_from_motion(steady[0].motion)
        return self._told(assembly, measures, orbit.cage_slip, _FOUND, balance.evaluate_contacts(orbit))

    def _told(
        self,
        assembly: Assembly,
        measures: tuple[DamageModel, ...],
        slip: float,
        status: str,
        evaluated: tuple[LoadedContacts, LoadedContacts] | None,
    ) -> "xr.Dataset":
        import xarray as xr

        shape = len(measures), len(RINGS)
        places = np.linspace(-1.0, 1.0, self.places)
        positions = 0 if evaluated is None else evaluated[0].rollers
        angle = 2.0 * np.pi * np.arange(positions) / positions if positions else np.zeros(0)
        (worst, where, beside) = np.full((3, *shape), np.nan)
        said = np.full(shape, status, dtype=object)
        along = np.full((*shape, positions), np.nan)
        across = np.full((*shape, self.places), np.nan)
        for k, model in enumerate(measures):
            for i, (ring, loaded) in enumerate(zip(RINGS, evaluated or (), strict=False)):
                if loaded.total == 0.0:
                    said[k, i] = f"no roller is loaded on the {ring} ring"
                    continue
                contacts = Contacts.of(assembly, ring, loaded.slices)
                try:
                    along[k, i], worst[k, i], at, across[k, i] = _measured(
                        model, contacts, loaded, places
                    )
                except DomainError as error:  # of one measure; the others have values
                    said[k, i] = str(error)
                    continue
                where[k, i] = angle[loaded.owner[at]]
                beside[k, i] = assembly.position[loaded.column[at]]
        variables = self.variables(
            worst=worst,
            worst_angle=where,
            worst_place=beside,
            worst_status=said.astype(np.str_),
            **described(measures),
            along=along,
            across=across,
            slip=slip,
            status=status,
        )
        coords = {
            "measure": named(measures),
            "ring": ("ring", np.array(RINGS), about("1", "ring")),
            "angle": (
                "angle",
                angle,
                about("rad", "position from the line of load, in the sense of the orbit"),
            ),
            "place": (
                "place",
                places,
                about("1", "place in half widths, from the inlet to the outlet"),
            ),
        }
        return xr.Dataset(variables, coords, attrs=self.attributes)


def _measured(
    model: DamageModel, contacts: Contacts, loaded: LoadedContacts, places: Array
) -> tuple[Array, float, int, Array]:
    """Return the worst value of each roller, NaN where it is not loaded, of all, its slice, and across that."""
    values = values_of(model, contacts)
    along = np.full(loaded.rollers, np.nan)
    np.fmax.at(along, loaded.owner, harm(model, values))
    at = int(np.nanargmax(harm(model, values)))
    inside = model.across(attrs.evolve(contacts, slices=contacts.slices.taken([at])), places)
    across = np.full(places.size, np.nan) if inside is None else np.asarray(inside[0], dtype=float)
    return harm(model, along), float(values[at]), at, across


def _worst_between(
    model: DamageModel, values: Array, loaded: LoadedContacts, position: Array
) -> float:
    """Return the worst value, at the vertex of a parabola through its slice and the neighbours on the roller."""
    at = int(np.nanargmax(harm(model, values)))
    near = np.array([at - 1, at, at + 1])
    if (
        near[0] < 0
        or near[2] >= values.size
        or np.ptp(loaded.owner[near])
        or np.isnan(values[near]).any()
    ):
        return float(values[at])  # at an end
    x = position[loaded.column[near]] - position[loaded.column[at]]
    curvature, slope, _ = np.polyfit(x / np.ptp(x), harm(model, values[near] - values[at]), 2)
    beyond = 0.25 * slope**2 / curvature if curvature < 0.0 else 0.0
    return float(values[at] - harm(model, beyond))
