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
from typing import Literal, Optional, Union, overload

from . import _truepath
from ._call import Call, Progress, Touches, TruepathWarning, warn
from ._job import AnyPath, Job
from ._results import Correction, Identification, Inspection, Parameter, Plan, Trace
from ._truepath import TruepathError, __version__

__all__ = [
    "Correction",
    "Identification",
    "Inspection",
    "Job",
    "Parameter",
    "Plan",
    "Trace",
    "TruepathError",
    "TruepathWarning",
    "__version__",
    "correct",
    "demo",
    "identify",
    "inspect",
    "learn",
    "plan",
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
    touches: Optional[Touches] = None,
    *,
    dimensions: Optional[AnyPath] = None,
    tolerance_mm: Optional[float] = None,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
) -> Inspection:
    """How far the wall is off by its touches alone, without a model, and the verdict on the part.

    Args:
        job: the job.
        touches, dimensions: what was measured; see :func:`correct`. Here of any part, corrected or not.
        tolerance_mm: half the width of the tolerance, mm, in place of ``[part]`` of the job.
        feature: the feature of the job, where it has several to choose from.
        depth: the depth of the feature, 1 for the first; otherwise the one that the touches lie on.

    Raises:
        TruepathError: what is wrong with job, program or touches.
        ValueError: an array of touches of another shape, or with values that are no numbers.
    """
    with Call(job) as call:
        call.measured(touches, dimensions)
        call.says("--tolerance", _float(tolerance_mm))
        call.says("--feature", feature)
        call.says("--pass", depth)
        found = Inspection._of(json.loads(call.bare(call.run(_truepath.inspect).encode())))
    warn(found.summary["warnings"])
    return found


def identify(
    job: Job,
    touches: Optional[Touches] = None,
    *,
    dimensions: Optional[AnyPath] = None,
    store: Optional[AnyPath] = None,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
    force_data: bool = False,
    progress: Optional[Progress] = None,
) -> Identification:
    """Machine and material from the touches of an uncorrected part, as :func:`correct` identifies them.

    Arguments and errors are those of :func:`correct`; nothing goes into the store.
    """
    with Call(job, progress) as call:
        call.measured(touches, dimensions)
        _measured(call, feature, depth, force_data, store)
        told = json.loads(call.bare(call.run(_truepath.identify).encode()))
    warn(told["warnings"])
    return Identification._of(told)


