"""The exceptions of rollslip, and helpers for their messages."""

from collections.abc import Iterable


class RollslipError(Exception):
    """Base of all errors of this package."""


class SceneError(RollslipError):
    """A scene cannot be used as it is written; ``problems`` lists every fault, one sentence each."""

    def __init__(self, problems: list[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = problems

    def __reduce__(self) -> tuple[type["SceneError"], tuple[list[str]]]:
        return type(self), (self.problems,)


class DomainError(RollslipError, ArithmeticError):
    """A law was evaluated outside the range in which it is defined."""


class PluginError(RollslipError):
    """A plugin is missing, broken or does not keep the contract; the message names it and the remedy."""


class UnknownNameError(PluginError):
    """Nothing that is installed has this name: a wrong name, and not a fault of a plugin."""


class ConvergenceError(RollslipError):
    """An iteration did not reach its tolerance; the message states the residual."""


class OutputError(RollslipError):
    """A result cannot be written or read at the requested location."""


class BusyError(OutputError):
    """Another run computes the contents of a folder."""


class EngineError(RollslipError):
    """An engine cannot compute points: it cannot be started or reached, or its workers lack packages or models."""


class RollslipDeprecationWarning(DeprecationWarning):
    """A public name will be removed, after one minor version at least; the message names its replacement."""


def describe_error(error: BaseException) -> str:
    """Return type and message of an error on one line."""
    return " ".join(f"{type(error).__name__}: {error}".split()).removesuffix(":")


def describe_failure(error: BaseException) -> str:
    """Return the message of an error, on one line with its type if it is not one of rollslip."""
    return str(error) if isinstance(error, RollslipError) else describe_error(error)


def wants_memory(error: BaseException) -> bool:
    """Return whether an error means that memory is too short, by its type or by a text of system or libraries."""
    texts = ("failed to map segment", "annot allocate memory", "can't start new thread")
    return isinstance(error, MemoryError) or any(text in str(error) for text in texts)


def nearest(word: str, known: Iterable[str], count: int = 3, cutoff: float = 0.6) -> list[str]:
    """Return the known names most similar to `word`, in descending order of similarity."""
    import difflib  # only wrong input needs it

    return difflib.get_close_matches(word, sorted(known), n=count, cutoff=cutoff)


def did_you_mean(near: Iterable[str], otherwise: str) -> str:
    """Return the question whether one of some names was meant; another hint where there are none."""
    names = " or ".join(map(repr, near))
    return f"did you mean {names}?" if names else otherwise
