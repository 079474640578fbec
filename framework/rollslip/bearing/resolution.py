"""Define the numerical resolution of a run: every numerical choice in one frozen value.

- The scene says what is modelled, the resolution how it is computed. Nothing below the plan has numerical defaults of
  its own, so that two runs with the same scene and the same resolution give the same numbers, and the cost can be
  compared with the error.
- A study runs exactly the resolution it is given. Only without a number of roller positions (`as_stated`, for a scene
  without a plan) the study doubles them until its results converge.
- Equal slices after ISO/TS 16281 lie at their midpoints. Gauss-Legendre points need fewer slices where a contact is
  loaded to its ends; where the contact ends before, both converge with the square of the number of slices. Graded
  slices need fewer than equal ones where only the middle of a profile is loaded.
"""

import abc
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Final, TypeAlias

import attrs
import numpy as np

from rollslip.errors import RollslipError
from rollslip.fields import at_least, choice_of, in_range, parameter
from rollslip.models.profile import profile_drop, slice_positions
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip_kernels.gauss import legendre
from rollslip_kernels.slices import Slices

#: Key of [accuracy], or name of a number -> relative error.
Errors: TypeAlias = Mapping[str, float]

#: Advice on how to make tables coarser, and a run faster. A plan takes the error of tables from the smallest of these.
COARSER_TABLES: Final = (
    "raise accuracy.tolerance, or accuracy.friction and "
    "accuracy.cage_speed where the scene has them"
)
#: Slices of a scene that is run without a plan. Doubling it divides the error of the quadrature by four and doubles the
#: time. ISO/TS 16281 needs at least 30; chosen three times as fine.
_DEFAULT_SLICES: Final = 101
#: Slices of the reference resolution. Doubling it doubles the time of every verification. Chosen so that the error of
#: the reference, a 64th of that with 101 slices, does not count.
_REFERENCE_SLICES: Final = 801
#: Roller positions within a pitch of the reference resolution. Doubling it doubles the time of every verification.
#: Chosen; an error that falls with the square of the number is then that of 16 positions over 64.
_REFERENCE_POSITIONS: Final = 128
#: Exponent of the edges of graded slices over their number from the middle; 1 gives equal slices. Of 20 bearings of the
#: catalogue with 24 slices the slip is within 10 % of that of 400 with 1, 6 % with 1.5 and 10 % with 2. With twice as
#: much the outermost slice of 24 would be a ninth of the roller.
_GRADING: Final = 1.5
#: Tolerance of tables at the reference resolution. Halving it makes tables larger and changes no error estimate.
#: Chosen a factor of 1000 below tolerances that scenes state.
_REFERENCE_TABLE_TOLERANCE: Final = 1e-7
#: Relative tolerance of a step in time at the reference resolution. Halving it takes more steps and changes no error
#: estimate. Chosen: far below the tolerances that scenes state, and above the rounding of the friction.
_REFERENCE_STEP_TOLERANCE: Final = 1e-9
#: Factor by which slices and positions of a bearing in motion are refined for its error estimate; tables and steps are
#: refined by its square. Doubling it makes a verification four times as slow. Chosen: by second-order convergence the
#: refined error is a sixteenth and may be neglected.
_REFINEMENT: Final = 4


