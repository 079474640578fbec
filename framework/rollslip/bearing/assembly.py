"""Assemble the bearing of a scene: models found by name, the oil at its temperature, one chain of laws per raceway.

1. Read the oil (`read_oil`), and construct the models that the scene names (`_structure_models`).
2. Let the models take from scene and oil what nobody sets (`_bind_models`), and simplify them as the resolution says.
3. Compute the conditions that all contacts of a ring share (`_conditions`), and bind the models to one chain:
   contact, film, pressure in the film, viscosity under pressure, traction (`rollslip.bearing.chain`).
4. The `Assembly` then computes loads of rollers, and caches what studies compute from them.

Where two scenes differ in the oil alone, `assemble` replaces only what depends on it (`like`).
"""

import logging
import math
import operator
from collections.abc import Callable, Hashable, Mapping
from functools import cached_property, partial
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.approach import film_deflection
from rollslip.bearing.cage import (
    Cage,
    oil_supply,
    read_cage,
    scene_values,
    with_drags,
    with_scene_values,
)
from rollslip.bearing.chain import Chain
from rollslip.bearing.drags import taken_from_scene
from rollslip.bearing.equilibrium import LoadCase, LoadDistribution, angular_positions, solve_pitch
from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.raceway import RINGS, Array, Raceway, Ring
from rollslip.bearing.resolution import Resolution, as_stated, slicing
from rollslip.bearing.ribs import RibPair, tapered_rib
from rollslip.catalogue.registry import get_class, structure_model
from rollslip.errors import DomainError, PluginError, SceneError
from rollslip.lubricant.oil import Lubricant, OilState
from rollslip.lubricant.pressure import with_law
from rollslip.lubricant.table import lubricant_from_table
from rollslip.models import (
    ContactModel,
    FilmModel,
    PressureModel,
    RibModel,
    SliceModel,
    TractionModel,
)
from rollslip.rings import Rings
from rollslip.scene.oil import check_given, members, unused_constants
from rollslip.scene.relations import smallest_tapered_load
from rollslip.scene.rings import rings_of
from rollslip.scene.values import LISTS_OF_MODELS, LubricantTable, ModelChoice, Scene
from rollslip.structure import Location, T, raise_problems
from rollslip.units import GRAVITY, format_quantity
from rollslip_kernels.slices import Conditions, Slices

#: Touching slices whose deflection is evaluated as one table: its columns then stay in the cache of a core. Doubling it
#: changes the speed only. Chosen.
_DEFLECTION_BLOCK = 2048
#: Largest number of loads (rollers times positions times slices) in a distribution that is cached: 128 kB. Doubling it
#: doubles the memory that plans and samples of one bearing hold. Chosen so that coarse distributions, which many plans
#: compute again, are cached and fine ones are not.
_MAX_CACHED_LOADS = 1 << 14
#: Load at which searches of a tapered bearing end, over the smallest that holds its rings together. There rollers
#: hardly touch the inner ring. Doubling its distance from 1 changes no minimum load above it. Chosen.
_HOLDING_LOAD: Final = 1.02
#: Names of the properties of an oil, which the conditions of a contact take over.
_OIL_PROPERTIES: Final = tuple(attrs.fields_dict(OilState))
_log = logging.getLogger(__name__)


