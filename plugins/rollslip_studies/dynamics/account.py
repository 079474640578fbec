"""The account of a motion in time."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account, Contact, Table
from rollslip.results.answer import Answer
from rollslip_studies.dynamics import findings, history_findings
from rollslip_studies.steady_slip.account import next_of_others
from rollslip_studies.surface_damage import findings as damage

if TYPE_CHECKING:
    import xarray as xr


class DynamicsAccount(Account):
    """How a motion is told: with its energy ledger and its events."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "level": ("level of the motion", ""),
        "friction": ("friction of the motion", ""),
        "integrator": ("integrator", ""),
        "steps": ("steps", ""),
        "rejected": ("steps rejected", ""),
        "rate_evaluations": ("evaluations of the rates", ""),
        "jacobians": ("Jacobians", ""),
        "contacts_evaluated": ("contacts evaluated in the motion", ""),
        "real_time_factor": ("time of the motion over that of its integration", "1"),
    }
    units: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("end_time", "largest_cage_slip_time", "least_cage_slip_time", "least_margin_time", "time",
                         "time_beyond_runaway"), "s"),
        **dict.fromkeys(("critical_cage_slip", "energy_closure", "final_cage_slip", "largest_cage_slip",
                         "least_cage_slip", "least_margin_to_runaway", "momentum_closure", "runaway_slip",
                         "smallest_film_parameter_inner", "smallest_film_parameter_outer", "steady_cage_slip"), "1"),
        **dict.fromkeys(("energy_turned_over", "frictional_work_inner", "frictional_work_outer", "heat_carried_away",
                         "heat_made", "heat_stored"), "J"),
        "runaway_drag": "N m", "sliding_distance_inner": "m", "sliding_distance_outer": "m",
        "final_temperatures": "K", "hottest_temperature": "K",
    }  # fmt: skip
    drawn = "rollslip_studies.dynamics.figures:motion_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the slip at the end, along a history the largest, and measures of damage on the way."""
        row = history_findings.row(dataset) if history_findings.along(dataset) else findings.row(dataset)
        cut = dataset.attrs["outcome"] in ("failed", "interrupted")
        faults = (findings.outcome(dataset).partition(": ")[2],) if cut else ()
        return Answer(rows=(row, *damage.rows(dataset)), commands=next_of_others(dataset), faults=faults)

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about."""
        return history_findings.told(dataset, findings.topics(dataset)) | damage.over_motion(dataset)

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values."""
        return {
            **findings.record(dataset),
            **history_findings.record(dataset),
            **history_findings.heat_record(dataset),
            **damage.record(dataset),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the energy ledger and the events."""
        return [
            Table("Energy ledger", *findings.ledger_table(dataset)),
            Table("Events", *findings.events_table(dataset)),
        ]

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts with both rings."""
        return [Contact(f"{ring} ring", "", film) for ring, film in findings.smallest_film(dataset).items()]


@hookimpl
def accounts() -> list[Account]:
    """Return how these results are told."""
    return [DynamicsAccount("dynamics")]
