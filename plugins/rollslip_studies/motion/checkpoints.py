"""A folder in which a long run leaves what it has computed, part by part, so that it can be gone on with.

- A part is a file that appears whole or not at all; a run that is killed loses what came after its last part.
- It belongs to one scene and one study. Another one's is refused, never overwritten.
"""

import json
import zipfile
import zlib
from pathlib import Path

import attrs
import numpy as np

from rollslip.errors import OutputError
from rollslip.files import whole_file
from rollslip.studies.answers import Store
from rollslip_studies.motion.time_integration import Event, Trajectory

_NUMBERS = (
    "last_t",
    "last_step",
    "steps",
    "rejected",
    "evaluations",
    "jacobians",
    "wall_time",
    "processor_time",
)


@attrs.frozen
class Checkpoints(Store):
    """Parts of one run."""

    def parts(self) -> list[Path]:
        """Return the files that are there, in order."""
        return sorted(self.folder.glob(f"{self.study}-*.npz"))

    def write(self, number: int, part: Trajectory) -> None:
        """Write the part of a number, counted from 0, in place of one that is there."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(
                f"{self.folder}: cannot be written ({error.strerror}); make room there, or name another --out"
            ) from error
        with (
            whole_file(self.folder / f"{self.study}-{number:05d}.npz") as partial,
            open(partial, "wb") as file,
        ):
            np.savez(
                file,
                t=part.t,
                y=part.y,
                last_y=part.last_y,
                last_state=part.last_state,
                events=np.array([(e.time, e.watched, e.rising) for e in part.events]).reshape(
                    -1, 3
                ),
                facts=np.frombuffer(
                    json.dumps(
                        {name: getattr(part, name) for name in _NUMBERS}
                        | {"scene_hash": self.scene_hash}
                    ).encode(),
                    dtype=np.uint8,
                ),
            )

    def load(self, times: np.ndarray, unknowns: int) -> Trajectory | None:
        """Return what the parts hold together, or None if there are none."""
        trajectory = None
        fits = True
        for path in self.parts():
            part = self._read(path)
            fits = (
                fits
                and part.y.shape == (part.t.size, unknowns)
                and part.last_y.shape == (unknowns,)
            )
            if fits:
                trajectory = part if trajectory is None else trajectory.then(part)
        if not fits or (
            trajectory is not None and not np.array_equal(trajectory.t, times[: trajectory.t.size])
        ):
            raise OutputError(
                f"{self.folder}: its parts do not fit together; remove the folder and run anew"
            )
        return trajectory

    def _read(self, path: Path) -> Trajectory:
        try:
            with open(path, "rb") as stored, np.load(stored, allow_pickle=False) as file:
                facts = json.loads(file["facts"].tobytes())
                of = facts.pop("scene_hash")
                part = Trajectory(
                    t=file["t"],
                    y=file["y"],
                    last_y=file["last_y"],
                    last_state=file["last_state"]
                    if "last_state" in file
                    else np.zeros(0),  # of older versions
                    events=tuple(Event(float(t), int(k), bool(up)) for t, k, up in file["events"]),
                    outcome="interrupted",
                    message="",
                    error=None,
                    **facts,
                )
        except (
            OSError,
            ValueError,
            KeyError,
            TypeError,
            EOFError,
            zipfile.BadZipFile,
            zlib.error,
        ) as error:
            raise OutputError(
                f"{path}: is not a part of a run that can be read ({error}); remove it"
            ) from error
        if of != self.scene_hash:
            raise OutputError(
                f"{self.folder}: holds a run of another scene, or of this one before it was changed; "
                "run without --resume, or remove the folder"
            )
        return part
