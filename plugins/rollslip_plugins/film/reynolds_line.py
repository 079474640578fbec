"""A lubricated line contact solved numerically, as a film model: the reference of the film formulas."""

from functools import lru_cache
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.regimes import groups
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import choice_of, parameter
from rollslip.lubricant.pressure import PressureViscosity, from_oil
from rollslip.models import Domain, FilmModel
from rollslip.references import Reference
from rollslip.search import Array
from rollslip_kernels.slices import CONDITIONS, Conditions, Slices
from rollslip_plugins.bibliography import DOWSON_HIGGINSON_1966, HAIRER_1996, MOES_1992
from rollslip_plugins.film.line_contact import ACCURACIES, LOCATIONS, solve_line_contact
from rollslip_plugins.symbols import explained

#: Members that the law of the oil reads and the film does not: viscosity does not fall with temperature here, and the
#: pressure is the local one.
_UNUSED: Final = frozenset({"pressure", "thermoviscosity", "pressure_thermoviscosity"})


@attrs.frozen(kw_only=True)
@explained
class ReynoldsLine(FilmModel):
    """Film of the numerically solved line contact: the reference of the formulas, and slow.

    Reynolds equation with the film of two elastic half-spaces and Reynolds's condition at the exit, steady, isothermal
    and fully flooded; the viscosity follows the local pressure by the law of the oil (``law``). One solution takes 0.1
    to 1 s, the next slice in the same state none.

    Symbols:

    - h: film over the contact; the minimum, the central one or that where dp/dx = 0 is returned (``thickness``) [m]
    - h0: constant of the film that the load fixes [m]
    - x, s: places along the contact [m]
    - p: pressure [Pa]
    - eta: viscosity at the local pressure [Pa s]
    - rho: density over the ambient one, 1 or 1 + 0.6 p/(1 + 1.7 p) with p in GPa (``compressible``) [1]
    - u, w, R, E'

    Range: M = W/sqrt(2 U) from 1e-6 to 200; L = alpha E' (2 U)^(1/4) to 25 and, where M is small, far beyond. A contact
    that is not solved to the relative error allowed (``accuracy``) is refused. With Barus's law the pressure spike has
    no limit, the film has. The central film may rise with the load below M = 2, where the middle of the contact is not
    yet the plateau.

    Examples
    --------
    A light load on an oil that pressure does not thicken: Martin's exact 4.89497 eta0 u R/w = 24.475 um.

    >>> film = ReynoldsLine().film_thickness(200.0, 10.0, 0.01, 2e11, 0.01, 0.0)
    >>> f"{film:.2e}"
    '2.45e-05'
    """

    at_any_load: ClassVar[bool] = False
    name: ClassVar[str] = "reynolds-line"
    equation: ClassVar[str] = (
        "d/dx [rho h^3/(12 eta) dp/dx] = u d(rho h)/dx, h = h0 + x^2/(2 R) - 4/(pi E') int p(s) ln|x - s| ds, "
        "w = int p dx, p >= 0"
    )
    references: ClassVar[tuple[Reference, ...]] = (
        DOWSON_HIGGINSON_1966,
        MOES_1992,
        HAIRER_1996.at("section IV.5"),
    )

    thickness: str = parameter(
        default="minimum",
        validator=choice_of(*LOCATIONS),
        doc="which film thickness: 'minimum', 'central' or 'dp/dx = 0', where the density is the ambient one",
    )
    compressible: bool = parameter(
        default=False, doc="the density follows the pressure after Dowson and Higginson"
    )
    accuracy: float = parameter(
        default=1e-3,
        unit="1",
        doc="relative error of the film that is allowed",
        usual=ACCURACIES,
        possible=ACCURACIES,
    )
    law: PressureViscosity = from_oil()

    @property
    def location(self) -> str:  # type: ignore[override]
        """Which film thickness it returns, the chosen one."""
        return self.thickness

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """Load, speed and oil; of the latter what the viscosity of its law reads."""
        return FilmModel.reads | (self.law.reads - _UNUSED)

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where the contact and the oil's law are defined."""
        return MappingProxyType(
            {
                **FilmModel.domain,
                **{name: self.law.domain[name] for name in self.law.reads - _UNUSED},
            }
        )

    def evaluate(self, slices: Slices) -> None:
        """Fill the film thickness; slices in the same state are solved once."""
        names = tuple(sorted(self.reads))
        members = np.broadcast_arrays(
            *(getattr(slices.conditions if name in CONDITIONS else slices, name) for name in names)
        )
        table = np.stack([member.ravel() for member in members])
        for name, values in zip(names, table, strict=True):
            if np.any(np.isnan(values)):
                raise DomainError(f"{self.name}: needs {name}")
        states, of_slice = np.unique(table, axis=1, return_inverse=True)
        film = np.empty(states.shape[1])
        for i, state in enumerate(states.T.tolist()):
            found = _film_thickness(
                self.law, self.compressible, self.thickness, self.accuracy, names, tuple(state)
            )
            if isinstance(found, str):
                raise DomainError(found)
            film[i] = found
        slices.film_thickness[...] = film[of_slice.ravel()].reshape(members[0].shape)


@lru_cache(maxsize=4096)
def _film_thickness(
    law: PressureViscosity,
    compressible: bool,
    location: str,
    accuracy: float,
    names: tuple[str, ...],
    state: tuple[float, ...],
) -> float | str:
    """Return the film of a state [m], or the reason why there is none, so that this is cached too."""
    members: dict[str, Any] = dict(zip(names, np.array(state), strict=True))  # whose zeros divide
    conditions = Conditions(**{name: members.pop(name) for name in names if name in CONDITIONS})
    refusals: list[str] = []

    def log_viscosity(pressure: Array) -> Array:
        try:
            viscosity, _ = law.at(conditions, unit * pressure)
        except DomainError as refused:  # of a pressure that the solution may not need
            refusals.append(str(refused))
            return np.full_like(pressure, np.nan)
        return np.log(viscosity / conditions.viscosity)

    def density(pressure: Array) -> Array:
        return 1 + 0.6e-9 * unit * pressure / (1 + 1.7e-9 * unit * pressure)

    with np.errstate(all="ignore"):
        U, G, W = groups(Slices.of_columns(conditions, members))
        Us = 2 * U
        unit = conditions.modulus * Us**0.25
        try:
            solved = solve_line_contact(
                float(W / np.sqrt(Us)),
                float(G * Us**0.25),
                accuracy=accuracy,
                location=location,
                log_viscosity=log_viscosity,
                density=density if compressible else None,
            )
        except (ConvergenceError, DomainError) as refused:
            return "; ".join([str(refused), *refusals[-1:]])
        return float(conditions.radius * np.sqrt(Us) * solved.thickness[location])
