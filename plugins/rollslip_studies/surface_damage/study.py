"""Study surface-damage: measures of damage by slip at the steady slip of a bearing, by ring and position of a roller.

- ``models.damage`` names the measures, by default power density and flash temperature (`_DEFAULT_MEASURES`).
- Measures are evaluated on every loaded slice at all roller positions of the orbit. Results are the worst value of the
  slices of a roller at each position, and the worst of all.
- Their error is that against more slices and roller positions at once, at the steady slip with these. The finer worst
  value is that of a parabola through the worst slice and its neighbours.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, LoadedContacts
from rollslip.catalogue.registry import get_model
from rollslip.errors import DomainError
from rollslip.fields import at_least, in_range, parameter
from rollslip.results.dataset import about, xr
from rollslip.results.text import Status
from rollslip.search import Array
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

#: Fraction of the largest slip at which the time of an orbit is measured for the estimate of the cost. Doubled, the
#: time hardly changes. Chosen.
_TIMED_SLIP_FRACTION = 0.3
#: Typical number of orbits for a steady slip, for the estimate of the cost, which is proportional to it. Chosen.
_TYPICAL_ORBITS = 30
#: Measures where a scene names none: the two that need no further data of oil or rig.
_DEFAULT_MEASURES: Final = ("power-density", "flash-temperature")
#: Parts of a resolution that change films and widths of contacts, which measures require.
_CONTACT_PARTS: Final = ("inlet_heating", "light_contacts")


@attrs.frozen(kw_only=True)
class SurfaceDamage(Study):
    """Measures of damage by slip at the steady slip, and where they are worst."""

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
                "measure ring",
                "rad",
                "orbital position of the roller with the worst value",
                status="worst_status",
            ),
            "worst_place": Output(
                "measure ring",
                "m",
                "position of the worst value along the roller",
                status="worst_status",
            ),
            "worst_status": Output("measure ring", "1", "status of the measure"),
            **DESCRIBED,
            "along": Output(
                "measure ring angle", OWN, "worst value on a roller", status="worst_status"
            ),
            "across": Output(
                "measure ring place", OWN, "value across the worst contact", status="worst_status"
            ),
            "slip": Output("", "1", "cage slip at which damage is measured", status="status"),
            "slip_without_play": Output(
                "", "1", "slip of rollers set in the cage that carry the same drag", status="status"
            ),
            "play_status": Output("", "1", "what was found of rollers with play in their pockets"),
            "status": Output("", "1", "status of the slip"),
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
        doc="cage slip at which damage is measured; by default the smallest steady one",
        validator=attrs.validators.optional(in_range(0.0, 1.0, open=True)),
    )
    places: int = parameter(
        default=81, doc="number of positions across the worst contact", validator=at_least(3)
    )
    max_cage_slip: float = parameter(
        default=0.9, unit="1", doc="largest cage slip", validator=in_range(0.0, 1.0, open=True)
    )
    inertia: bool = parameter(
        default=True, doc="whether the spin of a roller has inertia along the orbit"
    )

    @property
    def _steady(self) -> SteadySlip:
        """Study that finds the steady slip."""
        return SteadySlip(
            max_cage_slip=self.max_cage_slip, inertia=self.inertia, acceptable_slip=None
        )

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices, roller positions and laws as for the torques of a steady slip.

        Effects on films and half widths are not left out: measures depend on them even where torques do not.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        cheaper_laws : bool, optional
            Whether cheaper laws may be chosen.
        """
        found = choose_by_torques(self._steady, assembly, cheaper_laws=cheaper_laws)
        resolution = attrs.evolve(found.resolution, inlet_heating=True, light_contacts=True)
        if assembly.scene.accuracy.slices is None:
            # Gauss points are closer to the end of a roller, where the worst value often is
            resolution = attrs.evolve(resolution, quadrature="gauss")
        left_out = tuple(
            bound for bound in found.left_out if bound.reinstated(resolution) != resolution
        )
        return attrs.evolve(
            found,
            resolution=resolution,
            left_out=left_out,
            errors={
                name: error for name, error in found.errors.items() if name not in _CONTACT_PARTS
            },
        )

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags and the damage models, each with its kind."""
        return *self._steady.models(assembly), *(("damage", model) for model in _measures(assembly))

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the processor time [s] of the run, from that of one orbit; measures take next to nothing."""
        resisted = assembly.with_resistance()
        slip = self.cage_slip or _TIMED_SLIP_FRACTION * self.max_cage_slip
        seconds = processor_time(lambda: self._steady.balance(resisted).orbit(slip), 1)
        return {"run": seconds * (_TYPICAL_ORBITS if self.cage_slip is None else 1)}

    def extra_parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: dict[str, float]
    ) -> list[Part]:
        """Return the lines of a plan about the measures.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        estimated : ResolutionChoice
            The choices.
        costs : dict of str to float
            Processor times [s] by name.
        """
        if not assembly.scene.models.damage:
            return parts(_measures(assembly), "default")
        return parts(damage_of(assembly))

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the worst value of each measure on each ring."""
        return {
            f"worst {measure['meaning'].item()}, {ring} ring": ComparedValues(
                [[float(measure["worst"].sel(ring=ring))]],
                str(measure["worst_status"].sel(ring=ring).item()),
            )
            for measure in (dataset.isel(measure=k) for k in range(dataset.sizes["measure"]))
            for ring in RINGS
        }

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return the relative errors of the steady slip and of the worst value of each measure, by name.

        Parameters
        ----------
        finer : Assembly
            The bearing with a finer resolution.
        dataset : xarray.Dataset
            The result.
        """
        slip = float(dataset["slip"])
        measures = _measures(finer)
        if not np.isfinite(slip):
            return {}
        balance = self._steady.balance(finer.with_resistance())

        def worst(orbit: Orbit) -> Array:
            found = np.full((len(measures), len(RINGS)), np.nan)
            for i, (ring, loaded) in enumerate(
                zip(RINGS, balance.evaluate_contacts(orbit), strict=True)
            ):
                contacts = Contacts.of(finer, ring, loaded.slices)
                for k, model in enumerate(measures):
                    if loaded.total and dataset["worst_status"].values[k, i] == Status.FOUND:
                        found[k, i] = _worst_between(
                            model, values_of(model, contacts), loaded, finer.position
                        )
            return found

        errors = dict[str, float]()
        reference = None
        try:
            if self.cage_slip is None and not balance.rolls_freely:
                errors["cage slip"], reference = estimate_by_secant(balance, slip, worst)
            else:
                reference = worst(balance.orbit(slip))
        except DomainError:
            return {f"worst {model.measure}": np.inf for model in measures}
        with np.errstate(all="ignore"):
            ratio = np.abs(dataset["worst"] / reference - 1.0)
            deviation = np.where(reference == dataset["worst"], 0.0, ratio)
        for model, row, known in zip(
            measures, deviation, np.isfinite(dataset["worst"].values), strict=True
        ):
            if known.any():
                largest = np.nan_to_num(row[known], nan=np.inf).max()
                errors[f"worst {model.measure}"] = float(largest)
        return errors

    @property
    def validity_state(self) -> str:
        """State of the `validity_slices`."""
        if self.cage_slip is None:
            return "at the steady slip"
        return "at study.surface-damage.cage_slip"

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the slices that were measured.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        dataset : xarray.Dataset
            The result.
        """
        slip = float(dataset.get("slip_without_play", dataset["slip"]))
        if not np.isfinite(slip):
            return []
        balance = self._steady.balance(assembly)
        return evaluated_slices(balance, [balance.orbit(slip)])

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return all measures that the scene names, or the default ones.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        context : RunContext, optional
            Without effect.

        Returns
        -------
        xarray.Dataset
            Dimensions (measure, ring): worst, worst_angle, worst_place from the middle of the roller, worst_status;
            (measure,): limit, limit_source, unit, meaning, sense, scope; (measure, ring, angle): along, NaN where a
            roller is not loaded; (measure, ring, place): across, from the inlet at -1 to the outlet at 1, NaN where a
            measure has one value for a contact; scalars slip, status. Values are in the SI unit that `unit` names.

        Raises
        ------
        SceneError
            If the cage is wrong, or no roller is loaded on the inner ring.
        DomainError
            If a law has no value at the slip.
        """
        measures = _measures(assembly)
        resisted = assembly.with_resistance()
        if self.cage_slip is not None:
            balance = self._steady.balance(resisted)
            orbit = balance.orbit(self.cage_slip)
        else:
            balance, steady, status = self._steady.steady(resisted)
            if not steady:
                return self._dataset(assembly, measures, np.nan, status, None)
            orbit = balance.orbit_from_motion(steady[0].motion)
        return self._dataset(
            assembly, measures, orbit.cage_slip, Status.FOUND, balance.evaluate_contacts(orbit)
        )

    def completed(self, assembly: Assembly, dataset: "xr.Dataset") -> "xr.Dataset":
        """Return the result with the steady slip with play in the pockets, as that of `SteadySlip`.

        Measures are those of rollers set in the cage at the slip at which these carry the same drag.

        Parameters
        ----------
        assembly : Assembly
            The bearing of the result.
        dataset : Dataset
            The result of `run`.
        """
        without = float(dataset["slip"])
        if self.cage_slip is not None or math.isnan(without):
            return dataset
        slip, play_status = self._steady.with_play(assembly, without)
        return dataset.assign(
            self.variables(
                slip=slip,
                slip_without_play=without,
                play_status=str(play_status),
                status=play_status if math.isnan(slip) else str(Status.FOUND),
            )
        )

    def _dataset(
        self,
        assembly: Assembly,
        measures: tuple[DamageModel, ...],
        slip: float,
        status: str,
        evaluated: tuple[LoadedContacts, LoadedContacts] | None,
    ) -> "xr.Dataset":
        """Return the measures at a slip as dataset; NaN with a status without evaluated contacts."""
        shape = len(measures), len(RINGS)
        places = np.linspace(-1.0, 1.0, self.places)
        positions = 0 if evaluated is None else evaluated[0].rollers
        angle = 2.0 * np.pi * np.arange(positions) / positions
        worst, worst_angle, worst_place = np.full((3, *shape), np.nan)
        statuses = np.full(shape, str(status), dtype=object)
        along = np.full((*shape, positions), np.nan)
        across = np.full((*shape, self.places), np.nan)
        for k, model in enumerate(measures):
            for i, (ring, loaded) in enumerate(zip(RINGS, evaluated or (), strict=False)):
                if loaded.total == 0.0:
                    statuses[k, i] = f"no roller is loaded on the {ring} ring"
                    continue
                contacts = Contacts.of(assembly, ring, loaded.slices)
                try:
                    along[k, i], worst[k, i], index, across[k, i] = _measure(
                        model, contacts, loaded, places
                    )
                except DomainError as error:  # the other measures may have values
                    statuses[k, i] = str(error)
                    continue
                worst_angle[k, i] = angle[loaded.owner[index]]
                worst_place[k, i] = assembly.position[loaded.column[index]]
        variables = self.variables(
            worst=worst,
            worst_angle=worst_angle,
            worst_place=worst_place,
            worst_status=statuses.astype(np.str_),
            **described(measures),
            along=along,
            across=across,
            slip=slip,
            status=str(status),
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


def _measures(assembly: Assembly) -> tuple[DamageModel, ...]:
    """Return the measures that the scene names, or the default ones, with the data of the bearing."""
    return damage_of(assembly) or tuple(
        get_model("damage", name).of(assembly) for name in _DEFAULT_MEASURES
    )


def _measure(
    model: DamageModel, contacts: Contacts, loaded: LoadedContacts, places: Array
) -> tuple[Array, float, int, Array]:
    """Return the worst value of each roller, NaN without load; that of all, its index, and the values across it."""
    values = values_of(model, contacts)
    along = np.full(loaded.rollers, np.nan)
    np.fmax.at(along, loaded.owner, harm(model, values))
    index = int(np.nanargmax(harm(model, values)))
    inside = model.across(attrs.evolve(contacts, slices=contacts.slices.taken([index])), places)
    across = np.full(places.size, np.nan) if inside is None else np.asarray(inside[0], dtype=float)
    return harm(model, along), float(values[index]), index, across


def _worst_between(
    model: DamageModel, values: Array, loaded: LoadedContacts, position: Array
) -> float:
    """Return the worst value, at the vertex of a parabola through the worst slice and its neighbours on the roller."""
    index = int(np.nanargmax(harm(model, values)))
    worst = values[index]
    nearest = np.array([index - 1, index, index + 1])
    if (
        nearest[0] < 0
        or nearest[2] >= values.size
        or np.ptp(loaded.owner[nearest])
        or np.isnan(values[nearest]).any()
    ):
        return float(worst)  # the slice at the end of a roller
    x = position[loaded.column[nearest]] - position[loaded.column[index]]
    curvature, slope, _ = np.polyfit(x / np.ptp(x), harm(model, values[nearest] - worst), 2)
    excess = 0.25 * slope**2 / curvature if curvature < 0.0 else 0.0
    return float(worst - harm(model, excess))
