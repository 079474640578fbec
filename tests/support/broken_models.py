"""Models that each break one rule of the contract, and the rule that has to find it.

- Each fault is laid over a law that keeps every rule (`Film`, `Traction`, `Line`, `Drag`, `Resistance`, `Pocket`,
  `Explicit`, `oil`), so that nothing but the fault can be found; a test holds the sound ones against the whole kit.
- The first line of a docstring says what is wrong; the table in the documentation is made of it.
- Kernels are functions of Python behind ctypes, wrong in the same ways as compiled ones. Only a scratch that threads
  share is C, compiled when it is asked for: a function of Python holds the GIL and would not race.
- `FATAL` are sources of packages that end or hold up the process, for the runner.
"""

import contextlib
import functools
import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import MappingProxyType

import attrs
import numpy as np

from foreign_stages import compiled_capsule, foreign_capsule
from rollslip.catalogue.registry import get_model
from rollslip.engine import Engine
from rollslip.errors import DomainError
from rollslip.fields import parameter, positive
from rollslip.lubricant import Constant, Lubricant, Vogel
from rollslip.models import (
    FINITE,
    POSITIVE,
    ContactModel,
    DragModel,
    FilmModel,
    IntegratorModel,
    PocketFriction,
    ResistanceModel,
    RibModel,
    SliceModel,
    TractionModel,
    Validity,
)
from rollslip.planning.campaign import OfScene
from rollslip.results.dataset import xr
from rollslip.rings import RingModel, RingShapes
from rollslip.structure import FrozenTable
from rollslip.studies.rating_life.model import LifeModel, RatedLife
from rollslip.studies.steady_slip.loss import LossModel
from rollslip.studies.steady_slip.torque import TorqueFormula
from rollslip.studies.surface_damage.model import DamageModel
from rollslip.studies.thermal_balance.model import ROLES, ThermalModel
from rollslip_kernels.slices import COLUMNS, CONDITIONS
from rollslip_kernels.stages.drag import python_drag

SOURCE = ("Nobody N. On laws that are made to be tested. J. None 1, 2000.",)
BROKEN = []


def listing(broken):
    """Return a decorator that freezes a model and puts it on this list of those that a rule has to refuse."""

    def breaks(rule, eq=True, **parameters):
        def add(cls):
            frozen = attrs.frozen(cls, kw_only=True, eq=eq)
            broken.append((rule, frozen(**parameters)))
            return frozen

        return add

    return breaks


breaks = listing(BROKEN)


# Sound laws ----------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Film(FilmModel):
    """A rigid, isoviscous film h = c eta u R/w."""

    name = "sound-film"
    equation = "h = c eta u R/w"
    references = SOURCE
    location = "minimum"
    regime = "IR"
    factor: float = parameter(default=4.9, unit="1", validator=positive, doc="coefficient c")

    def evaluate(self, slices):
        slices.film_thickness[...] = self.law(slices, slices.conditions)

    def law(self, s, c):
        return self.factor * c.viscosity * s.rolling_speed * c.radius / s.load


@attrs.frozen(kw_only=True)
class Traction(TractionModel):
    """Friction mu = f s/sqrt(1 + (s/s0)^2)/s0 of the slide-roll ratio s = V/u."""

    name = "sound-traction"
    equation = "mu = f s/s0/sqrt(1 + (s/s0)^2)"
    references = SOURCE
    reads = frozenset({"rolling_speed", "sliding_speed"})
    domain = MappingProxyType({"rolling_speed": POSITIVE, "sliding_speed": FINITE})
    coefficient: float = parameter(
        default=0.05, unit="1", validator=positive, doc="friction f at large slip"
    )

    def evaluate(self, slices):
        slices.friction[...] = self.law(slices.sliding_speed, slices.rolling_speed)

    def law(self, V, u):
        return self.coefficient * V / np.hypot(V, 1e-3 * u)


@attrs.frozen
class Springs(SliceModel):
    """A bed of springs: the load is proportional to the approach."""

    name = "sound-deflection"
    equation = "w = E' delta"
    references = SOURCE
    reads = frozenset({"approach", "modulus"})
    writes = frozenset({"load", "stiffness"})
    domain = MappingProxyType({"approach": FINITE, "modulus": POSITIVE})

    def evaluate(self, slices):
        slices.load[...] = slices.conditions.modulus * np.maximum(slices.approach, 0.0)
        slices.stiffness[...] = np.where(slices.approach > 0, slices.conditions.modulus, 0.0)


@attrs.frozen
class Line(ContactModel):
    """Hertz line contact on a bed of springs."""

    name = "sound-contact"
    equation = "b = sqrt(8 w R/(pi E')), p = w/(2 b)"
    references = SOURCE

    def evaluate(self, slices):
        slices.half_width[...] = self.half_width(slices, slices.conditions)
        slices.pressure[...] = slices.load / (2 * slices.half_width)

    def half_width(self, s, c):
        return np.sqrt(8 * c.radius / (np.pi * c.modulus) * s.load)

    def deflection(self):
        return Springs()


@attrs.frozen(kw_only=True)
class Drag(DragModel):
    """A torque that is proportional to the speed of the cage."""

    name = "sound-drag"
    equation = "T = -k w_c"
    references = SOURCE
    damping: float = parameter(default=1e-3, unit="1", validator=positive, doc="damping k")

    def torque(self, cage_speed, inner_speed, outer_speed):
        return -self.damping * cage_speed


@attrs.frozen(kw_only=True)
class Resistance(ResistanceModel):
    """A resistance that is a share of the load."""

    name = "sound-resistance"
    equation = "F = k w"
    references = SOURCE
    reads = frozenset({"load"})
    domain = MappingProxyType({"load": POSITIVE})
    fraction: float = parameter(default=1e-3, unit="1", validator=positive, doc="share k")

    def evaluate(self, slices):
        slices.resistance[...] = self.fraction * slices.load


