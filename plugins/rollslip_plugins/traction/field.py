"""Traction of a line contact, integrated along the contact and across the film: the reference of the closed forms.

The equations, with x along the contact from -b to b and z across the film, transported with the rolling speed u:

- stress, uniform across the film: V/h = (u/Gamma) dtau/dx + mean over z of (tau0/eta) sinh(tau/tau0), tau(-b) = 0;
- viscosity eta = eta_Ni(p(x)) exp(-beta(p(x)) theta(x, z)), eta_Ni and beta after the oil's law at the local pressure;
- film: rho_f c_f u dtheta/dx = K_f d2theta/dz2 + tau (tau0/eta) sinh(tau/tau0). Stored elastic energy is no heat;
- both surfaces: theta_s(x) = 1/(E sqrt(pi u)) integral of q(x')/sqrt(x - x') dx', q = K_f dtheta/dz at the wall.

The method is a march along the contact (an exponential integrator) with Newton's method in each cell, and Richardson
extrapolation:

1. Divide the contact into cells that are even in phi, x = -b cos(phi): Hertz's pressure and the temperature of the
   surfaces are smooth in phi.
2. In a cell, freeze viscosity and heat release. Stress (`relaxation`) and temperatures (`conduction`) then have exact
   solutions, so that no stress relaxes too fast for the grid and no film is too thin.
3. Find the release at which both agree by Newton's method. Temperatures are linear in the release, so that one
   iteration serves the field and its simplified variants.
4. Double the cells, and extrapolate two grids: the scheme is of second order. The change of three extrapolations is the
   estimated error.

The conduction of the film must have a memory. Without it (rho_f c_f = 0) an elastic film has no solution beyond the
stress at which conduction cannot carry the heat of its shear.
"""

from collections.abc import Callable
from typing import ClassVar, Final, Literal, NamedTuple, TypeAlias

import attrs
import numpy as np
from numpy.typing import ArrayLike, NDArray

from rollslip.errors import DomainError
from rollslip.fields import parameter
from rollslip.lubricant.pressure import PressureViscosity, from_oil
from rollslip.models import Domain, TractionModel, Validity, common_domain
from rollslip.references import KLEBANOV, Reference
from rollslip.search import Array
from rollslip_kernels.slices import COLUMNS, Slices
from rollslip_plugins.bibliography import CARSLAW_1959, JOHNSON_TEVAARWERK_1977
from rollslip_plugins.pressure_viscosity import Barus
from rollslip_plugins.symbols import explained
from rollslip_plugins.traction.conduction import (
    Cells,
    ConductedHeat,
    Heat,
    LocalHeat,
    Modes,
    conduction_modes,
    even_cells,
)
from rollslip_plugins.traction.heating import (
    AT_LOCAL_PRESSURE,
    FLASH,
    NO_ASPERITIES,
    OIL_HEAT_CAPACITY,
    SLOW_SLIDING,
    heat_capacity,
)
from rollslip_plugins.traction.relaxation import carried
from rollslip_plugins.traction.stress import LINEAR

#: Pressure over the contact: Hertz's, its mean, or the user's as (x/b rising from -1 to 1, p over the mean pressure).
Pressure: TypeAlias = Literal["hertz", "mean"] | tuple[ArrayLike, ArrayLike]
#: Heating: of the field above; uniform across the film, by the local stress; none.
Heating: TypeAlias = Literal["field", "local-stress", "none"]

#: Cells along the contact and modes across half the film, from one refinement to the next.
GRIDS: Final = ((8, 3), (16, 4), (32, 6), (64, 10), (128, 16), (256, 24), (512, 32))
#: Maximum number of Newton steps in a cell; three or four are usual.
MAX_STEPS = 30
#: Largest change of beta theta in a Newton step. Doubling it lets more slices diverge; halving it costs steps. Chosen.
MAX_NEWTON_CHANGE = 3.0
#: Largest change of ln(kappa) over which a secant replaces the slope of the heat. Chosen.
MAX_SECANT_CHANGE = 0.3
#: Smallest change of ln(kappa) over which a secant is used: below it rounding counts.
MIN_SECANT_CHANGE = 1e-7
#: Change of beta theta that ends Newton's method: below the smallest error that is requested.
NEWTON_TOLERANCE = 1e-9
#: Number of cells below which a slice without a solution is tried on a finer grid. Doubled, a slice that has none is
#: tried once more before it is refused. Chosen: real ones fail on all grids.
MIN_DECISIVE_CELLS = 64
#: Number of slices that are marched together: their arrays fit into the cache of a processor. Chosen.
BATCH = 256