def correct(
    job: Job,
    touches: Optional[Touches] = None,
    *,
    dimensions: Optional[AnyPath] = None,
    store: Optional[AnyPath] = None,
    sign: Optional[AnyPath] = None,
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
        dimensions: widths, diameters and distances that were measured beside the touches or in their place: a file or its
            text, as ``docs/dimensions.md`` has it.
        store: a shop store, a file or ``postgres://user@host/database``: it says what other jobs know where the job has
            ``prior = "shop"``, and the part goes into it. Without it the one that ``TRUEPATH_STORE`` or the job names is
            asked, and no part goes in.
        sign: sign images with this private key (``truepath key new``).
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
        call.measured(touches, dimensions)
        _measured(call, feature, depth, force_data, store)
        _written(call, route, tolerance_mm, sign)
        call.run(_truepath.correct)
        correction = Correction._of(call.files())
        unkept = call.unkept(store, "correct")
    warn([*correction.summary["warnings"], *unkept])
    return correction


def plan(
    job: Job,
    touches: Touches,
    *,
    tolerance_mm: Optional[float] = None,
    confidence_percent: Optional[float] = None,
    write: Union[bool, int] = False,
    store: Optional[AnyPath] = None,
    sign: Optional[AnyPath] = None,
    route: Optional[Route] = None,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
    progress: Optional[Progress] = None,
) -> Plan:
    """Which passes hold a tolerance at every height of the wall, in least time, from the touches of an uncorrected part.

    Args:
        job: the job.
        touches: what was measured; see :func:`correct`.
        tolerance_mm: half the width of the tolerance at every height, mm; otherwise that of ``[part]`` of the job.
        confidence_percent: percent of the machines that the touches allow whose wall has to be within it, 50 to 99.9; 95 if
            not said.
        write: write the program of the choice that is recommended, or of one by its number, from 1.
        store, sign, route, feature, depth, progress: as of :func:`correct`; planned passes do not go into a store.

    Raises:
        TruepathError: as :func:`correct`.
        ValueError: an array of touches of another shape, or with values that are no numbers.
    """
    with Call(job, progress) as call:
        call.measured(touches, None)
        call.says("--output", call.output)
        call.says("--feature", feature)
        call.says("--pass", depth)
        call.says("--store", store)
        call.says("--confidence", _float(confidence_percent))
        call.says("--write", write)
        _written(call, route, tolerance_mm, sign)
        call.run(_truepath.plan)
        planned = Plan._of(call.files())
    warn(planned.summary["warnings"])
    return planned


@overload
def learn(
    job: Job,
    previous: Plan,
    touches: Touches,
    *,
    replan: bool = ...,
    store: Optional[AnyPath] = ...,
    sign: Optional[AnyPath] = ...,
    route: Optional[Route] = ...,
    tolerance_mm: Optional[float] = ...,
    feature: Optional[str] = ...,
    depth: Optional[int] = ...,
    force_data: bool = ...,
    progress: Optional[Progress] = ...,
) -> Plan: ...
@overload
def learn(
    job: Job,
    previous: Union[Correction, AnyPath],
    touches: Optional[Touches] = ...,
    *,
    dimensions: Optional[AnyPath] = ...,
    part: Optional[int] = ...,
    new_cutter: bool = ...,
    store: Optional[AnyPath] = ...,
    sign: Optional[AnyPath] = ...,
    route: Optional[Route] = ...,
    tolerance_mm: Optional[float] = ...,
    feature: Optional[str] = ...,
    depth: Optional[int] = ...,
    force_data: bool = ...,
    progress: Optional[Progress] = ...,
) -> Correction: ...


def learn(
    job: Job,
    previous: Union[Correction, Plan, AnyPath],
    touches: Optional[Touches] = None,
    *,
    dimensions: Optional[AnyPath] = None,
    part: Optional[int] = None,
    new_cutter: bool = False,
    replan: bool = False,
    store: Optional[AnyPath] = None,
    sign: Optional[AnyPath] = None,
    route: Optional[Route] = None,
    tolerance_mm: Optional[float] = None,
    feature: Optional[str] = None,
    depth: Optional[int] = None,
    force_data: bool = False,
    progress: Optional[Progress] = None,
) -> Union[Correction, Plan]:
    """A better correction, from the touches of a part that was cut with the previous one; of planned passes better ones.

    Args:
        job: the job.
        previous: what the measured part was cut with: the correction, or the folder that it was saved into; or a plan whose
            program was written (:meth:`Plan.read` reads that of a folder).
        touches, dimensions: what was measured on that part; see :func:`correct`. Of planned passes touches.
        part: number of that part in the order they were cut, where those between were not touched.
        new_cutter: the next part is cut with a new cutter: its correction is for the force that the parts say a new one needs.
        replan: of planned passes: search for passes anew, instead of designing the same ones anew.
        store, sign, route, tolerance_mm, feature, depth, force_data, progress: as of :func:`correct`.

    Raises:
        TruepathError: as :func:`correct`; a folder that holds no correction, or one of another job.
        ValueError: an array of touches of another shape, or with values that are no numbers; a folder of planned passes.
    """
    planned = isinstance(previous, Plan)
    with Call(job, progress) as call:
        call.measured(touches, dimensions)
        _measured(call, feature, depth, force_data, store)
        _written(call, route, tolerance_mm, sign)
        call.says("--from", _folder_of(call, previous))
        call.says("--part", part)
        call.says("--new-cutter", new_cutter)
        call.says("--replan", replan)
        call.run(_truepath.learn)
        files = call.files()
        result = Plan._of(files) if planned else Correction._of(files)
        unkept = [] if planned else call.unkept(store, "learn")
    warn([*result.summary["warnings"], *unkept])
    return result


def demo(folder: AnyPath) -> Path:
    """Writes the parts of the demonstration: ``corner``, ``corner-helix`` and ``pocket``.

    Each is a folder with ``job.toml``, ``program.nc``, ``plant.toml`` (the machine that cut it), ``probe.txt`` (what was
    touched on it) and the correction.

    Raises:
        TruepathError: files in the way (``F003``) that are not the demonstration's.
    """
    _truepath.demo([f"--output={os.fspath(folder)}"], {"hidden": [], "millimetres": False, "progress": None})
    return Path(folder)


def _measured(
    call: Call, feature: Optional[str], depth: Optional[int], force_data: bool, store: Optional[AnyPath]
) -> None:
    """What all say that fit a model to what was measured."""
    call.says("--output", call.output)
    call.says("--feature", feature)
    call.says("--pass", depth)
    call.says("--force-data", force_data)
    call.says("--store", store)


def _written(call: Call, route: Optional[Route], tolerance_mm: Optional[float], sign: Optional[AnyPath]) -> None:
    """What all say that write a program or an image."""
    call.says("--route", route)
    call.says("--tolerance", _float(tolerance_mm))
    call.says("--sign", sign)


def _folder_of(call: Call, previous: Union[Correction, Plan, AnyPath]) -> str:
    """The folder of a correction or of a plan."""
    if isinstance(previous, (Correction, Plan)):
        folder = call.folder("previous")
        previous.save(folder)
        return folder
    if Path(previous, "planned.nc").exists():
        raise ValueError(f"{os.fspath(previous)!r} holds planned passes: give Plan.read of it")
    return os.fspath(previous)


def _float(value: Optional[float]) -> Optional[float]:
    return None if value is None else float(value)