@attrs.frozen(kw_only=True)
class Pocket(PocketFriction):
    """A friction of the pocket."""

    name = "sound-pocket"
    equation = "M = mu P r"
    references = SOURCE
    coefficient: float = parameter(
        default=0.1, unit="1", validator=positive, doc="friction coefficient mu"
    )


@attrs.frozen
class Explicit(IntegratorModel):
    """SciPy's RK45."""

    name = "sound-integrator"
    equation = "dy/dt = f(t, y)"
    references = SOURCE
    order = 5
    solver_name = "RK45"

    def solver(self):
        import broken_solvers

        return getattr(broken_solvers, self.solver_name)


def oil(cls=Lubricant, **changes):
    sound = {
        "name": "sound-oil",
        "description": "An oil of nobody",
        "viscosity": Vogel(1e-4, 800.0, 170.0),
        "pressure_viscosity": Constant(1e-8),
        "minimum_temperature": 273.15,
        "maximum_temperature": 423.15,
        "source": "Made for these tests.",
        "references": SOURCE,
    }
    return cls(**{**sound, **changes})


@attrs.frozen(kw_only=True)
class Threads(Engine):
    """Two threads."""

    name = "sound-engine"
    separate = False
    pool: int = parameter(default=2, doc="points at a time")

    def executor(self):
        return ThreadPoolExecutor(self.pool)

    def workers(self, executor):
        return self.pool


SOUND = [Film(), Traction(), Line(), Drag(), Resistance(), Pocket(), Explicit(), Threads(), oil()]


# Engines -------------------------------------------------------------------------------------------------------------


@breaks("check_gives_back_what_its_tasks_return")
class FirstForAll(Threads):
    """All tasks get the result of the first."""

    def executor(self):
        executor = ThreadPoolExecutor(1)
        first = []

        def submit(fn, /, *arguments):
            first.append(executor.__class__.submit(executor, fn, *arguments))
            return first[0]

        executor.submit = submit
        return executor


@breaks("check_hands_on_what_a_task_raises")
class ErrorsAreLost(Threads):
    """A task that fails gives nothing instead."""

    def executor(self):
        executor = ThreadPoolExecutor(1)

        def submit(fn, /, *arguments):
            def kept():
                with contextlib.suppress(Exception):
                    return fn(*arguments)
                return None

            return executor.__class__.submit(executor, kept)

        executor.submit = submit
        return executor


# Values --------------------------------------------------------------------------------------------------------------


@breaks("check_is_frozen")
class Mutable(Film):
    """A parameter can be set after the model was made."""


@breaks("check_equal_models_are_equal_and_have_equal_hashes", eq=False)
class HashOfIdentity(Film):
    """Two models are equal but have different hashes."""

    def __eq__(self, other):
        return type(other) is type(self) and other.factor == self.factor

    def __hash__(self):
        return id(self)


@breaks("check_equal_models_are_equal_and_have_equal_hashes")
class ListAsParameter(Film):
    """A list as a parameter, which has no hash."""

    points: list = attrs.field(factory=lambda: [1.0, 2.0], metadata={"doc": "points", "unit": None})


@breaks("check_equal_models_are_equal_and_have_equal_hashes")
class UncomparedParameter(Film):
    """A parameter that equality leaves out."""

    other: float = attrs.field(default=1.0, eq=False, metadata={"doc": "anything", "unit": "1"})


@breaks("check_survives_pickling")
class FunctionAsParameter(Film):
    """A local function as a parameter, which cannot be sent to another process."""

    shape: object = attrs.field(
        factory=lambda: lambda x: x, metadata={"doc": "a shape", "unit": None}
    )


def _by_name(self):
    """Pickle a class that says it comes from elsewhere."""
    return _make, (type(self).__name__,)


def _make(name):
    return globals()[name]()


@breaks("check_is_named_as_its_entry_point")
class NotInItsEntryPoints(Film):
    """No entry point of its module has its name."""

    __module__ = "rollslip_plugins.film.formulas"
    __reduce__ = _by_name


@breaks("check_its_module_is_imported_fast_and_quietly")
class SlowImport(Film):
    """Its module takes 0.6 s to import."""

    __module__ = "slow_import"
    __reduce__ = _by_name


@breaks("check_its_module_is_imported_fast_and_quietly")
class PrintingImport(Film):
    """Its module prints when it is imported."""

    __module__ = "this"  # of the standard library
    __reduce__ = _by_name


# What is said --------------------------------------------------------------------------------------------------------


@breaks("check_has_description_and_citations")
class WithoutReference(Film):
    """It does not say where it comes from."""

    references = ()


@breaks("check_has_description_and_citations")
class NameWithBlanks(Film):
    """A name that no scene and no shell can hold."""

    name = "My Film (new)"


@breaks("check_has_description_and_citations")
class Undescribed(Film):  # its docstring is set below
    pass


Mutable.__setattr__ = object.__setattr__
Undescribed.__doc__ = "no docstring that is a sentence"


@breaks("check_every_parameter_has_a_meaning_and_a_unit")
class WithoutMeaning(Film):
    """A parameter without a word on what it means."""

    other: float = attrs.field(default=1.0)


@breaks("check_every_parameter_has_a_meaning_and_a_unit")
class WithoutUnit(Film):
    """A parameter that is a number, without a unit."""

    other: float = parameter(default=1.0, doc="anything")


@breaks("check_declares_its_film_thickness")
class SomeFilm(Film):
    """It does not say which thickness it returns."""

    location = "thin"


# Slices --------------------------------------------------------------------------------------------------------------


@breaks("check_reads_and_writes_members_that_exist")
class WithoutRange(Film):
    """It reads a member and gives no range for it."""

    domain = MappingProxyType(
        {name: limits for name, limits in Film.domain.items() if name != "load"}
    )


@breaks("check_reads_and_writes_members_that_exist")
class ReadsWhatItWrites(Film):
    """It reads the column that it writes."""

    reads = Film.reads | {"film_thickness"}
    domain = MappingProxyType({**Film.domain, "film_thickness": FINITE})