# March ---------------------------------------------------------------------------------------------------------------


class _Groups(NamedTuple):
    """The slices in dimensionless groups, (s,); viscosity is that at the mean pressure."""

    strain_rate: Array  # sigma = eta V/(tau0 h)
    deborah: Array  # D = eta u/(Gamma b)
    capacity: Array  # C = rho_f c_f u h^2/(K_f b), conduction against transit
    flash: Array  # 2 K_f/(h E) sqrt(b/(pi u))
    #: tau0^2 h^2/(K_f eta) [K]: times beta sigma, the exponent of the unit of temperature.
    heating: Array
    scale: Array  # tau0/p, with the sign of V


class _Oil(NamedTuple):
    """The oil along the contact, (s, cells): viscosity of the mean pressure over that of the cell, and its slope."""

    thinning: Array
    change: Array  # of the logarithm of the former across a cell
    softening: Array  # beta [1/K]


class _Marched(NamedTuple):
    """Result of a march along the contact: stress (s, cells), temperature (s, cells, nodes across the film)."""

    stress: Array
    temperature: Array


def _march(groups: _Groups, oil: _Oil, grid: Cells, heat: Heat) -> _Marched:
    """Integrate stress and temperature cell by cell; NaN where Newton's method does not converge."""
    s, n = oil.thinning.shape
    weight = heat.weight
    identity = np.eye(heat.weight.size)
    stress = np.empty((s, n))
    temperature = np.zeros((s, n, weight.size))
    unit = groups.heating * groups.strain_rate
    warming = np.zeros((s, n))  # logarithm of the film's mean of exp(beta theta)
    release = np.zeros((s, weight.size))
    start = np.zeros(s)
    end = np.zeros(s)
    alive = np.ones(s, dtype=bool)
    for i in range(n):
        offset, response = heat.affine(i)
        if i > 1:  # the cells are even in phi
            temperature[:, i] = 2 * temperature[:, i - 1] - temperature[:, i - 2]
        else:
            temperature[:, i] = temperature[:, 0] if i else offset
        todo = np.flatnonzero(alive)
        log_before, heated_before = np.full((2, s), np.nan)
        for _ in range(MAX_STEPS):
            sigma = groups.strain_rate[todo]
            deborah = groups.deborah[todo] / grid.width[i]
            first = start[todo]
            beta = (oil.softening[todo, i] * unit[todo])[:, None]
            t = temperature[todo, i]
            top = np.max(beta * t, axis=1)
            fraction = np.exp(beta * t - top[:, None])  # of the places in the shear
            mean_fraction = fraction @ weight
            fraction = fraction / mean_fraction[:, None]
            log = warming[todo, i] = top + np.log(mean_fraction)
            # a Newton step may leave the floats before it returns
            kappa = oil.thinning[todo, i] * np.exp(np.minimum(log, 600))
            change = oil.change[todo, i]
            if i > 1:
                change = change + 1.5 * log - 2 * warming[todo, i - 1] + 0.5 * warming[todo, i - 2]
            mean, last = carried(first, kappa, sigma, deborah, change)
            spring = 0.0 if heat.of_all_work else deborah / sigma
            heated = mean - spring * (last**2 - first**2) / 2
            # slope of the heat over ln(kappa), as if cosh S were constant in the cell: right for slow and for fast
            p = np.minimum(kappa * np.cosh(np.minimum(mean, 300.0)) / deborah, 1e30)
            fall = -np.tanh(mean) * -np.expm1(-p)
            slope = -np.tanh(mean) - fall / p - spring * last * fall
            difference = log - log_before[todo]
            secant = (heated - heated_before[todo]) / difference
            size = np.abs(difference)
            use_secant = (size > MIN_SECANT_CHANGE) & (size < MAX_SECANT_CHANGE)
            slope = np.where(use_secant, secant, slope)
            log_before[todo] = log
            heated_before[todo] = heated
            released = heated[:, None] * fraction
            steeper = (slope - heated)[:, None] * fraction
            r = response[todo]
            residual = t - offset[todo] - _times(r, released)
            jacobian = identity - r * (beta * released)[:, None, :]
            jacobian -= _times(r, steeper)[:, :, None] * (beta * fraction * weight)[:, None, :]
            step = _solved(jacobian, residual)
            size = np.max(np.abs(beta * step), axis=1)
            good = np.isfinite(size)
            temperature[todo, i] = (
                t - step * (MAX_NEWTON_CHANGE / np.maximum(size, MAX_NEWTON_CHANGE))[:, None]
            )
            stress[todo, i] = mean
            end[todo] = last
            release[todo] = released
            alive[todo[~good]] = False
            todo = todo[good & (size > NEWTON_TOLERANCE)]
            if not todo.size:
                break
        alive[todo] = False
        for values in (temperature[:, i], warming[:, i], release, end):
            values[~alive] = 0.0
        heat.advance(i, release)
        start = end.copy()
    stress[~alive] = np.nan
    return _Marched(stress, temperature)


