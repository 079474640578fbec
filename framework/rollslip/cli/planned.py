"""What a campaign will run, and how far it has come, as it reads on a terminal."""

import importlib.metadata
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rollslip.cli.console import headline_of
from rollslip.planning.plan import duration, duration_range
from rollslip.scene.values import scene_hash

if TYPE_CHECKING:
    from rollslip_campaigns.comparison.comparison import Comparison
    from rollslip_campaigns.pareto.candidates import Family
    from rollslip_campaigns.sweep.definition import Sweep
    from rollslip_campaigns.sweep.folder import Status
    from rollslip_campaigns.sweep.run import Progress


def comparison_headline(comparison: "Comparison") -> str:
    """Return the first line of a comparison, with the models of all combinations."""
    chosen = [one.choices for one in comparison.combinations.values()]
    models = dict.fromkeys((kind, c[kind].name, c[kind].full) for kind in chosen[0] for c in chosen)
    return headline_of(comparison.scene, models)


def print_comparison_plan(comparison: "Comparison") -> None:
    """Print what a comparison will run, with its size and cost as far as they can be told."""
    plans = comparison.plans.values()
    click.echo(
        f"{comparison.study} of {len(comparison.combinations)} combinations: {', '.join(comparison.combinations)}"
    )
    if comparison.exchanged:
        click.echo(comparison.exchanged)
    slices = sum(plan.evaluations for plan in plans)
    click.echo(f"about {slices} slices to evaluate, {duration_range(comparison.seconds)}")


def print_family(family: "Family") -> None:
    """Print what will be run: the number of choices of each study by kind, rounds and references."""
    for study in family.studies:
        of = {kind: len(family.of(study, kind)) for kind in ("numerical", "modelling", "film", "reference")}
        finest = family.of(study, "reference")[0].resolution
        instants = f" and {finest.instants} instants" if (finest.instants or 1) > 1 else ""
        click.echo(
            f"{study}: {of['numerical']} numerical and {of['modelling']} modelling choices and {of['film']} films, "
            f"{family.rounds} round{'s' * (family.rounds != 1)} each, against {of['reference']} references, the finest "
            f"with {finest.slices} slices{instants}"
        )
    for note in family.notes:
        click.echo(note)


# Sweeps ---------------------------------------------------------------------------------------------------------------


def sweep_headline(sweep: "Sweep") -> str:
    """Return the first line of a run: version, scene and hash, study and packages."""
    packages = ", ".join(f"{name} {version}" for name, version in sweep.facts["packages"].items())
    version = importlib.metadata.version("rollslip")
    scene = f"{sweep.given.source} {scene_hash(sweep.scene)[:12]}"
    return f"rollslip {version} | {scene} | sweep of {sweep.study} | {packages}"


def sweep_planned(sweep: "Sweep") -> list[str]:
    """Say what is swept, before anything runs."""
    from rollslip.scene.distributions import shown

    lines = []
    for axis in sweep.design.axes:
        count, ends = len(axis.values), [axis.shown(value) for value in axis.values]
        values = ", ".join(ends) if count <= 5 else f"{ends[0]}, {ends[1]} ... {ends[-1]}"
        lines.append(f"{axis.key}: {count} value{'s' * (count != 1)}, {values}")
        if axis.key == "models.traction" and "hydrodynamic" in dict(sweep.scene.models.traction.parameters):
            whole = sweep.scene.models.traction.name
            lines.append(
                f"  in place of the whole {whole}; to change the law in it, sweep models.traction.hydrodynamic"
            )
    for of in sweep.design.sampled:
        lines.append(f"{of.key}: {shown(sweep.uncertainty.distributions[of.key], of.unit or '1')}")
    if sweep.design.has_samples:
        n = len(sweep.design.samples)
        balance = (
            "; a Sobol sequence is balanced at powers of two"
            if sweep.table.sampling.endswith("sobol") and n & (n - 1)
            else ""
        )
        lines.append(f"{n} samples, {sweep.table.sampling}, seed {sweep.table.seed}{balance}")
    elif sweep.given.uncertainty:
        lines.append("the table [uncertainty] of the scene is not used: no samples are asked for; --samples N does")
    for name, resolution in sweep.resolutions.chosen.items():
        laws = f"{', '.join(map(str, json.loads(name)))}: " if json.loads(name) else ""
        lines.append(
            f"{laws}computed at {resolution.slices} slices ({resolution.quadrature}) and {resolution.instants} "
            "instants of a pitch, what scene and points far apart need for the error of "
            f"{sweep.scene.accuracy.tolerance:g} it states"
        )
    own = len(sweep.numbers)
    piece = f" of {sweep.design.size}, piece {sweep.shard[0]} of {sweep.shard[1]}" if sweep.shard[1] > 1 else ""
    lines.append(f"{own} points{piece}; of each {', '.join(sweep.outputs)}")
    return lines


def sweep_progress(of: "Progress") -> str:
    """Return how far a sweep is, in one line."""
    left = f", {duration(of.left)} left" if of.left is not None else ""
    return f"{of.told[0]}{left}"


def sweep_pieces(folder: Path, pieces: "Sequence[Status]") -> str:
    """Return how the pieces of a sweep that are not put together yet stand."""
    done, total, all_ = sum(piece.done for piece in pieces), sum(piece.total for piece in pieces), pieces[0].shard[1]
    return (
        f"{len(pieces)} of {all_} pieces in {folder}: {done} of {total} of their points done, "
        f"{sum(piece.running for piece in pieces)} running; put together by: rollslip sweep merge {folder}"
    )


def sweep_status(of: "Status") -> list[str]:
    """Return how a sweep stands, line by line."""
    piece = f", piece {of.shard[0]} of {of.shard[1]}" if of.shard[1] > 1 else ""
    lines = [f"sweep of {of.study}{piece} in {of.folder}: {of.done} of {of.total} points done"]
    lines += [f"  {name}: {count}" for name, count in of.counts.items()]
    if of.done < of.total:
        lines.append(f"  not yet: {of.total - of.done}")
        if of.left is not None and of.quiet is not None:
            lines.append(f"  at the last pace {duration(of.left)} left; the last point came {duration(of.quiet)} ago")
    for writer in of.writers:
        ended = writer["ended"] or ("runs" if of.running and writer is of.writers[-1] else "was killed")
        who = f"{writer['host']} process {writer['process']}, {writer['engine']}"
        lines.append(f"  {who}: {writer['points']} points, {ended}")
    lines += [f"  point {number} {status}: {message}" for number, status, message in of.errors]
    return lines


# Results --------------------------------------------------------------------------------------------------------------
