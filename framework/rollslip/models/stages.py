"""Base classes of contact, film, traction, drag, rib and integrator models.

- A model is an immutable value: equal parameters and slices give the same result. Its parameters are its attrs fields.
- Contact, film and traction models are stages of a chain, which read some members of a table of slices and fill
  others. They share a base class, a C struct and a binder.
- ``evaluate`` in NumPy is required as the readable reference; ``kernel`` is the same law compiled.
- Ranges are data: ``domain`` is the range in which a law is defined (outside it there is a status and no number),
  ``validity`` the range for which it was made (outside it there is a warning). So errors, documentation and property
  tests read the same numbers.
"""

import abc
import math
from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from rollslip.errors import DomainError
from rollslip.models.domains import NON_NEGATIVE, POSITIVE, Domain, evaluate_arrays
from rollslip.models.scene_values import left_to_scene
from rollslip.models.validity import ISOTHERMAL, MEAN_PRESSURE, SMOOTH, Validity, in_regime
from rollslip.references import CitedModel

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from rollslip_kernels.slices import Conditions, Slices


def submodel(
    kind: str, *, factory: Callable[[], object] | None = None, default: str = "", doc: str
) -> Any:
    """Declare a parameter that is itself a model of ``kind``: in a scene a name, or a table with ``model``.

    Its default is the result of ``factory``, or the model with the name ``default``, such as "muraki", of any package.
    """
    if (factory is None) == (not default):
        raise TypeError(
            f"a submodel of kind {kind!r} takes a factory or the name of its default, one of them"
        )

    make = factory or (lambda: import_module("rollslip").get_model(kind, default))
    return attrs.field(factory=make, metadata={"doc": doc, "unit": None, "kind": kind})


def common_domain(*domains: Domain) -> Domain:
    """Return the domain in which several laws are defined together, with the members of all of them.

    Parameters
    ----------
    *domains : mapping of str to tuple
        Smallest and largest value of each member, by law.
    """
    both: dict[str, tuple[float, float]] = {}
    for domain in domains:
        for member, (low, high) in domain.items():
            other_low, other_high = both.get(member, (low, high))
            both[member] = (max(low, other_low), min(high, other_high))
    return MappingProxyType(both)


class SliceModel(CitedModel):
    """A stage of a chain: it fills the columns in ``writes`` of all slices from the members in ``reads``."""

    #: Members of the slices that the law reads.
    reads: frozenset[str]
    #: Columns of the slices that the law fills.
    writes: frozenset[str]
    #: Member -> (low, high), both included, in SI units: the range in which the law is defined.
    domain: Domain
    #: Ranges for which the law was made; outside them there is a warning.
    validity: ClassVar[tuple[Validity, ...]] = ()
    #: Quantities in the validity of its submodels that the law corrects, so that their warnings do not apply.
    covers: ClassVar[frozenset[str]] = frozenset()
    #: Relative difference allowed between the compiled and the NumPy form.
    tolerance: ClassVar[float] = 1e-12
    #: Quantities of its own that results give beside its columns: name -> (SI unit, meaning), as `quantities` has them.
    outputs: ClassVar[Mapping[str, tuple[str, str]]] = MappingProxyType({})

    def quantities(self, slices: "Slices") -> "Mapping[str, NDArray[Any]]":
        """Return quantities of evaluated slices: those that its `validity` is stated in, and its `outputs`."""
        return {}

    @abc.abstractmethod
    def evaluate(self, slices: "Slices") -> None:
        """Fill the columns in ``writes`` of all slices, with NumPy.

        The arrays belong to the caller and may not exist after the call; a model that stores values has to copy them.
        """

    def kernel(self) -> object | None:
        """Return the compiled law as a capsule of ``rollslip.h``, or None to run ``evaluate``."""
        return None


class ContactModel(SliceModel):
    """Half width and mean pressure from the load per length, and the deflection law behind the load."""

    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            code="W07",
            quantity="width_ratio",
            high=0.1,
            consequence="a circle is not a parabola over the width of the contact: the gap is {error} off at its edge",
            error=lambda ratio: 25.0 * ratio**2,
            remedy="no built-in model covers conforming surfaces",
            source="next term of the circle's series, (b/R)^2/4",
        ),
        Validity(
            code="W08",
            quantity="pressure",
            high=0.25 * math.pi * 4e9,
            consequence="hard bearing steel yields, and an elastic law has nothing to say",
            remedy="a lower load, or a plastic law of contact",
            source="ISO 76: a largest Hertz pressure of 4 GPa leaves a dent of 1e-4 of the roller's diameter (B)",
        ),
    )
    reads = frozenset({"load", "radius", "modulus"})
    writes = frozenset({"half_width", "pressure"})
    domain = MappingProxyType({"load": POSITIVE, "radius": POSITIVE, "modulus": POSITIVE})

    @abc.abstractmethod
    def deflection(self) -> SliceModel:
        """Return the stage that computes load and stiffness from the approach."""


