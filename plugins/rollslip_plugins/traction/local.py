"""Traction of a Maxwell-Eyring oil at the local pressure: Gauss's rule of three points over Hertz's pressure.

With p(x) = (4/pi) p c and c = sqrt(1 - x^2/b^2), the mean over the contact of a function of pressure is its mean over
c in [0, 1] with the weight c/sqrt(1 - c^2). Gauss's rule of three points for this weight has both limits of the field:
slow, the mean of the viscosity; fast and cold, the mean of ln(2 sigma). At one pressure a law takes the stress of a
mean instead, and slow films come out too weak, by the bend of the viscosity over pressure.

The method, for each slice:

1. Take viscosity and its slope over temperature at the three pressures, after the oil's law.
2. Bracket the logarithm of the mean stress S: below it lies no stress, above it the stress of the cold film.
3. At a trial S, solve the equation of each point for its stress by Newton's method in logarithms. It is rising and
   convex there, so that steps from above descend to its one root.
4. ln S less the logarithm of the mean of these stresses rises, so that secants within the bracket find its one root;
   every third step halves the bracket.
"""

from collections.abc import Mapping
from typing import ClassVar, Final, NamedTuple

import attrs
import numpy as np

from rollslip.bearing.chain import stage
from rollslip.errors import DomainError
from rollslip.lubricant.pressure import PressureViscosity, from_oil, slope_of_oil
from rollslip.models import Domain, Tabled, Validity, common_domain
from rollslip.references import KLEBANOV, Reference
from rollslip.search import Array
from rollslip.units import format_quantity
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import traction as compiled
from rollslip_plugins.bibliography import JOHNSON_TEVAARWERK_1977
from rollslip_plugins.symbols import explained
from rollslip_plugins.traction.eyring import RISE_OF_MODULUS, RISE_OF_STRESS, EyringGroups
from rollslip_plugins.traction.heating import (
    AT_LOCAL_PRESSURE,
    NO_ASPERITIES,
    SLOW_SLIDING,
    flash_factor,
    heat_capacity,
)

#: Points of Gauss's rule for the weight c/sqrt(1 - c^2) on [0, 1], c = p(x)/(largest pressure); exact to c^5.
POINTS: Final = np.array([0.23115229612788454, 0.639971196234075, 0.9544967673433061])
#: Weights of these points.
WEIGHTS: Final = np.array([0.08530082397262705, 0.3414562579328136, 0.5732429180945593])
#: Pressure of a point over the mean pressure.
PRESSURE_RATIOS: Final = 4 / np.pi * POINTS
#: Coefficients of the film's mean heating kappa(y) = exp(2 y) N(y)/M(y), with N = 1 + a y + b y^2 and M = 1 + (4/3 +
#: a) y + c y^2 + 4 b y^3: they have the exact kappa's first order and asymptote, and are within 0.0143 of its
#: logarithm.
NAHME: Final = (0.08388, 0.41682, 0.83475)
#: Heat that leaves with the film: its heating falls by sqrt(1 + (0.13 C)^2), C = rho_f c_f u h^2/(K_f b), from that
#: of a film that conducts at once to that of one that keeps all heat. Fitted to 746 contacts of the field
#: (tools/references/traction_local.py): half and twice of it raise the rms error of 1.6 % to 3.1 and 6.1 %.
CARRIED: Final = 0.13
#: Heat that does not reach the surfaces within the contact: their temperature falls by sqrt(1 + (1.5 C)^2). Fitted
#: to the same contacts: none of it raises the rms error below D = 0.1 from 0.74 to 0.88 %, half and twice of it by
#: 0.01 %.
UNREACHED: Final = 1.5
#: Width of the corner between the stress of flow and that of an elastic film. Fitted to the same contacts: half and
#: twice of it change the rms error by 0.0 and 0.15 %.
CORNER: Final = 0.15
#: V/u below which friction is linear in V. The stress is then linear to the last bit, and no group underflows.
LINEAR_RATIO: Final = 1e-15
#: Smallest logarithm of a local stress: the heat of another point may ask for less, which no float holds.
LOWEST: Final = -700.0
#: Maximum number of steps that bracket the mean stress. Every third halves the bracket; some 10 are usual.
MAX_STEPS: Final = 120
#: Residual of ln S that ends them, relative to 1 + |ln S|: rounding.
TOLERANCE: Final = 1e-13


