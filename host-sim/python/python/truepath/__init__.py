"""Truepath: mill once, touch the wall, and get the program that cancels the deflection of the cutter.

::

    import truepath

    job = truepath.Job.read("job.toml")
    correction = truepath.correct(job, "probe.txt")
    correction.save("out")                       # what `truepath correct job.toml --probe probe.txt -o out` writes
    print(correction.error_before_mm.max(), correction.error_after_mm.max())

Lengths are millimetres, forces newtons, angles degrees. An error of the wall is positive where material is left. Every
function calls what the command of its name calls: numbers and files are the same, byte for byte.

Wrong input raises :class:`TruepathError`; what is doubtful is a :class:`TruepathWarning`. Other threads run meanwhile and
Ctrl-C is heard.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Literal, Optional, Union

from . import _truepath
from ._call import Call, Progress, Touches, TruepathWarning, warn
from ._job import AnyPath, Job
from ._results import Correction, Identification, Inspection, Parameter, Trace
from ._truepath import TruepathError, __version__

__all__ = [
    "Correction",
    "Identification",
    "Inspection",
    "Job",
    "Parameter",
    "Trace",
    "TruepathError",
    "TruepathWarning",
    "__version__",
    "correct",
    "demo",
    "identify",
    "inspect",
    "learn",
    "simulate",
]

Route = Literal["program", "coprocessor"]


def simulate(
    job: Job,
    machine: Optional[AnyPath] = None,
    *,
    corrected: Optional[Union[Correction, AnyPath]] = None,
    feature: Optional[str] = None,
) -> Trace:
    """One pass of the job's program: engagement, force, displacement and error of the wall along the contour.

    Args:
        job: the job.
        machine: a virtual machine that cuts it: a plant file or its text (``docs/plant.md``). Without one the model predicts
            the pass from the job's own numbers.
        corrected: cut with the corrected program of this correction, or of the folder that one was saved into; needs a machine.
        feature: the feature of the job, where it has several.

    Raises:
        TruepathError: what is wrong with job, program or machine.
    """
    with Call(job) as call:
        call.says("--output", call.output)
        call.says("--feature", feature)
        if machine is not None:
            call.file("--plant", machine, "plant.toml")
        if corrected is not None:
            call.says("--from", _folder_of(call, corrected))
        call.run(_truepath.simulate)
        trace = Trace._of(call.files())
    warn(trace.summary["warnings"])
    return trace


def inspect(
    job: Job,
    touches: Touches,
    *,
    tolerance_mm: Optional[float] = None,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
) -> Inspection:
    """How far the wall is off by its touches alone, without a model, and the verdict on the part.

    Args:
        job: the job.
        touches: what was measured; see :func:`correct`. Here of any part, corrected or not.
        tolerance_mm: half the width of the tolerance, mm, in place of ``[part]`` of the job.
        feature: the feature of the job, where it has several to choose from.
        depth: the depth of the feature, 1 for the first; otherwise the one that the touches lie on.

    Raises:
        TruepathError: what is wrong with job, program or touches.
        ValueError: an array of touches of another shape, or with values that are no numbers.
    """
    with Call(job) as call:
        call.touches(touches)
        call.says("--tolerance", _float(tolerance_mm))
        call.says("--feature", feature)
        call.says("--pass", depth)
        found = Inspection._of(json.loads(call.bare(call.run(_truepath.inspect).encode())))
    warn(found.summary["warnings"])
    return found


def identify(
    job: Job,
    touches: Touches,
    *,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
    force_data: bool = False,
    progress: Optional[Progress] = None,
) -> Identification:
    """Machine and material from the touches of an uncorrected part, as :func:`correct` identifies them.

    Arguments and errors are those of :func:`correct`.
    """
    with Call(job, progress) as call:
        _measured(call, touches, feature, depth, force_data)
        told = json.loads(call.bare(call.run(_truepath.identify).encode()))
    warn(told["warnings"])
    return Identification._of(told)


def correct(
    job: Job,
    touches: Touches,
    *,
    route: Optional[Route] = None,
    tolerance_mm: Optional[float] = None,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
    force_data: bool = False,
    progress: Optional[Progress] = None,
) -> Correction:
    """The correction of the next part, from the touches of one that was cut with the job's program.

    Args:
        job: the job, with ``[probe]``.
        touches: what was measured: a probe file or its text, in any format of ``docs/probe-formats.md``; or an array of ball
            centres x, y, z (n, 3) in mm and program coordinates, or (n, 6) with the unit normal nx, ny, nz of the wall to
            the free side. Z is that of ``z_reference`` of the job. Nanometres are the last digit that counts.
        route: correct in the program text, or in the coprocessor; otherwise as the job says.
        tolerance_mm: half the width of the tolerance at every height, mm, in place of ``[part]`` of the job.
        feature: the feature of the job, where it has several to choose from.
        depth: the depth of the feature, 1 for the first; otherwise the one that the touches lie on.
        force_data: go on although the touches do not fit the job (``Q009``).
        progress: is called with the share that is done, 0 to 1; what it raises stops the work.

    Raises:
        TruepathError: what is wrong with job, program or touches, with code, place and hint.
        ValueError: an array of touches of another shape, or with values that are no numbers.
    """
    with Call(job, progress) as call:
        _measured(call, touches, feature, depth, force_data)
        call.says("--route", route)
        call.says("--tolerance", _float(tolerance_mm))
        call.run(_truepath.correct)
        correction = Correction._of(call.files())
    warn(correction.summary["warnings"])
    return correction


def learn(
    job: Job,
    previous: Union[Correction, AnyPath],
    touches: Touches,
    *,
    part: Optional[int] = None,
    route: Optional[Route] = None,
    tolerance_mm: Optional[float] = None,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
    force_data: bool = False,
    progress: Optional[Progress] = None,
) -> Correction:
    """A better correction, from the touches of a part that was cut with the previous one.

    Args:
        job: the job.
        previous: the correction that the measured part was cut with, or the folder that it was saved into.
        touches: what was measured on that part; see :func:`correct`.
        part: number of that part in the order they were cut, where those between were not touched.
        route, tolerance_mm, feature, depth, force_data, progress: as of :func:`correct`.

    Raises:
        TruepathError: as :func:`correct`; a folder that holds no correction, or one of another job.
        ValueError: an array of touches of another shape, or with values that are no numbers.
    """
    with Call(job, progress) as call:
        _measured(call, touches, feature, depth, force_data)
        call.says("--from", _folder_of(call, previous))
        call.says("--part", part)
        call.says("--route", route)
        call.says("--tolerance", _float(tolerance_mm))
        call.run(_truepath.learn)
        correction = Correction._of(call.files())
    warn(correction.summary["warnings"])
    return correction


def demo(folder: AnyPath) -> Path:
    """Writes the parts of the demonstration: ``corner``, ``corner-helix`` and ``pocket``.

    Each is a folder with ``job.toml``, ``program.nc``, ``plant.toml`` (the machine that cut it), ``probe.txt`` (what was
    touched on it) and the correction.

    Raises:
        TruepathError: files in the way (``F003``) that are not the demonstration's.
    """
    _truepath.demo([f"--output={os.fspath(folder)}"], {"hidden": [], "millimetres": False, "progress": None})
    return Path(folder)


def _measured(call: Call, touches: Touches, feature: Optional[str], depth: Optional[int], force_data: bool) -> None:
    """What all say that take the touches of a part."""
    call.touches(touches)
    call.says("--output", call.output)
    call.says("--feature", feature)
    call.says("--pass", depth)
    call.says("--force-data", force_data)


def _folder_of(call: Call, correction: Union[Correction, AnyPath]) -> str:
    """The folder of a correction."""
    if not isinstance(correction, Correction):
        return os.fspath(correction)
    folder = call.folder("previous")
    correction.save(folder)
    return folder


def _float(value: Optional[float]) -> Optional[float]:
    return None if value is None else float(value)
