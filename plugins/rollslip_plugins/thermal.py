"""Bulk temperatures of a bearing: as they are given, or by a lumped-parameter network of up to six nodes."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Final, Self

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.errors import SceneError
from rollslip.fields import in_range, non_negative, parameter, positive
from rollslip.references import Reference
from rollslip.scene.clearance import operating_clearance
from rollslip.scene.supply import DENSITY, PUMPED
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import Location
from rollslip.studies.thermal_balance.model import ThermalModel
from rollslip_plugins.bibliography import HARRIS_2007, ISO_15312, PALMGREN_1959

#: Heat flux through the seats at the reference conditions of ISO 15312 [W/m2]; estimated conductances between rings and
#: surroundings are proportional to it.
_REFERENCE_FLUX = 1.6e4
#: Temperature of the bearing above the surroundings at the reference conditions of ISO 15312 [K].
_REFERENCE_EXCESS = 50.0
#: Area of the seats up to which that flux holds [m2], by ISO 15312.
_REFERENCE_AREA = 0.05
#: Exponent of the flux over the area of larger seats, of ISO 15312 (recalled, C).
_FLUX_EXPONENT = -0.34
#: Temperature of the surroundings at the reference conditions of ISO 15312 [K].
_AMBIENT: Final = 293.15
#: Conductance of a seat with an interference or transition fit [W/(m2 K)] (D). Doubling it changes the temperatures of
#: housing and shaft, but not the conductance from a ring to the surroundings, which is that of ISO 15312.
_SEAT_CONDUCTANCE: Final = 2000.0
#: Width of a bearing over the length of its rollers (D): 1.87 of the 1032930.
_WIDTH: Final = 1.8
#: Mass of the housing over that of the rings (D). It sets how fast temperatures change, not the balance.
_HOUSING = 5.0
#: Mass of the shaft over that of the rings (D), as for the housing.
_SHAFT = 3.0
#: Fraction of the free volume of the bearing that oil fills (D), as for the housing.
_OIL_FRACTION = 0.1
#: Rise of temperature with which an assumed flow of oil carries the heat of the reference conditions of ISO 15312 [K]
#: (D): makers size flows by heat and rises of 10 to 25 K (NTN, C). Doubling it halves the flow.
_OIL_RISE: Final = 15.0
#: Specific heat of an oil where none is given [J/(kg K)] (B).
_OIL_HEAT: Final = 2000.0

#: Names of the nodes, the leading one first.
_NODES: Final = ("oil", "inner ring", "rollers", "outer ring", "housing", "shaft")
_OIL = 0  # index of the oil in `_NODES`
_INNER = 1  # of the inner ring
_ROLLERS = 2  # of the rollers
_OUTER = 3  # of the outer ring
_HOUSE = 4  # of the housing
_AXLE = 5  # of the shaft
#: Conductance -> the two nodes that it connects; one alone is connected to the surroundings.
_LINKS: Final[Mapping[str, tuple[int, ...]]] = {
    "oil_inner_ring": (_OIL, _INNER),
    "oil_rollers": (_OIL, _ROLLERS),
    "oil_outer_ring": (_OIL, _OUTER),
    "inner_ring_rollers": (_INNER, _ROLLERS),
    "outer_ring_rollers": (_OUTER, _ROLLERS),
    "inner_ring_shaft": (_INNER, _AXLE),
    "outer_ring_housing": (_OUTER, _HOUSE),
    "shaft_ambient": (_AXLE,),
    "housing_ambient": (_HOUSE,),
}


@attrs.frozen(kw_only=True)
class Given(ThermalModel):
    """Temperatures as ``operation`` gives them, whatever the losses: something outside holds them.

    T = T_given.

    Symbols:

    - T: temperatures of oil, rings and rollers [K]

    Range: any; the study then reports the heat that would have to be carried away.

    Examples
    --------
    >>> Given().nodes
    ()
    """

    name: ClassVar[str] = "given"
    equation: ClassVar[str] = "T = T_given"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(kind="remark", title="No law: the temperatures of the scene."),
    )

    @property
    def nodes(self) -> tuple[str, ...]:
        """No nodes."""
        return ()

    def start(self, scene: Scene) -> Array:
        """Return an empty array: there are no nodes."""
        return np.zeros(0)

    def capacities(self) -> Array:
        """Return an empty array: there are no nodes."""
        return np.zeros(0)

    def inflows(self, temperatures: Array, losses: Mapping[str, float]) -> Array:
        """Return an empty array: there are no nodes."""
        return np.zeros(0)

    def carried_away(self, temperatures: Array) -> dict[str, float]:
        """Return an empty dict."""
        return {}

    def changes(self, temperatures: Array, scene: Scene) -> dict[str, float]:
        """Return an empty dict."""
        return {}


def _conductance(doc: str) -> Any:
    """Return an optional parameter for a thermal conductance."""
    return parameter(
        default=None,
        unit="W/K",
        doc=f"thermal conductance {doc}",
        validator=attrs.validators.optional(non_negative),
        usual=(0, 1e4),
        possible=(0, 1e9),
    )


def _capacity(doc: str) -> Any:
    """Return an optional parameter for a heat capacity."""
    return parameter(
        default=None,
        unit="J/K",
        doc=f"heat capacity of {doc}",
        validator=attrs.validators.optional(positive),
        usual=(0.1, 1e8),
        possible=(1e-9, 1e12),
    )


def _factor(doc: str) -> Any:
    """Return a parameter for the factor of estimated conductances."""
    return parameter(
        default=1.0,
        unit="1",
        doc=f"factor of the conductances {doc} that are estimated",
        validator=positive,
        usual=(0.2, 5),
        possible=(1e-3, 1e3),
    )


def _temperature(doc: str, default: float | None) -> Any:
    """Return a parameter for a temperature."""
    return parameter(
        default=default,
        unit="K",
        doc=doc,
        validator=attrs.validators.optional(positive),
        usual=(213.15, 523.15),
        possible=(123.15, 1273.15),
    )


@attrs.frozen(kw_only=True)
class Network(ThermalModel):
    """Six nodes that exchange heat in proportion to differences of temperature, after Palmgren and Harris.

    C_k dT_k/dt = H_k + sum_j K_kj (T_j - T_k) + m c (T_in - T_k), the last term of the oil alone.

    The oil in the bearing is well mixed: it leaves as warm as it is, T_in is that of its inlet. Heat of friction of
    two bodies goes half into each: of a contact into ring and rollers, of a pocket into rollers and oil, of a land
    into ring and oil; what the oil itself resists goes into the oil. The cage is no node: it is as warm as the oil.

    Symbols:

    - T_k: temperature of node k: oil, inner ring, rollers, outer ring, housing, shaft [K]
    - C_k: its heat capacity (``oil_capacity`` ...) [J/K]
    - H_k: heat that the losses make in it [W]
    - K_kj: conductance between two nodes, or to the surroundings at T_a (``ambient_temperature``) [W/K]
    - m, c: flow of the oil (``oil_flow``) and its specific heat (``oil_specific_heat``) [kg/s], [J/(kg K)]
    - T_in: temperature of the oil at its inlet (``oil_inlet_temperature``; ``operation.temperature`` if not given) [K]

    What is not given is estimated from the bearing, and every estimate is graded (D), good to a factor of two or three:

    - Rings to surroundings, through seats, shaft and housing in series: the heat that ISO 15312 takes at its reference
      conditions, 16 kW/m2 of seat at 50 K above 20 degC, up to 0.05 m2, then less with the power -0.34 of the area
      (exponent recalled, C). Shaft and housing take what the areas of their seats are; a seat conducts 2 kW/(m2 K) (D).
    - Oil to rings and rollers: a laminar plate, Nu = 0.332 Re^0.5 Pr^(1/3), at the pitch diameter and a third of the
      cage's surface speed, as Harris and Kotzalas take it, over the wetted surfaces.
    - Rings to rollers: the film over the Hertz width of a mean contact in series with the flash of two half-spaces,
      K = Z l 2 b/(h/K_f + sqrt(pi 2 b/u)/e).
    - Flow of oil that is pumped, where ``lubrication`` gives none: as much as carries the heat of ISO 15312's reference
      conditions with a rise of 15 K. Makers size flows by heat and rises of 10 to 25 K (NTN, C). Other oil has no flow.
    - Masses: rings and rollers by size; housing 5 and shaft 3 times the rings (D). They set the pace, not the balance.

    ``oil_factor``, ``contact_factor`` and ``surroundings_factor`` multiply what is estimated, so that it can scatter.

    A bearing with ``bearing.mounting`` has the clearance that its seats leave at the temperatures of the nodes, as in
    every study (`rollslip.scene.clearance.operating_clearance`). Where ``bearing.radial_clearance`` is stated, or
    follows from the diameters alone, ``expansion`` a lets it change with the temperatures of the parts: it holds at
    those of the scene, and changes by a (E_o dT_o - E_i dT_i - 2 D dT_r). 0 leaves it as it is.

    Range: one temperature for each part, as lumped nodes have; no radiation by itself, no boiling oil.

    Raises
    ------
    SceneError
        If heat is made in a part that no conductance connects to the surroundings or to flowing oil.

    Examples
    --------
    10 W in the oil that flows with 1 g/s of 2000 J/(kg K) and touches nothing but the inlet: 5 K above it.

    >>> one = Network(oil_flow=1e-3, oil_inlet_temperature=300.0, **dict.fromkeys(_LINKS, 0.0))
    >>> one.nodes
    ('oil',)
    >>> one.inflows(np.array([305.0]), {"oil": 10.0})
    array([0.])
    """

    name: ClassVar[str] = "network"
    equation: ClassVar[str] = "C_k dT_k/dt = H_k + sum_j K_kj (T_j - T_k) + m c (T_in - T_k)"
    references: ClassVar[tuple[Reference, ...]] = (PALMGREN_1959, HARRIS_2007, ISO_15312)

    oil_flow: float | None = parameter(
        default=None,
        unit="kg/s",
        doc="flow of oil through the bearing, by default that of lubrication; 0 for a bath, whose heat leaves through "
        "the rings",
        validator=attrs.validators.optional(non_negative),
        usual=(0, 10),
        possible=(0, 1e6),
    )
    oil_specific_heat: float = parameter(
        default=_OIL_HEAT,
        unit="J/(kg K)",
        doc="specific heat c of the oil (B)",
        validator=positive,
        usual=(1000, 4500),
        possible=(100, 2e4),
    )
    oil_inlet_temperature: float | None = _temperature(
        "temperature of the oil at its inlet; by default operation.temperature", None
    )
    ambient_temperature: float = _temperature(
        "temperature of the surroundings, 20 degC in ISO 15312", _AMBIENT
    )
    contact_fraction: float = parameter(
        default=0.5,
        unit="1",
        doc="fraction of a contact's heat that goes into the rollers, the rest into the ring",
        validator=in_range(0.0, 1.0),
        usual=(0, 1),
        possible=(0, 1),
    )
    expansion: float = parameter(
        default=0.0,
        unit="1/K",
        doc="thermal expansion of rings and rollers, where the clearance is stated; 0 for one that stays",
        validator=non_negative,
        usual=(0, 3e-5),
        possible=(0, 1e-3),
    )
    oil_factor: float = _factor("between oil and parts")
    contact_factor: float = _factor("between rings and rollers")
    surroundings_factor: float = _factor("between rings and surroundings")
    oil_inner_ring: float | None = _conductance("between oil and inner ring")
    oil_rollers: float | None = _conductance("between oil and rollers")
    oil_outer_ring: float | None = _conductance("between oil and outer ring")
    inner_ring_rollers: float | None = _conductance("between inner ring and rollers")
    outer_ring_rollers: float | None = _conductance("between outer ring and rollers")
    inner_ring_shaft: float | None = _conductance("between inner ring and shaft")
    outer_ring_housing: float | None = _conductance("between outer ring and housing")
    shaft_ambient: float | None = _conductance("between shaft and surroundings")
    housing_ambient: float | None = _conductance("between housing and surroundings")
    oil_capacity: float | None = _capacity("the oil in the bearing")
    inner_ring_capacity: float | None = _capacity("the inner ring")
    rollers_capacity: float | None = _capacity("all rollers")
    outer_ring_capacity: float | None = _capacity("the outer ring")
    housing_capacity: float | None = _capacity("the housing")
    shaft_capacity: float | None = _capacity("the shaft")

    # Nodes ---------------------------------------------------------------------------------------------------------

    @property
    def _present(self) -> list[int]:
        """Indices of the nodes with a conductance, and of the oil."""
        linked = {
            node for name, ends in _LINKS.items() if getattr(self, name) != 0.0 for node in ends
        }
        return sorted(linked | {_OIL})

    @property
    def nodes(self) -> tuple[str, ...]:
        """The oil, and every part with a conductance."""
        return tuple(_NODES[k] for k in self._present)

    def of(self, assembly: "Assembly") -> Self:
        """Return the network with estimates from the bearing for all parameters that are not given."""
        estimates: dict[str, Any] = _estimates(self, assembly)
        model = attrs.evolve(
            self, **{k: v for k, v in estimates.items() if getattr(self, k) is None}
        )
        reached = {
            node
            for name, ends in _LINKS.items()
            if len(ends) == 1 and getattr(model, name)
            for node in ends
        }
        reached |= {_OIL} if model.oil_flow else set()
        for _ in _NODES:
            for name, ends in _LINKS.items():
                if len(ends) == 2 and getattr(model, name) and reached & set(ends):
                    reached |= set(ends)
        if isolated := [_NODES[k] for k in (_OIL, _INNER, _ROLLERS, _OUTER) if k not in reached]:
            raise SceneError(
                [
                    Location(assembly.scene.origins, ("models", "thermal")).message(
                        f"no heat leaves {', '.join(isolated)}, where losses make some: temperatures rise without end; "
                        "give a flow of oil, or conductances above 0 that lead to the surroundings"
                    )
                ]
            )
        return model

    # Flows of heat --------------------------------------------------------------------------------------------------

    def start(self, scene: Scene) -> Array:
        """Return the temperatures of the scene, and those of the surroundings for housing and shaft."""
        o = scene.operation
        return np.array(
            [
                o.temperature,
                o.inner_ring_temperature,
                o.roller_temperature,
                o.outer_ring_temperature,
                self.ambient_temperature,
                self.ambient_temperature,
            ]
        )[self._present]

    def capacities(self) -> Array:
        """Return the heat capacities."""
        return np.array(
            [getattr(self, f"{name.replace(' ', '_')}_capacity") for name in _NODES], dtype=float
        )[self._present]

    def _all(self, temperatures: Array) -> Array:
        """Return the temperatures of all six nodes [K]; those without a conductance are at ambient temperature."""
        every = np.full(len(_NODES), self.ambient_temperature)
        every[self._present] = temperatures
        return every

    def inflows(self, temperatures: Array, losses: Mapping[str, float]) -> Array:
        """Return the heat that flows into each node; see `ThermalModel.inflows`."""
        T = self._all(temperatures)
        flow = np.zeros(len(_NODES))
        fraction = self.contact_fraction
        for place, parts in {
            "inner contact": ((_INNER, 1.0 - fraction), (_ROLLERS, fraction)),
            "outer contact": ((_OUTER, 1.0 - fraction), (_ROLLERS, fraction)),
            "pocket": ((_ROLLERS, 0.5), (_OIL, 0.5)),
            "inner land": ((_INNER, 0.5), (_OIL, 0.5)),
            "outer land": ((_OUTER, 0.5), (_OIL, 0.5)),
            "oil": ((_OIL, 1.0),),
        }.items():
            for node, part in parts:
                flow[node] += part * losses.get(place, 0.0)
        for name, ends in _LINKS.items():
            conductance = getattr(self, name)
            if len(ends) == 1:
                flow[ends[0]] -= conductance * (T[ends[0]] - self.ambient_temperature)
            else:
                heat = conductance * (T[ends[1]] - T[ends[0]])
                flow[ends[0]] += heat
                flow[ends[1]] -= heat
        if self.inlet is not None:
            flow[_OIL] -= self.inlet[1] * (T[_OIL] - self.inlet[0])
        return flow[self._present]

    def carried_away(self, temperatures: Array) -> dict[str, float]:
        """Return the heat that oil, housing and shaft carry away."""
        T = self._all(temperatures)
        return {
            "oil": float(0.0 if self.inlet is None else self.inlet[1] * (T[_OIL] - self.inlet[0])),
            "housing": float(self.housing_ambient * (T[_HOUSE] - self.ambient_temperature)),
            "shaft": float(self.shaft_ambient * (T[_AXLE] - self.ambient_temperature)),
        }

    def changes(self, temperatures: Array, scene: Scene) -> dict[str, float]:
        """Return the temperatures of oil, rings and rollers, and the clearance where parts expand."""
        known = dict(zip(self.nodes, map(float, temperatures), strict=True))
        o = scene.operation
        b = scene.bearing
        oil = known["oil"]
        inner, rollers, outer = (
            known.get(part, oil) for part in ("inner ring", "rollers", "outer ring")
        )
        changes = {
            "operation.temperature": oil,
            "operation.inner_ring_temperature": inner,
            "operation.roller_temperature": rollers,
            "operation.outer_ring_temperature": outer,
        }
        if b.mounted is not None:
            changes["bearing.radial_clearance"] = operating_clearance(
                b, (o.inner_speed, o.outer_speed), (inner, rollers, outer), rigid=b.mounted.rigid
            ).clearance
        elif self.expansion > 0.0:
            changes["bearing.radial_clearance"] = b.radial_clearance + self.expansion * (
                b.outer_raceway_diameter * (outer - o.outer_ring_temperature)
                - b.inner_raceway_diameter * (inner - o.inner_ring_temperature)
                - 2.0 * b.roller_diameter * (rollers - o.roller_temperature)
            )
        return changes

    @property
    def inlet(self) -> tuple[float, float] | None:
        """Temperature of the oil at its inlet [K] and its heat capacity flow [W/K]; None without a flow."""
        if not self.oil_flow or self.oil_inlet_temperature is None:
            return None
        return self.oil_inlet_temperature, self.oil_flow * self.oil_specific_heat


def _estimates(model: Network, assembly: "Assembly") -> dict[str, Any]:
    """Return estimates of conductances and capacities by size and speed of a bearing, by parameter; see `Network`."""
    b = assembly.scene.bearing
    k = assembly.kinematics
    scene = assembly.scene
    oil = assembly.lubricant.at(scene.operation.temperature)
    width = _WIDTH * b.roller_length
    bore, outside = b.boundaries
    seats = {"shaft": math.pi * bore * width, "housing": math.pi * outside * width}
    area = sum(seats.values())
    flux = _REFERENCE_FLUX * max(area / _REFERENCE_AREA, 1.0) ** _FLUX_EXPONENT
    estimates: dict[str, float] = {}
    for ring, part in (("inner_ring", "shaft"), ("outer_ring", "housing")):
        whole = flux * seats[part] / _REFERENCE_EXCESS
        seat = _SEAT_CONDUCTANCE * seats[part]
        estimates[f"{ring}_{part}"] = model.surroundings_factor * seat
        estimates[f"{part}_ambient"] = model.surroundings_factor / (1.0 / whole - 1.0 / seat)
    density = DENSITY
    if assembly.lubricant.density is not None:
        density = assembly.lubricant.density(scene.operation.temperature)
    if scene.lubrication.oil_flow is not None:
        estimates["oil_flow"] = scene.lubrication.oil_flow * density
    else:
        carried = flux * area if scene.lubrication.supply in PUMPED else 0.0
        estimates["oil_flow"] = carried / (model.oil_specific_heat * _OIL_RISE)
    nu = oil.viscosity / density
    diffusivity = oil.conductivity / (density * model.oil_specific_heat)
    pitch = 2.0 * k.orbit_radius
    speed = max(abs(k.epicyclic_cage_speed), 0.1 * k.epicyclic_roller_speed) * k.orbit_radius / 3.0
    plate = (
        0.332
        * math.sqrt(speed * pitch / nu)
        * (nu / diffusivity) ** (1.0 / 3.0)
        * oil.conductivity
        / pitch
    )
    wetted = {
        "inner_ring": math.pi * b.inner_raceway_diameter * width,
        "rollers": b.rollers * math.pi * b.roller_diameter * b.roller_length,
        "outer_ring": math.pi * b.outer_raceway_diameter * width,
    }
    estimates |= {
        f"oil_{part}": model.oil_factor * plate * surface for part, surface in wetted.items()
    }
    rolling = k.roller_radius * k.epicyclic_roller_speed
    mean = (2.0 * scene.operation.radial_load / b.rollers + 1.0) / b.roller_length
    for raceway in assembly.raceways:
        slices = raceway.evaluate(np.array([mean]), rolling, 0.0)
        across = 2.0 * float(slices.half_width[0])
        film = float(slices.film_thickness[0])
        flash = math.sqrt(math.pi * across / rolling) / raceway.conditions.effusivity
        area = b.rollers * b.roller_length * across
        estimates[f"{raceway.ring}_ring_rollers"] = (
            model.contact_factor * area / (film / oil.conductivity + flash)
        )
    materials = {
        "rollers": b.material,
        "inner_ring": b.material_of("inner"),
        "outer_ring": b.material_of("outer"),
    }
    heat = {part: m.density * m.specific_heat for part, m in materials.items()}
    heat |= {"shaft": heat["inner_ring"], "housing": heat["outer_ring"]}
    rings = {
        "inner_ring": 0.25 * math.pi * (b.inner_raceway_diameter**2 - bore**2) * width,
        "outer_ring": 0.25 * math.pi * (outside**2 - b.outer_raceway_diameter**2) * width,
    }
    rollers = b.rollers * 0.25 * math.pi * b.roller_diameter**2 * b.roller_length
    free = (
        0.25 * math.pi * (b.outer_raceway_diameter**2 - b.inner_raceway_diameter**2) * width
        - rollers
    )
    both = sum(rings.values())
    volumes = rings | {"rollers": rollers, "housing": _HOUSING * both, "shaft": _SHAFT * both}
    estimates |= {f"{part}_capacity": heat[part] * volume for part, volume in volumes.items()}
    estimates["oil_capacity"] = (
        density * model.oil_specific_heat * _OIL_FRACTION * max(free, 0.1 * rollers)
    )
    estimates["oil_inlet_temperature"] = scene.operation.temperature
    return estimates
