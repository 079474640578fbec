"""The family of numerical and modelling choices for one scene, whose cost is held against their error.

- A numerical choice computes the scene's own models more or less finely; its error is against the finest of the same
  models. A modelling choice puts another law or friction in; it differs from the exact model. The two never mix: what a
  law leaves out, no slices bring back.
- Of films none is exact. They differ from the scene's own film with the same law, and have no front: against the exact
  law a wrong film could make good for what another law leaves out.
- The full product of all choices would not end. The family varies one thing at a time around the plan's choice, and
  crosses what acts together: slices with instants, integrators with their tolerance.
- Where a scene states its slices, they are part of what is asked for: the finest has them too, and only fewer are
  choices.
- The finest is not exact either. One half as fine tells how far: nothing is known of errors below that.
"""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import attrs

from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution, reference_resolution
from rollslip.catalogue.discovery import get_class
from rollslip.catalogue.registry import get_model
from rollslip.errors import PluginError, SceneError, nearest
from rollslip.planning.campaign import listed
from rollslip.planning.plan import Plan, plan
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.studies.study import AXES, Study
from rollslip_campaigns.comparison.choices import choice_of, loadable

if TYPE_CHECKING:
    from rollslip_campaigns.pareto import ParetoSettings

#: One at a time.
_SLICES: Final = (5, 11, 21, 41, 101, 201, 401)
_GAUSS: Final = (5, 11, 21, 41, 101)
_INSTANTS: Final = (1, 2, 4, 8, 16, 32, 64)
_TABLES: Final = (10.0, 3.0, 0.3)  # times the plan's
_STEPS: Final = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
#: Crossed.
_CORE: Final = ((5, 11, 21, 41), (1, 2, 4))
_CORE_STEPS: Final = (1e-3, 1e-5, 1e-7)
#: Tables of the finest, over the plan's: loads over the orbit take time with the inverse of their error, and end.
_FINEST_TABLES: Final = 0.1
#: By how much coarser the tolerances are of what tells how exact the finest is; slices and instants are halved.
_COARSER: Final = 4.0

#: Labels that are no deviation from the plan.
PLANNED = "as planned"
FINEST = "finest"
HALF = "half as fine"
EXACT = "finest, exact model"


@attrs.frozen(eq=False, kw_only=True)
class Choice:
    """One way to compute the results of a study.

    Attributes
    ----------
    study : str
        Its study.
    label : str
        Where it departs from the plan: "11 slices, 2 instants".
    kind : {"numerical", "modelling", "film", "reference"}
        What it is; a reference is not timed again and again.
    scene : Scene
        The scene, with another film in it where that is the choice.
    resolution : Resolution
        All else.
    """

    study: str
    label: str
    kind: str
    scene: Scene
    resolution: Resolution


@attrs.frozen(eq=False, kw_only=True)
class Family:
    """All choices of a scene, those of a study one after the other and its references first.

    Attributes
    ----------
    plan : Plan
        The scene's own.
    studies : mapping of str to Study
        What is run, without what nobody compares.
    choices : tuple of Choice
        All of them.
    rounds : int
        How often each is timed.
    notes : tuple of str
        What limits the family, in words.
    """

    plan: Plan
    studies: Mapping[str, Study]
    choices: tuple[Choice, ...]
    rounds: int
    notes: tuple[str, ...]

    @property
    def messages(self) -> list[str]:
        """What will be run: the number of choices of each study by kind, rounds and references."""
        from rollslip.cli.console import headline

        lines = [headline(self.plan)]
        for study in self.studies:
            of = {
                kind: len(self.of(study, kind))
                for kind in ("numerical", "modelling", "film", "reference")
            }
            reference_resolution = self.of(study, "reference")[0].resolution
            n_positions = (
                f" and {reference_resolution.n_positions} roller positions"
                if (reference_resolution.n_positions or 1) > 1
                else ""
            )
            lines.append(
                f"{study}: {of['numerical']} numerical and {of['modelling']} modelling choices and {of['film']} films, "
                f"{self.rounds} round{'s' * (self.rounds != 1)} each, against {of['reference']} references, the finest "
                f"with {reference_resolution.slices} slices{n_positions}"
            )
        return [*lines, *self.notes]

    def of(self, study: str, *kinds: str) -> list[Choice]:
        """Return the choices of a study that are of some kinds."""
        return [one for one in self.choices if one.study == study and one.kind in kinds]


