"""Bind models into one compiled pass over slices: contact -> film -> traction, compiled and NumPy stages mixed."""

from collections.abc import Callable

from rollslip.discovery import in_words, origin
from rollslip.errors import DomainError, PluginError, RollslipError
from rollslip.models import FINITE, SliceModel, in_unit, interval
from rollslip_kernels import chain as compiled
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Slices


def stage(model: SliceModel) -> object:
    """Return the capsule of a model: its kernel, or a call of its ``evaluate``.

    Raises
    ------
    PluginError
        If the model's kernel does not keep the contract of ``rollslip.h``.
    """
    return _checked(model, _kernel(model))


def _checked(model: SliceModel, capsule: object | None) -> object:
    if capsule is None:
        return compiled.python_stage(_blaming(model), model.writes)
    if problem := compiled.problem(capsule):
        raise PluginError(f"model {model.name!r}: {_who(model)} {problem}; {origin(type(model))}")
    return capsule


def _kernel(model: SliceModel) -> object | None:
    try:
        return model.kernel()
    except RollslipError:  # of a child, who is named in it
        raise
    except Exception as error:
        raise PluginError(
            f"model {model.name!r}: {_who(model)} fails ({in_words(error)}); {origin(type(model))}"
        ) from error


def _who(model: SliceModel) -> str:
    return f"{type(model).__module__}.{type(model).__qualname__}.kernel()"


def _blaming(model: SliceModel) -> Callable[[Slices], None]:
    """Return ``evaluate`` of a model such that its errors, otherwise as they are, say whose they are."""

    def evaluate(slices: Slices) -> None:
        try:
            model.evaluate(slices)
        except BaseException as error:
            error.add_note(f"raised by evaluate() of model {model.name!r}; {origin(type(model))}")
            raise

    return evaluate


class Chain:
    """Models bound in order; calling it evaluates all of them on a table of slices, in place, without the GIL.

    Parameters
    ----------
    *models : SliceModel
        At most eight stages.
    block : int, optional
        Slices taken at a time; by default 256, or all at once if a stage runs in Python and pays per call.

    Raises
    ------
    PluginError
        If a kernel does not keep the contract, or returns a status that does not exist.
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

    def __init__(self, *models: SliceModel, block: int | None = None) -> None:
        self.models = models
        kernels = [_kernel(model) for model in models]
        if block is None and None in kernels:
            block = 0
        # what a model reads without a range of its own must at least be a number
        stages = [
            (_checked(m, kernel), dict.fromkeys(sorted(m.reads), FINITE) | dict(m.domain), m.writes)
            for m, kernel in zip(models, kernels, strict=True)
        ]
        self._chain = compiled.Chain(stages) if block is None else compiled.Chain(stages, block)
        #: slices evaluated so far, as far as calls did not overlap
        self.evaluated = 0

    @property
    def block(self) -> int:
        """Slices taken at a time; 0 is all."""
        return self._chain.block

    def __call__(self, slices: Slices) -> None:
        """Evaluate all models on ``slices``, in place."""
        refusal = self._chain.run(slices)
        self.evaluated += len(slices)
        if refusal is not None:
            raise self.error(refusal, slices)

    @property
    def kernel(self) -> compiled.Chain:
        """The chain itself, for compiled code that runs it."""
        return self._chain

    @property
    def resists(self) -> bool:
        """Whether a stage fills the rolling resistance."""
        return any("resistance" in model.writes for model in self.models)

    def error(self, refusal: "compiled.Refusal", slices: Slices) -> RollslipError:
        """Return the error that says in words what the compiled chain refused of ``slices``."""
        what, k, member, index = refusal
        model = self.models[k]
        if what == "status" and index < 0:
            return PluginError(
                f"the kernel of {model.name!r} returned a status that rollslip.h does not define; {origin(type(model))}"
            )
        return DomainError(_refusal_text(model, what, member, index, slices))


def _refusal_text(model: SliceModel, what: str, member: str, index: int, slices: Slices) -> str:
    if what == "status":
        return f"{model.name}: slice {index} is outside its domain"
    if what == "output":
        return f"{model.name}: slice {index} gives a {member} that is not finite; its inputs are too large or too small"
    allowed = interval(model.domain.get(member, FINITE))
    if member in CONDITIONS:
        value = getattr(slices.conditions, member)
        if value != value:
            return f"{model.name}: needs {member} ({CONDITIONS[member][1]}), which the lubricant or scene does not give"
        return f"{model.name}: {member} = {in_unit(value, member)} is outside its domain ({allowed})"
    value = float(getattr(slices, member)[index])
    if value != value:
        unit, meaning = COLUMNS[member]
        return (
            f"{model.name}: slice {index} has no {member} ({meaning}, {unit}); "
            "give it, or put a stage that fills it before this one"
        )
    return f"{model.name}: {member} = {in_unit(value, member)} at slice {index} is outside its domain ({allowed})"
