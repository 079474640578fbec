"""The rules of engines: each task is computed once, and what it returns or raises comes back."""

from collections.abc import Sequence
from typing import Any

from rollslip.engine import Engine
from rollslip.errors import EngineError
from rollslip.testing.rules import Inapplicable, refuse_unless, rule


def _outcomes(engine: Engine, tasks: Sequence[tuple[Any, ...]]) -> list[Any]:
    """Return the result or the error of each task, which is a function and its arguments."""
    try:
        executor = engine.executor()
    except EngineError as error:
        raise Inapplicable(f"it cannot be started here: {error}") from error
    try:
        refuse_unless(
            engine.workers(executor) >= 1,
            f"it says that {engine.workers(executor)} tasks run at once",
        )
        outcomes: list[Any] = []
        for future in [executor.submit(*task) for task in tasks]:
            try:
                outcomes.append(future.result(timeout=120.0))
            except Exception as error:
                outcomes.append(error)
        return outcomes
    finally:
        engine.end(executor, at_once=False)


@rule(Engine)
def check_gives_back_what_its_tasks_return(engine: Engine) -> None:
    """Every task is computed once, and its result is that of the same task."""
    found = _outcomes(engine, [(divmod, n, 7) for n in range(20)])
    wanted = [divmod(n, 7) for n in range(20)]
    refuse_unless(
        found == wanted, f"of divmod(n, 7) it gives {found[:4]} ..., not {wanted[:4]} ..."
    )


@rule(Engine)
def check_hands_on_what_a_task_raises(engine: Engine) -> None:
    """The error of a task is raised by its future, and other tasks continue."""
    found = _outcomes(engine, [(int, "1"), (int, "one"), (int, "2")])
    refuse_unless(
        isinstance(found[1], ValueError)
        and not engine.killed(found[1])
        and (found[0], found[2]) == (1, 2),
        f"of a task that raises a ValueError between two that do not, it gives {found!r}",
    )