def made_for(**changes):
    """A sound validity with changes."""
    sound = {
        "quantity": "slide_roll_ratio",
        "high": 0.1,
        "consequence": "it is off",
        "remedy": "none",
    }
    return Validity(**{**sound, "source": "nobody", **changes})


@breaks("check_states_what_it_was_made_for_in_quantities_that_can_be_evaluated")
class MadeForNothingKnown(Traction):
    """Its validity is stated in a quantity that nobody knows."""

    validity = (made_for(quantity="weissenberg"),)


@breaks("check_states_what_it_was_made_for_in_quantities_that_can_be_evaluated")
class MadeForAnything(Traction):
    """Its validity has no bound."""

    validity = (made_for(high=math.inf),)


@breaks("check_states_what_it_was_made_for_in_quantities_that_can_be_evaluated")
class ErrorBelowNothing(Traction):
    """The error that it states outside its validity is negative."""

    validity = (made_for(consequence="it is {error} off", error=lambda ratio: 0.1 - ratio),)


@breaks("check_states_what_it_was_made_for_in_quantities_that_can_be_evaluated")
class NoRemedy(Traction):
    """It was made for something and says not what to do outside."""

    validity = (made_for(remedy=" "),)


@breaks("check_can_be_bound_in_a_chain")
class NoCapsule(Film):
    """Its kernel is a number."""

    def kernel(self):
        return 42


@breaks("check_takes_what_a_bearing_gives")
class RefusesAll(Film):
    """It refuses every slice of its own domain."""

    def evaluate(self, slices):
        raise DomainError(f"{self.name}: slice 0 is outside its domain")


class _Kernel(Film):
    """A film with a kernel: `compiled(part, law)` fills a block, whose members are arrays."""

    def kernel(self):
        return _capsule(type(self))

    @staticmethod
    def compiled(part, law):
        part.film_thickness[...] = law


class _Part:
    """A block as arrays."""

    def __init__(self, part):
        self.n = part.n
        for name in CONDITIONS:
            setattr(self, name, getattr(part, name))
        for name in (
            name for name in COLUMNS if getattr(part, name)
        ):  # where slices are nobody asks
            setattr(self, name, np.ctypeslib.as_array(getattr(part, name), (part.n,)))


@functools.cache
def _capsule(cls):
    def evaluate(struct):
        part = _Part(struct)
        cls.compiled(part, 4.9 * part.viscosity * part.rolling_speed * part.radius / part.load)
        return 0

    return foreign_capsule(evaluate)


@breaks("check_complies_with_its_declarations")
class Overwrites(Film):
    """It limits the load in its place."""

    def evaluate(self, slices):
        slices.load[...] = np.maximum(slices.load, 1.0)
        slices.film_thickness[...] = self.law(slices, slices.conditions)


@breaks("check_complies_with_its_declarations")
class Unfilled(Film):
    """It gives its result to a name of its own."""

    def evaluate(self, slices):
        film_thickness = self.law(slices, slices.conditions)  # noqa: F841 - that is the fault


@breaks("check_complies_with_its_declarations")
class Undeclared(Film):
    """It reads the sliding speed, which it does not say."""

    def law(self, s, c):
        return super().law(s, c) * (1.0 + 1e-3 * s.sliding_speed / s.rolling_speed)


@breaks("check_complies_with_its_declarations")
class WritesRegime(Film):
    """It writes the regime, which it does not say."""

    def evaluate(self, slices):
        slices.film_thickness[...] = self.law(slices, slices.conditions)
        slices.regime[...] = 0.0


@breaks("check_complies_with_its_declarations")
class ReadsUnknown(Film):
    """It declares a member that there is not."""

    reads = Film.reads | {"velocity"}
    domain = MappingProxyType({**Film.domain, "velocity": POSITIVE})


@breaks("check_complies_with_its_declarations")
class Misspelt(Film):
    """It asks for a column that there is not."""

    def law(self, s, c):
        return super().law(s, c) * s.velocity


@breaks("check_does_not_know_metre_kilogram_second_and_kelvin")
class Jumps(Film):
    """It jumps at a rolling speed that is written into it."""

    def law(self, s, c):
        return super().law(s, c) * np.where(s.rolling_speed > 10.0, 1.1, 1.0)


@breaks("check_fills_what_it_writes_and_touches_nothing_else")
class WritesAnotherColumn(_Kernel):
    """Its kernel writes the regime, which it does not say."""

    @staticmethod
    def compiled(part, law):
        part.film_thickness[...] = law
        part.regime[...] = 2.0


@breaks("check_fills_what_it_writes_and_touches_nothing_else")
class WritesItsInput(_Kernel):
    """Its kernel changes the load it reads."""

    @staticmethod
    def compiled(part, law):
        part.film_thickness[...] = law
        part.load[...] *= 1 + 1e-15


@breaks("check_fills_what_it_writes_and_touches_nothing_else")
class LeavesTheLastSlice(_Kernel):
    """Its kernel forgets the last slice of a block."""

    @staticmethod
    def compiled(part, law):
        part.film_thickness[:-1] = law[:-1]


@breaks("check_fills_what_it_writes_and_touches_nothing_else")
class ReadsAnotherColumn(_Kernel):
    """Its kernel reads the friction, which it does not say."""

    @staticmethod
    def compiled(part, law):
        part.film_thickness[...] = law * np.where(part.friction > 0, 1.01, 1.0)


@breaks("check_takes_read_only_inputs")
class AsksForMore(Film):
    """Its NumPy form reads a column that it does not declare."""

    def evaluate(self, slices):
        slices.film_thickness[...] = self.law(slices, slices.conditions) + 0.0 * np.nan_to_num(
            slices.pressure
        )


@breaks("check_compiled_equals_numpy")
class AnotherConstant(_Kernel):
    """Compiled and NumPy form differ by 1e-9."""

    @staticmethod
    def compiled(part, law):
        part.film_thickness[...] = law * (1 + 1e-9)


