"""How finely a scene is computed: every numerical choice in one frozen value.

- What is modelled is the scene's; this is how. Nothing below the plan has numerical defaults of its own, so that two
  runs with the same scene and the same resolution give the same numbers, and cost can be held against error.
- A study runs exactly the resolution it is given. Only one without a number of instants doubles them until its results
  stand still (`as_stated`, what a scene gets that nobody planned).
- Equal slices after ISO/TS 16281 lie at their midpoints. The points of Gauss and Legendre need fewer where a contact is
  loaded to its ends; where it parts from its ring before, both converge with the square of the number of slices.
"""

import abc
from collections.abc import Collection, Mapping
from typing import Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.errors import RollslipError
from rollslip.fields import at_least, choice_of, in_range, parameter
from rollslip.profile import profile_drop, slice_positions
from rollslip.scene.values import Scene
from rollslip_kernels.gauss import legendre
from rollslip_kernels.slices import Slices

Array = NDArray[np.float64]

#: What makes tables coarser, of which a plan takes the error from the least of these.
COARSER_TABLES: Final = (
    "raise accuracy.tolerance, or accuracy.friction and "
    "accuracy.cage_speed where the scene has them"
)
#: Slices of a scene that nobody planned.
_SLICES: Final = 101
#: Slices and instants of the finest resolution.
_FINEST_SLICES: Final = 801
_REFERENCE_POSITIONS: Final = 128
#: Tolerances of tables and of a step in time at the finest.
_FINEST_TABLE: Final = 1e-7
_FINEST_STEP: Final = 1e-9
#: How much finer bearings in motion are computed to verify them.
_FINER: Final = 4


@attrs.frozen(kw_only=True)
class Resolution:
    """All numerical choices of a run."""

    #: Slices along a roller, where a profile or a tilt needs them; elsewhere one serves.
    slices: int = parameter(default=101, doc="slices along a roller", validator=in_range(1, 20_000))
    #: Midpoints of equal slices (ISO/TS 16281), or the points and weights of Gauss and Legendre.
    quadrature: str = parameter(
        default="equal", doc="where slices lie", validator=choice_of("equal", "gauss")
    )
    #: Instants of a roller pitch; None to double them until the results stand still.
    n_positions: int | None = parameter(
        default=None,
        doc="roller positions within a pitch",
        validator=attrs.validators.optional(at_least(1)),
    )
    #: "named" for the scene's hydrodynamic law, or the name of a law that serves in its place.
    traction: str = parameter(default="named", doc="hydrodynamic law")
    #: Whether boundary friction takes part; False for the law of the full film alone.
    boundary: bool = parameter(default=True, doc="whether boundary friction takes part")
    #: Whether the heat of its inlet thins the film, if the film model knows it.
    inlet_heating: bool = parameter(
        default=True, doc="whether the heat of its inlet thins the film"
    )
    #: Whether the film has a pressure of its own, if the scene names a model of it; False for that of the contact.
    light_contacts: bool = parameter(default=True, doc="whether the film has a pressure of its own")
    #: Error of tables: loads over the orbit, effective friction, the slip-drag curve.
    table_tolerance: float = parameter(
        default=1e-3, unit="1", doc="error of tables", validator=in_range(0, 1, open=True)
    )
    #: integrator, integrator_tolerance: Name of the integrator and relative tolerance of its steps; None for what the
    #: study says.
    integrator: str | None = parameter(default=None, doc="integrator")
    integrator_tolerance: float | None = parameter(
        default=None,
        unit="1",
        doc="relative tolerance of a step",
        validator=attrs.validators.optional(in_range(0, 0.1, open=True)),
    )
    #: friction, level: Friction and level of detail of a bearing in motion; None for what the study says.
    friction: str | None = parameter(default=None, doc="friction of the raceways in motion")
    level: str | None = parameter(default=None, doc="level of detail of motion")
    #: Whether stages run compiled where they can, else in NumPy.
    compiled: bool = parameter(default=True, doc="whether stages run compiled")

    @classmethod
    def maximum_of(
        cls, some: Collection["Resolution"], alike: Collection[str] = ()
    ) -> "Resolution":
        """Return the finest of some, number by number; of fields that are to be `alike` what all have in common."""
        most = max(some, key=lambda one: one.slices)
        return cls(
            slices=most.slices,
            quadrature=most.quadrature,
            n_positions=max(one.n_positions or 1 for one in some),
            table_tolerance=min(one.table_tolerance for one in some),
            integrator_tolerance=min(
                (s for one in some if (s := one.integrator_tolerance) is not None), default=None
            ),
            **{
                name: getattr(most, name)
                for name in alike
                if len({getattr(one, name) for one in some}) == 1
            },
        )

    def slicing(self, length: float) -> tuple[Array, Array]:
        """Return positions from the middle and widths of the slices of a roller [m], (n,)."""
        if self.quadrature == "equal":
            return slice_positions(length, self.slices), np.full(self.slices, length / self.slices)
        nodes, weights = legendre(self.slices)
        return 0.5 * length * nodes, 0.5 * length * weights


