"""Bind models into one compiled pass over slices: contact -> film -> traction, with compiled and NumPy stages.

- A large table is divided between blocks, and threads evaluate its parts in order
  (`rollslip.engine.run_in_threads`), each without the GIL. Stages are pure functions and a block is the same in any
  part, so that the number of threads does not change a bit of the result. All parts before one that is refused are
  evaluated, so that it does not change the refusal either.
- A chain with a stage in Python runs in one thread: the GIL would block the others, and models need not be re-entrant.
"""

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rollslip.catalogue.discovery import origin
from rollslip.engine import is_helper_thread, run_in_threads, threads
from rollslip.errors import DomainError, PluginError, RollslipError, describe_error
from rollslip.models import SliceModel
from rollslip.models.domains import FINITE, refusal_text
from rollslip_kernels import chain as kernels
from rollslip_kernels.slices import PLACES, Slices

Array = NDArray[np.float64]

#: Slices that a thread takes at a time: some 0.1 ms of work, as long as it takes to wake a thread. Halving it wastes
#: time on waking, doubling it leaves threads idle at the end. Chosen.
_PART: Final = 4096
#: Number of slices from which a table is evaluated in threads. Doubling it leaves tables of medium size to one thread.
#: Chosen: with five parts two threads gain more than waking them costs.
_LARGE: Final = 5 * _PART


def stage(model: SliceModel) -> object:
    """Return the capsule of a model: its kernel, or a call of its ``evaluate``."""
    return _checked(model, _kernel(model))


def _checked(model: SliceModel, capsule: object | None) -> object:
    if capsule is None:
        return kernels.python_stage(_blaming(model), model.writes)
    if problem := kernels.problem(capsule, not {*PLACES}.isdisjoint(model.reads)):
        raise PluginError(f"model {model.name!r}: {_who(model)} {problem}; {origin(type(model))}")
    return capsule


def _kernel(model: SliceModel) -> object | None:
    try:
        return model.kernel()
    except RollslipError:  # of a submodel, which its message names
        raise
    except Exception as error:
        raise PluginError(
            f"model {model.name!r}: {_who(model)} fails ({describe_error(error)}); {origin(type(model))}"
        ) from error


def _runs_python(model: Any) -> bool:
    """Whether a model, or a model among its parameters, has no kernel."""
    if isinstance(model, tuple | list):
        return any(map(_runs_python, model))
    if not hasattr(model, "kernel"):
        return False
    parameters = [getattr(model, a.name) for a in getattr(type(model), "__attrs_attrs__", ())]
    return model.kernel() is None or _runs_python(parameters)


def _who(model: SliceModel) -> str:
    """Return the qualified name of the method ``kernel`` of a model, for messages."""
    return f"{type(model).__module__}.{type(model).__qualname__}.kernel()"


def _blaming(model: SliceModel) -> Callable[[Slices], None]:
    """Return ``evaluate`` of a model, with a note on its errors that names the model."""

    def evaluate(slices: Slices) -> None:
        try:
            model.evaluate(slices)
        except BaseException as error:
            error.add_note(f"raised by evaluate() of model {model.name!r}; {origin(type(model))}")
            raise

    return evaluate


