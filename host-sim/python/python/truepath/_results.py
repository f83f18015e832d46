"""What the functions give: arrays, summaries, files."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Optional, TypeVar

import numpy as np
import numpy.typing as npt

from . import _truepath
from ._call import files_in
from ._job import AnyPath

Array = npt.NDArray[np.float64]
Names = npt.NDArray[np.str_]


def _tables(files: Mapping[str, bytes], name: str) -> tuple[dict[str, Array], Names]:
    """The columns of a table, of several contours one after the other, and the contour of every row."""
    texts = {"": files[name]} if name in files else {}
    for path, data in files.items():
        parts = path.split("/")
        if parts[0] == "contours" and parts[-1] == name:
            texts[parts[1]] = data
    columns: dict[str, list[float]] = {}
    contours: list[str] = []
    for contour, data in texts.items():
        rows = csv.reader(io.StringIO(data.decode()))
        head = next(rows)
        for row in rows:
            for key, value in zip(head, row):
                columns.setdefault(key, []).append(float(value) if value else np.nan)
            contours.append(contour)
    return {key: np.array(values, dtype=np.float64) for key, values in columns.items()}, np.array(contours, dtype=np.str_)


def _listed(rows: Sequence[Mapping[str, Any]], key: str) -> Array:
    """A column of a list of objects."""
    return np.array([row[key] for row in rows], dtype=np.float64)


def _contours(rows: Sequence[Mapping[str, Any]]) -> Names:
    return np.array([row.get("contour") or "" for row in rows], dtype=np.str_)


@dataclass(frozen=True, eq=False, repr=False)
class Trace:
    """One pass along the contour, by :func:`simulate`. All arrays are of length n unless said."""

    s_mm: Array
    """Place along the contour, mm; begins anew with every contour."""
    x_mm: Array
    """Centre of the cutter, programmed, mm."""
    y_mm: Array
    """Centre of the cutter, programmed, mm."""
    engagement_deg: Array
    """Arc over which the cutter is engaged, degrees."""
    chip_area_mm2: Array
    """Mean area of the chip, mm²."""
    force_n: Array
    """Mean force, N."""
    force_xy_n: Array
    """Mean force on the cutter in X and Y, N; (n, 2)."""
    displacement_mm: Array
    """Where the cutter is beside its programmed place, X and Y, mm; (n, 2)."""
    error_mm: Array
    """Error of the wall, mean over the height, mm: positive, material left. NaN where the cutter makes no wall."""
    contour: Names
    """The contour of every row; empty texts where the program has only one."""
    summary: dict[str, Any]
    """``summary.json`` of ``truepath simulate``."""
    files: dict[str, bytes] = field(repr=False)
    """Every file that the command writes, by name."""

    @classmethod
    def _of(cls, files: dict[str, bytes]) -> Trace:
        table, contour = _tables(files, "trace.csv")
        return cls(
            s_mm=table["s_mm"],
            x_mm=table["x_mm"],
            y_mm=table["y_mm"],
            engagement_deg=table["arc_deg"],
            chip_area_mm2=table["chip_area_mm2"],
            force_n=table["force_n"],
            force_xy_n=np.column_stack([table["fx_n"], table["fy_n"]]),
            displacement_mm=np.column_stack([table["dx_mm"], table["dy_mm"]]),
            error_mm=table["error_mm"],
            contour=contour,
            summary=json.loads(files["summary.json"]),
            files=files,
        )

    def __repr__(self) -> str:
        return f"Trace({len(self.s_mm)} places, largest error {self.summary['max_error_mm']:.4f} mm)"


@dataclass(frozen=True, eq=False, repr=False)
class Inspection:
    """How far a wall is off by its touches alone, by :func:`inspect`. All arrays are of length n, in the order of the contour."""

    line: npt.NDArray[np.int64]
    """Line of the probe file; of an array of touches its row, from 1."""
    s_mm: Array
    """Place along the contour, mm."""
    x_mm: Array
    """Point of the wall, mm."""
    y_mm: Array
    """Point of the wall, mm."""
    height_mm: Array
    """Height above the cutter's tip, mm."""
    error_mm: Array
    """Error of the wall, mm: positive, material left."""
    verdict: Names
    """``pass``, ``fail`` or ``open`` where job or call state a tolerance; else empty texts."""
    contour: Names
    """The contour of every point; empty texts where the program has only one."""
    summary: dict[str, Any]
    """Totals and the verdict on the part, as in ``summary.json`` of ``truepath inspect``."""

    @classmethod
    def _of(cls, told: dict[str, Any]) -> Inspection:
        rows = told["contacts"]
        return cls(
            line=np.array([row["line"] for row in rows], dtype=np.int64),
            s_mm=_listed(rows, "s_mm"),
            x_mm=_listed(rows, "x_mm"),
            y_mm=_listed(rows, "y_mm"),
            height_mm=_listed(rows, "height_mm"),
            error_mm=_listed(rows, "error_mm"),
            verdict=np.array([row.get("verdict") or "" for row in rows], dtype=np.str_),
            contour=_contours(rows),
            summary=told["summary"],
        )

    def __repr__(self) -> str:
        return f"Inspection({len(self.s_mm)} points, {self.summary['verdict']['text']})"


