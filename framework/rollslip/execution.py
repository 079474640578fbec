"""Run a plan: its studies one after the other, each result with its warnings and its origin."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rollslip.assembly import assemble
from rollslip.dynamics import Dynamics
from rollslip.friction_curve import about
from rollslip.planning import Plan, plan
from rollslip.reading import load_scene
from rollslip.regimes import LIGHT, LONG_NAMES, NAMES
from rollslip.result import provenance
from rollslip.run_store import RunStore
from rollslip.scene import Scene, scene_hash

if TYPE_CHECKING:
    import xarray as xr


def run(scene: Scene | str, study: str | None = None) -> "xr.Dataset":
    """Run one study of a scene.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    study : str, optional
        "effective-friction", "friction-curve", "dynamics" or "steady-slip"; by default the first one of the scene.

    Returns
    -------
    xarray.Dataset
        The result, see the study; its attributes hold scene, versions, warnings and citations.

    Raises
    ------
    SceneError, PluginError
        If the scene or a model it names cannot be used.
    DomainError, ConvergenceError
        If a law is asked where it is not defined, or an iteration does not end.

    Examples
    --------
    >>> result = run("1032930-70C")
    >>> round(float(result.critical_cage_slip.sel(ring="inner")), 2)
    0.5
    """
    made = plan(scene, study)
    return execute(made, next(iter(made.studies)))


def execute(
    plan: Plan, study: str, *, kept: Path | None = None, progress: Callable[[str], None] | None = None
) -> "xr.Dataset":
    """Return the result of one study of a plan.

    Parameters
    ----------
    plan : Plan
        What is to be run.
    study : str
        The study.
    kept : Path, optional
        Folder in which a long study in time leaves what it has computed, and from which it goes on; to be removed by
        who has stored the result.
    progress : callable, optional
        Told how far a study in time has come.
    """
    begin, chain = time.perf_counter(), plan.assembly.inner.chain
    before, running = chain.evaluated, plan.studies[study]
    if isinstance(running, Dynamics):
        store = None if kept is None else RunStore(kept, scene_hash(plan.scene), study)
        dataset = running.kept_in(plan.assembly, store, progress)
    else:
        dataset = running.run(plan.assembly)
    dataset.attrs |= provenance(plan, warnings(plan, dataset), chain.evaluated - before, time.perf_counter() - begin)
    return dataset


def load_distribution(scene: Scene | str, instants: int = 1) -> "xr.Dataset":
    """Return the quasi-static load distribution of a scene.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    instants : int
        Instants spread over one roller pitch; at the first one a roller is in the line of load.

    Returns
    -------
    xarray.Dataset
        Dimensions (ring, instant, roller): normal_force; (ring, instant, roller, slice): load_per_length;
        (instant, direction): displacement; (instant,): moment; attributes force_residual and moment_residual,
        relative.

    Raises
    ------
    SceneError, PluginError
        If the scene or a model it names cannot be used.
    ConvergenceError
        If forces and moments do not balance to 1e-10.
    """
    import xarray as xr

    assembly = assemble(scene if isinstance(scene, Scene) else load_scene(scene))
    loads = assembly.load_distribution(instants)

    contacts = ("ring", "instant", "roller")
    return xr.Dataset(
        {
            "normal_force": (contacts, np.stack([loads.inner_force, loads.outer_force]), about("N", "normal force")),
            "load_per_length": (
                (*contacts, "slice"),
                np.stack([loads.inner_load, loads.outer_load]),
                about("N/m", "normal force per length"),
            ),
            "displacement": (
                ("instant", "direction"),
                loads.displacement,
                about("m", "displacement of the inner ring"),
            ),
            "roller_tilt": (("instant", "roller"), loads.roller_tilt, about("rad", "tilt of the roller")),
            "moment": ("instant", loads.moment, about("N m", "moment on the inner ring from its misalignment")),
        },
        coords={
            "ring": ("ring", np.array(["inner", "outer"]), about("1", "ring")),
            "direction": ("direction", np.array(["along", "across"]), about("1", "direction to the line of load")),
            "angle": (("instant", "roller"), loads.psi, about("rad", "position from the line of load")),
            "position": ("slice", loads.position, about("m", "position along the roller from its middle")),
        },
        attrs={
            "force_residual": loads.force_residual,
            "moment_residual": loads.moment_residual,
            "iterations": loads.iterations,
        },
    )


def warnings(plan: Plan, dataset: "xr.Dataset") -> list[str]:
    """Return in words where the models were used outside what they were made for, and what a reader must know."""
    found: list[str] = []
    film = plan.assembly.film
    shares = _regime_shares(dataset)
    outside = {name: share for name, share in shares.items() if film.regime not in ("all", name) and share > 0.0}
    if outside:
        where = " and ".join(f"{share:.0%} {LONG_NAMES[name]}" for name, share in outside.items())
        found.append(
            f"film model {film.name!r} holds in the {LONG_NAMES[film.regime]} regime, but of the contact force "
            f"{where}; there its film may be far off: film 'moes' covers all regimes"
        )
    corrections = [f"shear heating of the inlet after {film.inlet_heating!r}"] if film.inlet_heating else []
    if film.inlet_starvation < 1:
        corrections.append(f"starvation by a factor of {film.inlet_starvation:g}")
    if corrections:
        found.append(f"the film is thinned for {' and '.join(corrections)}, as the scene asks")
    if "light_share" in dataset:
        light, what = float(dataset["light_share"].max()), "of the contact force of a ring"
    else:
        light, what = float((dataset["load_parameter"] < LIGHT).mean()), "of the normal forces"
    if light > 0.005:
        found.append(
            f"lightly loaded contacts: {light:.0%} {what} with a Moes load parameter M below {LIGHT:g}, where the "
            "pressure in the film is far from Hertz's, on which traction is based"
        )
    tolerance = plan.scene.accuracy.tolerance
    if (error := dataset.attrs.get("slices_error", 0.0)) > tolerance:
        found.append(
            f"{dataset.attrs['slices']} slices leave a relative error of about {error:.1e}, more than "
            f"accuracy.tolerance = {tolerance:g}; raise accuracy.slices"
        )
    return found


def _regime_shares(dataset: "xr.Dataset") -> dict[str, float]:
    """Share of the contact force, or of the curve's points, in each film regime."""
    if "regime_share" in dataset:
        return {str(name): float(dataset["regime_share"].sel(regime=name).mean()) for name in NAMES}
    codes = dataset["regime"].to_numpy()
    return {name: float(np.mean(codes == code)) for code, name in enumerate(NAMES)}