@attrs.frozen(kw_only=True)
class Resolution:
    """All numerical choices of a run."""

    #: Slices along a roller; one is taken where neither profile nor tilt varies the load along it.
    slices: int = parameter(default=101, doc="slices along a roller", validator=in_range(1, 20_000))
    #: "equal" for midpoints of equal slices (ISO/TS 16281), "gauss" for Gauss-Legendre points and weights, "graded" for
    #: midpoints of slices that are narrower in the middle, where light loads are carried.
    quadrature: str = parameter(
        default="equal", doc="where slices lie", validator=choice_of("equal", "gauss", "graded")
    )
    #: Roller positions within a pitch; None to double them until the results converge.
    n_positions: int | None = parameter(
        default=None,
        doc="roller positions within a pitch",
        validator=attrs.validators.optional(at_least(1)),
    )
    #: "named" for the scene's hydrodynamic law, or the name of a law that replaces it.
    traction: str = parameter(default="named", doc="hydrodynamic law")
    #: Whether boundary friction is included; False for the law of the full film alone.
    boundary: bool = parameter(default=True, doc="whether boundary friction takes part")
    #: Whether shear heating of the inlet thins the film, if the film model includes it.
    inlet_heating: bool = parameter(
        default=True, doc="whether the heat of its inlet thins the film"
    )
    #: Whether the film has a pressure of its own, if the scene names a model of it; False for that of the contact.
    light_contacts: bool = parameter(default=True, doc="whether the film has a pressure of its own")
    #: Error of tables: loads over the orbit, effective friction, the slip-drag curve.
    table_tolerance: float = parameter(
        default=1e-3, unit="1", doc="error of tables", validator=in_range(0, 1, open=True)
    )
    #: Name of the integrator; None for the choice of the study.
    integrator: str | None = parameter(default=None, doc="integrator")
    #: Relative tolerance of its steps [1]; None for the choice of the study.
    integrator_tolerance: float | None = parameter(
        default=None,
        unit="1",
        doc="relative tolerance of a step",
        validator=attrs.validators.optional(in_range(0, 0.1, open=True)),
    )
    #: Friction of the raceways of a bearing in motion; None for the choice of the study.
    friction: str | None = parameter(default=None, doc="friction of the raceways in motion")
    #: Level of detail of a bearing in motion; None for the choice of the study.
    level: str | None = parameter(default=None, doc="level of detail of motion")
    #: Whether stages run compiled where they can, else in NumPy.
    compiled: bool = parameter(default=True, doc="whether stages run compiled")

    @classmethod
    def maximum_of(
        cls, resolutions: Collection["Resolution"], common: Collection[str] = ()
    ) -> "Resolution":
        """Return the finest value of each number; of the fields `common` those values that all resolutions share."""
        largest = max(resolutions, key=lambda resolution: resolution.slices)
        steps = [resolution.integrator_tolerance for resolution in resolutions]
        return cls(
            slices=largest.slices,
            quadrature=largest.quadrature,
            n_positions=max(resolution.n_positions or 1 for resolution in resolutions),
            table_tolerance=min(resolution.table_tolerance for resolution in resolutions),
            integrator_tolerance=min((step for step in steps if step is not None), default=None),
            **{
                name: getattr(largest, name)
                for name in common
                if len({getattr(resolution, name) for resolution in resolutions}) == 1
            },
        )

    def slicing(self, length: float) -> tuple[Array, Array]:
        """Return positions from the middle and widths of the slices of a roller [m], (n,)."""
        if self.quadrature == "equal":
            return slice_positions(length, self.slices), np.full(self.slices, length / self.slices)
        if self.quadrature == "graded":
            # odd and even integers over their number: symmetric about the middle to the last bit
            fraction = np.arange(-self.slices, self.slices + 1, 2) / self.slices
            edges = 0.5 * length * np.copysign(np.abs(fraction) ** _GRADING, fraction)
            return 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        nodes, weights = legendre(self.slices)
        return 0.5 * length * nodes, 0.5 * length * weights


def reference_resolution(scene: Scene) -> Resolution:
    """Return the finest resolution of a scene, with which results are compared.

    A number of slices that the scene states is retained, because it is then part of the model.
    """
    return Resolution(
        slices=scene.accuracy.slices or _REFERENCE_SLICES,
        n_positions=_REFERENCE_POSITIONS,
        table_tolerance=_REFERENCE_TABLE_TOLERANCE,
        integrator_tolerance=_REFERENCE_STEP_TOLERANCE,
    )


