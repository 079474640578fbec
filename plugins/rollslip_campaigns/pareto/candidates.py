"""Generate the family of numerical and modelling choices of a scene, whose errors are compared with their costs.

- A numerical choice computes the models of the scene more or less finely; its error is the difference from the
  reference solution of the same models, "finest". A modelling choice has another law or friction; it is compared with
  the exact model. The two are separate, because no resolution corrects what a law neglects.
- None of the films is exact. They are compared with the film of the scene under the same law, and have no front:
  against the exact law, a wrong film could compensate what another law neglects.
- The full product of all choices would be too large. The family varies one setting at a time around the plan, and
  crosses settings that interact: slices with roller positions, integrators with their tolerance.
- If a scene states its slices, they are part of the problem: the reference solution has as many, and only fewer are
  choices.
- The reference solution has an error, too. It is estimated by a solution with half its resolution (half the slices and
  positions, four times the tolerances): errors below this difference are unknown.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from operator import attrgetter
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution, reference_resolution
from rollslip.catalogue.discovery import get_class
from rollslip.catalogue.registry import get_model
from rollslip.errors import PluginError, SceneError, did_you_mean, nearest
from rollslip.planning.campaign import listed
from rollslip.planning.plan import Plan, plan
from rollslip.results.text import duration_range, format_count
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.structure import raise_problems
from rollslip.studies.study import AXES, Study
from rollslip.studies.timing import processor_time
from rollslip_campaigns.comparison.choices import choice_of, loadable
from rollslip_campaigns.pareto import ParetoSettings
from rollslip_campaigns.pareto.findings import PLANNED, REFERENCE

#: Kinds of choices.
_KINDS: Final = ("numerical", "modelling", "film", "reference")
#: Numbers of equal slices; odd, so that one slice is at the centre.
_SLICES: Final = (5, 11, 21, 41, 101, 201, 401)
#: Numbers of Gauss-Legendre points; fewer than slices, because they converge faster.
_GAUSS_POINTS: Final = (5, 11, 21, 41, 101)
#: Numbers of roller positions within one pitch.
_N_POSITIONS: Final = (1, 2, 4, 8, 16, 32, 64)
#: Tolerances of tables over that of the plan.
_TABLE_FACTORS: Final = (10.0, 3.0, 0.3)
#: Relative tolerances of a step.
_INTEGRATOR_TOLERANCES: Final = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
#: Numbers of slices that are combined with each of `_CROSSED_POSITIONS`.
_CROSSED_SLICES: Final = (5, 11, 21, 41)
#: Numbers of roller positions that are combined with each of `_CROSSED_SLICES`.
_CROSSED_POSITIONS: Final = (1, 2, 4)
#: Relative tolerances that are combined with each integrator.
_CROSSED_TOLERANCES: Final = (1e-3, 1e-5, 1e-7)
#: Upper limit of the tolerance of tables, above which a table is meaningless.
_MAX_TABLE_TOLERANCE: Final = 0.5
#: Tolerance of tables of the reference solution over that of the plan. The time for loads over the orbit is
#: proportional to its inverse: halving it doubles this time.
_REFERENCE_TABLES: Final = 0.1
#: Tolerances of the solution that estimates the error of the reference solution, over those of the latter; slices
#: and roller positions are halved. Four is two halvings, as of a method of second order.
_COARSENING: Final = 4.0
#: Fraction of the time of a study that is proportional to slices and roller positions. The estimate for references,
#: which have 80 to 600 times as many, is proportional to it. With 0.5 it is right to a factor of 2.3 for friction and
#: steady slip of NU 2316; with 1 that for the steady slip is 4.5 times too long.
_PROPORTIONAL_TIME: Final = 0.5
#: Processor time [s] of a turn at least: the clock of some systems has steps of 16 ms. Doubling it halves the error of
#: the clock, and doubles the time of short studies.
MIN_TURN: Final = 0.05

#: Label of the solution with half the resolution of the reference solution.
HALF = "half as fine"
#: Label of the reference solution of the exact model.
EXACT = "finest, exact model"


@attrs.frozen(eq=False, kw_only=True)
class Choice:
    """One way to compute the results of a study.

    Attributes
    ----------
    study : str
        Name of the study.
    label : str
        Differences from the plan: "11 slices, 2 positions".
    kind : {"numerical", "modelling", "film", "reference"}
        Kind of the difference; a reference is run once and not timed in rounds.
    scene : Scene
        The scene, with another film where that is the choice.
    resolution : Resolution
        All other settings.
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
        The plan of the scene.
    studies : mapping of str to Study
        Studies by name, without outputs that are not compared.
    choices : tuple of Choice
        All choices.
    rounds : int
        Number of times that each choice is timed.
    notes : tuple of str
        Sentences on limits of the family.
    """

    plan: Plan
    studies: Mapping[str, Study]
    choices: tuple[Choice, ...]
    rounds: int
    notes: tuple[str, ...]

    @property
    def cost_sentences(self) -> list[str]:
        """Sentences on scope and time, printed before the run. For the estimate of the time each study runs twice."""
        seconds = 0.0
        for name, study in self.studies.items():
            planned = self.choices_of(name, "numerical")[0]
            assembly = assemble(planned.scene, planned.resolution)
            once = processor_time(partial(study.run, assembly))
            size = planned.resolution.slices * (planned.resolution.n_positions or 1)
            for choice in self.choices_of(name, *_KINDS):
                ratio = choice.resolution.slices * (choice.resolution.n_positions or 1) / size
                turn = once * (1.0 - _PROPORTIONAL_TIME + _PROPORTIONAL_TIME * ratio)
                seconds += turn if choice.kind == "reference" else self.rounds * max(turn, MIN_TURN)
        return [
            *self.messages[1:],
            f"this takes {duration_range(seconds)} of the processor; --rounds, --study and --choices shorten it, "
            "and Ctrl-C ends it",
        ]

    @property
    def messages(self) -> list[str]:
        """Lines that describe the run: the number of choices of each study by kind, rounds and references."""
        from rollslip.cli.console import headline

        lines = [headline(self.plan)]
        for study in self.studies:
            counts = {kind: len(self.choices_of(study, kind)) for kind in _KINDS}
            reference = self.choices_of(study, "reference")[0].resolution
            n_positions = reference.n_positions or 1
            lines.append(
                f"{study}: {counts['numerical']} numerical and {counts['modelling']} modelling choices and "
                f"{counts['film']} films, {format_count(self.rounds, 'round')} each, against "
                f"{counts['reference']} references, the finest with {reference.slices} slices"
                + f" and {n_positions} roller positions"
                * (n_positions > 1)
            )
        return [*lines, *self.notes]

    def choices_of(self, study: str, *kinds: str) -> list[Choice]:
        """Return the choices of a study that are of one of some kinds.

        Parameters
        ----------
        study : str
            Name of the study.
        *kinds : str
            Kinds of choices.
        """
        return [choice for choice in self.choices if choice.study == study and choice.kind in kinds]


def plan_family(requested: "ParetoSettings") -> Family:
    """Return the family of choices for a scene, after a check of all names."""
    scene = requested.base_scene
    axes = tuple(listed(requested.choices))
    laws = tuple(listed(requested.traction))
    films = tuple(listed(requested.film))
    _check_settings(axes, requested.rounds)
    for law in laws:
        get_class("traction", law)
    base = plan(scene, requested.study)
    notes = list[str]()
    if not axes:
        notes.append(
            "NumPy in place of compiled code is not compared; --choices compiled does that"
        )
        axes = tuple(axis for axis in AXES if axis != "compiled")
    axes = tuple(dict.fromkeys((*axes, *["traction"] * bool(laws), *["film"] * bool(films))))
    scenes = _films(scene, films)
    choices: list[Choice] = []
    for name, study in base.studies.items():
        varied = [axis for axis in axes if axis in study.affected_by]
        choices += _choices_of_study(base, name, varied, laws, scenes)
    if all(choice.label in (PLANNED, REFERENCE, HALF, EXACT) for choice in choices):
        possible = [
            axis for axis in AXES if any(axis in s.affected_by for s in base.studies.values())
        ]
        raise SceneError(
            [
                f"there is nothing to choose: {', '.join(base.studies)} of this scene can differ in "
                f"{', '.join(possible)}, but not in {', '.join(axes)} as far as the scene leaves that open"
            ]
        )
    if (
        scene.accuracy.slices is not None
        and base.assembly.slices > 1
        and {"slices", "quadrature"} & {*axes}
    ):
        notes.append(
            f"the scene states {scene.accuracy.slices} slices, and so has the finest; with "
            "--set accuracy.slices=auto more of them, and those of Gauss and Legendre, take part"
        )
    return Family(
        plan=base,
        # other outputs are not compared, so that they are not computed
        studies={
            name: study.without_outputs(
                frozenset(study.outputs.keys() - set(study.controlled_outputs.values()))
            )
            for name, study in base.studies.items()
        },
        choices=tuple(choices),
        rounds=requested.rounds,
        notes=tuple(notes),
    )


def _check_settings(axes: Sequence[str], rounds: int) -> None:
    """Raise `SceneError` for unknown names of choices, and for less than one round."""
    problems = list[str]()
    for name in axes:
        if name not in AXES:
            hint = did_you_mean(nearest(name, AXES, cutoff=0.4), f"there are: {', '.join(AXES)}")
            problems.append(f"choices: nothing to choose is called {name!r}; {hint}")
    if rounds < 1:
        problems.append(f"rounds: must be at least 1, not {rounds}")
    raise_problems(problems)


# One study ------------------------------------------------------------------------------------------------------------


def _choices_of_study(
    base: Plan, study: str, axes: Sequence[str], laws: Sequence[str], films: Mapping[str, Scene]
) -> list[Choice]:
    """Return the references of a study, the choice of the plan, and its variations, each once."""
    scene = base.scene
    planned, reference = _resolutions(base, study)
    law = assemble(scene, reference_resolution(scene)).traction.full_film.name
    # the exact model: the equation that the law approximates, with friction of each slice
    exact = attrs.evolve(
        reference,
        traction=get_class("traction", law).solved_by or reference.traction,
        friction=reference.friction and "conventional",
    )
    # half the resolution of the reference solution; slices that a scene states are not in doubt
    half = attrs.evolve(
        reference,
        slices=scene.accuracy.slices or reference.slices // 2,
        n_positions=reference.n_positions and max(1, reference.n_positions // 2),
        table_tolerance=_COARSENING * reference.table_tolerance,
        integrator_tolerance=reference.integrator_tolerance
        and _COARSENING * reference.integrator_tolerance,
    )
    choice = partial(Choice, study=study, scene=scene)
    choices = [
        choice(label=label, kind="reference", resolution=resolution)
        for label, resolution in ((REFERENCE, reference), (HALF, half), (EXACT, exact))
        if label == REFERENCE or resolution != reference
    ]
    choices.append(choice(label=PLANNED, kind="numerical", resolution=planned))
    present = {planned}
    own_models = [(resolution.traction, resolution.friction) for resolution in (reference, planned)]
    for changes in (
        *_numerical_changes(base, study, planned, axes),
        *_modelling_changes(axes, laws, law),
    ):
        resolution = attrs.evolve(planned, **changes)
        if resolution not in present:
            present.add(resolution)
            is_own = (resolution.traction, resolution.friction) in own_models
            kind = "numerical" if is_own else "modelling"
            choices.append(
                choice(label=_label(planned, resolution), kind=kind, resolution=resolution)
            )
    if "film" in axes:
        choices += [
            Choice(
                study=study, label=f"film {name}", kind="film", scene=changed, resolution=planned
            )
            for name, changed in films.items()
        ]
    return choices


def _resolutions(base: Plan, study: str) -> tuple[Resolution, Resolution]:
    """Return the planned resolution of a study, and that of its reference solution."""
    planned = base.choices[study].resolution
    settings = base.studies[study]
    reference = reference_resolution(base.scene)
    if "table_tolerance" in settings.affected_by:
        tolerance = _REFERENCE_TABLES * planned.table_tolerance
        reference = attrs.evolve(
            reference, table_tolerance=max(reference.table_tolerance, tolerance)
        )
    if "n_positions" not in settings.affected_by:
        reference = attrs.evolve(reference, n_positions=planned.n_positions)
    if own := settings.numerical_settings(base.assembly):
        planned = attrs.evolve(
            planned,
            friction=planned.friction or own["friction"],
            integrator_tolerance=planned.integrator_tolerance or own["integrator_tolerance"],
        )
        reference = attrs.evolve(reference, friction=own["friction"])
    return planned, reference


def _numerical_changes(
    base: Plan, study: str, planned: Resolution, axes: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """Yield changes of the planned resolution: crossed settings first, then one setting at a time."""
    yield from _slice_changes(base, axes)
    integrators = _integrators(base, study) if "integrator" in axes else []
    values: dict[str, Sequence[Any]] = {
        "n_positions": _N_POSITIONS,
        "table_tolerance": [
            min(_MAX_TABLE_TOLERANCE, factor * planned.table_tolerance) for factor in _TABLE_FACTORS
        ],
        "integrator": integrators,
        "integrator_tolerance": _INTEGRATOR_TOLERANCES,
    }
    for axis, options in values.items():
        if axis in axes:
            yield from ({axis: value} for value in options)
    if "integrator_tolerance" in axes:
        for name, value in itertools.product(integrators, _CROSSED_TOLERANCES):
            yield {"integrator": name, "integrator_tolerance": value}
    if "compiled" in axes:
        yield {"compiled": False}


def _slice_changes(base: Plan, axes: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Yield changes of slices and quadrature, those crossed with roller positions first."""
    if base.assembly.slices <= 1:
        return
    stated = base.scene.accuracy.slices
    if "slices" in axes:
        slices = [n for n in _SLICES if stated is None or n < stated]
        if "n_positions" in axes:
            for n, m in itertools.product(_CROSSED_SLICES, _CROSSED_POSITIONS):
                if n in slices:
                    yield {"slices": n, "quadrature": "equal", "n_positions": m}
        yield from ({"slices": n, "quadrature": "equal"} for n in slices)
    if stated is None and "quadrature" in axes:
        yield from ({"slices": n, "quadrature": "gauss"} for n in _GAUSS_POINTS)