class Groups(NamedTuple):
    """The dimensionless groups of slices for |V|: (n,), or (3, n) for each point."""

    log_rate: Array  # ln(2 sigma), sigma = eta V/(tau0 h)
    flash: Array  # exponent of the flash temperature at S = 1
    film: Array  # heating y of the film at a local stress of 1
    bound: Array  # V Gamma b/(h tau0 u): mean stress of a film that only stretches


def film_heating(y: Array) -> tuple[Array, Array]:
    """Return the logarithm of kappa, the mean of exp(beta theta) across a film heated by its own shear, and its slope.

    A film between walls of equal temperature, sheared by a uniform stress, has kappa = m sqrt(1 + m^2)/asinh(m) at
    y = beta tau V h/(8 K_f) = m asinh(m)/sqrt(1 + m^2).
    """
    a, b, c = NAHME
    over = 1 + y * (a + y * b)
    under = 1 + y * (4 / 3 + a + y * (c + y * (4 * b)))
    slope = 2 + (a + 2 * b * y) / over - (4 / 3 + a + y * (2 * c + y * (12 * b))) / under
    return 2 * y + np.log(over / under), slope


def lesser(stress: Array, bound: Array) -> Array:
    """Return a mean stress that is below both the stress of flow and that of a film that only stretches.

    It is the smaller root m of (1 - d) m^2 - (s + bound) m + s bound = 0 with d = s/((s + 0.15 bound)(1 + s)): the
    corner is soft for a slow film, which relaxes exponentially, and sharp for a plastic one.
    """
    corner = stress / ((stress + CORNER * bound) * (1 + stress))
    root = np.sqrt((stress - bound) ** 2 + 4 * corner * stress * bound)
    return np.asarray(2 * stress * (bound / (stress + bound + root)))


def point_stresses(groups: Groups, mean: Array) -> Array:
    """Return the local stresses (3, n) at a mean stress, the roots of sinh(s) kappa exp(g S) = sigma."""
    target = groups.log_rate - groups.flash * mean
    flowing = np.arcsinh(np.exp(np.clip(target, -30, 30)) / 2)
    log = np.log(np.where(target > 30, target, flowing)) + np.minimum(target + 30, 0)
    log = np.maximum(log, LOWEST)
    for _ in range(100):
        stress = np.exp(log)
        drop = -np.expm1(-2 * stress)
        heating, slope = film_heating(groups.film * stress)
        residual = stress + np.log(drop) + heating - target
        step = residual / (stress * (2 / drop - 1) + groups.film * stress * slope)
        step = np.minimum(np.clip(step, -4, 4), log - LOWEST)
        log = log - step
        if not np.any(np.abs(step) > 1e-14 * (1 + np.abs(log))):
            break
    return np.asarray(np.exp(log))


def mean_stress(groups: Groups) -> Array:
    """Return the mean shear stress over the Eyring stress (n,), to rounding."""

    def mean_at(stress: Array) -> Array:
        return np.asarray(WEIGHTS @ lesser(point_stresses(groups, stress), groups.bound))

    high = np.log(mean_at(np.zeros_like(groups.bound)))
    low = high - 20
    for _ in range(3):  # the bracket of a very hot film is wider
        low = np.where(np.log(mean_at(np.exp(low))) < low, low - 200, low)
    log = high
    last = np.full_like(log, np.nan)
    residual_last = last
    for step in range(MAX_STEPS):
        residual = log - np.log(mean_at(np.exp(log)))
        if not np.any(np.abs(residual) > TOLERANCE * (1 + np.abs(log))):
            break
        high = np.where(residual > 0, log, high)
        low = np.where(residual < 0, log, low)
        change = log - last
        known = np.abs(change) > 1e-14
        slope = np.where(known, (residual - residual_last) / np.where(known, change, 1), 1)
        last = log
        residual_last = residual
        next_log = log - residual / np.maximum(slope, 1)
        inside = (next_log >= low) & (next_log <= high) & (step % 3 < 2)
        log = np.where(inside, next_log, (low + high) / 2)
    return np.asarray(np.exp(log))


