"""Study effective-friction: friction of each raceway as a whole against cage slip, and the critical cage slip.

- One revolution is one to two orders shorter than the cage's transient, so a raceway acts on the cage through its
  effective friction mu_e = sum(mu_km Q_km)/sum(Q_km) over its *loaded* contacts k and the instants m of a revolution
  (Klebanov et al. 2022); averaging unloaded rollers in is a known mistake. With slices the sum runs over them too.
- Equal rollers repeat after one pitch, so the instants are spread over a pitch and doubled until the curve and its
  maximum stand still; what the last doubling still moved is reported.
- Effective friction is positive where it drives the cage towards its epicyclic speed. With the outer ring driving that
  is against the direction in which rolling speeds are positive, hence the sign in ``LoadedContacts``.
- The map over cage slip and roller slip, which needs no closure, is stored beside the curve.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from rollslip.bearing.assembly import RINGS, Array, Assembly
from rollslip.bearing.critical import Critical, slip_grid
from rollslip.bearing.equilibrium import LoadDistribution
from rollslip.bearing.kinematics import SurfaceSpeeds
from rollslip.bearing.raceway import PROBES, LoadedContacts
from rollslip.errors import ConvergenceError
from rollslip.fields import at_least, in_range, one_of, parameter
from rollslip.results.dataset import about
from rollslip.studies.friction_curve.study import Only
from rollslip.studies.raceways import LoadedRaceways, evaluated_together, largest_change, regime_variables

if TYPE_CHECKING:
    import xarray as xr

#: Doublings start here and give up there.
_FIRST_INSTANTS, _MOST_INSTANTS = 2, 1024


@attrs.frozen(kw_only=True)
class EffectiveFriction:
    """Settings of the study."""

    closure: str = parameter(
        default="epicyclic",
        doc="what the rollers spin at",
        validator=one_of("outer-rolling", "epicyclic", "free-roller"),
    )
    max_cage_slip: float = parameter(
        default=0.4, unit="1", doc="largest cage slip", validator=in_range(0.0, 1.0, open=True)
    )
    points: int = parameter(default=101, doc="cage slips of the curve, denser towards zero", validator=at_least(5))
    map_points: int = parameter(
        default=15, doc="cage slips, and roller slips either way, of the map; 0 for none", validator=at_least(0)
    )
    per_roller: bool = parameter(default=False, doc="store the friction of every roller at the first instant")

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate: curve, maximum, error of the slices, and map."""
        loads = assembly.load_distribution(1)
        half = loads.psi.size // 2 + 1
        contacts = sum(
            LoadedContacts(raceway, load[0, :half], assembly.widths, 1.0).force.size
            for raceway, load in ((assembly.inner, loads.inner_load), (assembly.outer, loads.outer_load))
        )
        instants = 2 * _FIRST_INSTANTS  # at which most curves stand still
        per_point = 12 if self.closure == "free-roller" else 1
        curves = (_FIRST_INSTANTS + instants) * (self.points + 15) + instants // 2 * self.points
        surface = self.map_points * max(2 * self.map_points - 1, 0)
        return contacts * (curves * per_point + instants * PROBES * bool(surface)) + 2 * 16 * surface

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return nothing: contacts are all there is."""
        return ()

    def run(self, assembly: Assembly) -> "xr.Dataset":
        """Return the effective friction curves, the critical cage slip and the map.

        Returns
        -------
        xarray.Dataset
            Dimensions (ring, cage_slip): effective_friction, sliding_speed, rolling_speed, film_parameter (smallest),
            roller_slip; (ring,): critical_cage_slip, critical_friction, critical_status; (ring, map_cage_slip,
            map_roller_slip): friction_map; (ring, roller): normal_force at the first instant and, on request,
            (ring, roller, cage_slip): roller_friction, NaN where the roller is not loaded.

        Raises
        ------
        SceneError
            If no roller is loaded on the inner ring.
        DomainError
            If a contact rolls backwards at a cage slip of the range, or a law has no value there.
        ConvergenceError
            If doubling the instants does not settle the curve, or the radial load is lost beside centrifugal forces.
        """
        if assembly.resolution.instants is not None:
            return self.at_instants(assembly, assembly.resolution.instants)
        slip = slip_grid(self.max_cage_slip, self.points)
        raceways, curves, critical, error = self._converged(assembly, slip)
        errors = {"instants_error": error, "slices_error": raceways.slices_error(slip, curves[0])}
        return self._dataset(assembly, raceways, slip, curves, critical).assign_attrs(errors)

    @staticmethod
    def together(cases: "Sequence[tuple[EffectiveFriction, Assembly]]", names: frozenset[str]) -> list[Only] | None:
        """Return what `run` does of curves and critical slips, for several bearings at once; None if more is asked."""
        if not names <= {"effective_friction", "critical_cage_slip", "critical_friction", "critical_status"}:
            return None
        found = dict[int, tuple[Array, Array, tuple[Critical, Critical]]]()
        begun = list[tuple[int, Array, LoadedRaceways, SurfaceSpeeds]]()
        for k, (study, assembly) in enumerate(cases):
            slip, instants = slip_grid(study.max_cage_slip, study.points), assembly.resolution.instants
            if instants is None:
                _, (friction, _), critical, _ = study._converged(assembly, slip)
                found[k] = slip, friction, critical
            else:
                raceways = study.loaded(assembly, instants)
                begun.append((k, slip, raceways, raceways.speeds(slip)))
        curves = evaluated_together([(raceways, speeds) for *_, raceways, speeds in begun])
        for (k, slip, raceways, _), (friction, _) in zip(begun, curves, strict=True):
            found[k] = slip, friction, raceways.critical(slip, friction)
        return [_curves(*found[k]) for k in range(len(cases))]

    def at_instants(self, assembly: Assembly, instants: int) -> "xr.Dataset":
        """Return what `run` does, on a given number of instants, but for the errors that instants and slices leave."""
        slip = slip_grid(self.max_cage_slip, self.points)
        raceways, curves, critical = self._on(assembly, slip, instants)
        return self._dataset(assembly, raceways, slip, curves, critical)

    def _on(
        self, assembly: Assembly, slip: Array, instants: int
    ) -> tuple[LoadedRaceways, tuple[Array, Array], tuple[Critical, Critical]]:
        """Raceways, curves of friction and film, and critical slips on a number of instants."""
        raceways = self.loaded(assembly, instants)
        curves = raceways.evaluated(raceways.speeds(slip))
        return raceways, curves, raceways.critical(slip, curves[0])

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        return self.max_cage_slip

    @property
    def averaged(self) -> bool:
        """Whether the curves are means over the instants of a pitch."""
        return True

    def curves(self, assembly: Assembly, slip: Array, instants: Sequence[int]) -> Array:
        """Return effective friction on few of the instants of a pitch, each a part of the most, (k, 2, n)."""
        raceways = self.loaded(assembly, max(instants))
        found = np.empty((len(instants), 2, slip.size))
        for k, both in enumerate(raceways.contacts(raceways.speeds(slip))):
            for ring, (contacts, u, V) in enumerate(both):
                pull = contacts.per_roller(contacts.friction(u, V) * contacts.force)
                force = contacts.per_roller(contacts.force)
                for i, m in enumerate(instants):  # of every M/m-th position of the orbit
                    some = slice(None, None, max(instants) // m)
                    found[i, ring, k] = pull[some].sum() / force[some].sum() if force[some].any() else np.nan
        return found

    def loaded(self, assembly: Assembly, instants: int, known: LoadDistribution | None = None) -> LoadedRaceways:
        """Return the loaded contacts at a number of instants of a pitch; those at half as many may be known."""
        return LoadedRaceways(assembly, assembly.load_distribution(instants, known=known), self.closure)

    def _converged(
        self, assembly: Assembly, slip: Array
    ) -> tuple[LoadedRaceways, tuple[Array, Array], tuple[Critical, Critical], float]:
        """Double the instants until neither the curves nor the critical slips move by more than the tolerance."""
        tolerance = assembly.scene.accuracy.tolerance
        before: tuple[Array, tuple[Critical, Critical]] | None = None
        known: LoadDistribution | None = None
        instants, moved = _FIRST_INSTANTS, np.inf
        while instants <= _MOST_INSTANTS:
            raceways = self.loaded(assembly, instants, known)
            known = raceways.distribution
            curves = friction, _ = raceways.evaluated(raceways.speeds(slip))
            critical = raceways.critical(slip, friction)
            if before is not None:
                moved = max(largest_change(before[0], friction), *map(_critical_moved, before[1], critical))
                if moved <= tolerance:
                    return raceways, curves, critical, moved
            before, instants = (friction, critical), 2 * instants
        raise ConvergenceError(
            f"effective friction still moves by {moved:.1e} (relative) from {_MOST_INSTANTS // 2} to {_MOST_INSTANTS} "
            f"instants of a pitch; raise accuracy.tolerance, which is {tolerance:g}"
        )

    def _dataset(
        self,
        assembly: Assembly,
        raceways: LoadedRaceways,
        slip: Array,
        curves: tuple[Array, Array],
        critical: tuple[Critical, Critical],
    ) -> "xr.Dataset":
        import xarray as xr

        speeds = raceways.speeds(slip)
        means, (friction, film) = raceways.means(speeds), curves
        loads = raceways.distribution
        curve, rollers = ("ring", "cage_slip"), ("ring", "roller")
        forces = np.stack([loads.inner_force[0], loads.outer_force[0]])
        found, coords = _curves(slip, friction, critical)
        variables: dict[str, Any] = {
            **found,
            "roller_slip": (curve, means["roller_slip"], about("1", "roller slip, mean over the loaded contacts")),
            "sliding_speed": (curve, means["sliding_speed"], about("m/s", "sliding speed, mean over them")),
            "rolling_speed": (curve, means["rolling_speed"], about("m/s", "rolling speed, mean over them")),
            "film_parameter": (curve, film, about("1", "smallest film parameter Lambda")),
            **regime_variables(*raceways.regimes(speeds)),
            "normal_force": (rollers, forces, about("N", "normal force at the first instant")),
            "angle": ("roller", loads.psi[0], about("rad", "position from the line of load, first instant")),
        }
        coords["roller"] = ("roller", np.arange(forces.shape[1]), about("1", "roller"))
        if self.per_roller:
            variables["roller_friction"] = (
                ("ring", "roller", "cage_slip"),
                raceways.per_roller(slip),
                about("1", "friction coefficient of each roller, first instant"),
            )
        if self.map_points:
            cage, roller, surface = raceways.map(self.max_cage_slip, self.map_points)
            variables["friction_map"] = (
                ("ring", "map_cage_slip", "map_roller_slip"),
                surface,
                about("1", "effective friction coefficient"),
            )
            coords["map_cage_slip"] = ("map_cage_slip", cage, about("1", "cage slip"))
            coords["map_roller_slip"] = ("map_roller_slip", roller, about("1", "roller slip"))
        return xr.Dataset(
            variables,
            coords,
            attrs={
                "study": "effective-friction",
                "closure": self.closure,
                "instants": int(loads.psi.shape[0]),
                "slices": assembly.slices,
                "force_residual": loads.force_residual,
                "moment_residual": loads.moment_residual,
            },
        )


def _curves(slip: Array, friction: Array, critical: tuple[Critical, Critical]) -> Only:
    """Variables of the curves and their maxima, and their coordinates."""
    return {
        "effective_friction": (("ring", "cage_slip"), friction, about("1", "effective friction coefficient")),
        "critical_cage_slip": (
            "ring",
            np.array([c.slip for c in critical]),
            about("1", "cage slip of the largest effective friction"),
        ),
        "critical_friction": (
            "ring",
            np.array([c.friction for c in critical]),
            about("1", "largest effective friction coefficient"),
        ),
        "critical_status": (
            "ring",
            np.array([c.status for c in critical]),
            about("1", "what was found of the critical slip"),
        ),
    }, {
        "ring": ("ring", np.array(RINGS), about("1", "ring")),
        "cage_slip": ("cage_slip", slip, about("1", "cage slip")),
    }


def _critical_moved(before: Critical, after: Critical) -> float:
    if np.isnan(before.slip) != np.isnan(after.slip):
        return np.inf
    return 0.0 if np.isnan(after.slip) else abs(after.slip / before.slip - 1.0)
