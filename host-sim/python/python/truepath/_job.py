"""The job: what is milled, with which cutter, on which machine."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Optional, Union

from . import _truepath

AnyPath = Union[str, "os.PathLike[str]"]


class Job:
    """A job file and its program, as every function here takes them.

    Made by :meth:`Job.read` or :meth:`Job.from_text`. The files are read again by every call, so an edit takes effect.
    ``docs/job.md`` lists the keys of a job with their units.
    """

    def __init__(self, path: AnyPath, *, _folder: Optional[str] = None) -> None:
        self._folder = _folder
        if _folder is not None:
            weakref.finalize(self, shutil.rmtree, _folder, ignore_errors=True)
        self.path: str = os.fspath(path)
        """The job file, as it was named."""
        self._program = _truepath.read(self.path, self._hidden)

    @classmethod
    def read(cls, path: AnyPath) -> Job:
        """Reads a job file (``job.toml``); its ``program`` lies beside it.

        Raises:
            TruepathError: what is wrong with job or program, with its place: ``J006`` a value out of range, for instance.
        """
        return cls(path)

    @classmethod
    def from_text(
        cls, toml: str, program: Union[str, bytes], files: Optional[Mapping[str, Union[str, bytes]]] = None
    ) -> Job:
        """A job from texts, without files of your own.

        Args:
            toml: text of the job file.
            program: text of the milling program; it gets the name that the job's ``program`` says.
            files: other files that the job names, by name: the surface of the stock, for instance.

        Raises:
            TruepathError: as :meth:`read`; places are told as of ``job.toml``.
            ValueError: a name that leads out of the job's folder.
        """
        named = _truepath.program_name(toml) or "program.nc"
        texts = {**(files or {}), named: program, "job.toml": toml}
        for name in texts:
            pure = PurePath(name)
            if pure.is_absolute() or ".." in pure.parts or not pure.parts:
                raise ValueError(f"{name!r} leads out of the job's folder: name a file beside the job")
        folder = tempfile.mkdtemp(prefix="truepath-")
        for name, text in texts.items():
            target = Path(folder) / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(text.encode() if isinstance(text, str) else text)
        return cls(os.path.join(folder, "job.toml"), _folder=folder)

    @property
    def program_text(self) -> str:
        """The milling program."""
        return Path(self._program).read_bytes().decode("utf-8", "surrogateescape")

    @property
    def _hidden(self) -> list[str]:
        """Folders that the caller does not know."""
        return [] if self._folder is None else [self._folder]

    def __repr__(self) -> str:
        return f"Job({os.path.basename(self.path) if self._folder else self.path!r})"