@attrs.frozen(eq=False, kw_only=True)
class Assembly:
    """The bearing of a scene with its models bound: what all studies compute with."""

    scene: Scene
    resolution: Resolution
    contact: ContactModel
    film: FilmModel
    pressure: PressureModel
    traction: TractionModel
    lubricant: Lubricant
    kinematics: Kinematics
    #: Positions of the slices along a roller, from its middle [m], (n,).
    position: Array
    #: Widths of the slices [m], (n,).
    widths: Array
    #: Profile at the slices [m], (n,).
    drop: Array
    inner: Raceway
    outer: Raceway
    #: Friction of the ribs; None without axial load.
    rib: RibModel | None = None
    #: Flexible rings and forms of raceways; None where both are rigid and round.
    rings: Rings | None = None
    #: Coarse load distributions, and results that depend on these alone (`cached_by_loads`). All assemblies with the
    #: same loads share it, such as plans and samples of one bearing.
    load_cache: dict[tuple[Hashable, ...], Any] = attrs.field(factory=dict, repr=False)
    #: Results of this assembly (`cached`), such as loads over the orbit and tables of friction: a plan computes them,
    #: and its runs read them.
    map_cache: dict[tuple[Any, ...], Any] = attrs.field(factory=dict, repr=False)
    #: The cage as it is read, the cage with its drags bound, and a chain with its resistance, each with the objects it
    #: was made of. A cage does not depend on slices and laws of the contacts; one that is only read not on the oil.
    cage_cache: dict[str, tuple[tuple[object, ...], Any]] = attrs.field(factory=dict, repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle all fields except the caches."""
        values = {
            a.name: getattr(self, a.name)
            for a in attrs.fields(Assembly)
            if not a.name.endswith("_cache")
        }
        return partial(Assembly, **values), ()

    @property
    def models(self) -> dict[str, SliceModel]:
        """The models by kind; in the chain the oil's law of viscosity under pressure comes before the last one."""
        return {
            "contact": self.contact,
            "film": self.film,
            "pressure": self.pressure,
            "traction": self.traction,
        }

    @property
    def raceways(self) -> tuple[Raceway, Raceway]:
        """Inner and outer raceway."""
        return self.inner, self.outer

    @property
    def slices(self) -> int:
        """Number of slices along a roller."""
        return self.drop.size

    @property
    def roller_mass(self) -> float:
        """Mass of a roller [kg], a solid cylinder."""
        b = self.scene.bearing
        return b.material.density * math.pi * b.roller_diameter**2 / 4 * b.roller_length

    @property
    def centrifugal_force(self) -> float:
        """Centrifugal force m R_m w_ce^2 of a roller at the epicyclic cage speed [N]."""
        return self.centrifugal_force_at(self.kinematics.epicyclic_cage_speed)

    def centrifugal_force_at(self, cage_speed: float) -> float:
        """Return the centrifugal force [N] at a cage speed relative to the carrier [rad/s]."""
        if (carrier := self.scene.operation.carrier) is not None:
            cage_speed += self.kinematics.direction * carrier.speed
        # a product overflows to infinity where a power would raise
        force = self.roller_mass * self.kinematics.orbit_radius * (cage_speed * cage_speed)
        if not force < math.inf:
            raise DomainError(
                f"the centrifugal force of a roller of {format_quantity(self.roller_mass, 'kg')} overflows at a cage "
                f"speed of {format_quantity(cage_speed, 'rad/s')}; lower operation.inner_speed and "
                "operation.outer_speed, or the mass"
            )
        return force

    @property
    def body_force(self) -> tuple[float, float]:
        """Force on each roller in a fixed direction [N], along the line of load and across it in the sense of rotation.

        On a carrier (planet bearing) it is m w^2 R_p, with the speed w of the carrier and the distance R_p of both
        axes; otherwise the weight m g, where `weight_fraction` is above the tolerance of the scene.
        """
        o = self.scene.operation
        force = 0.0
        direction = 0.0
        if o.carrier is not None:
            force = self.roller_mass * o.carrier.speed**2 * o.carrier.radius
            direction = o.carrier.direction
        elif (
            o.gravity_direction is not None and self.weight_fraction > self.scene.accuracy.tolerance
        ):
            force = self.roller_mass * GRAVITY
            direction = o.gravity_direction
        return force * math.cos(direction), force * math.sin(direction) * self.kinematics.direction

    @property
    def weight_fraction(self) -> float:
        """Weight of a roller over the other forces on it, F_r/Z + F_c [1]; infinite where these are zero.

        The axial load of a tapered bearing adds F_a/(Z sin(alpha)).
        """
        operation = self.scene.operation
        bearing = self.scene.bearing
        other = operation.radial_load / bearing.rollers + self.centrifugal_force
        if bearing.contact_angle is not None:
            axial = (operation.axial_load or 0.0) / bearing.rollers
            other += axial / math.sin(bearing.contact_angle)
        return self.roller_mass * GRAVITY / other if other > 0.0 else math.inf

    def _read_cage(self) -> Cage:
        """The cage as it is read, with its drags not yet bound."""
        sources = self.scene.cage, self.scene.bearing, self.scene.models
        return self._memoised("read", sources, lambda: read_cage(self.scene))

    @property
    def cage(self) -> Cage:
        """The cage with its drags bound; it is read when a study of motion needs it."""

        def bound() -> Cage:
            cage = with_drags(self._read_cage(), self.scene, self.kinematics, self.lubricant)
            if (resistance := cage.drags.resistance) is not None:
                check_given(
                    (resistance,),
                    self.inner.conditions,
                    self.lubricant,
                    Location(self.scene.origins),
                )
            return cage

        return self._memoised(
            "cage", (self.scene, self.kinematics, self.lubricant, self.inner.conditions), bound
        )

    def _memoised(self, name: str, sources: tuple[object, ...], make: Callable[[], T]) -> T:
        """Return the cached value of a name; compute it where it was made of other source objects."""
        entry = self.cage_cache.get(name)
        if entry is None or not all(map(operator.is_, entry[0], sources)):
            entry = self.cage_cache[name] = sources, make()
        value: T = entry[1]
        return value

    def with_resistance(self) -> "Assembly":
        """Return the same bearing with the rolling resistance as the last stage of its chains, if there is any."""
        resistance = self.cage.drags.resistance
        own = self.inner.chain
        if resistance is None or own.resists:
            return self
        compiled = self.resolution.compiled
        chain = self._memoised(
            "chain",
            (own, resistance, compiled),
            lambda: Chain(*own.models, resistance, compiled=compiled, bounds=own.bounds),
        )
        return self._with_chain(chain)

    def with_bounds(self, *bounds: Callable[[Slices], None]) -> "Assembly":
        """Return the same bearing with bounds that are checked at every evaluation of its contacts."""
        if not bounds:
            return self
        return self._with_chain(
            Chain(*self.inner.chain.models, compiled=self.resolution.compiled, bounds=bounds)
        )

    def _with_chain(self, chain: Chain) -> "Assembly":
        return attrs.evolve(
            self,
            inner=attrs.evolve(self.inner, chain=chain),
            outer=attrs.evolve(self.outer, chain=chain),
        )

    def at(self, resolution: Resolution) -> "Assembly":
        """Return the same bearing at another resolution; it is assembled anew where the resolution changes its laws."""
        laws = ("traction", "boundary", "inlet_heating", "light_contacts", "compiled")
        if any(getattr(self.resolution, name) != getattr(resolution, name) for name in laws):
            return assemble(self.scene, resolution)
        key = ("slicing", resolution.slices, resolution.quadrature)
        if key not in self.load_cache:
            self.load_cache[key] = slicing(self.scene, resolution)
        position, widths, drop = self.load_cache[key]
        return attrs.evolve(
            self, resolution=resolution, position=position, widths=widths, drop=drop
        )

    def at_load(self, load: float) -> "Assembly":
        """Return the same bearing under another load [N], for a search; its scene retains text and origins.

        It is the radial load, or the axial one where there is no radial load; both retain their ratio. A tapered
        bearing has at least the load that holds its rings together.
        """
        cage = self.cage
        scene = self.scene
        if scene.bearing.contact_angle is not None:
            load = max(load, _HOLDING_LOAD * smallest_tapered_load(scene))
        scene = attrs.evolve(scene, operation=scene.operation.with_load(load))
        if any(
            "radial_load" in taken_from_scene(model)
            for model in (*self.models.values(), *cage.named)
        ):
            chain = self.inner.chain
            assembly = assemble(scene, self.resolution).with_bounds(*chain.bounds)
            return assembly.with_resistance() if chain.resists else assembly
        cage_cache = {
            **self.cage_cache,
            "cage": ((scene, self.kinematics, self.lubricant, self.inner.conditions), cage),
        }
        return attrs.evolve(self, scene=scene, load_cache={}, map_cache={}, cage_cache=cage_cache)

    def load_distribution(
        self,
        n_positions: int = 1,
        cage_speed: float | None = None,
        known: LoadDistribution | None = None,
    ) -> LoadDistribution:
        """Return the quasi-static loads of all rollers at positions spread over one roller pitch.

        Parameters
        ----------
        n_positions : int
            Number of roller positions.
        cage_speed : float, optional
            Speed for the centrifugal force [rad/s]; by default the epicyclic one.
        known : LoadDistribution, optional
            Loads at half as many positions and the same speed, which are not solved for again.
        """
        if known is not None or cage_speed is not None:
            return self._solved_loads(n_positions, cage_speed, known)
        return self.cached_by_loads(
            ("loads", n_positions), n_positions, lambda: self._solved_loads(n_positions, None, None)
        )

    def cached(self, name: str, key: tuple[object, ...], make: Callable[[], T]) -> T:
        """Return the value of a name and a key with all that it depends on; it is computed once."""
        try:
            is_cached = (name, key) in self.map_cache
        except TypeError:  # a model in the key is not hashable
            return make()
        _log.debug("%s: %s", name, "known already" if is_cached else "built")
        if not is_cached:
            self.map_cache[name, key] = make()
        value: T = self.map_cache[name, key]
        return value

    def cached_by_loads(
        self, name: tuple[Hashable, ...], n_positions: int, make: Callable[[], T]
    ) -> T:
        """Return a value that depends on the loads at some positions alone, computed once for all equal loads.

        Where there are more than `_MAX_CACHED_LOADS` loads it is computed each time.
        """
        if self.scene.bearing.rollers * n_positions * self.slices > _MAX_CACHED_LOADS:
            return make()
        key = (name, self._load_key)
        if key not in self.load_cache:
            self.load_cache[key] = make()
        value: T = self.load_cache[key]
        return value

    def _solved_loads(
        self, n_positions: int, cage_speed: float | None, known: LoadDistribution | None
    ) -> LoadDistribution:
        force = (
            self.centrifugal_force if cage_speed is None else self.centrifugal_force_at(cage_speed)
        )
        # with a ring that turns, half as many positions are at other angles of the ring
        if self.rings is not None and self.rings.turning:
            known = None
        return solve_pitch(self.load_case(n_positions, force), self.raceways, known)

    @property
    def carrying_clearance(self) -> float:
        """Radial clearance less the gaps at which contacts begin to carry, on both sides of the bearing [m]."""
        return self.scene.bearing.radial_clearance - 2.0 * (self.inner.gap + self.outer.gap)

    @property
    def ribs(self) -> RibPair | None:
        """The ribs that carry the axial load; None without such a load."""
        if self.rib is None:
            return None
        k = self.kinematics
        moduli = self.inner.conditions.modulus, self.outer.conditions.modulus
        if self.scene.bearing.contact_angle is not None:
            return tapered_rib(self.scene.bearing, k, moduli)
        if (geometry := self.scene.bearing.ribs) is None:
            return None
        spin_radius = k.roller_radius - geometry.height
        end_radius = geometry.end_radius
        if end_radius is None:
            end_radius = spin_radius / math.sin(geometry.angle)
        return RibPair(
            geometry.height,
            end_radius,
            spin_radius,
            (k.inner_radius + geometry.height, k.outer_radius - geometry.height),
            moduli,
        )

    @property
    def named_ribs(self) -> tuple[tuple[str, RibModel], ...]:
        """The friction of ribs with the name of its kind; empty without axial load."""
        return () if self.rib is None else (("rib", self.rib),)

    @property
    def rib_conditions(self) -> tuple[Conditions, Conditions]:
        """Oil, steel and geometry of the contacts of roller ends with inner and outer rib, under axial load."""
        pair = self.ribs
        assert pair is not None
        inner, outer = (
            attrs.evolve(raceway.conditions, radius=pair.end_radius, length=pair.contact_height)
            for raceway in self.raceways
        )
        return inner, outer

    def load_case(self, n_positions: int, centrifugal_force: float = 0.0) -> LoadCase:
        """Return the input of the equilibrium at positions over one pitch, with a centrifugal force per roller [N]."""
        b = self.scene.bearing
        o = self.scene.operation
        return LoadCase(
            angular_positions(b.rollers, n_positions),
            b.roller_length,
            self.drop,
            radial_clearance=self.carrying_clearance,
            radial_load=o.radial_load,
            misalignment=o.misalignment,
            centrifugal_force=centrifugal_force,
            position=self.position,
            widths=self.widths,
            rings=self.rings,
            body_force=self.body_force,
            contact_angle=b.contact_angle or 0.0,
            half_angle=b.angles.half,
            axial_load=o.axial_load or 0.0,
            ribs=self.ribs if b.contact_angle is None else None,
        )

    @cached_property
    def _load_key(self) -> tuple[Hashable, ...]:
        """All that the loads depend on and that assemblies which share `load_cache` may have different."""
        sides = [
            (
                raceway.deflection,
                *(
                    getattr(raceway.conditions, name)
                    for name in sorted(conditions_read(raceway.deflection))
                ),
            )
            for raceway in self.raceways
        ]
        return (
            self.slices,
            self.resolution.quadrature,
            self.inner.chain.placed,
            self.body_force,
            *sides,
        )

    def places(self, ring: Ring, angle: Array, roller: Array | None = None) -> dict[str, Array]:
        """Return the positions of the slices, as `LoadedContacts` takes them; empty where no law reads them.

        Parameters are the angles psi of the rollers from the line of load [rad] and their numbers. The axis of a roller
        is parallel to that of the outer ring, so that the transverse speed is V_t = gamma w_i R_i sin(psi) on the inner
        ring, with the misalignment gamma, and zero on the outer one.
        """
        if not self.inner.chain.placed:
            return {}
        columns = {
            "position": self.position,
            "orbit_angle": angle,
            "transverse_speed": self.max_transverse_speed(ring) * np.sin(angle),
        }
        return columns if roller is None else columns | {"roller": roller}

    def max_transverse_speed(self, ring: Ring) -> float:
        """Largest transverse sliding speed of a ring over the orbit [m/s]."""
        k = self.kinematics
        tilt = self.scene.operation.misalignment if ring == "inner" else 0.0
        return tilt * k.direction * k.inner_speed * k.inner_radius

    def deflect(self, approach: Array, ring: Ring) -> tuple[Array, Array]:
        """Return load per length [N/m] and stiffness [N/m2] of the contacts with a ring.

        The approach [m] is measured from the gap at which they begin to carry (`Raceway.gap`).
        """
        raceway: Raceway = getattr(self, ring)
        flat = approach.ravel()
        touching = np.flatnonzero(~(flat <= 0.0))  # with NaN, which the chain refuses
        load = np.zeros_like(flat)
        stiffness = np.zeros_like(flat)
        for start in range(0, touching.size, _DEFLECTION_BLOCK):
            block = touching[start : start + _DEFLECTION_BLOCK]
            slices = Slices(block.size, raceway.conditions, approach=flat[block])
            raceway.deflection(slices)
            load[block] = slices.load
            stiffness[block] = slices.stiffness
        return load.reshape(approach.shape), stiffness.reshape(approach.shape)


def conditions_read(chain: Chain) -> frozenset[str]:
    """Return the names of the conditions that the models of a chain read."""
    return members(tuple(frozenset(model.reads) for model in chain.models))


def assemble(
    scene: Scene, resolution: Resolution | None = None, *, like: Assembly | None = None
) -> Assembly:
    """Return the bearing of a scene with its models bound.

    Parameters
    ----------
    scene : Scene
        The scene.
    resolution : Resolution, optional
        The numerical resolution; by default that of `as_stated`.
    like : Assembly, optional
        The assembly of another scene. Where the two scenes differ in oil, temperatures and roughness alone, only what
        depends on these is computed anew. The result is the same, to the last bit, with it or without.

    Raises
    ------
    SceneError
        If a parameter of a model or the oil is wrong, the temperature is outside the oil's range, or a model needs
        data that the scene does not give. It lists all faults that can be found at once.
    PluginError
        If a model or the oil does not exist or cannot be loaded.
    """
    if resolution is None:
        resolution = as_stated(scene)
    where = Location(scene.origins)
    load_cache = dict[tuple[Hashable, ...], Any]()
    if like is not None and _has_same_loads(scene, resolution, like):
        if (changed := _with_changed_oil(scene, like, where)) is not None:
            return changed
        load_cache = _shared_loads(like)
    problems: list[str] = []
    lubricant = _lubricant(scene, where, problems)
    models = _structure_models(scene, lubricant, where, problems)
    rib = _rib_friction(scene, where.at("models").at("rib"), problems)
    rings = rings_of(
        scene,
        lambda choice, at: structure_model(
            "ring", {"model": choice.name, **choice.parameters}, at, problems
        ),
        problems,
    )
    kinematics = Kinematics(
        scene.bearing.inner_raceway_diameter / 2,
        scene.bearing.outer_raceway_diameter / 2,
        scene.bearing.roller_diameter / 2,
        scene.operation.inner_speed,
        scene.operation.outer_speed,
        scene.bearing.cosines,
    )
    try:
        position, widths, drop = slicing(scene, resolution)
    except ValueError as error:
        problems.append(where.at("bearing").at("profile").message(str(error)))
    if lubricant is None or problems:
        raise SceneError(problems)
    models = _bind_models(models, scene, kinematics, lubricant, where)
    conditions = {ring: _conditions(scene, kinematics, lubricant, ring, where) for ring in RINGS}
    models["traction"] = simplified_traction(models["traction"], resolution)
    if not resolution.inlet_heating:
        models["film"] = models["film"].isothermal
    stages = [
        models["contact"],
        models["film"],
        lubricant.pressure_viscosity_law,
        models["traction"],
    ]
    if resolution.light_contacts and not models["pressure"].of_contact:
        stages.insert(2, models["pressure"])
    check_given((models["contact"].deflection(), *stages), conditions["inner"], lubricant, where)
    chain = Chain(*stages, compiled=resolution.compiled)
    inner, outer = (
        Raceway(
            ring,
            at,
            chain,
            *_deflection(scene, models, kinematics, lubricant, at, resolution.compiled),
        )
        for ring, at in conditions.items()
    )
    return Assembly(
        scene=scene,
        resolution=resolution,
        lubricant=lubricant,
        kinematics=kinematics,
        position=position,
        widths=widths,
        drop=drop,
        inner=inner,
        outer=outer,
        rib=rib,
        rings=rings.image if rings and kinematics.direction < 0.0 else rings,
        load_cache=load_cache,
        **models,
    )


def _structure_models(
    scene: Scene, lubricant: Lubricant | None, where: Location, problems: list[str]
) -> dict[str, Any]:
    """Return the models of the contacts by kind; faults of all models of the scene are added to ``problems``."""
    constants = None if lubricant is None or not lubricant.models else lubricant.constants_for
    named = where.at("models")
    choices = scene.models

    def constructed(kind: str, choice: ModelChoice, at: Location, *constants: Any) -> Any:
        table = {"model": choice.name, **choice.parameters}
        return structure_model(kind, table, at, problems, *constants)

    models = {
        kind: constructed(kind, getattr(choices, kind), named.at(kind), constants)
        for kind in ("contact", "film", "pressure", "traction")
    }
    problems += unused_constants(scene, models, where.at("lubricant").at("models"))
    # models of studies are constructed here for their faults only
    if choices.thermal is not None:
        constructed("thermal", choices.thermal, named.at("thermal"))
    for kind in LISTS_OF_MODELS:
        for k, choice in enumerate(getattr(choices, kind) or ()):
            constructed(kind, choice, named.at(kind).at(k))
    return models


def _rib_friction(scene: Scene, where: Location, problems: list[str]) -> RibModel | None:
    """Return the friction of the ribs of a scene; None without axial load."""
    if scene.models.rib is None and not scene.operation.axial_load:
        return None
    choice = scene.models.rib_friction
    table = {"model": choice.name, **choice.parameters}
    model: RibModel | None = structure_model("rib", table, where, problems)
    return model if scene.operation.axial_load else None


def _bind_models(
    models: dict[str, Any], scene: Scene, kinematics: Kinematics, oil: Lubricant, where: Location
) -> dict[str, Any]:
    """Return models with all that they take from the scene and from the oil's law of viscosity under pressure."""
    problems = list[str]()
    values = scene_values(scene, kinematics, oil)
    bound = {
        kind: with_scene_values(model, values, where.at("models").at(kind), problems, kind)
        for kind, model in models.items()
    }
    raise_problems(problems)
    return {
        kind: with_law(model, oil.pressure_viscosity_law, oil.slopes)
        for kind, model in bound.items()
    }


def _has_same_loads(scene: Scene, resolution: Resolution, like: Assembly) -> bool:
    """Whether a scene has models, bearing and loads of another, and the same resolution is requested."""

    def same(first: object, second: object) -> bool:
        # what did not change is the same object, and comparing objects takes longer
        return first is second or first == second

    own = scene.operation
    other = like.scene.operation
    temperatures = (
        "temperature",
        "inner_ring_temperature",
        "outer_ring_temperature",
        "roller_temperature",
    )
    loads = [a.name for a in attrs.fields(type(own)) if a.name not in temperatures]
    return (
        same(resolution, like.resolution)
        and same(scene.models, like.scene.models)
        and same(scene.bearing, like.scene.bearing)
        and (like.rings is None or scene.accuracy.tolerance == like.scene.accuracy.tolerance)
        and (own is other or all(getattr(own, name) == getattr(other, name) for name in loads))
    )


def _with_changed_oil(scene: Scene, like: Assembly, where: Location) -> Assembly | None:
    """Return the assembly of a scene with other oil properties; None where the laws of the oil differ too."""
    problems = list[str]()
    if (oil := _lubricant(scene, where, problems)) is None:
        raise SceneError(problems)
    old = like.lubricant
    same_laws = (oil.pressure_viscosity_law, oil.slopes, oil.models) == (
        old.pressure_viscosity_law,
        old.slopes,
        old.models,
    )
    if same_laws and _has_same_scene_values(scene, oil, like):
        return _with_oil(like, scene, oil, where)
    return None


def _has_same_scene_values(scene: Scene, oil: Lubricant, like: Assembly) -> bool:
    """Whether the models of an assembly would take the same values from a scene as from their own."""
    names = {name for model in like.models.values() for name in taken_from_scene(model)}
    new = scene_values(scene, like.kinematics, oil)
    old = scene_values(like.scene, like.kinematics, like.lubricant)
    return all(new[name] == old[name] for name in names if name in new)


def _with_oil(like: Assembly, scene: Scene, oil: Lubricant, where: Location) -> Assembly:
    """Return the assembly of a scene which differs from another one in the conditions of its contacts alone."""

    def changed(raceway: Raceway) -> Raceway:
        conditions = _conditions(scene, like.kinematics, oil, raceway.ring, where)
        if raceway.gap == 0.0:
            return attrs.evolve(raceway, conditions=conditions)
        law, gap = _deflection(
            scene, like.models, like.kinematics, oil, conditions, like.resolution.compiled
        )
        return attrs.evolve(raceway, conditions=conditions, deflection=law, gap=gap)

    inner, outer = map(changed, like.raceways)
    read = like.cage_cache.get("read")
    check_given(
        (*like.inner.deflection.models, *like.inner.chain.models), inner.conditions, oil, where
    )
    return attrs.evolve(
        like,
        scene=scene,
        lubricant=oil,
        inner=inner,
        outer=outer,
        load_cache=_shared_loads(like),
        map_cache={},
        cage_cache={} if read is None else {"read": read},
    )


def _shared_loads(like: Assembly) -> dict[tuple[Hashable, ...], Any]:
    """Return the cache of loads for an assembly with another oil: an own one where loads depend on films."""
    return {} if like.inner.gap > 0.0 else like.load_cache


def _deflection(
    scene: Scene,
    models: Mapping[str, Any],
    kinematics: Kinematics,
    lubricant: Lubricant,
    conditions: Conditions,
    is_compiled: bool,
) -> tuple[Chain, float]:
    """Return the law of deflection of the contacts with a ring, and the gap at which they begin to carry [m]."""
    contact: ContactModel = models["contact"]
    film: FilmModel = models["film"]
    if (scene.models.approach or ("film" if film.at_any_load else "dry")) == "dry":
        return Chain(contact.deflection(), compiled=is_compiled), 0.0
    speed = float(kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    layer = oil_supply(scene, lubricant).oil_layer
    law, gap = film_deflection(contact, film, conditions, speed, layer, is_compiled=is_compiled)
    return Chain(law, compiled=is_compiled), gap


def _lubricant(scene: Scene, where: Location, problems: list[str]) -> Lubricant | None:
    """Return the oil of a scene; None, with its faults in ``problems``, where it is wrong."""
    try:
        return read_oil(scene.lubricant, where.at("lubricant"))
    except SceneError as error:
        problems += error.problems
        return None


def read_oil(table: LubricantTable, where: Location) -> Lubricant:
    """Return the oil of a table ``[lubricant]``, with its law of viscosity under pressure."""

    def named(name: str) -> Lubricant:
        try:
            oil: Lubricant = get_class("lubricant", name)
        except PluginError as error:
            raise type(error)(where.at("name").message(str(error))) from error
        return oil

    data = dict(table.data) | ({} if table.name is None else {"name": table.name})
    return lubricant_from_table(data, named, where, partial(structure_model, "pressure-viscosity"))


def simplified_traction(traction: TractionModel, resolution: Resolution) -> TractionModel:
    """Return the traction law as a resolution simplifies it: without boundary friction, or with a cheaper law."""
    if not resolution.boundary:
        traction = traction.full_film
    if resolution.traction != "named":
        cls = get_class("traction", resolution.traction)
        named = traction.full_film
        shared = {a.name for a in attrs.fields(cls)} & {
            a.name for a in getattr(named, "__attrs_attrs__", ())
        }
        traction = traction.with_full_film(cls(**{name: getattr(named, name) for name in shared}))
    return traction


def _conditions(
    scene: Scene, kinematics: Kinematics, lubricant: Lubricant, ring: Ring, where: Location
) -> Conditions:
    """Return what the contacts of a ring share: geometry, steel, and the oil at the mean surface temperature."""
    o = scene.operation
    s = scene.surface
    pair = (scene.bearing.material_of(ring), scene.bearing.material)
    ring_temperature: float = getattr(o, f"{ring}_ring_temperature")
    try:
        oil = lubricant.at((ring_temperature + o.roller_temperature) / 2)
    except DomainError as error:
        raise SceneError([where.at("operation").at("temperature").message(str(error))]) from error
    raceway_roughness: float = getattr(s, f"{ring}_raceway_roughness")
    own, other = (m.elastic_modulus / (1 - m.poisson_ratio**2) for m in pair)
    return Conditions(
        length=scene.bearing.roller_length,
        radius=getattr(kinematics, f"{ring}_equivalent_radius"),
        # 2/(1/own + 1/other), in a form that is exactly own where both are equal
        modulus=own * (other / ((own + other) / 2)),
        # Rq is about 1.25 Ra, and the squares of both surfaces add
        roughness=1.25 * math.hypot(raceway_roughness, s.roller_roughness),
        # the heat is divided such that both surfaces are equally warm
        effusivity=sum(
            math.sqrt(m.thermal_conductivity * m.density * m.specific_heat) for m in pair
        )
        / 2,
        **{name: getattr(oil, name) for name in _OIL_PROPERTIES},
    )
