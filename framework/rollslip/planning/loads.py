"""The quasi-static loads of all rollers of a scene, as a dataset."""

import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.results.dataset import about, xr
from rollslip.scene.reading import as_scene
from rollslip.scene.values import Scene


def load_distribution(scene: Scene | str, n_positions: int = 1) -> "xr.Dataset":
    """Return the quasi-static load distribution of a scene.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    n_positions : int
        Number of roller positions within a pitch; at the first one a roller is in the line of load.

    Returns
    -------
    xarray.Dataset
        Dimensions (ring, instant, roller), where "instant" is the roller position: normal_force;
        (ring, instant, roller, slice): load_per_length; (instant, direction): displacement;
        (ring, instant, orbit_angle): raceway_shape, from its form, at the first position, and the bending of the ring;
        (instant, roller): roller_tilt, rib_force;
        (instant,): moment, axial_displacement; attributes force_residual and moment_residual, relative.

    Raises
    ------
    SceneError, PluginError
        If the scene or a model it names cannot be used.
    ConvergenceError
        If forces and moments do not balance to 1e-10.
    """
    assembly = assemble(as_scene(scene))
    loads = assembly.load_distribution(n_positions)

    orbit = np.radians(np.arange(361.0))  # one degree, enough to draw a ring
    rings = assembly.rings
    sense = assembly.kinematics.direction
    psi = sense * loads.psi % (2.0 * np.pi)
    shape = np.zeros((2, n_positions, orbit.size))
    if rings is not None:
        m = rings.inner.stiffness.size
        shape[0] = -loads.deflection[:, :m] @ rings.inner.at(sense * orbit).T
        shape[1] = loads.deflection[:, m:] @ rings.outer.at(sense * orbit).T
        for k, outwards in enumerate((1.0, -1.0)):
            shape[k] += outwards * rings.with_single_form(k + 1).form(sense * orbit)
    contacts = ("ring", "instant", "roller")
    return xr.Dataset(
        {
            "normal_force": (
                contacts,
                np.stack([loads.inner_force, loads.outer_force]),
                about("N", "normal force"),
            ),
            "load_per_length": (
                (*contacts, "slice"),
                np.stack([loads.inner_load, loads.outer_load]),
                about("N/m", "normal force per length"),
            ),
            "displacement": (
                ("instant", "direction"),
                loads.displacement * np.array([1.0, sense]),
                about("m", "displacement of the inner ring"),
            ),
            "roller_tilt": (
                ("instant", "roller"),
                loads.roller_tilt,
                about("rad", "tilt of the roller"),
            ),
            "raceway_shape": (
                ("ring", "instant", "orbit_angle"),
                shape,
                about("m", "how far the raceway stands outwards of a circle"),
            ),
            "rib_force": (
                ("instant", "roller"),
                loads.rib_force,
                about("N", "force of each rib of the roller"),
            ),
            "axial_displacement": (
                "instant",
                loads.axial_displacement,
                about(
                    "m", "axial displacement of the inner ring from where rollers touch both ribs"
                ),
            ),
            "moment": (
                "instant",
                loads.moment,
                about("N m", "moment on the inner ring from its misalignment"),
            ),
        },
        coords={
            "ring": ("ring", np.array(["inner", "outer"]), about("1", "ring")),
            "direction": (
                "direction",
                np.array(["along", "across"]),
                about("1", "direction to the line of load"),
            ),
            "angle": (("instant", "roller"), psi, about("rad", "position from the line of load")),
            "orbit_angle": ("orbit_angle", orbit, about("rad", "angle from the line of load")),
            "position": (
                "slice",
                loads.position,
                about("m", "position along the roller from its middle"),
            ),
        },
        attrs={
            "force_residual": loads.force_residual,
            "moment_residual": loads.moment_residual,
            "iterations": loads.iterations,
        },
    )
