"""The bearing of a scene put together: models by name, oil at temperature, one bound chain for each raceway."""

import logging
import math
import operator
from collections.abc import Callable, Hashable
from functools import cached_property, partial
from typing import Any, Final, TypeVar

import attrs
import numpy as np

from rollslip.bearing.cage import Cage, filled, read_cage, scene_values, with_drags
from rollslip.bearing.chain import Chain
from rollslip.bearing.drags import taken_from_scene
from rollslip.bearing.equilibrium import LoadCase, LoadDistribution, angular_positions, solve_pitch
from rollslip.bearing.kinematics import Kinematics
from rollslip.bearing.raceway import RINGS, Array, Raceway, Ring
from rollslip.bearing.resolution import Resolution, as_stated, slicing
from rollslip.catalogue.registry import get_class, structure_model
from rollslip.errors import DomainError, PluginError, SceneError
from rollslip.lubricant.oil import Lubricant, OilState
from rollslip.lubricant.pressure import with_law
from rollslip.lubricant.table import lubricant_from_table
from rollslip.models import ContactModel, FilmModel, PressureModel, SliceModel, TractionModel
from rollslip.rings import Rings
from rollslip.scene.oil import check_given, members, unused_constants
from rollslip.scene.rings import rings_of
from rollslip.scene.values import LubricantTable, Scene
from rollslip.structure import Location
from rollslip.units import GRAVITY, format_quantity
from rollslip_kernels.slices import Conditions, Slices

_PIECE = 2048  # slices whose deflection is found at a time
_KEPT = 1 << 14  # loads in a distribution that is kept, at most
_OF_OIL: Final = tuple(attrs.fields_dict(OilState))
_log = logging.getLogger(__name__)
_T = TypeVar("_T")