@breaks("check_does_not_depend_on_the_block_size")
class KnowsItsBlock(_Kernel):
    """The last bits depend on the number of slices in a block."""

    @staticmethod
    def compiled(part, law):
        part.film_thickness[...] = law * (1 + 1e-15 * (part.n % 16))


@breaks("check_does_not_depend_on_the_order_of_slices")
class KnowsItsNeighbour(_Kernel):
    """The last bits depend on the slice before."""

    @staticmethod
    def compiled(part, law):
        part.film_thickness[...] = law * (1 + 2e-16 * (np.roll(law, 1) > law))


@breaks("check_has_no_hidden_state")
class Counts(_Kernel):
    """A hidden counter changes the last bits from call to call."""

    calls = [0]  # noqa: RUF012 - the fault

    @staticmethod
    def compiled(part, law):
        Counts.calls[0] += 1
        part.film_thickness[...] = law * (1 + 4e-16 * (Counts.calls[0] % 7))


@breaks("check_has_no_hidden_state")
class Remembers(Film):
    """Its NumPy form starts from the last result, as a warm start would."""

    last = [0.0]  # noqa: RUF012 - the fault

    def evaluate(self, slices):
        film = self.law(slices, slices.conditions)
        slices.film_thickness[...] = film * (1 + 1e-14 * self.last[0])
        self.last[0] = 1.0 if film[0] > film[-1] else 0.0


@breaks("check_gives_the_same_bits_in_eight_threads")
class StaticScratch(Film):
    """Its kernel keeps a block in a static array, which all threads share."""

    def kernel(self):
        return _static_scratch()


@functools.cache
def _static_scratch():
    source = """
        #include "rollslip.h"
        static volatile double scratch[256];
        int evaluate(const rs_slices *s, const void *params) {
            for (size_t start = 0; start < s->n; start += 256) {
                size_t n = s->n - start < 256 ? s->n - start : 256;
                for (size_t i = 0; i < n; i++)
                    scratch[i] = 4.9 * s->viscosity * s->rolling_speed[start + i] * s->radius;
                for (size_t i = 0; i < n; i++)
                    s->film_thickness[start + i] = scratch[i] / s->load[start + i];
            }
            return 0;
        }
    """
    return compiled_capsule(source)


@breaks("check_refuses_values_outside_its_domain")
class TakesInfinity(Film):
    """Its domain goes to infinity, so that infinite loads are computed with."""

    domain = MappingProxyType({**Film.domain, "load": (5e-324, math.inf)})


@breaks("check_answers_its_whole_domain_with_numbers_or_an_error")
class Overflows(Film):
    """A power of Python's floats raises OverflowError at large viscosities."""

    def law(self, s, c):
        return self.factor * (c.viscosity**2 / c.viscosity) * s.rolling_speed * c.radius / s.load


@breaks("check_does_not_know_metre_kilogram_second_and_kelvin")
class HiddenConstant(Film):
    """A constant in N/m is hidden in the law."""

    def law(self, s, c):
        return super().law(s, c) / (1 + s.load / 1e6)


@breaks("check_does_not_know_metre_kilogram_second_and_kelvin")
class WrongUnit(Film):
    """A length is declared as a plain number."""

    floor: float = parameter(default=1e-9, unit="1", doc="least film thickness")

    def law(self, s, c):
        return np.hypot(super().law(s, c), self.floor)


# Contact and deflection ----------------------------------------------------------------------------------------------


@breaks("check_mean_pressure_carries_the_load")
class MaximumPressure(Line):
    """It returns the maximum pressure for the mean."""

    def evaluate(self, slices):
        super().evaluate(slices)
        slices.pressure[...] *= 4 / np.pi


@breaks("check_half_width_rises_with_the_load")
class ConstantWidth(Line):
    """The half width does not depend on the load."""

    def half_width(self, s, c):
        return 1e-2 * c.radius + 0 * s.load


@breaks("check_deflection_is_a_stage_of_its_own")
class NoDeflection(Line):
    """Its deflection is a film."""

    def deflection(self):
        return Film()


@breaks("check_separated_surfaces_carry_no_load")
class Sticks(Springs):
    """Surfaces that are apart pull."""

    def evaluate(self, slices):
        slices.load[...] = slices.conditions.modulus * slices.approach
        slices.stiffness[...] = slices.conditions.modulus


@breaks("check_load_rises_with_the_approach")
class Softens(Springs):
    """The load falls again where the approach is large."""

    reads = Springs.reads | {"radius"}
    domain = MappingProxyType({**Springs.domain, "radius": POSITIVE})

    def evaluate(self, slices):
        c = slices.conditions
        d = np.maximum(slices.approach, 0.0)
        fraction = d / (1e-3 * c.radius)
        slices.load[...] = c.modulus * d / (1 + fraction**2)
        slices.stiffness[...] = np.where(
            d > 0, c.modulus * np.abs(1 - fraction**2) / (1 + fraction**2) ** 2, 0.0
        )


@breaks("check_stiffness_is_the_derivative_of_the_load")
class AnotherSlope(Springs):
    """The stiffness errs by 1e-6."""

    def evaluate(self, slices):
        super().evaluate(slices)
        slices.stiffness[...] *= 1 + 1e-6


# Film and traction ---------------------------------------------------------------------------------------------------


@breaks("check_film_is_positive")
class NegativeFilm(Film):
    """The film is negative under light loads."""

    def law(self, s, c):
        return super().law(s, c) * (1 - 1e-3 * c.modulus * c.radius / s.load)


@breaks("check_film_does_not_grow_with_the_load")
class GrowsWithLoad(Film):
    """The film grows with the load where the load is large."""

    def law(self, s, c):
        return super().law(s, c) * (1 + (s.load / (1e-4 * c.modulus * c.radius)) ** 2)


@breaks("check_film_grows_with_the_rolling_speed")
class FallsWithSpeed(Film):
    """The film falls with the speed where the speed is large."""

    def law(self, s, c):
        film = super().law(s, c)
        return film / (1 + film / c.radius * 1e3) ** 2


