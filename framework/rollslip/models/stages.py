"""What a contact, film, traction, drag or integrator model must offer.

- A model is an immutable value: same parameters and slices, same result. Its parameters are its attrs fields.
- Contact, film and traction are the same thing, a stage that reads some members of a table of slices and fills
  others; so they share one base, one C struct and one binder.
- ``evaluate`` in NumPy is required because it is the readable reference; ``kernel`` is the same law compiled.
- Ranges are data: ``domain`` is what a law is defined on (outside it a status, never a number), ``validity`` is what
  it was made for (outside it a warning), so errors, docs and property tests read the same numbers.
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
from rollslip.models.validity import ISOTHERMAL, SMOOTH, Validity, in_regime
from rollslip.references import Citation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from rollslip_kernels.slices import Slices


def submodel(
    kind: str, *, factory: Callable[[], object] | None = None, default: str = "", doc: str
) -> Any:
    """Declare a parameter that is itself a model of ``kind``: in a scene a name, or a table with ``model``.

    Without a value it is what ``factory`` makes, or the model called ``default``: "muraki", of whatever package.
    """
    if (factory is None) == (not default):
        raise TypeError(
            f"a submodel of kind {kind!r} takes a factory or the name of its default, one of them"
        )

    made = factory or (lambda: import_module("rollslip").get_model(kind, default))
    return attrs.field(factory=made, metadata={"doc": doc, "unit": None, "kind": kind})


class SliceModel(abc.ABC):
    """A stage: fills the ``writes`` columns of all slices from the members named in ``reads``."""

    name: ClassVar[str]
    #: The law in one line, in the symbols of its docstring.
    equation: ClassVar[str]
    #: Where it comes from: values of `rollslip.references.Reference`, or texts, one citation each.
    references: ClassVar[tuple[Citation, ...]]
    reads: frozenset[str]
    writes: frozenset[str]
    #: Member -> (low, high), both included, in SI units: where the law is defined.
    domain: Domain
    #: What it was made for: outside of it a warning.
    validity: ClassVar[tuple[Validity, ...]] = ()
    #: Quantities of the validity of its submodels that it takes care of, so that they need not be told.
    covers: ClassVar[frozenset[str]] = frozenset()
    #: Rule of the conformance kit that the law breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Relative difference allowed between the compiled and the NumPy form.
    tolerance: ClassVar[float] = 1e-12
    #: Quantities of its own that results give beside its columns: name -> (SI unit, meaning), as `quantities` has them.
    outputs: ClassVar[Mapping[str, tuple[str, str]]] = MappingProxyType({})

    def quantities(self, slices: "Slices") -> "Mapping[str, NDArray[Any]]":
        """Return quantities of evaluated slices: those that its `validity` is stated in, and its `outputs`."""
        return {}

    @abc.abstractmethod
    def evaluate(self, slices: "Slices") -> None:
        """Fill the ``writes`` columns of all slices, with NumPy.

        The arrays belong to the caller and may be gone after the call: copy what is to be kept.
        """

    def kernel(self) -> object | None:
        """Return the same law as a capsule of ``rollslip.h``, or None to run ``evaluate``."""
        return None


class ContactModel(SliceModel):
    """Half width and mean pressure from the load per length, and the deflection law behind the load."""

    validity: ClassVar[tuple[Validity, ...]] = (
        Validity(
            code="W07",
            quantity="width_ratio",
            high=0.1,
            consequence="a circle is no parabola over the width of the contact: the gap is {error} off at its edge",
            error=lambda ratio: 25.0 * ratio**2,
            remedy="a law of conforming surfaces; there is none in the box",
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
        """Return the stage that fills load and stiffness from the approach."""


class FilmModel(SliceModel):
    """Film thickness from load, speed and oil."""

    reads = frozenset(
        {"load", "rolling_speed", "radius", "modulus", "viscosity", "pressure_viscosity"}
    )
    writes = frozenset({"film_thickness"})
    domain = MappingProxyType(
        {**dict.fromkeys(sorted(reads), POSITIVE), "pressure_viscosity": NON_NEGATIVE}
    )
    #: Which film thickness it returns: "minimum", "central" or "dp/dx = 0".
    location: ClassVar[str]
    #: Film regime it holds in: "IR", "VR", "IE", "VE", or "all".
    regime: ClassVar[str] = "all"
    #: Per cent that its film is off in other regimes, least and largest; None where nobody knows.
    elsewhere: ClassVar[tuple[float, float] | None] = None
    #: Whether fronts of error against cost hold it against others where nobody names films.
    on_fronts: ClassVar[bool] = False

    @property
    def validity(self) -> tuple[Validity, ...]:  # type: ignore[override]
        """Its regime, an isothermal inlet and smooth surfaces."""
        return (*in_regime(self.regime, self.elsewhere), ISOTHERMAL, SMOOTH)

    @property
    def inlet_heating(self) -> str:
        """Law by which shear heating of the inlet thins the film; empty if the inlet is isothermal."""
        return ""

    @property
    def isothermal(self) -> "FilmModel":
        """The same film with a cold inlet; itself if its inlet is isothermal."""
        return self

    @property
    def inlet_starvation(self) -> str:
        """What a starved inlet is thinned by, in words; empty if it is fully flooded."""
        return ""

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
    """Mean pressure in the film and its half width, which viscosity and traction read; the load stays, w = 2 b p."""

    reads = FilmModel.reads
    domain = FilmModel.domain
    writes = ContactModel.writes
    #: Whether it leaves what the contact model fills, so that it is no stage of the chain.
    of_contact: ClassVar[bool] = False


class TractionModel(SliceModel):
    """Traction coefficient, with the sign of the sliding speed."""

    writes = frozenset({"friction"})
    #: Name of a closed form that may serve in place of the law where the difference is allowed; None if there is none.
    closed_form: ClassVar[str | None] = None
    #: Name of the law that solves the equation of which this law is an approximation; None if it is none.
    solved_by: ClassVar[str | None] = None
    #: By what comparisons sort slices, little up to 0.1 and much beyond 1: name -> one of `quantities`, its symbol.
    regimes: ClassVar[Mapping[str, tuple[str, str]]] = MappingProxyType({})
    #: What the conformance kit holds friction over slip to: "cold" and "heated" -> "rises", "one maximum" or "at most
    #: one maximum", and "bound" -> name of the parameter, or of the method of slices, that it stays below.
    shapes: ClassVar[Mapping[str, str]] = MappingProxyType({})

    def groups(self, slices: "Slices") -> "Mapping[str, NDArray[Any]]":
        """Return the dimensionless groups of evaluated slices with which the law and its closed form grow apart.

        A plan that takes the closed form watches that no group leaves the range in which it compared the two; where
        there are no groups, it does not take it.
        """
        return {}

    def quantities(self, slices: "Slices") -> "Mapping[str, NDArray[Any]]":
        """Return the groups of the law, in which its validity may be stated."""
        return self.groups(slices)

    @property
    def full_film_from(self) -> float | None:
        """Film parameter from which on no boundary friction takes part; None if the model has none."""
        return None

    @property
    def boundary_up_to(self) -> float:
        """Film parameter up to which there is boundary friction alone; 0 if a film always has a share."""
        return 0.0

    @property
    def full_film(self) -> "TractionModel":
        """Law of the full film alone; the model itself if it has no boundary friction."""
        return self

    def with_full_film(self, law: "TractionModel") -> "TractionModel":
        """Return the model with another law of the full film; that law itself if it has no boundary friction."""
        return law


class Drag(abc.ABC):
    """What resists the cage or the rollers beside the traction of the raceways: one of the three sorts below."""

    name: ClassVar[str]
    equation: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]]

    def check_given(self) -> None:
        """Raise a `DomainError` where a parameter is still left to a scene."""
        if missing := left_to_scene(self):
            names = ", ".join(a.name for a in missing)
            raise DomainError(
                f"drag {self.name!r} takes {names} from a scene; outside of one give them"
            )


class DragModel(Drag):
    """Torque on the cage [N m], from the speeds of cage and rings."""

    #: Ring that bears the reaction, "inner" or "outer"; empty for what stands still: housing, oil, air.
    against: str = ""
    #: Whether the torque varies in time; ``torque`` then has a fourth argument ``time``, s since the motion began, by
    #: default any. Only motions in time have such a torque: what asks for a steady one is refused.
    varies_in_time: bool = False
    #: Rule of the conformance kit that the law breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Relative difference allowed between the compiled and the Python form.
    tolerance: ClassVar[float] = 1e-12

    @abc.abstractmethod
    def torque(self, cage_speed: float, inner_speed: float, outer_speed: float) -> float:
        """Return the torque on the cage [N m], positive where it accelerates the cage; speeds in rad/s."""

    def kernel(self) -> object | None:
        """Return the same law as a capsule ``rs_drag`` of ``rollslip.h``, or None to call ``torque``."""
        return None


class ResistanceModel(SliceModel, Drag):
    """Rolling resistance [N/m]: a force F on each of the two surfaces, against its rolling; it takes the power 2 F u.

    The stage runs after that of traction, on loaded slices; where the motion stops or turns back, at a rolling speed
    of its size with a floor of 1 mm/s.
    """

    writes = frozenset({"resistance"})


class PocketFriction(Drag):
    """Friction of a roller that spins in its pocket, mu_p P against the spin, with P the normal force of the pocket."""

    #: Coefficient mu_p [1].
    coefficient: float


class IntegratorModel(abc.ABC):
    """A factory of ``scipy.integrate.OdeSolver``, so that SciPy's solvers come as they are."""

    #: Rule of the conformance kit that the solver breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Order of convergence of a method that has a fixed one.
    order: ClassVar[int | None] = None
    #: Whether its steps solve no equations; a plan then tries it where motions are not stiff.
    explicit: ClassVar[bool] = False
    name: ClassVar[str]
    equation: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]]

    @abc.abstractmethod
    def solver(self) -> type[Any]:
        """Return the OdeSolver class."""

    def compiled(self) -> type[Any] | None:
        """Return the class that goes through many steps of a compiled system at once, or None.

        Its interface is that of `rollslip_kernels.motion.rosenbrock.Stepper`.
        """
        return None
