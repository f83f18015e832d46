"""What a user's checker sees of the package: it is only checked, not run."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

import truepath


def corrected(folder: Path, touches: npt.NDArray[np.float64]) -> float:
    job = truepath.Job.read(folder / "job.toml")
    try:
        correction = truepath.correct(job, touches, route="program", progress=lambda share: print(share))
    except truepath.TruepathError as error:
        line: int = error.line or 0
        print(error.code, error.file, line, error.column, error.hint)
        return 0.0
    correction.save(folder / "out")
    better: truepath.Correction = truepath.learn(job, correction, folder / "probe.txt", part=2, new_cutter=True)
    trace = truepath.simulate(job, folder / "plant.toml", corrected=better)
    displacement: npt.NDArray[np.float64] = trace.displacement_mm
    compliance: truepath.Parameter = truepath.identify(job, [[27.0, 50.0, -10.0]]).parameters["compliance"]
    program: str = correction.corrected_program or ""
    print(len(program), compliance.value, displacement.shape, truepath.inspect(job, "1 2 3\n").verdict)
    return float(correction.error_after_mm.max())


def planned(folder: Path) -> int:
    job = truepath.Job.read(folder / "job.toml")
    plan = truepath.plan(job, folder / "probe.txt", tolerance_mm=0.05, write=True)
    better: truepath.Plan = truepath.learn(job, plan, folder / "probe-2.txt", replan=True)
    typed = truepath.correct(job, dimensions=folder / "dimensions.toml", store="shop.db", sign=folder / "key")
    plan.save(folder / "planned")
    return len(better.planned_program or "") + len(typed.image or b"")


def wrong(job: truepath.Job) -> None:
    truepath.correct(job, "probe.txt", route="both")  # type: ignore[arg-type]
    truepath.simulate(job).nothing  # type: ignore[attr-defined]
    truepath.learn(job)  # type: ignore[call-overload]
    truepath.plan(job)  # type: ignore[call-arg]