def reference_resolution(scene: Scene) -> Resolution:
    """Return the finest resolution of a scene: what results are held against.

    A number of slices that the scene states is kept, since it is then part of what is asked for.
    """
    return Resolution(
        slices=scene.accuracy.slices or _FINEST_SLICES,
        n_positions=_REFERENCE_POSITIONS,
        table_tolerance=_FINEST_TABLE,
        integrator_tolerance=_FINEST_STEP,
    )


def refined(scene: Scene, own: Resolution, step: float = 1.0) -> Resolution:
    """Return four times as many slices and instants as a resolution has, with tables and steps to match.

    For bearings in motion, whose finest would take days; the error of this is a sixteenth.
    """
    best = reference_resolution(scene)
    return attrs.evolve(
        best,
        slices=scene.accuracy.slices or min(_FINER * own.slices, best.slices),
        n_positions=min(_FINER * (own.n_positions or 1), best.n_positions or 1),
        table_tolerance=own.table_tolerance / _FINER**2,
        integrator_tolerance=max(step / _FINER**2, best.integrator_tolerance or 0.0),
    )


def as_stated(scene: Scene) -> Resolution:
    """Return the resolution of a scene that nobody planned: its tolerance for all tables, instants doubled."""
    return Resolution(
        slices=scene.accuracy.slices or _SLICES, table_tolerance=scene.accuracy.tolerance
    )


def error_text(errors: Mapping[str, float | None]) -> str:
    """Return estimated errors as text: "friction 3e-04, critical slip 8e-05"."""
    return ", ".join(
        f"{name.replace('_', ' ')} {error:.0e}"
        for name, error in errors.items()
        if error is not None
    )


class BoundBrokenError(RollslipError):
    """What was left out is needed after all; ``bound`` is the one that broke."""

    def __init__(self, bound: "LeftOut", found: str) -> None:
        super().__init__(f"{bound.what} was left out, but {found}; it was taken back in")
        self.bound = bound


class LeftOut(abc.ABC):
    """Something left out under a bound that is checked on every table of slices."""

    @property
    @abc.abstractmethod
    def what(self) -> str:
        """What is left out, in words."""

    @abc.abstractmethod
    def __call__(self, slices: Slices) -> None:
        """Check the bound on evaluated slices."""

    @abc.abstractmethod
    def reinstated(self, resolution: Resolution) -> Resolution:
        """Return a resolution that does not leave it out."""


def slicing(scene: Scene, resolution: Resolution) -> tuple[Array, Array, Array]:
    """Return places, widths and profile of the slices [m], (n,) each: of one where nothing varies along it."""
    b = scene.bearing
    if b.profile.shape == "none" and scene.operation.misalignment == 0.0:
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
    return position, widths, drop