def _solved(matrix: Array, vector: Array) -> Array:
    """Solve many systems; NaN for the singular ones, which values at the ends of the floats give."""
    try:
        return np.asarray(np.linalg.solve(matrix, vector[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:
        if len(matrix) == 1:
            return np.full_like(vector, np.nan)
        return np.concatenate(
            [_solved(matrix[k : k + 1], vector[k : k + 1]) for k in range(len(matrix))]
        )


def _times(matrix: Array, vector: Array) -> Array:
    """Return the products of many matrices and vectors."""
    return (matrix @ vector[:, :, None])[:, :, 0]


def _solve(
    groups: _Groups, oil: _Oil, grid: Cells, modes: Modes, heating: Heating
) -> tuple[_Marched, Heat]:
    """Integrate along a grid with a kind of heating."""
    heat: Heat
    if heating == "field":
        heat = ConductedHeat(groups.capacity, groups.flash, grid, modes)
    elif heating == "local-stress":
        heat = LocalHeat(FLASH * groups.flash / 2 + 1 / 12)
    else:
        heat = LocalHeat(np.zeros_like(groups.flash))
    return _march(groups, oil, grid, heat), heat


def _mean(marched: _Marched, grid: Cells) -> Array:
    """Return the mean stress along the contact, (s,)."""
    return np.asarray(marched.stress @ grid.width / 2)


# Slices --------------------------------------------------------------------------------------------------------------


def _profile(pressure: Pressure) -> Callable[[Array], Array]:
    """Return the pressure over its mean as a function of x/b."""
    if isinstance(pressure, str):
        if pressure == "mean":
            return np.ones_like
        return lambda x: 4 / np.pi * np.sqrt(np.maximum(1 - x * x, 0))
    places, ratios = (np.asarray(values, dtype=float) for values in pressure)
    return lambda x: np.interp(x, places, ratios)


def _groups(slices: Slices, law: PressureViscosity, heat_capacity: float) -> _Groups:
    """Return the dimensionless groups of slices."""
    c = slices.conditions
    s = slices
    eta = law.at(c, s.pressure)[0]
    transit = s.half_width / s.rolling_speed
    signed = eta * s.sliding_speed / (c.eyring_stress * s.film_thickness)
    return _Groups(
        strain_rate=np.maximum(np.abs(signed), LINEAR),
        deborah=eta / (c.shear_modulus * transit),
        capacity=heat_capacity * s.film_thickness**2 / (c.conductivity * transit),
        flash=2 * c.conductivity / (s.film_thickness * c.effusivity) * np.sqrt(transit / np.pi),
        heating=(c.eyring_stress * s.film_thickness) ** 2 / (c.conductivity * eta),
        scale=c.eyring_stress
        / s.pressure
        * np.copysign(np.minimum(np.abs(signed), LINEAR) / LINEAR, signed),
    )


def _oil(
    slices: Slices, law: PressureViscosity, profile: Callable[[Array], Array], grid: Cells
) -> _Oil:
    """Return viscosity and its dependence on temperature in the cells of a grid."""
    c = slices.conditions
    p = slices.pressure[:, None]
    eta, softening = law.at(c, p * profile(grid.middle))
    at_edges = np.log(law.at(c, p * profile(grid.edge))[0])
    # an oil that thickens with heat has no solution
    softening = np.where(softening >= 0, softening, np.nan)
    return _Oil(law.at(c, p)[0] / eta, at_edges[:, :-1] - at_edges[:, 1:], softening)


def _picked(slices: Slices, part: NDArray[np.intp]) -> Slices:
    """Return some of the slices, by index."""
    return Slices.of_columns(
        slices.conditions,
        {name: getattr(slices, name)[part] for name in COLUMNS if hasattr(slices, name)},
    )


@attrs.frozen(eq=False, kw_only=True)
class TractionField:
    """Stress and temperature in one contact.

    Attributes
    ----------
    position : ndarray
        x along the contact [m], in the direction of rolling, (cells,).
    pressure, stress : ndarray
        Local pressure and shear stress [Pa], (cells,).
    height : ndarray
        z/h across the film, 0 at one surface and 1 at the other, (places,).
    film_temperature : ndarray
        Rise over the inlet temperature [K], (cells, places).
    surface_temperature : ndarray
        That of both surfaces [K], (cells,); where heating is uniform that of the film.
    friction, error : float
        Friction coefficient, and its estimated relative error.
    """

    position: Array
    pressure: Array
    stress: Array
    height: Array
    film_temperature: Array
    surface_temperature: Array
    friction: float
    error: float


def solve_friction(
    slices: Slices,
    *,
    law: PressureViscosity | None = None,
    pressure: Pressure = "hertz",
    heating: Heating = "field",
    heat_capacity: float = OIL_HEAT_CAPACITY,
    accuracy: float = 1e-5,
) -> tuple[Array, Array]:
    """Return friction coefficient and its estimated relative error of every slice, with all physics or with less.

    Parameters
    ----------
    slices : Slices
        With the columns that `MaxwellEyringField` reads.
    law : PressureViscosity, optional
        Of the oil; Barus's by default.
    pressure : "hertz", "mean" or (array_like, array_like)
        Pressure over the contact; or x/b, rising from -1 to 1, and the pressure there over the slice's, linear between.
    heating : "field", "local-stress" or "none"
        Temperatures of film and surfaces; or theta = zeta tau V uniform across the film, with the local stress; or
        none.
    heat_capacity : float, optional
        Of the oil, rho_f c_f [J/(m3 K)].
    accuracy : float, optional
        Relative error of the friction at which refinement ends.

    Returns
    -------
    friction, error : ndarray
        The error is the change between the last two extrapolations, or a quarter of the change before if that is more.
        Where it is above `accuracy`, the finest grid did not suffice; where it is infinite, the friction is NaN and
        the field has no solution or left the floats.
    """
    friction, error, _ = _refined(slices, law, pressure, heating, heat_capacity, accuracy)
    return friction, error


def solve_field(
    slices: Slices,
    k: int = 0,
    *,
    law: PressureViscosity | None = None,
    pressure: Pressure = "hertz",
    heating: Heating = "field",
    heat_capacity: float = OIL_HEAT_CAPACITY,
    accuracy: float = 1e-5,
) -> TractionField:
    """Return stress and temperatures of one slice, on the finest grid that its friction took.

    Parameters
    ----------
    slices, law, pressure, heating, heat_capacity, accuracy
        As in `solve_friction`.
    k : int, optional
        Which slice.

    Raises
    ------
    DomainError
        If the field has no solution, or not of that accuracy.
    """
    single = _picked(slices, np.array([k]))
    law = law or Barus()
    profile = _profile(pressure)
    friction, error, level = _refined(single, law, pressure, heating, heat_capacity, accuracy)
    _refuse_inaccurate("traction field", error, accuracy, k)
    n, m = GRIDS[level[0]]
    grid = even_cells(n)
    modes = conduction_modes(m)
    c = single.conditions
    V = single.sliding_speed[0]
    h = single.film_thickness[0]
    groups = _groups(single, law, heat_capacity)
    marched, heat = _solve(groups, _oil(single, law, profile, grid), grid, modes, heating)
    kelvin = c.eyring_stress * abs(V) * h / c.conductivity
    film = kelvin * marched.temperature[0]
    height = np.array([0.5])
    surface = film[:, 0]
    if isinstance(heat, ConductedHeat):
        height = np.concatenate([(1 - modes.place[::-1]) / 2, (1 + modes.place) / 2])
        film = np.concatenate([film[:, ::-1], film], axis=1)
        surface = kelvin * (heat.surface[0, :-1] + heat.surface[0, 1:]) / 2
    return TractionField(
        position=single.half_width[0] * grid.middle,
        pressure=single.pressure[0] * profile(grid.middle),
        stress=single.pressure[0] * groups.scale[0] * marched.stress[0],
        height=height,
        film_temperature=film,
        surface_temperature=surface,
        friction=float(friction[0]),
        error=float(error[0]),
    )


def stress_on_grid(
    slices: Slices,
    cells: int,
    modes: int,
    *,
    law: PressureViscosity | None = None,
    pressure: Pressure = "hertz",
    heating: Heating = "field",
    heat_capacity: float = OIL_HEAT_CAPACITY,
) -> Array:
    """Return the mean shear stress over the Eyring stress by one grid, (slices,); NaN where it has no solution.

    Parameters
    ----------
    slices, law, pressure, heating, heat_capacity
        As in `solve_friction`.
    cells : int
        Number of cells along the contact.
    modes : int
        Number of modes of conduction across half the film.
    """
    law = law or Barus()
    profile = _profile(pressure)
    grid = even_cells(cells)
    stress = np.empty(slices.pressure.size)
    with np.errstate(all="ignore"):  # what leaves the floats becomes NaN
        for first in range(0, stress.size, BATCH):
            part = _picked(slices, np.arange(first, min(first + BATCH, stress.size)))
            groups = _groups(part, law, heat_capacity)
            oil = _oil(part, law, profile, grid)
            marched, _ = _solve(groups, oil, grid, conduction_modes(modes), heating)
            stress[first : first + BATCH] = _mean(marched, grid)
    return stress


def _refined(
    slices: Slices,
    law: PressureViscosity | None,
    pressure: Pressure,
    heating: Heating,
    heat_capacity: float,
    accuracy: float,
) -> tuple[Array, Array, NDArray[np.intp]]:
    """Return friction, error, and the index of the finest grid of each slice."""
    s = slices.pressure.size
    stress = np.full(s, np.nan)
    error = np.full(s, np.inf)
    level = np.zeros(s, dtype=np.intp)
    todo = np.arange(s)
    (coarse, guess, last) = np.full((3, s), np.nan)
    for at, (n, m) in enumerate(GRIDS):
        part = _picked(slices, todo)
        mean = stress_on_grid(
            part, n, m, law=law, pressure=pressure, heating=heating, heat_capacity=heat_capacity
        )
        better = mean + (mean - coarse) / 3
        change = np.abs(better - guess) / better
        # one change alone may be small by chance; where all is smooth, a finer grid divides it by four or more
        estimate = np.maximum(change, last / 4)
        level[todo] = at
        stress[todo] = better
        error[todo] = np.where(np.isnan(estimate), np.inf, estimate)
        # a slice that two grids in a row cannot solve has no solution, unless they are coarse
        on = ~(estimate <= accuracy) & (
            np.isfinite(mean) | np.isfinite(coarse) | (n < MIN_DECISIVE_CELLS)
        )
        todo = todo[on]
        coarse = mean[on]
        guess = better[on]
        last = change[on]
        if not todo.size:
            break
    with np.errstate(all="ignore"):
        friction = stress * _groups(slices, law or Barus(), heat_capacity).scale
    error[~np.isfinite(friction)] = np.inf
    friction[np.isinf(error)] = np.nan
    return friction, error, level


def _refuse_inaccurate(name: str, error: Array, accuracy: float, first: int = 0) -> None:
    """Raise the error of the first slice that does not have the requested accuracy."""
    bad = np.flatnonzero(~(error <= accuracy))
    if not bad.size:
        return
    k = int(bad[0])
    estimate = float(error[bad[0]])
    if np.isfinite(estimate):
        raise DomainError(
            f"{name}: slice {first + k} did not settle: the error of its friction is {estimate:.1e} at "
            f"{GRIDS[-1][0]} cells, {accuracy:g} is requested; request less accuracy, or take maxwell-eyring"
        )
    raise DomainError(
        f"{name}: slice {first + k} has no solution: its film runs away thermally, its oil thickens with heat, or a "
        "value is too large or too small; take maxwell-eyring"
    )


# Model ---------------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
@explained
class MaxwellEyringField(TractionModel):
    """Maxwell-Eyring oil, integrated over Hertz's pressure, the film's and the surfaces' temperatures.

    V/h = (u/Gamma) dtau/dx + mean over z of (tau0/eta) sinh(tau/tau0), tau(-b) = 0, eta = eta_Ni exp(-beta theta) with
    eta_Ni and beta = -dln(eta)/dT after the oil's law (``law``) at p = (4/pi) p_mean sqrt(1 - x^2/b^2);
    rho_f c_f u dtheta/dx = K_f d2theta/dz2 + tau (tau0/eta) sinh(tau/tau0) across the film, and at both walls
    theta = 1/(E sqrt(pi u)) integral of K_f (dtheta/dz)(x') / sqrt(x - x') dx', E = sqrt(K rho c) of the solids.
    mu = mean(tau)/p_mean, with the sign of V.

    It is the reference of the closed forms ``muraki``, ``maxwell-eyring`` and ``eyring``, which take the mean pressure,
    the mean stress, and a temperature that is uniform and without the film's own heat capacity. The grid is doubled
    until the extrapolated friction stands still to the relative error allowed (``accuracy``).

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - tau: local shear stress, uniform across the film [Pa]
    - tau0: Eyring stress [Pa]
    - Gamma: shear modulus of the oil [Pa]
    - gamma: shear; its rate of flow releases heat [1]
    - t: time along with the oil, dx = u dt [s]
    - x, z: places along the contact and across the film [m]
    - p: Hertz's pressure at x, in mu its mean [Pa]
    - eta: viscosity at the local pressure and temperature [Pa s]
    - beta
    - theta: temperature above the inlet [K]
    - rho_f, c_f: density and heat capacity of the oil, by volume (``heat_capacity``) [J/(m3 K)]
    - K_f, V, u, h, b

    Range: sliding slow against rolling. Film and both surfaces move with u here; surfaces at u + V/2 and u - V/2 would
    have a mean flash temperature larger by the factor 1 + (3/32) (V/u)^2. Conduction along the film, heat of
    compression, and the change of h, K_f and rho_f c_f over the contact are left out. Where
    beta tau tau0/(Gamma rho_f c_f) is of order 1 or more (1e-3 to 1e-2 for oils) an elastic film releases its energy
    faster than it is conducted, in an ever thinner band; such a slice is refused, and one for which the finest grid
    does not suffice. The heat capacity of oils is 1.7e6 to 1.9e6 J/(m3 K), 850 to 950 kg/m3 times 1.9 to 2.1 kJ/(kg K)
    (C).

    Raises
    ------
    DomainError
        From ``evaluate``: if a slice does not reach the accuracy, or has no solution.

    Examples
    --------
    An oil that neither pressure nor heat changes at sigma = D = 1: mu = 0.1 S with the S = 0.551296 of
    ``maxwell-eyring`` in fifty digits (tools/references/maxwell_eyring.py).

    >>> from rollslip import Conditions, Slices
    >>> oil = Conditions(viscosity=1.0, pressure_viscosity=0.0, thermoviscosity=0.0, pressure_thermoviscosity=0.0,
    ...                  conductivity=0.14, effusivity=13e3, eyring_stress=1e6, shear_modulus=1e4)
    >>> slices = Slices(1, oil, pressure=1e7, half_width=1e-4, film_thickness=1e-6, rolling_speed=1.0,
    ...                 sliding_speed=1.0)
    >>> MaxwellEyringField(accuracy=1e-6).evaluate(slices)
    >>> f"{slices.friction[0]:.5f}"
    '0.05513'
    """

    name: ClassVar[str] = "maxwell-eyring-field"
    equation: ClassVar[str] = (
        "mu = mean(tau)/p, V/h = (u/Gamma) dtau/dx + mean_z[(tau0/eta) sinh(tau/tau0)], eta = eta(p(x)) "
        "exp(-beta(p(x)) theta(x, z)), rho_f c_f u dtheta/dx = K_f d2theta/dz2 + tau dgamma/dt"
    )
    references: ClassVar[tuple[Reference, ...]] = (
        JOHNSON_TEVAARWERK_1977,
        CARSLAW_1959.at("section 2.9"),
        KLEBANOV,
    )
    #: Relative difference of a slice that is solved together with others: Newton's method ends with the slowest one.
    tolerance: ClassVar[float] = 1e-7
    validity: ClassVar[tuple[Validity, ...]] = (NO_ASPERITIES, SLOW_SLIDING)

    accuracy: float = parameter(
        default=1e-3,
        unit="1",
        doc="relative error of the friction that is allowed",
        usual=(1e-6, 0.01),
        possible=(1e-8, 0.1),
    )
    heat_capacity: float = heat_capacity()
    law: PressureViscosity = from_oil()

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """Contact, film and oil; of the latter what its law reads."""
        return frozenset(self.domain) | self.law.reads

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where the field and the oil's law are defined."""
        return common_domain(AT_LOCAL_PRESSURE, self.law.domain)

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        slices.friction[...], error = solve_friction(
            slices, law=self.law, heat_capacity=self.heat_capacity, accuracy=self.accuracy
        )
        _refuse_inaccurate(self.name, error, self.accuracy)