@dataclass(frozen=True)
class Parameter:
    """An identified quantity."""

    value: float
    """Its value."""
    sigma: float
    """One standard deviation."""
    prior: float
    """What was believed before probing."""
    prior_sigma: float
    """One standard deviation of that belief."""
    unit: str
    """Unit of the four."""
    observable: bool
    """Whether the points decide it."""


@dataclass(frozen=True, eq=False, repr=False)
class Identification:
    """Machine and material as the points have them, by :func:`identify`. All arrays are of length n, in the order of the contour."""

    parameters: dict[str, Parameter]
    """By name: ``compliance`` (µm/N), ``radial_ratio``, ``undersize`` (mm) and others; ``docs/theory.md`` says what they are."""
    wall_law: str
    """Which force the wall follows: ``mean`` or ``helical``."""
    line: npt.NDArray[np.int64]
    """Line of the probe file; of an array of touches its row, from 1."""
    s_mm: Array
    """Place along the contour, mm."""
    height_mm: Array
    """Height above the cutter's tip, mm."""
    measured_mm: Array
    """Measured error of the wall, mm: positive, material left."""
    predicted_mm: Array
    """The error by the identified machine, mm."""
    residual_mm: Array
    """Measured less predicted, mm."""
    weight: Array
    """Weight of the point in the fit, 0 to 1."""
    contour: Names
    """The contour of every point; empty texts where the program has only one."""

    @classmethod
    def _of(cls, told: dict[str, Any]) -> Identification:
        rows = told["points"]
        return cls(
            parameters={name: Parameter(**values) for name, values in told["identified"].items()},
            wall_law=told["wall_law"],
            line=np.array([row["line"] for row in rows], dtype=np.int64),
            s_mm=_listed(rows, "s_mm"),
            height_mm=_listed(rows, "height_mm"),
            measured_mm=_listed(rows, "measured_mm"),
            predicted_mm=_listed(rows, "predicted_mm"),
            residual_mm=_listed(rows, "residual_mm"),
            weight=_listed(rows, "weight"),
            contour=_contours(rows),
        )

    def __repr__(self) -> str:
        values = ", ".join(f"{name} {p.value:.4g} ± {p.sigma:.2g} {p.unit}" for name, p in self.parameters.items())
        return f"Identification({len(self.s_mm)} points: {values})"


_OTHERS = {
    "Correction": "those of a correction: read them with Correction.read",
    "Plan": "those of a plan: read them with Plan.read, whose summary has the passes and planned_program the program",
    "Trace": "those of truepath simulate: take trace.csv of it, or call simulate",
}
"""What is said of a folder that something else reads."""


def _kind(files: Mapping[str, bytes]) -> str:
    """The class whose files these are; an empty text for none."""
    summary = json.loads(files["summary.json"])
    plans = [summary, *(summary.get("contours") or [])]
    names = {name.rsplit("/", 1)[-1] for name in files}
    if "plan-history.json" in names or any("choices" in plan for plan in plans):
        return "Plan"
    if "correction.csv" in names:
        return "Correction"
    return "Trace" if "trace.csv" in names else ""


W = TypeVar("W", bound="_Written")