@breaks("check_is_odd_in_slip")
class OneWay(Traction):
    """Friction is greater in one direction than in the other."""

    def law(self, V, u):
        return super().law(V, u) * np.where(V > 0, 1 + 1e-9, 1.0)


@breaks("check_is_zero_at_zero_slip")
class RollsWithFriction(Traction):
    """Friction is not zero in pure rolling."""

    def law(self, V, u):
        return super().law(V, u) + 1e-12


@breaks("check_takes_power_out_of_sliding")
class Drives(Traction):
    """ln(2 V/u s0) in place of asinh: negative friction at small slip."""

    def law(self, V, u):
        s = np.abs(V) / (1e-3 * u)
        return np.sign(V) * self.coefficient * np.log(2 * np.maximum(s, 1e-300))


@breaks("check_friction_coefficient_is_below_unity")
class Percent(Traction):
    """The coefficient is in percent."""

    def law(self, V, u):
        return 100 * super().law(V, u)


# Drag ----------------------------------------------------------------------------------------------------------------


@breaks("check_torque_is_finite_and_the_same_again")
class DividesByTheRing(Drag):
    """The torque is not a number where the inner ring stands still."""

    def torque(self, cage_speed, inner_speed, outer_speed):
        return -self.damping * cage_speed / inner_speed * inner_speed if inner_speed else math.nan


@breaks("check_torque_changes_sign_with_all_speeds")
class ForgetsTheSign(Drag):
    """Churning without the sign of the speed."""

    def torque(self, cage_speed, inner_speed, outer_speed):
        return -self.damping * cage_speed**2


@breaks("check_torque_takes_power_out_of_a_cage_between_still_rings")
class DrivesTheCage(Drag):
    """The torque drives the cage."""

    def torque(self, cage_speed, inner_speed, outer_speed):
        return self.damping * cage_speed


@breaks("check_compiled_torque_equals_python")
class AnotherTorque(Drag):
    """The compiled form forgets a digit of the damping."""

    def kernel(self):
        return python_drag(lambda cage, inner, outer: -1.0000001 * self.damping * cage)


@breaks("check_resistance_takes_power_out_of_rolling")
class Helps(Resistance):
    """The oil rolls the rollers on."""

    def evaluate(self, slices):
        slices.resistance[...] = -self.fraction * slices.load


@breaks("check_resistance_does_not_fall_with_load_and_speed")
class TiresWithLoad(Resistance):
    """The resistance falls as the load rises."""

    def evaluate(self, slices):
        slices.resistance[...] = self.fraction / slices.load


@breaks("check_pocket_coefficient_is_a_fraction", coefficient=12.0)
class PercentOfThePocket(Pocket):
    """The friction of the pocket is given in per cent."""


# Integrators ---------------------------------------------------------------------------------------------------------


@breaks("check_is_a_solver_of_scipys_kind")
class Function(Explicit):
    """It returns a function in place of a solver."""

    solver_name = "solve_ivp"


@breaks("check_converges_with_its_order")
class LowerOrder(Explicit):
    """It says order 5 and has order 3."""

    solver_name = "RK23"


@breaks("check_error_falls_with_the_tolerance")
class Careless(Explicit):
    """It takes no tolerance below 1e-2."""

    solver_name = "Careless"


@breaks("check_is_as_accurate_between_its_steps")
class Straight(Explicit):
    """Straight lines between the steps of order 5."""

    solver_name = "Straight"


@breaks("check_runs_backwards_in_time")
class Forwards(Explicit):
    """It runs forwards only."""

    solver_name = "Forwards"


@breaks("check_follows_an_angle_over_many_turns")
class WithinATurn(Explicit):
    """It takes every unknown above 2 pi for an angle, and a turn off it."""

    solver_name = "WithinATurn"


@breaks("check_adapts_its_steps")
class FixedStep(Explicit):
    """Steps of 2e-3, whatever the problem."""

    solver_name = "FixedStep"


@breaks("check_reports_a_failure")
class Hides(Explicit):
    """It says that it has finished where it has failed."""

    solver_name = "Hides"


# Lubricants ----------------------------------------------------------------------------------------------------------


@attrs.frozen
class _Bump:
    law: Vogel
    height: float = 3.0

    def __call__(self, T):
        return self.law(T) * (1 + self.height * math.exp(-(((T - 350.0) / 5.0) ** 2)))

    def derivative(self, T):
        bump = self.height * math.exp(-(((T - 350.0) / 5.0) ** 2))
        return self.law.derivative(T) * (1 + bump) - self.law(T) * bump * 2 * (T - 350.0) / 25.0


@attrs.frozen
class _OtherSlope:
    law: Vogel

    def __call__(self, T):
        return self.law(T)

    def derivative(self, T):
        return 1.001 * self.law.derivative(T)


@attrs.frozen(kw_only=True)
class _Clamped(Lubricant):
    """Outside its range the nearest temperature is taken."""

    def at(self, temperature):
        clamped = min(max(temperature, self.minimum_temperature), self.maximum_temperature)
        with contextlib.suppress(DomainError):
            return super().at(clamped)
        return super().at(self.minimum_temperature)