@attrs.frozen(kw_only=True)
@explained
class MaxwellEyringLocal(EyringGroups):
    """Maxwell-Eyring oil at the local pressure, with heat across the film and an elastic bound, in closed form.

    The oil is asked at three pressures p_i = (4/pi) c_i p of Hertz's contact, with the weights w_i of Gauss's rule for
    the mean over the contact: c = 0.231152, 0.639971, 0.954497, w = 0.085301, 0.341456, 0.573243. Local stresses are

        sinh(s_i) kappa(y_i) exp(g_i S) = sigma_i, sigma_i = eta_i V/(tau0 h),
        y_i = s_i beta_i tau0 V h/(8 K_f)/sqrt(1 + (0.13 C)^2), C = rho_f c_f u h^2/(K_f b),
        g_i = beta_i tau0 V flash sqrt(b/(pi u))/E/sqrt(1 + (1.5 C)^2),
        S = sum of w_i m(s_i, B), mu = tau0 S/p, B = V Gamma b/(h tau0 u).

    kappa is the mean of exp(beta theta) over a film that its own shear heats, of which the film carries a part away. m
    is the lesser of its arguments with a rounded corner: no stress rises faster than B, whatever the viscosity.

    Symbols:

    - mu: traction coefficient, with the sign of V [1]
    - S: mean shear stress over tau0 [1]
    - s_i: stress over tau0 at p_i [1]
    - sigma_i: strain rate over tau0/eta_i at p_i [1]
    - eta_i: viscosity at p_i and the inlet temperature, after the oil's law (``law``) [Pa s]
    - beta_i: its fall with temperature -dln(eta)/dT [1/K]
    - kappa: mean of exp(beta theta) across a film heated by its own shear [1]
    - g_i: exponent of the flash temperature of both surfaces at S = 1 [1]
    - m: lesser of two stresses, with a rounded corner [1]
    - B: mean stress over tau0 of a film that only stretches [1]
    - C: conduction time of the film over its transit time [1]
    - p: mean pressure [Pa]
    - E: thermal effusivity of both surfaces [J/(m2 K s^0.5)]
    - tau0: Eyring stress of the oil, with its rise to p (``eyring_stress_slope``) [Pa]
    - Gamma: shear modulus of the oil, with its rise to p (``shear_modulus_slope``) [Pa]
    - rho_f, c_f: density and heat capacity of the oil, by volume (``heat_capacity``) [J/(m3 K)]
    - V, u, h, b, flash, K_f

    Range: it is within 1 % rms of ``maxwell-eyring-field`` for D < 0.1 and within 4 % rms beyond, with Hertz's
    pressure, to 1.5 GPa and V/u of 2. Single contacts err by up to 15 % near the origin at D of 0.05 to 0.4, as
    slopes of test rigs are measured, and by up to 25 % in elastic films (D > 0.3) of which heat leaves less than a
    hundredth of the viscosity. An oil that thickens with heat at one of the three pressures is refused.

    Raises
    ------
    DomainError
        From ``evaluate``: if the oil thickens with heat at one of the pressures.

    Examples
    --------
    A Barus oil at 200 MPa; the field gives 0.000821.

    >>> from rollslip import Conditions, Slices
    >>> from rollslip_plugins.pressure_viscosity import Barus
    >>> oil = Conditions(viscosity=0.02, pressure_viscosity=16e-9, thermoviscosity=0.034,
    ...                  pressure_thermoviscosity=0.12e-9, conductivity=0.14, effusivity=13e3, eyring_stress=5e6,
    ...                  shear_modulus=0.3e9)
    >>> slices = Slices(1, oil, pressure=2e8, half_width=1e-4, film_thickness=0.4e-6, rolling_speed=10.0,
    ...                 sliding_speed=0.1)
    >>> MaxwellEyringLocal(law=Barus()).evaluate(slices)
    >>> f"{slices.friction[0]:.8f}"
    '0.00082083'
    """

    name: ClassVar[str] = "maxwell-eyring-local"
    equation: ClassVar[str] = (
        "mu = tau0 S/p, S = mean of m(s_i, B), sinh(s_i) kappa exp(g_i S) = eta_i V/(tau0 h)"
    )
    references: ClassVar[tuple[Reference, ...]] = (JOHNSON_TEVAARWERK_1977, KLEBANOV)
    #: Relative difference that the compiled form has: its last step is in single precision's slopes.
    tolerance: ClassVar[float] = 1e-6
    validity: ClassVar[tuple[Validity, ...]] = (
        NO_ASPERITIES,
        SLOW_SLIDING,
        Validity(
            code="W25",
            quantity="slow_deborah",
            quantity_name="Deborah number D of slow films (sigma < 1)",
            high=0.05,
            consequence="friction near the origin errs by at most {error} up to an exponent ln(eta/eta0) of 10",
            error=Tabled(
                (
                    (0.05, 9.3),
                    (0.1, 14.5),
                    (0.2, 14.6),
                    (0.4, 13.2),
                    (1.0, 15.4),
                    (3.0, 13.3),
                    (10.0, 9.7),
                    (100.0, 6.0),
                    (1000.0, 4.1),
                )
            ),
            remedy="traction 'maxwell-eyring-field'",
            source="maxwell-eyring-field without heat, exponents of 4 to 10 (tools/references/traction_local.py)",
        ),
    )

    flash: float = flash_factor()
    heat_capacity: float = heat_capacity()
    law: PressureViscosity = from_oil()
    eyring_stress_slope: float = slope_of_oil(RISE_OF_STRESS)
    shear_modulus_slope: float = slope_of_oil(RISE_OF_MODULUS)

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """Contact, film and oil; of the latter what its law reads."""
        return frozenset(self.domain) | self.law.reads

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where the law and the oil's law are defined."""
        return common_domain(AT_LOCAL_PRESSURE, self.law.domain)

    def oil(self, slices: Slices) -> tuple[Array, Array]:
        """Return viscosity [Pa s] and its fall with temperature [1/K] at the mean pressure."""
        return self.law.at(slices.conditions, slices.pressure)

    def quantities(self, slices: Slices) -> Mapping[str, Array]:
        """Return those of its fluid, and slow_deborah = D of slow films, which the elastic bound may reach, else 0."""
        found = super().quantities(slices)
        is_slow = np.abs(found["strain_rate"]) < 1
        return {**found, "slow_deborah": np.where(is_slow, found["deborah"], 0.0)}

    def local_groups(self, slices: Slices) -> Groups:
        """Return the groups that determine the mean stress."""
        c = slices.conditions
        s = slices
        pressures = PRESSURE_RATIOS[:, None] * s.pressure
        eta, beta = self.law.at(c, pressures)
        beta = np.broadcast_to(beta, pressures.shape)
        thickens = np.argwhere(~(beta >= 0))
        if thickens.size:
            point, at = thickens[0]
            highest = pressures[point, at]
            tried = np.linspace(0.0, highest, 201)
            valid = tried[np.argmax(~(self.law.at(c, tried)[1] >= 0)) - 1]
            raise DomainError(
                f"{self.name}: slice {at} is outside its domain: at {format_quantity(highest, 'Pa', 3)} the oil "
                f"thickens with heat after {self.law.name!r}, up to {format_quantity(valid, 'Pa', 2)} it does not; "
                "give lubricant.pressure_viscosity as a table that falls with temperature, or choose another "
                "lubricant.pressure_viscosity_law"
            )
        tau0 = self.eyring_stress(s)
        V = np.maximum(np.abs(s.sliding_speed), LINEAR_RATIO * s.rolling_speed)
        transit = s.half_width / s.rolling_speed
        capacity = self.heat_capacity * s.film_thickness**2 / (c.conductivity * transit)
        heat = tau0 * V
        flash = self.flash / (c.effusivity * np.sqrt(np.pi)) * np.sqrt(transit)
        across = s.film_thickness / (8 * c.conductivity)
        return Groups(
            log_rate=np.log(2 * V / (tau0 * s.film_thickness) * eta),
            flash=beta * (flash * heat / np.sqrt(1 + (UNREACHED * capacity) ** 2)),
            film=beta * (heat * across / np.sqrt(1 + (CARRIED * capacity) ** 2)),
            bound=self.shear_modulus(s) * V / (s.film_thickness * tau0) * transit,
        )

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        s = slices
        stress = mean_stress(self.local_groups(s))
        linear = np.minimum(np.abs(s.sliding_speed) / (LINEAR_RATIO * s.rolling_speed), 1)
        s.friction[...] = np.copysign(
            self.eyring_stress(s) / s.pressure * stress * linear, s.sliding_speed
        )

    def kernel(self) -> object:
        """Return the compiled form, which calls that of the oil's law."""
        logarithm = self.law.log_kernel()
        return compiled.maxwell_eyring_local(
            stage(self.law) if logarithm is None else logarithm,
            logarithm is not None,
            self.flash,
            self.heat_capacity,
            self.eyring_stress_slope,
            self.shear_modulus_slope,
        )
