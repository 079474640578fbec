"""A folder in which a long run stores what it has computed, part by part, so that it can continue.

- A part is a file that is written completely or not at all. A run that is killed loses only what it computed after its
  last part.
- The folder belongs to one scene and one study. That of another one is refused, and never overwritten.
"""

import json
import zipfile
import zlib
from functools import reduce
from pathlib import Path
from typing import Final

import attrs
import numpy as np

from rollslip.errors import OutputError
from rollslip.files import whole_file
from rollslip.studies.answers import Store
from rollslip_studies.motion.time_integration import Event, Trajectory

#: Attributes of a trajectory that are stored as JSON.
_NUMBERS: Final = (
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
        """Return the files of the parts, in order."""
        return sorted(self.folder.glob(f"{self.study}-*.npz"))

    def write(self, number: int, part: Trajectory) -> None:
        """Write a part, and replace that of the same number.

        Parameters
        ----------
        number : int
            Number of the part, from 0.
        part : Trajectory
            What was computed since the previous part.
        """
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(
                f"{self.folder}: cannot be written ({error.strerror}); make room there, or name another --out"
            ) from error
        facts = {name: getattr(part, name) for name in _NUMBERS} | {"scene_hash": self.scene_hash}
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
                facts=np.frombuffer(json.dumps(facts).encode(), dtype=np.uint8),
            )

    def load(self, times: np.ndarray, unknowns: int) -> Trajectory | None:
        """Return the joined parts, or None if there are none.

        Parameters
        ----------
        times : ndarray
            Requested times of the run [s], (m,).
        unknowns : int
            Number of unknowns of the motion.
        """
        parts = [self._read(path) for path in self.parts()]
        if not parts:
            return None
        fits = all(
            part.y.shape == (part.t.size, unknowns) and part.last_y.shape == (unknowns,)
            for part in parts
        )
        stored = np.concatenate([part.t for part in parts])
        if not fits or not np.array_equal(stored, times[: stored.size]):
            raise OutputError(
                f"{self.folder}: its parts do not fit together; remove the folder and run anew"
            )
        return reduce(Trajectory.join, parts)

    def _read(self, path: Path) -> Trajectory:
        """The part in a file; it raises `OutputError` for a file that is damaged or of another scene."""
        try:
            with open(path, "rb") as stored, np.load(stored, allow_pickle=False) as file:
                facts = json.loads(file["facts"].tobytes())
                scene_hash = facts.pop("scene_hash")
                part = Trajectory(
                    t=file["t"],
                    y=file["y"],
                    last_y=file["last_y"],
                    last_state=file["last_state"],
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
        if scene_hash != self.scene_hash:
            raise OutputError(
                f"{self.folder}: holds a run of another scene, or of this one before it was changed; "
                "run without --resume, or remove the folder"
            )
        return part