OILS = {  # what is wrong with it, for the table: a value has no docstring
    "no source": ("check_oil_has_description_and_references", oil(source="")),
    "the viscosity rises in the middle of its range": (
        "check_viscosity_falls_with_temperature",
        oil(viscosity=_Bump(Vogel(1e-4, 800.0, 170.0))),
    ),
    "the slope of its viscosity law errs by 1e-3": (
        "check_slopes_are_those_of_its_laws",
        oil(viscosity=_OtherSlope(Vogel(1e-4, 800.0, 170.0))),
    ),
    "outside its range the nearest temperature is taken": (
        "check_refuses_temperatures_outside_its_range",
        oil(_Clamped),
    ),
    "its viscosity is in mPa s": (
        "check_properties_are_usual",
        oil(viscosity=Vogel(0.1, 800.0, 170.0)),
    ),
    "its viscosity is a kinematic one": (
        "check_properties_are_usual",
        oil(viscosity=Vogel(1e-4 / 870.0, 800.0, 170.0)),
    ),
    "its pressure-viscosity coefficient is in 1/GPa": (
        "check_properties_are_usual",
        oil(pressure_viscosity=Constant(20.0)),
    ),
    "its pressure-viscosity coefficient is 10 times too large": (
        "check_properties_are_usual",
        oil(pressure_viscosity=Constant(2e-7)),
    ),
    "its conductivity is 100 times too small": (
        "check_properties_are_usual",
        oil(conductivity=Constant(0.0014)),
    ),
    "its Eyring stress is in MPa": ("check_properties_are_usual", oil(eyring_stress=5.0)),
    "its density is in g/cm3": ("check_properties_are_usual", oil(density=Constant(0.87))),
    "it has constants for a law of nobody": (
        "check_constants_are_parameters_of_laws",
        oil(models={"law-of-nobody": {"flash": 1.0}}),
    ),
    "it has a constant that its law does not know": (
        "check_constants_are_parameters_of_laws",
        oil(models={"maxwell-eyring": {"flush": 1.0}}),
    ),
    "it has a constant that no law knows": (
        "check_constants_are_parameters_of_laws",
        oil(models={"flush": 1.0}),
    ),
    "it has a negative constant": (
        "check_constants_are_parameters_of_laws",
        oil(models={"eyring": {"flash": -1.0}}),
    ),
}
BROKEN += OILS.values()


# Data sets -----------------------------------------------------------------------------------------------------------


def data_set(**changes):
    sound = get_model("measurement", "klebanov-2022")
    return attrs.evolve(sound, name="sound-data", **changes)


def _rows(**changes):
    """Return a sound series with other conditions in its row."""
    series = data_set().series[0]
    return (
        attrs.evolve(series, rows=(attrs.evolve(series.rows[0], changes=FrozenTable(changes)),)),
    )


DATA_SETS = {
    "no citation": ("check_data_set_states_contents_and_source", data_set(references=())),
    "a row names an oil that nobody offers": (
        "check_rows_make_valid_bearings",
        data_set(series=_rows(**{"lubricant.name": "oil-of-nobody"})),
    ),
}
BROKEN += DATA_SETS.values()
SOUND.append(data_set())

# Campaigns -----------------------------------------------------------------------------------------------------------


def _campaign(**members):
    return type(
        "SoundCampaign", (get_model("campaign", "limit"),), {"name": "sound-campaign", **members}
    )


CAMPAIGNS = {
    "a summary that is not how its help begins": (
        "check_a_campaign_has_its_command_and_its_function",
        _campaign(summary="Search a limit.", own_command="rollslip.cli.run:plan"),
    ),
}


RUNS = []


@attrs.frozen(eq=False)
class _Counting(OfScene):
    """Count the runs of SCENE."""

    name = "counting"

    def plan(self):
        return None

    def run(self, made, folder, show, message):
        RUNS.append(made)
        return xr.Dataset({"runs": len(RUNS)})


CAMPAIGNS["a result that counts its runs"] = (
    "check_a_campaign_gives_the_same_bits_twice",
    _Counting,
)
BROKEN += CAMPAIGNS.values()
SOUND.append(_campaign())


def fault_of(model):
    """Return what is wrong with a model, as its docstring says it."""
    for fault, (_, broken) in (OILS | DATA_SETS | CAMPAIGNS).items():
        if broken is model:
            return fault
    return (type(model).__doc__ or "").strip().splitlines()[0].rstrip(".")


# Rings ---------------------------------------------------------------------------------------------------------------


@breaks("check_a_preloaded_bearing_rests_in_it_and_presses_less")
class Squeezed(RingModel):
    """A seat that squeezes its ring, told as part of how the ring yields."""

    name = "squeezed"
    equation = "K q = F - P"
    references = SOURCE

    def shapes(self, bearing, ring, turns):
        return RingShapes(np.ones((1, 1), complex), np.array([1e9]), pushes=np.array([-1e5]))


# Thermal models ------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Heat(ThermalModel):
    """Oil and steel that exchange heat; oil carries it away."""

    name = "sound-heat"
    equation = "C_k dT_k/dt = H_k + K (T_j - T_k) - m c (T_oil - T_0)"
    references = SOURCE

    exchange: float = parameter(
        default=20.0, unit="W/K", doc="conductance between oil and steel", validator=positive
    )
    carried: float = parameter(
        default=10.0, unit="W/K", doc="heat that the oil carries a kelvin", validator=positive
    )
    inflow: float = parameter(
        default=300.0, unit="K", doc="temperature of oil that comes in", validator=positive
    )

    @property
    def nodes(self):
        return ("oil", "steel")

    def start(self, scene):
        return np.full(2, scene.operation.temperature)

    def capacities(self):
        return np.array([1e3, 1e4])

    def inflows(self, temperatures, losses):
        oil, steel = temperatures
        across = self.exchange * (steel - oil)
        return np.array(
            [sum(losses.values()) + across - self.carried * (oil - self.inflow), -across]
        )

    def carried_away(self, temperatures):
        return {"oil": self.carried * (temperatures[0] - self.inflow)}

    def changes(self, temperatures, scene):
        return {key: float(temperatures[int(role != "oil")]) for key, role in ROLES.items()}


@breaks("check_has_an_equation_and_references")
class _Unsourced(Heat):
    """A thermal model without a source."""

    references = ()


@breaks("check_heat_is_conserved")
class _Leaks(Heat):
    """A tenth of the losses goes nowhere."""

    def inflows(self, temperatures, losses):
        return super().inflows(temperatures, {place: 0.9 * loss for place, loss in losses.items()})


@breaks("check_a_warmer_node_takes_less_heat_and_the_others_no_less", exchange=-20.0)
class _Backwards(Heat):
    """Heat flows from cold oil to warm steel."""

    exchange: float = parameter(default=-20.0, unit="W/K", doc="conductance of the wrong sign")


