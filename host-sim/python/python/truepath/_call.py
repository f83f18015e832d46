"""A call of a command: its words, its files, what it warns of."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _truepath
from ._job import AnyPath, Job

if TYPE_CHECKING:
    from ._truepath import _Given

Progress = Callable[[float], object]
Touches = Union[AnyPath, "npt.ArrayLike"]


class TruepathWarning(UserWarning):
    """What a command warns of: the same sentences as on the command line and in its summary."""


class Call:
    """The words of a command for one job, with a folder for what it needs and writes."""

    def __init__(self, job: Job, progress: Optional[Progress] = None) -> None:
        self.job = job
        self.words: list[str] = []
        self._progress = progress
        self._columns = False
        self._folder = tempfile.TemporaryDirectory(prefix="truepath-")
        # Its own name inside: what is written beside an output is not an output.
        self.output = os.path.join(self._folder.name, "out")

    def __enter__(self) -> Call:
        return self

    def __exit__(
        self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self._folder.cleanup()

    def says(self, flag: str, value: object) -> None:
        """Adds a flag, where there is something to say."""
        if value is True:
            self.words.append(flag)
        elif value is not None and value is not False:
            text = np.format_float_positional(value, trim="-") if isinstance(value, float) else str(value)
            self.words.append(f"{flag}={text}")

    def file(self, flag: str, given: AnyPath, name: str) -> None:
        """Adds a file: a path, or a text of more than one line, which becomes a file of that name."""
        if isinstance(given, str) and "\n" in given:
            path = os.path.join(self._folder.name, name)
            with open(path, "w", encoding="utf-8", newline="") as file:
                file.write(given)
            given = path
        self.says(flag, os.fspath(given))

    def folder(self, name: str) -> str:
        """A place for a folder."""
        return os.path.join(self._folder.name, name)

    def measured(self, touches: Optional[Touches], dimensions: Optional[AnyPath]) -> None:
        """Adds what was measured."""
        if dimensions is not None:
            self.file("--dimensions", dimensions, "dimensions.toml")
        if touches is not None:
            self._touches(touches)

    def _touches(self, touches: Touches) -> None:
        if isinstance(touches, (str, os.PathLike)):
            self.file("--probe", touches, "probe.txt")
            return
        self.file("--probe", columns(touches), "touches.csv")
        self.words += ["--cols=x,y,z,nx,ny", "--sep=comma", "--decimal=point", "--frame=work", "--point=tip"]
        if np.shape(touches)[1] == 3:
            self.words[-5] = "--cols=x,y,z"
        self._columns = True

    def run(self, command: Callable[[list[str], _Given], Any]) -> Any:
        """Runs a command."""
        given: _Given = {
            "hidden": self._hidden,
            "millimetres": self._columns,
            "progress": self._progress,
        }
        return command([*self.words, "--", self.job.path], given)

    def unkept(self, store: Optional[AnyPath], by: str) -> list[str]:
        """Puts what was written into a store, if one is given; what there is to warn of."""
        if store is None:
            return []
        try:
            _truepath.keep(self.job.path, os.fspath(store), self.output, by)
        except _truepath.TruepathError as error:
            return [f"the part is not in the store: {error}. Save it, and truepath store import takes its folder later"]
        return []

    @property
    def _hidden(self) -> list[str]:
        return [*self.job._hidden, self._folder.name]

    def bare(self, text: bytes) -> bytes:
        """A text without the folders that the caller does not know."""
        for folder in self._hidden:
            text = text.replace(os.path.join(folder, "").encode(), b"")
        return text

    def files(self) -> dict[str, bytes]:
        """What the command wrote, by name."""
        return {
            name: data if name.endswith(".tpi") else self.bare(data) for name, data in files_in(self.output).items()
        }


def files_in(folder: AnyPath) -> dict[str, bytes]:
    """All files of a folder and those below it, by name."""
    root = Path(folder)
    found = (path for path in sorted(root.rglob("*")) if path.is_file())
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in found}


def columns(touches: npt.ArrayLike) -> str:
    """Touches as a table; a nanometre is the last digit that counts."""
    array = np.asarray(touches, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] not in (3, 6) or len(array) == 0:
        raise ValueError(f"touches of shape {array.shape}: (n, 3) for x, y, z or (n, 6) with the normals nx, ny, nz is needed")
    if not np.isfinite(array).all():
        raise ValueError("a touch that is no number: leave out places where the probe touched nothing")
    if array.shape[1] == 6:
        if np.abs(array[:, 5]).max() > 1e-3 or np.abs(np.hypot(array[:, 3], array[:, 4]) - 1.0).max() > 1e-3:
            raise ValueError("a normal that does not lie in XY or is not of length 1: walls are vertical")
        array = array[:, :5]
    return "".join(",".join(f"{value:.6f}" for value in row) + "\n" for row in array)


def warn(said: Iterable[str]) -> None:
    """Warns, as from the line that called the function."""
    for text in said:
        warnings.warn(text, TruepathWarning, stacklevel=3)