class Chain:
    """Models bound in order; a call evaluates all of them on a table of slices, in place.

    Compiled stages run without the GIL if the table has 4096 slices or more.

    Parameters
    ----------
    *models : SliceModel
        At most eight stages.
    block : int, optional
        Slices taken at a time; by default 256, or all at once if a stage runs in Python, which costs time per call.
    threads : int, optional
        Threads that may share a large table; by default the number in ROLLSLIP_THREADS, or that of the processors which
        the process may use, and 1 where a model runs in Python. The results are the same to the last bit.
    compiled : bool
        Whether stages run compiled where they can, else all in NumPy.
    bounds : sequence of callables
        Called with the slices after each evaluation; they raise where an effect that the plan left out is needed.

    Raises
    ------
    PluginError
        If a kernel does not keep the contract, or returns a status that does not exist.
    ValueError
        If there are more than eight stages, or less than one thread.
    DomainError
        When called: if a value is outside a model's domain or a result is not finite.

    Examples
    --------
    >>> from rollslip import Chain, Conditions, Slices, get_model
    >>> slices = Slices(3, Conditions(radius=0.006875, modulus=2.2857e11), load=[1e4, 2e4, 4e4])
    >>> Chain(get_model("contact", "palmgren"))(slices)
    >>> (slices.half_width * 1e6).round(2)
    array([27.68, 39.14, 55.35])
    """

    def __init__(
        self,
        *models: SliceModel,
        block: int | None = None,
        threads: int | None = None,
        compiled: bool = True,
        bounds: Sequence[Callable[[Slices], None]] = (),
    ) -> None:
        self.models = models
        self.bounds = tuple(bounds)
        self._compiled = compiled
        capsules = [_kernel(model) if compiled else None for model in models]
        if block is None and None in capsules:
            block = 0
        if threads is not None and threads < 1:
            raise ValueError(f"a chain runs in at least one thread, not in {threads}")
        if threads is None and (not compiled or any(map(_runs_python, models))):
            threads = 1
        self._threads = threads
        # a member that a model reads without a range of its own must be finite
        stages = [
            (
                _checked(m, capsule),
                dict.fromkeys(sorted(m.reads), FINITE) | dict(m.domain),
                m.writes,
            )
            for m, capsule in zip(models, capsules, strict=True)
        ]
        self._chain = kernels.Chain(stages) if block is None else kernels.Chain(stages, block)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the models and options, of which the chain is bound again."""
        return partial(
            Chain,
            block=self.block,
            threads=self._threads,
            compiled=self._compiled,
            bounds=self.bounds,
        ), self.models

    @property
    def block(self) -> int:
        """Slices taken at a time; 0 for all."""
        return self._chain.block

    @property
    def evaluated(self) -> int:
        """Slices evaluated so far."""
        return self._chain.evaluated

    @property
    def is_single_threaded(self) -> bool:
        """Whether only one thread at a time may evaluate the chain, as where a model runs in Python."""
        return self._threads == 1

    @cached_property
    def placed(self) -> bool:
        """Whether a model reads the positions of slices (`PLACES`)."""
        return any(not model.reads.isdisjoint(PLACES) for model in self.models)

    def __call__(self, slices: Slices) -> None:
        """Evaluate all models on ``slices``, in place."""
        refusal = self._chain.run(slices) if len(slices) < _LARGE else self._run_large(slices)
        if refusal is not None:
            raise self.error(refusal, slices)
        for bound in self.bounds:
            bound(slices)

    def bind(self, slices: Slices) -> "kernels.Bound | Guarded":
        """Return a function that evaluates ``slices`` with their values at the time of the call.

        For a small table it is faster than the chain. It keeps references to chain and table, raises what the chain
        raises, and is an argument of `along`.

        Examples
        --------
        >>> from rollslip import Chain, Conditions, Slices, get_model
        >>> slices = Slices(1, Conditions(radius=0.006875, modulus=2.2857e11), load=1e4)
        >>> evaluate = Chain(get_model("contact", "palmgren")).bind(slices)
        >>> for load in (1e4, 4e4):
        ...     slices.load[:] = load
        ...     evaluate()
        ...     print((slices.half_width * 1e6).round(2))
        [27.68]
        [55.35]
        """
        if len(slices) < _LARGE and not self.bounds:
            return self._chain.bind(slices, self.error)
        return Guarded(self, slices)

    def _run_large(self, slices: Slices) -> "kernels.Refusal | None":
        """Evaluate a table in this and other threads; return the refusal of the first part that has one."""
        count = 1 if not self.block or is_helper_thread() else self._threads or threads()
        if count == 1:
            return self._chain.run(slices)
        if self.placed:
            slices.places()  # allocated before threads read them
        return run_in_threads(
            partial(self._chain.run, slices),
            len(slices),
            -(-_PART // self.block) * self.block,
            count,
        )

    @property
    def kernel(self) -> kernels.Chain:
        """The compiled chain, for compiled code that runs it."""
        return self._chain

    @cached_property
    def resists(self) -> bool:
        """Whether a stage computes the rolling resistance."""
        return any("resistance" in model.writes for model in self.models)

    def error(self, refusal: "kernels.Refusal", slices: Slices) -> RollslipError:
        """Return the error for a refusal of the compiled chain: which value of which slice, and why."""
        what, k, member, index = refusal
        model = self.models[k]
        if what == "status" and index < 0:
            return PluginError(
                f"the kernel of {model.name!r} returned a status that rollslip.h does not define; {origin(type(model))}"
            )
        text = refusal_text(model.name, model.domain, what, member, index, slices)
        reason = _reason(model, slices, index) if what == "status" else ""
        return DomainError(f"{text}: {reason}" if reason else text)


def _reason(model: SliceModel, slices: Slices, index: int) -> str:
    """Return what the NumPy form of a model says about a slice that its kernel refuses; empty if it says nothing."""
    try:
        model.evaluate(slices.taken(slice(index, index + 1)))
    except DomainError as error:
        detail = str(error).rpartition("outside its domain: ")[2]
        return (
            "" if detail.endswith("outside its domain") else detail.removeprefix(f"{model.name}: ")
        )
    except Exception:  # the refusal of the kernel is reported, not that it has no other form
        return ""
    return ""


class Guarded:
    """A table bound to a chain that evaluates it in threads, or checks bounds: a result of `Chain.bind`."""

    def __init__(self, chain: Chain, slices: Slices) -> None:
        self._chain = chain
        self.slices = slices

    def __call__(self) -> None:
        """Evaluate the table."""
        self._chain(self.slices)


#: A bound table, rolling and sliding speeds (n, k), the roller of each slice and its weight, (N,).
Job: TypeAlias = "tuple[kernels.Bound | Guarded, Array, Array, NDArray[np.intp], Array]"


def along(jobs: Sequence[Job]) -> list[tuple[Array, Array]]:
    """Evaluate bound tables at one row of speeds after the other, the small tables in one call without the GIL.

    Speeds are those of k rollers, or of all slices if k is 1. The results of each table are the sums of friction times
    weight, and the smallest films [m], of every row of speeds, (n,) each.
    """
    small = [
        (bound, u, V, owner, weight)
        for bound, u, V, owner, weight in jobs
        if isinstance(bound, kernels.Bound)
    ]
    sums = iter(kernels.along(small))
    return [
        next(sums) if isinstance(bound, kernels.Bound) else _along(bound, u, V, owner, weight)
        for bound, u, V, owner, weight in jobs
    ]


def _along(
    bound: Guarded, rolling: Array, sliding: Array, owner: "NDArray[np.intp]", weight: Array
) -> tuple[Array, Array]:
    slices = bound.slices
    column = owner if rolling.shape[1] > 1 else np.zeros_like(owner)
    sums, films = np.empty((2, len(rolling)))
    for k, (u, V) in enumerate(zip(rolling, sliding, strict=True)):
        slices.rolling_speed[:] = u[column]
        slices.sliding_speed[:] = V[column]
        bound()
        sums[k] = kernels.weighted(slices.friction, weight)
        films[k] = slices.film_thickness.min(initial=np.inf)
    return sums, films