@breaks("check_nodes_have_capacities_and_keys_of_the_scene")
class _Weightless(Heat):
    """Its oil has no heat capacity."""

    def capacities(self):
        return np.array([0.0, 1e4])


SOUND.append(Heat())


# Damage models -------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Rubbing(DamageModel):
    """Force of friction on the area of a contact, largest in its middle."""

    name = "sound-rubbing"
    equation = "tau = |mu| p"
    references = SOURCE
    measure = "friction stress"
    unit = "Pa"
    scope = "it knows nothing of speed"

    def evaluate(self, contacts):
        return np.abs(contacts.slices.friction) * contacts.slices.pressure

    def across(self, contacts, places):
        return self.evaluate(contacts)[:, None] * (2.0 - places**2)

    @property
    def limit(self):
        return 1e8, "Nobody (2000)"


@breaks("check_has_an_equation_and_references")
class _UnsourcedRubbing(Rubbing):
    """A damage model without a source."""

    references = ()


@breaks("check_describes_its_unit_and_limits")
class _Boundless(Rubbing):
    """It says nothing of what it does not say."""

    scope = ""


@breaks("check_describes_its_unit_and_limits")
class _Imperial(Rubbing):
    """Its unit is none that the program knows."""

    unit = "psi ft/min"


@breaks("check_value_of_each_slice_is_finite")
class _Summed(Rubbing):
    """One number for all slices."""

    def evaluate(self, contacts):
        return super().evaluate(contacts).sum()


@breaks("check_slices_are_measured_alone_and_left_as_they_are")
class _Relative(Rubbing):
    """Each slice is measured by the first one."""

    def evaluate(self, contacts):
        own = super().evaluate(contacts)
        return own / own[0]


@breaks("check_slices_are_measured_alone_and_left_as_they_are")
class _Tidying(Rubbing):
    """It takes the sign of the friction out of the slices."""

    def evaluate(self, contacts):
        contacts.slices.friction[:] = np.abs(contacts.slices.friction)
        return contacts.slices.friction * contacts.slices.pressure


@breaks("check_more_friction_is_no_better")
class _Upside(Rubbing):
    """Its worst value is the largest, and it says the smallest."""

    worst = "smallest"


@breaks("check_values_across_a_contact_agree_with_the_measure")
class _Mild(Rubbing):
    """Nowhere across a contact is it half as bad as it says."""

    def across(self, contacts, places):
        return 0.4 * self.evaluate(contacts)[:, None] * (1.0 - 0.5 * places**2)


@breaks("check_a_limit_has_a_source")
class _Hearsay(Rubbing):
    """Nobody knows where its limit comes from."""

    @property
    def limit(self):
        return 1e8, ""


SOUND.append(Rubbing())


# Rating lives ---------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Lasting(LifeModel):
    """A life by the radial load alone."""

    name = "sound-life"
    equation = "L = (C/P)^3"
    references = SOURCE
    basis = "a cube"

    def rate(self, duty):
        P = duty.radial_load
        n = duty.widths.size
        return RatedLife(
            revolutions=1e6 * (duty.dynamic_rating / P) ** 3,
            equivalent_load=P,
            damage=np.full((2, n), 0.5 / n),
            slice_load=np.full(n, P),
        )


@breaks("check_has_an_equation_and_references")
class _UnsourcedLife(Lasting):
    """A life without a source."""

    references = ()


@breaks("check_more_load_shortens_the_life")
class _Tireless(Lasting):
    """It lasts as long under any load."""

    def rate(self, duty):
        return attrs.evolve(super().rate(duty), revolutions=1e9)


@breaks("check_more_load_shortens_the_life")
class _Endless(Lasting):
    """It lasts for ever."""

    def rate(self, duty):
        return attrs.evolve(super().rate(duty), revolutions=math.inf)


@breaks("check_fractions_of_the_damage_add_up")
class _Doubled(Lasting):
    """It counts the damage of each ring as a whole."""

    def rate(self, duty):
        life = super().rate(duty)
        return attrs.evolve(life, damage=2.0 * life.damage)


@breaks("check_fractions_of_the_damage_add_up")
class _OneRing(Lasting):
    """It forgets a ring."""

    def rate(self, duty):
        life = super().rate(duty)
        return attrs.evolve(life, damage=2.0 * life.damage[:1])


SOUND.append(Lasting())


# Formulas of the friction torque -------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Bearing(TorqueFormula):
    """One coefficient at the bore."""

    name = "sound-torque"
    equation = "M = mu F_r d/2"
    references = SOURCE

    coefficient: float = parameter(
        default=0.001, unit="1", doc="coefficient of friction", validator=positive
    )

    def terms(self, duty):
        return {"load": 0.5 * self.coefficient * duty.radial_load * duty.bore}


@breaks("check_has_an_equation_and_references")
class _UnsourcedTorque(Bearing):
    """A formula without a source."""

    references = ()


@breaks("check_torque_is_of_the_size_that_bearings_have")
class _InMillimetres(Bearing):
    """It takes the bore for millimetres."""

    def terms(self, duty):
        return {"load": 1e-3 * super().terms(duty)["load"]}


@breaks("check_every_term_resists")
class _Driving(Bearing):
    """Its oil drives fast bearings."""

    def terms(self, duty):
        return {**super().terms(duty), "oil": 1e-3 - 1e-4 * duty.speed}


@breaks("check_every_term_resists")
class _Changing(Bearing):
    """Slow bearings have another term."""

    def terms(self, duty):
        return super().terms(duty) if duty.speed > 10.0 else {"starting": 1.0}


@breaks("check_more_load_resists_no_less")
class _Floating(Bearing):
    """Heavy loads are carried without friction."""

    def terms(self, duty):
        return {"load": 1.0 / duty.radial_load}