def _modelling_changes(
    axes: Sequence[str], laws: Sequence[str], law: str
) -> Iterator[dict[str, Any]]:
    """Yield other laws, by default all forms of the same equation and its solution, and both kinds of friction."""
    if "traction" in axes:
        solution = get_class("traction", law).solved_by or law
        forms = [name for name, cls in loadable("traction") if cls.solved_by == solution]
        for name in laws or (*forms, solution):
            yield {"traction": "named" if name == law else name}
    if "friction" in axes:
        yield from ({"friction": name} for name in ("conventional", "effective"))


def _integrators(base: Plan, study: str) -> list[str | None]:
    """Return the implicit integrators that are installed; None for that of the scene."""
    own = base.studies[study].numerical_settings(base.assembly).get("integrator")
    names = list[str | None]()
    for name, cls in loadable("integrator"):
        if own == name:
            names.append(None)
        elif not cls.explicit:
            with suppress(PluginError):  # its package is not installed
                get_model("integrator", name).solver()
                names.append(name)
    return names


def _films(scene: Scene, names: Sequence[str]) -> dict[str, Scene]:
    """Return the scene with each of some films, by label; by default with all films that declare `on_fronts`."""
    own = choice_of(scene, "film", None).label
    names = names or [name for name, cls in loadable("film") if name != own and cls.on_fronts]
    choices = [choice_of(scene, "film", name) for name in names]
    return {
        choice.label: evolve(scene, {"models.film": choice.table}, si=True) for choice in choices
    }


# Labels ---------------------------------------------------------------------------------------------------------------


def _label(planned: Resolution, resolution: Resolution) -> str:
    """Return the differences of a resolution from the planned one, as text."""
    r = resolution
    texts = {
        (
            "slices",
            "quadrature",
        ): f"{r.slices} {'Gauss points' if r.quadrature == 'gauss' else 'slices'}",
        ("n_positions",): format_count(r.n_positions or 0, "position"),
        ("table_tolerance",): f"tables to {r.table_tolerance:.0e}",
        ("integrator",): str(r.integrator),
        # None, where a study has no integrator, is the same in both
        ("integrator_tolerance",): f"steps to {r.integrator_tolerance or 0.0:.0e}",
        ("traction",): "the law" if r.traction == "named" else r.traction,
        ("friction",): f"{r.friction} friction",
        ("compiled",): "in NumPy",
    }
    return ", ".join(
        text
        for names, text in texts.items()
        if attrgetter(*names)(resolution) != attrgetter(*names)(planned)
    )