@attrs.frozen(eq=False, kw_only=True)
class Assembly:
    """All that the studies need of a scene, with the models bound."""

    scene: Scene
    resolution: Resolution
    contact: ContactModel
    film: FilmModel
    pressure: PressureModel
    traction: TractionModel
    lubricant: Lubricant
    kinematics: Kinematics
    #: Slices along a roller: their places from the middle, their widths and the profile there [m], (n,).
    position: Array
    widths: Array
    drop: Array
    inner: Raceway
    outer: Raceway
    #: Rings that yield and forms of raceways; None where both are rigid and round.
    rings: Rings | None = None
    #: Load distributions of few slices at few instants, and what they alone decide, which plans and samples of the same
    #: bearing ask for again and again: shared by all that are loaded alike.
    known_loads: dict[tuple[Hashable, ...], Any] = attrs.field(factory=dict, repr=False)
    #: What `kept` holds, such as loads over the orbit and tables of friction: a plan builds them, runs ask again.
    known_maps: dict[tuple[Any, ...], Any] = attrs.field(factory=dict, repr=False)
    #: The cage once it was read, and with its drags bound, and a chain with its resistance, each with what it was made
    #: of: slices and laws of the contacts change nothing of a cage, and the oil nothing of one that is only read.
    known_cage: dict[str, tuple[tuple[object, ...], Any]] = attrs.field(factory=dict, repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        """Leave behind what is found again."""
        made = {
            a.name: getattr(self, a.name)
            for a in attrs.fields(Assembly)
            if not a.name.startswith("known")
        }
        return partial(Assembly, **made), ()

    @property
    def models(self) -> dict[str, SliceModel]:
        """The models by kind; the oil's law of viscosity with pressure runs before the last."""
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
        """Slices along a roller."""
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
        """Return that force at a cage speed [rad/s], which a carrier adds its own to."""
        if (carrier := self.scene.operation.carrier) is not None:
            cage_speed += self.kinematics.direction * carrier.speed
        force = (
            self.roller_mass * self.kinematics.orbit_radius * (cage_speed * cage_speed)
        )  # a power would raise
        if not force < math.inf:
            raise DomainError(
                f"the centrifugal force of a roller of {format_quantity(self.roller_mass, 'kg')} overflows at a cage "
                f"speed of {format_quantity(cage_speed, 'rad/s')}; lower operation.inner_speed and "
                "operation.outer_speed, or the mass"
            )
        return force

    @property
    def body_force(self) -> tuple[float, float]:
        """Force on each roller in one direction [N], along the line of load and across it in the sense of kinematics.

        m w^2 R_p off the axis of a carrier, w its speed and R_p the distance of both axes; or the weight m g, where its
        share is above the tolerance.
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
        """Weight of a roller over what presses it besides, F_r/Z + F_c."""
        pressed = (
            self.scene.operation.radial_load / self.scene.bearing.rollers + self.centrifugal_force
        )
        return self.roller_mass * GRAVITY / pressed if pressed > 0.0 else math.inf

    def _read_cage(self) -> Cage:
        """The cage as it is read, with its drags as they are named."""
        of = self.scene.cage, self.scene.bearing, self.scene.models
        return self._known("read", of, lambda: read_cage(self.scene))

    @property
    def cage(self) -> Cage:
        """The cage with its drags; read when a study in time asks for it."""

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

        return self._known(
            "cage", (self.scene, self.kinematics, self.lubricant, self.inner.conditions), bound
        )

    def _known(self, what: str, of: tuple[object, ...], make: Callable[[], _T]) -> _T:
        """Return what is made of some objects, once for all bearings that have them."""
        known = self.known_cage.get(what)
        if known is None or not all(map(operator.is_, known[0], of)):
            known = self.known_cage[what] = of, make()
        made: _T = known[1]
        return made

    def with_resistance(self) -> "Assembly":
        """Return the same bearing with resistance to rolling behind the friction of its raceways, if there is any."""
        resistance = self.cage.drags.resistance
        if resistance is None:
            return self
        before = self.inner.chain
        compiled = self.resolution.compiled
        chain = self._known(
            "chain",
            (before, resistance, compiled),
            lambda: Chain(*before.models, resistance, compiled=compiled, bounds=before.bounds),
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
        """Return the same bearing at another resolution; where its laws are to be others, it is put together anew."""
        laws = ("traction", "boundary", "inlet_heating", "light_contacts", "compiled")
        if any(getattr(self.resolution, name) != getattr(resolution, name) for name in laws):
            return assemble(self.scene, resolution)
        made = partial(slicing, self.scene, resolution)
        key = ("slicing", resolution.slices, resolution.quadrature)
        position, widths, drop = self.known_loads.get(key) or self.known_loads.setdefault(
            key, made()
        )
        return attrs.evolve(
            self, resolution=resolution, position=position, widths=widths, drop=drop
        )

    def at_load(self, radial_load: float) -> "Assembly":
        """Return the same bearing under another radial load [N], to search for one: its scene keeps the text it has."""
        cage = self.cage
        scene = self.scene
        scene = attrs.evolve(
            scene, operation=attrs.evolve(scene.operation, radial_load=radial_load)
        )
        if any(
            "radial_load" in taken_from_scene(model)
            for model in (*self.models.values(), *cage.named)
        ):
            made = assemble(scene, self.resolution)
            chain = self.inner.chain
            made = made.with_bounds(*chain.bounds)
            return made.with_resistance() if chain.resists else made
        known = {
            **self.known_cage,
            "cage": ((scene, self.kinematics, self.lubricant, self.inner.conditions), cage),
        }
        return attrs.evolve(self, scene=scene, known_loads={}, known_maps={}, known_cage=known)

    def load_distribution(
        self,
        n_positions: int = 1,
        cage_speed: float | None = None,
        known: LoadDistribution | None = None,
    ) -> LoadDistribution:
        """Return the quasi-static loads of all rollers at instants spread over one roller pitch.

        Their centrifugal force is that at a cage speed [rad/s], by default the epicyclic one. Instants of the ``known``
        distribution, of half as many at this speed, are not solved for again.
        """
        if known is not None or cage_speed is not None:
            return self._solved_loads(n_positions, cage_speed, known)
        return self.cached_by_loads(
            ("loads", n_positions), n_positions, lambda: self._solved_loads(n_positions, None, None)
        )

    def cached(self, what: str, key: tuple[object, ...], make: Callable[[], _T]) -> _T:
        """Return something of the bearing under a key that has all it depends on, made once."""
        try:
            known = (what, key) in self.known_maps
        except TypeError:  # a model that is not to be told from others
            return make()
        _log.debug("%s: %s", what, "known already" if known else "built")
        if not known:
            self.known_maps[what, key] = make()
        found: _T = self.known_maps[what, key]
        return found

    def cached_by_loads(
        self, what: tuple[Hashable, ...], n_positions: int, make: Callable[[], _T]
    ) -> _T:
        """Return what the loads of some instants alone decide, made once for all bearings that are loaded alike.

        Where it is large it is made anew each time.
        """
        if self.scene.bearing.rollers * n_positions * self.slices > _KEPT:
            return make()
        key = (what, self._alike)
        if key not in self.known_loads:
            self.known_loads[key] = make()
        known: _T = self.known_loads[key]
        return known

    def _solved_loads(
        self, n_positions: int, cage_speed: float | None, known: LoadDistribution | None
    ) -> LoadDistribution:
        force = (
            self.centrifugal_force if cage_speed is None else self.centrifugal_force_at(cage_speed)
        )
        if self.rings is not None and self.rings.turning:  # instants of half as many are others
            known = None
        return solve_pitch(self.load_case(n_positions, force), self.raceways, known)

    def load_case(self, n_positions: int, centrifugal_force: float = 0.0) -> LoadCase:
        """Return what the equilibrium is solved of, at instants spread over one roller pitch."""
        b = self.scene.bearing
        o = self.scene.operation
        return LoadCase(
            angular_positions(b.rollers, n_positions),
            b.roller_length,
            self.drop,
            radial_clearance=b.radial_clearance,
            radial_load=o.radial_load,
            misalignment=o.misalignment,
            centrifugal_force=centrifugal_force,
            position=self.position,
            widths=self.widths,
            rings=self.rings,
            body_force=self.body_force,
        )

    @cached_property
    def _alike(self) -> tuple[Hashable, ...]:
        """What bearings that share `known_loads` have the same if they are loaded alike."""
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
        """Return where slices of rollers are, as `LoadedContacts` takes it; nothing where no law asks.

        By their angles from the line of load [rad] and their numbers. The axis of a roller is that of the outer ring,
        so that V_t = gamma w_i R_i sin(psi) on the inner one, gamma the misalignment, and none on the outer.
        """
        if not self.inner.chain.placed:
            return {}
        known = {
            "position": self.position,
            "orbit_angle": angle,
            "transverse_speed": self.across(ring) * np.sin(angle),
        }
        return known if roller is None else known | {"roller": roller}

    def across(self, ring: Ring) -> float:
        """Largest transverse sliding speed of a ring over the orbit [m/s]."""
        k = self.kinematics
        tilt = self.scene.operation.misalignment if ring == "inner" else 0.0
        return tilt * k.direction * k.inner_speed * k.inner_radius

    def deflect(self, approach: Array, ring: Ring) -> tuple[Array, Array]:
        """Return load per length [N/m] and stiffness [N/m2] of the contacts with a ring, by approach [m]."""
        raceway = self.inner if ring == "inner" else self.outer
        every = approach.ravel()
        touching = np.flatnonzero(~(every <= 0.0))  # NaN among them, for the chain to refuse
        load = np.zeros_like(every)
        stiffness = np.zeros_like(every)
        for start in range(
            0, touching.size, _PIECE
        ):  # a table is many columns: pieces of it stay in the cache
            some = touching[start : start + _PIECE]
            slices = Slices(some.size, raceway.conditions, approach=every[some])
            raceway.deflection(slices)
            load[some] = slices.load
            stiffness[some] = slices.stiffness
        return load.reshape(approach.shape), stiffness.reshape(approach.shape)


def conditions_read(chain: Chain) -> frozenset[str]:
    """Conditions that the models of a chain read."""
    return members(tuple(frozenset(model.reads) for model in chain.models))


def assemble(
    scene: Scene, resolution: Resolution | None = None, *, like: Assembly | None = None
) -> Assembly:
    """Put the bearing of a scene together.

    Parameters
    ----------
    scene : Scene
        The scene.
    resolution : Resolution, optional
        How finely it is computed; by default as the scene states, with instants doubled until results stand still.
    like : Assembly, optional
        What this function gave of another scene. Where the two differ in oil, temperatures and roughness alone, only
        what these change is made anew; the bearing is the same, to the last bit, with it or without.

    Raises
    ------
    SceneError
        If a parameter of a model or the oil is wrong, the temperature is outside the oil's range, or a model needs
        data that the scene does not give; all faults that can be found at once.
    PluginError
        If a model or the oil does not exist or cannot be loaded.
    """
    b = scene.bearing
    resolution = as_stated(scene) if resolution is None else resolution
    where = Location(scene.origins)
    problems: list[str] = []
    loads: dict[tuple[Hashable, ...], Any]
    if like is not None and _loaded_alike(scene, resolution, like):
        oil = _lubricant(scene, where, problems)
        if oil is None:
            raise SceneError(problems)
        laws = [(of.pressure_viscosity_law, of.slopes, of.models) for of in (oil, like.lubricant)]
        if laws[0] == laws[1] and _given_alike(scene, oil, like):
            return _with_oil(like, scene, oil, where)
        problems = []
        loads = like.known_loads
    else:
        loads = {}
    lubricant = _lubricant(scene, where, problems)
    constants = None if lubricant is None or not lubricant.models else lubricant.constants_for
    models: dict[str, Any] = {
        kind: structure_model(
            kind,
            {"model": choice.name, **choice.parameters},
            where.at("models").at(kind),
            problems,
            constants,
        )
        for kind, choice in (
            ("contact", scene.models.contact),
            ("film", scene.models.film),
            ("pressure", scene.models.pressure),
            ("traction", scene.models.traction),
        )
    }
    problems += unused_constants(scene, models, where.at("lubricant").at("models"))
    named = where.at("models")
    thermal = scene.models.thermal
    beside = [] if thermal is None else [("thermal", named.at("thermal"), thermal)]
    beside += [
        ("damage", named.at("damage").at(k), one) for k, one in enumerate(scene.models.damage)
    ]
    beside += [
        ("torque", named.at("torque").at(k), one) for k, one in enumerate(scene.models.torque)
    ]
    for (
        kind,
        place,
        choice,
    ) in beside:  # for studies that ask for them; their faults are those of the scene
        structure_model(kind, {"model": choice.name, **choice.parameters}, place, problems)
    rings = rings_of(
        scene,
        lambda choice, at: structure_model(
            "ring", {"model": choice.name, **choice.parameters}, at, problems
        ),
        problems,
    )
    kinematics = Kinematics(
        b.inner_raceway_diameter / 2,
        b.outer_raceway_diameter / 2,
        b.roller_diameter / 2,
        scene.operation.inner_speed,
        scene.operation.outer_speed,
    )
    try:
        position, widths, drop = slicing(scene, resolution)
    except ValueError as error:
        problems.append(where.at("bearing").at("profile").message(str(error)))
    if lubricant is None or problems:
        raise SceneError(problems)
    values = scene_values(scene, kinematics, lubricant)
    named = where.at("models")
    models = {
        kind: filled(model, values, named.at(kind), problems, kind)
        for kind, model in models.items()
    }
    if problems:
        raise SceneError(problems)
    conditions = {ring: _conditions(scene, kinematics, lubricant, ring, where) for ring in RINGS}
    law = lubricant.pressure_viscosity_law
    models = {kind: with_law(model, law, lubricant.slopes) for kind, model in models.items()}
    models["traction"] = simplified(models["traction"], resolution)
    if not resolution.inlet_heating:
        models["film"] = models["film"].isothermal
    in_film = (
        ()
        if models["pressure"].of_contact or not resolution.light_contacts
        else (models["pressure"],)
    )
    stages = models["contact"], models["film"], *in_film, law, models["traction"]
    deflection = models["contact"].deflection()
    check_given((deflection, *stages), conditions["inner"], lubricant, where)
    chain = Chain(*stages, compiled=resolution.compiled)
    approach = Chain(deflection, compiled=resolution.compiled)
    inner, outer = (Raceway(ring, conditions[ring], chain, approach) for ring in RINGS)
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
        rings=rings.image if rings and kinematics.direction < 0.0 else rings,
        known_loads=loads,
        **models,
    )


def _loaded_alike(scene: Scene, resolution: Resolution, like: Assembly) -> bool:
    """Whether a scene has models, bearing and loads of another, and the same resolution is asked of it."""

    def same(one: object, other: object) -> bool:
        return (
            one is other or one == other
        )  # what is not changed is the same object, and comparing takes longer

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


def _given_alike(scene: Scene, oil: Lubricant, like: Assembly) -> bool:
    """Whether the laws of a bearing take from a scene what they take from its own."""
    named = {of for model in like.models.values() for of in taken_from_scene(model)}
    one, other = (
        scene_values(of, like.kinematics, its)
        for of, its in ((scene, oil), (like.scene, like.lubricant))
    )
    return all(one[of] == other[of] for of in named if of in one)


def _with_oil(like: Assembly, scene: Scene, oil: Lubricant, where: Location) -> Assembly:
    """The bearing of a scene that has all but its conditions of another."""
    inner, outer = (
        attrs.evolve(
            raceway, conditions=_conditions(scene, like.kinematics, oil, raceway.ring, where)
        )
        for raceway in like.raceways
    )
    read = like.known_cage.get("read")
    check_given(
        (*like.inner.deflection.models, *like.inner.chain.models), inner.conditions, oil, where
    )
    return attrs.evolve(
        like,
        scene=scene,
        lubricant=oil,
        inner=inner,
        outer=outer,
        known_maps={},
        known_cage={} if read is None else {"read": read},
    )


def _lubricant(scene: Scene, where: Location, problems: list[str]) -> Lubricant | None:
    try:
        return read_oil(scene.lubricant, where.at("lubricant"))
    except SceneError as error:
        problems += error.problems
        return None


def read_oil(written: LubricantTable, where: Location) -> Lubricant:
    """Return the oil of a table ``[lubricant]``, with its law of viscosity under pressure."""

    def named(name: str) -> Lubricant:
        try:
            oil: Lubricant = get_class("lubricant", name)
        except PluginError as error:
            raise type(error)(where.at("name").message(str(error))) from error
        return oil

    table = dict(written.data) | ({} if written.name is None else {"name": written.name})
    return lubricant_from_table(table, named, where, partial(structure_model, "pressure-viscosity"))


def simplified(traction: TractionModel, resolution: Resolution) -> TractionModel:
    """Return the traction that a resolution leaves of a scene's: without boundary friction, or by a cheaper law."""
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
    """What the contacts of a ring share; the film enters at the mean temperature of the two surfaces."""
    o = scene.operation
    s = scene.surface
    pair = (scene.bearing.material_of(ring), scene.bearing.material)
    ring_temperature = o.inner_ring_temperature if ring == "inner" else o.outer_ring_temperature
    try:
        oil = lubricant.at((ring_temperature + o.roller_temperature) / 2)
    except DomainError as error:
        raise SceneError([where.at("operation").at("temperature").message(str(error))]) from error
    raceway_roughness = s.inner_raceway_roughness if ring == "inner" else s.outer_raceway_roughness
    own, other = (m.elastic_modulus / (1 - m.poisson_ratio**2) for m in pair)
    return Conditions(
        length=scene.bearing.roller_length,
        radius=kinematics.inner_equivalent_radius
        if ring == "inner"
        else kinematics.outer_equivalent_radius,
        modulus=own
        * (
            other / ((own + other) / 2)
        ),  # 2/(1/own + 1/other), and own to the bit where both are one
        roughness=1.25 * math.hypot(raceway_roughness, s.roller_roughness),
        # heat parts such that both are equally warm
        effusivity=sum(
            math.sqrt(m.thermal_conductivity * m.density * m.specific_heat) for m in pair
        )
        / 2,
        **{name: getattr(oil, name) for name in _OF_OIL},
    )