def plan_family(requested: "ParetoSettings") -> Family:
    """Return the family of choices for a scene."""
    scene = requested.base_scene
    rounds = requested.rounds
    wanted, laws, films = (
        tuple(listed(names)) for names in (requested.choices, requested.traction, requested.film)
    )
    problems = list[str]()
    for name in wanted:
        if name not in AXES:
            near = nearest(name, AXES, cutoff=0.4)
            hint = (
                f"did you mean {' or '.join(map(repr, near))}?"
                if near
                else f"there are: {', '.join(AXES)}"
            )
            problems.append(f"choices: nothing to choose is called {name!r}; {hint}")
    if rounds < 1:
        problems.append(f"rounds: must be at least 1, not {rounds}")
    if problems:
        raise SceneError(problems)
    for law in laws:
        get_class("traction", law)
    made = plan(scene, requested.study)
    named = [axis for axis, names in (("traction", laws), ("film", films)) if names]
    wanted = tuple(dict.fromkeys((*wanted, *named))) if wanted else tuple(AXES)
    varied = _films(scene, films)
    found: list[Choice] = []
    for name, one in made.studies.items():
        found += _of_study(made, name, [axis for axis in wanted if axis in one.affected_by], laws, varied)
    if not any(one.label not in (PLANNED, FINEST, HALF, EXACT) for one in found):
        can = [axis for axis in AXES if any(axis in one.affected_by for one in made.studies.values())]
        raise SceneError(
            [
                f"there is nothing to choose: {', '.join(made.studies)} of this scene can differ in {', '.join(can)}, "
                f"but not in {', '.join(wanted)} as far as the scene leaves that open"
            ]
        )
    notes = []
    if (
        scene.accuracy.slices is not None
        and made.assembly.slices > 1
        and {"slices", "quadrature"} & {*wanted}
    ):
        notes.append(
            f"the scene states {scene.accuracy.slices} slices, and so has the finest; with "
            "--set accuracy.slices=auto more of them, and those of Gauss and Legendre, take part"
        )
    return Family(
        plan=made,
        # without what is no result here, so that it costs nothing
        studies={
            name: one.without_outputs(frozenset(one.outputs.keys() - set(one.controlled_outputs.values())))
            for name, one in made.studies.items()
        },
        choices=tuple(found),
        rounds=rounds,
        notes=tuple(notes),
    )


# One study ------------------------------------------------------------------------------------------------------------


def _of_study(
    made: Plan, study: str, axes: Sequence[str], laws: Sequence[str], films: Mapping[str, Scene]
) -> list[Choice]:
    """References of a study, the plan's choice, and what departs from it, each once."""
    scene = made.scene
    base = made.choices[study].resolution
    settings = made.studies[study]
    best = reference_resolution(scene)
    law = assemble(scene, best).traction.full_film.name
    if "table_tolerance" in settings.affected_by:
        best = attrs.evolve(
            best, table_tolerance=max(best.table_tolerance, _FINEST_TABLES * base.table_tolerance)
        )
    if "n_positions" not in settings.affected_by:
        best = attrs.evolve(best, n_positions=base.n_positions)
    if own := settings.numerical_settings(made.assembly):
        base = attrs.evolve(
            base,
            friction=base.friction or own["friction"],
            integrator_tolerance=base.integrator_tolerance or own["integrator_tolerance"],
        )
        best = attrs.evolve(best, friction=own["friction"])
    # the exact model: the equation solved that the law is a form of, friction of every slice
    traction = get_class("traction", law).solved_by or best.traction
    exact = attrs.evolve(best, traction=traction, friction=best.friction and "conventional")
    choice = partial(Choice, study=study, scene=scene)
    found = [
        choice(label=label, kind="reference", resolution=resolution)
        for label, resolution in ((FINEST, best), (HALF, _coarser(scene, best)), (EXACT, exact))
        if label == FINEST or resolution != best
    ]
    found.append(choice(label=PLANNED, kind="numerical", resolution=base))
    seen = {base}
    own_models = [(one.traction, one.friction) for one in (best, base)]
    for changes in (*_numerical(made, study, base, axes), *_modelling(axes, laws, law)):
        resolution = attrs.evolve(base, **changes)
        if resolution not in seen:
            seen.add(resolution)
            kind = (
                "numerical"
                if (resolution.traction, resolution.friction) in own_models
                else "modelling"
            )
            found.append(choice(label=_label(base, resolution), kind=kind, resolution=resolution))
    if "film" in axes:
        found += [
            Choice(study=study, label=f"film {name}", kind="film", scene=changed, resolution=base)
            for name, changed in films.items()
        ]
    return found