@breaks("check_oil_without_density_is_refused_or_accepted")
class _Watery(Bearing):
    """It takes an oil of unknown density for water."""

    def terms(self, duty):
        return {**super().terms(duty), "oil": 1e-6 * duty.viscosity / (duty.density or 1000.0)}


SOUND.append(Bearing())


# Losses beside the rollers -------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Seal(LossModel):
    """One torque at all speeds."""

    name = "sound-loss"
    equation = "P = M w"
    references = SOURCE
    place = "inner land"

    torque: float = parameter(default=0.1, unit="N m", doc="torque of the seal", validator=positive)

    def power(self, duty):
        return self.torque * duty.speed


@breaks("check_power_is_finite_and_not_negative")
class _Motor(Seal):
    """It drives light bearings."""

    def power(self, duty):
        return super().power(duty) * (1.0 if duty.radial_load > 100.0 else -1.0)


@breaks("check_a_bearing_at_rest_loses_nothing")
class _Idling(Seal):
    """It takes 5 W more at rest, too."""

    def power(self, duty):
        return super().power(duty) + 5.0


@breaks("check_a_bearing_at_rest_loses_nothing")
class _Sticking(Seal):
    """Its power does not depend on the speed, but for none."""

    def power(self, duty):
        return 5.0 if duty.speed else 0.0


@breaks("check_power_is_of_the_size_that_bearings_have")
class _InNewtonMillimetres(Seal):
    """It takes N mm for N m."""

    def power(self, duty):
        return 1e3 * super().power(duty)


SOUND.append(Seal())


# Friction of ribs -----------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Rib(RibModel):
    """A smooth coefficient."""

    name = "sound-rib"
    equation = "F = mu Q tanh(V/V0)"
    references = SOURCE

    coefficient: float = parameter(default=0.05, unit="1", doc="coefficient", validator=positive)

    def friction(self, contact):
        return self.coefficient * contact.load * np.tanh(contact.sliding_speed / 0.01)


@breaks("check_a_rib_has_an_equation_and_references")
class _Unsourced(Rib):
    """Nobody says whose it is."""

    references = ()


@breaks("check_rib_friction_takes_power_and_is_odd_in_the_sliding_speed")
class _Driving(Rib):
    """It drives where it slides fast."""

    def friction(self, contact):
        return super().friction(contact) * (1.0 - contact.sliding_speed**2)


@breaks("check_rib_friction_takes_power_and_is_odd_in_the_sliding_speed")
class _OneWay(Rib):
    """It rubs one way alone."""

    def friction(self, contact):
        return np.abs(super().friction(contact))


@breaks("check_rib_friction_rises_with_the_load")
class _Floating(Rib):
    """It floats where it is loaded."""

    def friction(self, contact):
        return super().friction(contact) / contact.load**1.5


@breaks("check_rib_friction_has_no_jump_where_the_sliding_ends")
class _Coulomb(Rib):
    """It jumps where the sliding ends."""

    def friction(self, contact):
        return self.coefficient * contact.load * np.sign(contact.sliding_speed)


@breaks("check_rib_friction_is_less_than_the_load")
class _InPercent(Rib):
    """Its coefficient is in percent."""

    def friction(self, contact):
        return 100.0 * super().friction(contact)


SOUND.append(Rib())


# Packages that end the process ---------------------------------------------------------------------------------------

_PACKAGE = '''
import ctypes, os, sys, time
import attrs
from rollslip.hookspecs import hookimpl
from rollslip.models import FilmModel
{before}

@attrs.frozen
class Fatal(FilmModel):
    """A film that ends the process."""

    name = "{name}"
    equation = "h = c eta u R/w"
    references = ("Nobody N. On laws that are made to be tested. J. None 1, 2000.",)
    location = "minimum"

    def evaluate(self, slices):
        caller = sys._getframe()
        while caller is not None and not caller.f_code.co_name.startswith("check_"):
            caller = caller.f_back
        if caller is not None and caller.f_code.co_name in {where}:
            {fault}
        c = slices.conditions
        slices.film_thickness[...] = 4.9 * c.viscosity * slices.rolling_speed * c.radius / slices.load

@hookimpl
def film_models():
    return [Fatal]
'''
_IN = ("check_film_does_not_grow_with_the_load",)


def _package(name, fault="pass", where=_IN, before=""):
    return _PACKAGE.format(name=name, fault=fault, where=where, before=before)


#: name -> (what is wrong, check that is running, what the message must contain, source of the module)
FATAL = {
    "segfaults": (
        "it reads the address 0",
        "check_film_does_not_grow_with_the_load",
        "crashed with signal 11 (SIGSEGV) in check_film_does_not_grow_with_the_load",
        _package("segfaults", "ctypes.string_at(0)"),
    ),
    "hangs": (
        "a loop that does not end",
        "check_film_does_not_grow_with_the_load",
        "did not end within 5 s in check_film_does_not_grow_with_the_load",
        _package("hangs", "while True: time.sleep(0.01)"),
    ),
    "leaves": (
        "it calls sys.exit",
        "check_film_does_not_grow_with_the_load",
        "left the process with exit code 3 in check_film_does_not_grow_with_the_load",
        _package("leaves", "sys.exit(3)"),
    ),
    "vanishes": (
        "it ends the process with exit code 0",
        "check_film_does_not_grow_with_the_load",
        "left the process with exit code 0 in check_film_does_not_grow_with_the_load",
        _package("vanishes", "os._exit(0)"),
    ),
    "dies-early": (
        "it crashes while it is imported",
        "loading",
        "crashed with signal 6 (SIGABRT)",
        _package("dies-early", before="os.abort()"),
    ),
}


def install(folder, name, source):
    """Write a package that offers a film model, as pip would leave it."""
    module = "fatal_" + name.replace("-", "_")
    info = Path(folder, f"{module}-1.0.dist-info")
    info.mkdir(parents=True)
    (info / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\nRequires-Dist: rollslip\n"
    )
    (info / "entry_points.txt").write_text(f"[rollslip.film]\n{name} = {module}\n")
    Path(folder, f"{module}.py").write_text(source)