class FilmModel(SliceModel):
    """Film thickness from load, speed and oil."""

    reads = frozenset(
        {"load", "rolling_speed", "radius", "modulus", "viscosity", "pressure_viscosity"}
    )
    writes = frozenset({"film_thickness"})
    domain = MappingProxyType(
        {**dict.fromkeys(sorted(reads), POSITIVE), "pressure_viscosity": NON_NEGATIVE}
    )
    #: Location of the film thickness: "minimum", "central" or "dp/dx = 0".
    location: ClassVar[str]
    #: Film regime of the formula: "IR", "VR", "IE", "VE", or "all".
    regime: ClassVar[str] = "all"
    #: Smallest and largest error of the film in other regimes [%]; None where it is unknown.
    other_regime_error: ClassVar[tuple[float, float] | None] = None
    #: Whether it gives the film of a contact at any load, so that rollers may be kept apart from the rings by it.
    at_any_load: ClassVar[bool] = True
    #: Whether Pareto fronts of error against cost include it where no films are requested.
    on_fronts: ClassVar[bool] = False
    #: Oil on both surfaces together before a contact [m], where the model takes one; NaN leaves it to a scene.
    oil_layer: float = math.inf
    #: Exponent g of a film that a layer limits, (h^-g + layer^-g)^(-1/g): the larger, the less oil flows to the sides.
    #: Rollers in two dimensions agree with 4 to 9 %.
    layer_exponent: float = 4.0

    @property
    def validity(self) -> tuple[Validity, ...]:  # type: ignore[override]
        """Bounds of its regime, of an isothermal inlet and of smooth surfaces."""
        return (*in_regime(self.regime, self.other_regime_error), ISOTHERMAL, SMOOTH)

    @property
    def inlet_heating(self) -> str:
        """Name of the law by which shear heating of the inlet thins the film; empty if the inlet is isothermal."""
        return ""

    @property
    def isothermal(self) -> "FilmModel":
        """The same film model with an isothermal inlet; the model itself if its inlet is isothermal."""
        return self

    @property
    def flooded(self) -> "FilmModel":
        """The same film model with a fully flooded inlet; the model itself if its inlet is flooded."""
        return self

    def film_thickness(
        self,
        load_per_length: "ArrayLike",
        rolling_speed: "ArrayLike",
        radius: "ArrayLike",
        modulus: "ArrayLike",
        viscosity: "ArrayLike",
        pressure_viscosity: "ArrayLike",
    ) -> "NDArray[Any]":
        """Return the film thickness [m]; arguments broadcast.

        Parameters
        ----------
        load_per_length : array_like
            Normal force per length w [N/m], > 0.
        rolling_speed : array_like
            Mean surface speed u [m/s], > 0.
        radius, modulus : array_like
            Equivalent radius R [m] and modulus E' [Pa].
        viscosity, pressure_viscosity : array_like
            Dynamic viscosity at ambient pressure eta0 [Pa s] and pressure-viscosity coefficient alpha [1/Pa].

        Raises
        ------
        DomainError
            If an argument is outside the model's domain.
        """
        return evaluate_arrays(
            self,
            "film_thickness",
            load=load_per_length,
            rolling_speed=rolling_speed,
            radius=radius,
            modulus=modulus,
            viscosity=viscosity,
            pressure_viscosity=pressure_viscosity,
        )


class PressureModel(SliceModel):
    """Mean pressure in the film and its half width, which viscosity and traction read, at the same load w = 2 b p."""

    reads = FilmModel.reads
    domain = FilmModel.domain
    writes = ContactModel.writes
    #: Whether the pressure is that of the contact model, so that the chain does not need this stage.
    of_contact: ClassVar[bool] = False


class TractionModel(SliceModel):
    """Traction coefficient, with the sign of the sliding speed."""

    writes = frozenset({"friction"})
    #: Name of a closed form that may replace the law where the difference is below the tolerance; None without one.
    closed_form: ClassVar[str | None] = None
    #: Name of the law that solves the equation of which this law is an approximation; None for other laws.
    solved_by: ClassVar[str | None] = None
    #: Regimes by which comparisons sort slices, weak up to 0.1 and strong beyond 1: name -> name of one of `quantities`
    #: and its symbol.
    regimes: ClassVar[Mapping[str, tuple[str, str]]] = MappingProxyType({})
    #: Shape of friction over slip, which the conformance kit checks: "cold" and "heated" -> "rises", "one maximum", "at
    #: most one maximum", which is that of a law that declares none, or "any"; and "bound" -> name of the parameter, or
    #: of the method of slices, that is its upper bound.
    shapes: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Pressure at which a law takes the ``film_viscosity`` that it reads: "mean" of the contact, or "local" for a law
    #: that corrects it. A law of the mean pressure has the validity `MEAN_PRESSURE`, unless it states another W11.
    viscosity_at: ClassVar[str] = "mean"

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if (
            isinstance(reads := getattr(cls, "reads", None), frozenset)
            and "film_viscosity" in reads
            and cls.viscosity_at == "mean"
            and isinstance(cls.validity, tuple)
            and MEAN_PRESSURE.code not in [bound.code for bound in cls.validity]
        ):
            cls.validity = (*cls.validity, MEAN_PRESSURE)

    def groups(self, slices: "Slices") -> "Mapping[str, NDArray[Any]]":
        """Return the dimensionless groups of evaluated slices on which the error of the closed form depends.

        A plan that uses the closed form checks that no group leaves the range in which it compared both laws. Without
        groups the closed form is not used.
        """
        return {}

    def quantities(self, slices: "Slices") -> "Mapping[str, NDArray[Any]]":
        """Return the dimensionless groups of evaluated slices in which the validity of the law may be stated."""
        return self.groups(slices)

    @property
    def full_film_from(self) -> float | None:
        """Film parameter from which on there is no boundary friction; None for a law without boundary friction."""
        return None

    @property
    def boundary_up_to(self) -> float:
        """Film parameter up to which there is boundary friction only; 0 if the film always carries a fraction."""
        return 0.0

    @property
    def full_film(self) -> "TractionModel":
        """Law of the full film; the model itself if it has no boundary friction."""
        return self

    def with_full_film(self, law: "TractionModel") -> "TractionModel":
        """Return the model with another law of the full film; that law itself if it has no boundary friction."""
        return law