def refined(scene: Scene, own: Resolution, step: float = 1.0) -> Resolution:
    """Return a resolution with four times as many slices and positions, and with tables and steps 16 times as accurate.

    It verifies bearings in motion, for which the reference resolution would take days. ``step`` is the relative
    tolerance of steps in time [1] that is refined.
    """
    reference = reference_resolution(scene)
    return attrs.evolve(
        reference,
        slices=scene.accuracy.slices or min(_REFINEMENT * own.slices, reference.slices),
        n_positions=min(_REFINEMENT * (own.n_positions or 1), reference.n_positions or 1),
        table_tolerance=own.table_tolerance / _REFINEMENT**2,
        integrator_tolerance=max(step / _REFINEMENT**2, reference.integrator_tolerance or 0.0),
    )


def as_stated(scene: Scene) -> Resolution:
    """Return the resolution of a scene without a plan: its tolerance for tables, positions doubled to convergence."""
    return Resolution(
        slices=scene.accuracy.slices or _DEFAULT_SLICES, table_tolerance=scene.accuracy.tolerance
    )


def error_text(errors: Mapping[str, float | None]) -> str:
    """Return estimated errors as text: "friction 3e-04, critical slip 8e-05"."""
    return ", ".join(
        f"{name.replace('_', ' ')} {error:.0e}"
        for name, error in errors.items()
        if error is not None
    )


def combine_errors(errors: Iterable[Errors], by: Callable[[list[float]], float]) -> Errors:
    """Return the sum or the maximum of several errors, result by result; a result that one of them lacks counts as 0.

    Parameters
    ----------
    errors : iterable of mappings
        Relative errors by result.
    by : callable
        `sum` or `max`.
    """
    parts = [*errors]
    names = dict.fromkeys(name for part in parts for name in part)
    return {name: by([part.get(name, 0.0) for part in parts]) for name in names}


class BoundBrokenError(RollslipError):
    """A simplification is not allowed after all; ``bound`` is the one that was exceeded."""

    def __init__(self, bound: "LeftOut", found: str) -> None:
        super().__init__(f"{bound.what} was left out, but {found}; it was reinstated")
        self.bound = bound


class LeftOut(abc.ABC):
    """An effect that is left out under a bound, which is checked on every evaluated table of slices."""

    @property
    @abc.abstractmethod
    def what(self) -> str:
        """The effect that is left out, as messages name it."""

    @abc.abstractmethod
    def __call__(self, slices: Slices) -> None:
        """Check the bound on evaluated slices."""

    @abc.abstractmethod
    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return a resolution that includes the effect."""


def tilting(scene: Scene) -> str:
    """Return what loads the contacts of a scene unevenly apart from the profile; empty where nothing does."""
    causes = {
        "the misalignment": scene.operation.misalignment != 0.0,
        "the axial load": bool(scene.operation.axial_load),
    }
    return " and ".join(cause for cause, is_there in causes.items() if is_there)


def slicing(scene: Scene, resolution: Resolution) -> tuple[Array, Array, Array]:
    """Return positions, widths and profile of the slices [m], (n,) each; a single slice where the load is uniform."""
    b = scene.bearing
    if b.profile.shape == "none" and not tilting(scene):
        return np.zeros(1), np.full(1, b.roller_length), np.zeros(1)
    position, widths = resolution.slicing(b.roller_length)
    drop = profile_drop(
        b.profile.shape,
        position,
        b.roller_length,
        b.roller_diameter,
        radius=b.profile.radius,
        table=(b.profile.position, b.profile.drop) if b.profile.shape == "table" else None,
    )
    return position, widths, b.profile.depth_factor * drop


def resolution_numbers(resolution: Resolution) -> dict[str, int]:
    """Return the numbers of slices and roller positions of a resolution, by the names of its fields."""
    return {"slices": resolution.slices, "n_positions": resolution.n_positions or 1}