def _coarser(scene: Scene, best: Resolution) -> Resolution:
    """Return one half as fine; slices that a scene states are what it asks for, and so are not in doubt."""
    step = best.integrator_tolerance
    return attrs.evolve(
        best,
        slices=scene.accuracy.slices or best.slices // 2,
        n_positions=best.n_positions and max(1, best.n_positions // 2),
        table_tolerance=_COARSER * best.table_tolerance,
        integrator_tolerance=step and _COARSER * step,
    )


def _numerical(
    made: Plan, study: str, base: Resolution, axes: Sequence[str]
) -> Iterable[dict[str, Any]]:
    """What departs from the plan in numbers: the crossed core first, then one thing at a time."""
    stated = made.scene.accuracy.slices
    sliced = made.assembly.slices > 1
    slices = (
        [n for n in _SLICES if stated is None or n < stated] if sliced and "slices" in axes else []
    )
    if slices and "n_positions" in axes:
        for n in _CORE[0]:
            for m in _CORE[1]:
                if n in slices:
                    yield {"slices": n, "quadrature": "equal", "n_positions": m}
    yield from ({"slices": n, "quadrature": "equal"} for n in slices)
    if sliced and stated is None and "quadrature" in axes:
        yield from ({"slices": n, "quadrature": "gauss"} for n in _GAUSS)
    if "n_positions" in axes:
        yield from ({"n_positions": m} for m in _INSTANTS)
    if "table_tolerance" in axes:
        yield from (
            {"table_tolerance": min(0.5, factor * base.table_tolerance)} for factor in _TABLES
        )
    integrators = _integrators(made, study) if "integrator" in axes else []
    yield from ({"integrator": name} for name in integrators)
    if "integrator_tolerance" in axes:
        yield from ({"integrator_tolerance": tolerance} for tolerance in _STEPS)
        for name in integrators:
            yield from (
                {"integrator": name, "integrator_tolerance": tolerance} for tolerance in _CORE_STEPS
            )
    if "compiled" in axes:
        yield {"compiled": False}


def _modelling(axes: Sequence[str], laws: Sequence[str], law: str) -> Iterable[dict[str, Any]]:
    """Other laws, by default all forms of the same equation and what solves it, and the other friction of dynamics."""
    if "traction" in axes:
        solves = get_class("traction", law).solved_by or law
        forms = [name for name, cls in loadable("traction") if cls.solved_by == solves]
        for name in laws or (*forms, solves):
            yield {"traction": "named" if name == law else name}
    if "friction" in axes:
        yield from ({"friction": name} for name in ("conventional", "effective"))


def _integrators(made: Plan, study: str) -> list[str | None]:
    """Implicit integrators that are there, with the packages that they need; None for the scene's own."""
    own = made.studies[study].numerical_settings(made.assembly).get("integrator")
    found = list[str | None]()
    for name, cls in loadable("integrator"):
        if own == name:
            found.append(None)
        elif not cls.explicit:
            with suppress(PluginError):  # one that lacks its package is no choice
                get_model("integrator", name).solver()
                found.append(name)
    return found


def _films(scene: Scene, names: Sequence[str]) -> dict[str, Scene]:
    """Return the scene with each of some films in it, by their labels; by default those that say they are to be."""
    own = choice_of(scene, "film", None).label
    names = names or [name for name, cls in loadable("film") if name != own and cls.on_fronts]
    choices = [choice_of(scene, "film", name) for name in names]
    return {one.label: evolve(scene, {"models.film": one.table}) for one in choices}


# Words ----------------------------------------------------------------------------------------------------------------


def _label(base: Resolution, resolution: Resolution) -> str:
    """Say in what a resolution departs from the plan's."""
    said = []
    if (resolution.slices, resolution.quadrature) != (base.slices, base.quadrature):
        said.append(
            f"{resolution.slices} {'Gauss points' if resolution.quadrature == 'gauss' else 'slices'}"
        )
    if resolution.n_positions != base.n_positions:
        said.append(f"{resolution.n_positions} instant{'s' * (resolution.n_positions != 1)}")
    if resolution.table_tolerance != base.table_tolerance:
        said.append(f"tables to {resolution.table_tolerance:.0e}")
    if resolution.integrator != base.integrator:
        said.append(str(resolution.integrator))
    if resolution.integrator_tolerance != base.integrator_tolerance:
        said.append(f"steps to {resolution.integrator_tolerance:.0e}")
    if resolution.traction != base.traction:
        said.append("the law" if resolution.traction == "named" else resolution.traction)
    if resolution.friction != base.friction:
        said.append(f"{resolution.friction} friction")
    if not resolution.compiled and base.compiled:
        said.append("in NumPy")
    return ", ".join(said)