class Drag(CitedModel):
    """A drag on the cage or the rollers other than the traction of the raceways: one of the three sorts below."""

    def check_given(self) -> None:
        """Raise a `DomainError` where a parameter has to be taken from a scene."""
        if missing := left_to_scene(self):
            names = ", ".join(a.name for a in missing)
            raise DomainError(
                f"drag {self.name!r} takes {names} from a scene; outside of one give them"
            )


class DragModel(Drag):
    """Torque on the cage [N m], from the speeds of cage and rings."""

    #: Ring on which the reaction acts, "inner" or "outer"; empty for parts at rest: housing, oil, air.
    against: str = ""
    #: Whether the torque varies over time; ``torque`` then has a fourth argument ``time`` with a default, the time
    #: since the start of the motion [s]. Such a torque is refused for steady motions.
    varies_in_time: bool = False
    #: Relative difference allowed between the compiled and the Python form.
    tolerance: ClassVar[float] = 1e-12

    @abc.abstractmethod
    def torque(self, cage_speed: float, inner_speed: float, outer_speed: float) -> float:
        """Return the torque on the cage [N m], positive where it accelerates the cage; speeds in rad/s."""

    def kernel(self) -> object | None:
        """Return the compiled law as a capsule ``rs_drag`` of ``rollslip.h``, or None to call ``torque``."""
        return None


class ResistanceModel(SliceModel, Drag):
    """Rolling resistance [N/m]: a force F on each of the two surfaces, against its rolling, with the power 2 F u.

    The stage runs after that of traction, on loaded slices. Where the rolling speed is zero or negative, its absolute
    value is used, at least 1 mm/s.
    """

    writes = frozenset({"resistance"})


class PocketFriction(Drag):
    """Friction of a roller that spins in its pocket, mu_p P against the spin, with P the normal force of the pocket."""

    #: Coefficient mu_p [1].
    coefficient: float


@attrs.frozen(kw_only=True, eq=False)
class RibContact:
    """Contacts of roller ends with a rib: a sphere on a plane, at n loads and speeds."""

    #: Oil and steel; ``radius`` is that of the roller's end, ``length`` the height of the contact above the raceway.
    conditions: "Conditions"
    load: "NDArray[Any]"  #: Normal force Q [N], above 0, (n,).
    rolling_speed: "NDArray[Any]"  #: Mean surface speed u [m/s], above 0, (n,).
    sliding_speed: "NDArray[Any]"  #: Difference of the surface speeds V [m/s], signed, (n,).


class RibModel(CitedModel):
    """Friction of a roller's end on a rib; its parameters are its attrs fields.

    The friction is odd in the sliding speed at the same rolling speed, takes power, and rises with the load. Where the
    sliding speed passes zero it has no jump: a roller whose ribs do not slide would find no balance of its torques.
    """

    @abc.abstractmethod
    def friction(self, contact: RibContact) -> "NDArray[Any]":
        """Return the friction force [N], (n,), with the sign of the sliding speed.

        Parameters
        ----------
        contact : RibContact
            Loads, speeds, oil and geometry.
        """


class IntegratorModel(CitedModel):
    """A factory of ``scipy.integrate.OdeSolver``, so that SciPy's solvers can be used as they are."""

    #: Order of convergence of a method that has a fixed one.
    order: ClassVar[int | None] = None
    #: Whether the method is explicit; a plan then tries it where motions are not stiff.
    explicit: ClassVar[bool] = False

    @abc.abstractmethod
    def solver(self) -> type[Any]:
        """Return the OdeSolver class."""

    def compiled(self) -> type[Any] | None:
        """Return the class that takes many steps of a compiled system in one call, or None.

        Its interface is that of `rollslip_kernels.motion.rosenbrock.Stepper`.
        """
        return None