@dataclass(frozen=True, eq=False, repr=False)
class _Written:
    """What a command wrote into a folder."""

    summary: dict[str, Any]
    """``summary.json`` of the command."""
    files: dict[str, bytes]
    """Every file that the command writes, by name: ``report.html``, ``difference.txt`` and others."""

    @classmethod
    def read(cls: type[W], folder: AnyPath) -> W:
        """What the command or :meth:`save` wrote into a folder.

        Raises:
            FileNotFoundError: no folder, or none of a command.
            ValueError: the folder of another command; the message says which, and what reads it.
        """
        files, own = files_in(folder), cls.__name__
        if "summary.json" not in files:
            raise FileNotFoundError(f"{os.fspath(folder)!r} holds no {own.lower()}: summary.json is missing")
        found = _kind(files)
        if found == own:
            return cls._of(files)
        said = _OTHERS.get(found, "of another command")
        raise ValueError(f"{os.fspath(folder)!r} holds no {own.lower()}: its files are {said}")

    @classmethod
    def _of(cls: type[W], files: dict[str, bytes]) -> W:
        return cls(summary=json.loads(files["summary.json"]), files=files)

    def save(self, folder: AnyPath, *, force: bool = False) -> None:
        """Writes every file into a folder, whole or not at all: what the command writes with ``-o``.

        Args:
            folder: a new or an empty folder.
            force: replace the files of an earlier run in it.

        Raises:
            TruepathError: ``F003`` the folder is not empty, ``F002`` it cannot be written.
        """
        _truepath.save(os.fspath(folder), list(self.files.items()), force)

    def _text(self, name: str) -> Optional[str]:
        data = self.files.get(name)
        return None if data is None else data.decode("utf-8", "surrogateescape")


@dataclass(frozen=True, eq=False, repr=False)
class Correction(_Written):
    """A correction of the next part, by :func:`correct` or :func:`learn`. All arrays are of length n."""

    s_mm: Array
    """Place along the contour, mm; begins anew with every contour."""
    x_mm: Array
    """Centre of the cutter, programmed, mm."""
    y_mm: Array
    """Centre of the cutter, programmed, mm."""
    dx_mm: Array
    """What is added to X, mm."""
    dy_mm: Array
    """What is added to Y, mm."""
    error_before_mm: Array
    """Error of the wall that is expected without correction, mm: positive, material left."""
    error_after_mm: Array
    """The same with it, mm."""
    sigma_mm: Array
    """One standard deviation of the error on the next part, mm."""
    contour: Names
    """The contour of every row; empty texts where only one was corrected."""

    @classmethod
    def _of(cls, files: dict[str, bytes]) -> Correction:
        table, contour = _tables(files, "correction.csv")
        return cls(
            s_mm=table["s_mm"],
            x_mm=table["x_mm"],
            y_mm=table["y_mm"],
            dx_mm=table["dx_mm"],
            dy_mm=table["dy_mm"],
            error_before_mm=table["predicted_error_before_mm"],
            error_after_mm=table["predicted_error_after_mm"],
            sigma_mm=table["sigma_mm"],
            contour=contour,
            summary=json.loads(files["summary.json"]),
            files=files,
        )

    @property
    def corrected_program(self) -> Optional[str]:
        """The program to load at the machine; None where the coprocessor corrects."""
        return self._text("corrected.nc")

    @property
    def image(self) -> Optional[bytes]:
        """The image for the coprocessor; None where the program is corrected. Of several contours each has its own in ``files``."""
        return self.files.get("correction.tpi")

    def __repr__(self) -> str:
        before, after = self.summary["max_error_before_mm"], self.summary["max_error_after_mm"]
        return f"Correction({len(self.s_mm)} places, largest error {before:.4f} -> {after:.4f} mm)"


@dataclass(frozen=True, eq=False, repr=False)
class Plan(_Written):
    """Passes that hold a tolerance at every height, by :func:`plan`, or better ones by :func:`learn`.

    ``summary`` has ``choices`` with time and wall, and the one ``recommended``; of several contours in ``contours``.
    """

    @property
    def planned_program(self) -> Optional[str]:
        """The program to load at the machine; None where none was written."""
        return self._text("planned.nc")

    def __repr__(self) -> str:
        plans = self.summary.get("contours") or [self.summary]
        return f"Plan({sum(len(plan.get('choices', ())) for plan in plans)} choices)"
