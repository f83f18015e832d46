"""The installed package against the command line: `python3 test_truepath.py`, with TRUEPATH naming the program.

`cargo xtask dist --check` runs it in an environment of its own. The parts are those of the demonstration, and one with several contours.
"""

import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
from _thread import interrupt_main
from pathlib import Path

import numpy as np

import truepath

TRUEPATH = os.environ["TRUEPATH"]
PLATE = Path(__file__).resolve().parents[2] / "page/tests/parts/plate"


def command(*words, json_out=False):
    """Runs the program; what it prints."""
    words = [TRUEPATH, "--quiet", *(["--json"] if json_out else []), *map(str, words)]
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE).stdout


def setUpModule():
    global PARTS
    folder = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(folder.cleanup)
    PARTS = truepath.demo(Path(folder.name) / "parts")
    command("demo", "-o", Path(folder.name) / "command")
    assert files(PARTS) == files(Path(folder.name) / "command")
    # Several contours; touched as a machine touches them.
    plate = shutil.copytree(PLATE, PARTS / "plate")
    command("probe", plate / "job.toml", "--dialect", "linuxcnc", "-o", plate / "verify.ngc")
    cut = ["simulate", plate / "job.toml", "--plant", plate / "plant.toml", "--touch", plate / "verify.ngc"]
    command(*cut, "-o", Path(folder.name) / "cut")
    shutil.copy(Path(folder.name) / "cut/probe.txt", plate / "probe.txt")


def files(folder):
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in Path(folder).rglob("*") if p.is_file()}


def touched(path):
    """Ball centres of a LinuxCNC probe file."""
    return np.loadtxt(path)[:, :3]


class Wheel(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        warnings.simplefilter("ignore", truepath.TruepathWarning)

    def enterContext(self, context):  # Python 3.9 has none.
        value = context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)
        return value

    def same(self, result, folder):
        ours, theirs = result.files, files(folder)
        self.assertEqual(sorted(ours), sorted(theirs))
        for name, data in theirs.items():
            self.assertEqual(ours[name], data, name)


class OfTheCommand(Wheel):
    """Every file is that of the command, byte for byte."""

    def test_corrections(self):
        for part, routes in [
            ("corner", ["program"]),
            ("corner-helix", ["program", "coprocessor"]),
            ("pocket", ["program"]),
            ("plate", ["program"]),
        ]:
            for route in routes:
                with self.subTest(part=part, route=route):
                    job, probe = PARTS / part / "job.toml", PARTS / part / "probe.txt"
                    out = self.folder / part / route
                    command("correct", job, "--probe", probe, "--route", route, "-o", out)
                    done = truepath.correct(truepath.Job.read(job), probe, route=route)
                    self.same(done, out)
                    saved = self.folder / "saved" / part / route
                    done.save(saved)
                    self.assertEqual(files(saved), files(out))
                    self.same(truepath.Correction.read(saved), out)
                    with self.assertRaisesRegex(ValueError, "those of a correction.*Correction.read"):
                        truepath.Plan.read(saved)

    def test_what_is_learned(self):
        part = PARTS / "corner-helix"
        first, second, verify = self.folder / "first", self.folder / "second", self.folder / "verify.ngc"
        command("correct", part / "job.toml", "--probe", part / "probe.txt", "-o", first)
        command("probe", part / "job.toml", "--dialect", "linuxcnc", "-o", verify)
        cut = ["simulate", part / "job.toml", "--plant", part / "plant.toml", "--from", first, "--touch", verify]
        command(*cut, "-o", self.folder / "cut")
        probe = self.folder / "cut" / "probe.txt"
        command("learn", part / "job.toml", "--probe", probe, "--from", first, "-o", second)
        job = truepath.Job.read(part / "job.toml")
        before = truepath.correct(job, part / "probe.txt")
        for previous in [before, first]:
            self.same(truepath.learn(job, previous, probe), second)

    def test_passes(self):
        for part in ["corner-helix", "plate"]:
            job, plant = PARTS / part / "job.toml", PARTS / part / "plant.toml"
            for machine in [None, plant]:
                with self.subTest(part=part, machine=machine):
                    out = self.folder / part / str(machine is None)
                    command("simulate", job, "-o", out, *(["--plant", plant] if machine else []))
                    trace = truepath.simulate(truepath.Job.read(job), machine)
                    self.same(trace, out)
        self.assertEqual(set(trace.contour), {p.name for p in (out / "contours").iterdir()})
        self.same(truepath.simulate(truepath.Job.read(job), plant.read_text()), out)

    def test_inspections(self):
        for part in ["corner-helix", "plate"]:
            job, probe = PARTS / part / "job.toml", PARTS / part / "probe.txt"
            told = json.loads(command("inspect", job, "--probe", probe, json_out=True))
            found = truepath.inspect(truepath.Job.read(job), probe)
            self.assertEqual(found.summary, told["summary"])
            self.assertEqual(found.error_mm.tolist(), [c["error_mm"] for c in told["contacts"]])
            self.assertEqual(found.contour.tolist(), [c.get("contour", "") for c in told["contacts"]])


    def test_what_is_typed_in_place_of_touches(self):
        part = PARTS / "pocket"
        job = truepath.Job.read(part / "job.toml")
        command("probe", part / "job.toml", "--dimensions", "-o", self.folder / "sheet.html")
        # As a calliper reads walls with a tenth of a millimetre left on each.
        read = lambda dimension: f'{dimension[1]}{float(dimension[2]) - 0.2:.3f}\n'
        sheet = (self.folder / "sheet.toml").read_text()
        typed = re.sub(r'(nominal ([\d.]+) mm\n(?:[^[]*\n)?value_mm = )""\n', read, sheet)
        measured = self.folder / "dimensions.toml"
        measured.write_text(typed)
        command("correct", part / "job.toml", "--dimensions", measured, "-o", self.folder / "out")
        for given in [measured, measured.read_text()]:
            done = truepath.correct(job, dimensions=given)
            for name in ["correction.csv", "wall.csv", "points.csv"]:
                self.assertEqual(done.files[name], (self.folder / "out" / name).read_bytes(), name)
        told = json.loads(command("inspect", part / "job.toml", "--dimensions", measured, json_out=True))
        errors = truepath.inspect(job, dimensions=measured).error_mm
        self.assertEqual(errors.tolist(), [c["error_mm"] for c in told["contacts"]])
        np.testing.assert_allclose(errors, 0.1, atol=1e-6)
        found = truepath.identify(job, dimensions=measured)
        self.assertEqual(found.parameters["compliance"].value, done.summary["identified"]["compliance"]["value"])
        with self.assertRaises(truepath.TruepathError):
            truepath.correct(job)

    def test_planned_passes_and_what_is_learned_of_them(self):
        folder = self.folder
        part = shutil.copytree(PARTS / "corner-helix", folder / "part")
        # Limits under which a search is short.
        with open(part / "job.toml", "a") as file:
            file.write("\n[plan]\nmax_cuts = 2\nmax_levels = 1\nmax_percent = 100\n")
        job, probe = truepath.Job.read(part / "job.toml"), part / "probe.txt"
        words = ["--tolerance", "0.05", "--write", "1"]
        command("plan", part / "job.toml", "--probe", probe, *words, "-o", folder / "plan")
        plan = truepath.plan(job, probe, tolerance_mm=0.05, write=1)
        ours, theirs = plan.files, files(folder / "plan")
        self.assertEqual(sorted(ours), sorted(theirs))
        # The summary names the folder.
        different = {name for name, data in theirs.items() if ours[name] != data}
        self.assertLessEqual(different, {"summary.json"})
        self.assertEqual(plan.summary["choices"], json.loads(theirs["summary.json"])["choices"])
        self.assertEqual(plan.planned_program.encode(), theirs["planned.nc"])
        self.assertIsNone(truepath.plan(job, probe, tolerance_mm=0.05).planned_program)
        plan.save(folder / "saved")
        self.assertEqual(files(folder / "saved"), ours)

        verify = folder / "verify.ngc"
        command("probe", part / "job.toml", "--dialect", "linuxcnc", "-o", verify)
        cut = ["simulate", part / "job.toml", "--plant", part / "plant.toml", "--program", folder / "plan/planned.nc"]
        command(*cut, "--touch", verify, "-o", folder / "cut")
        touched = folder / "cut" / "probe.txt"
        command("learn", part / "job.toml", "--probe", touched, "--from", folder / "plan", "-o", folder / "next")
        with self.assertRaisesRegex(ValueError, "holds no correction: its files are those of a plan.*Plan.read"):
            truepath.Correction.read(folder / "plan")
        for previous in [plan, truepath.Plan.read(folder / "plan")]:
            learned = truepath.learn(job, previous, touched)
            self.assertIsInstance(learned, truepath.Plan)
            self.assertEqual(learned.planned_program.encode(), (folder / "next" / "planned.nc").read_bytes())
        with self.assertRaisesRegex(ValueError, "Plan.read"):
            truepath.learn(job, folder / "plan", touched)

    def test_images_are_signed(self):
        part, key = PARTS / "corner-helix", self.folder / "key"
        command("key", "new", key)
        done = truepath.correct(truepath.Job.read(part / "job.toml"), part / "probe.txt", route="coprocessor", sign=key)
        image = self.folder / "correction.tpi"
        image.write_bytes(done.image)
        command("image", "verify", image, "--key", f"{key}.pub")
        plain = truepath.correct(truepath.Job.read(part / "job.toml"), part / "probe.txt", route="coprocessor")
        image.write_bytes(plain.image)
        with self.assertRaises(subprocess.CalledProcessError):
            command("image", "verify", image, "--key", f"{key}.pub")

    def test_a_store_takes_parts_and_is_asked(self):
        part, store = PARTS / "corner-helix", self.folder / "shop.db"
        named = '[store]\nmachine = "mill-1"\ncutter = "em-20"\nmaterial = "al"\nprior = "shop"\n'
        text = (part / "job.toml").read_text() + named
        job = truepath.Job.from_text(text, (part / "program.nc").read_text())
        with self.assertWarnsRegex(truepath.TruepathWarning, "not in the store"):
            warnings.simplefilter("always", truepath.TruepathWarning)
            truepath.correct(job, part / "probe.txt", store=store)
        command("store", "init", "--store", store)
        parts = lambda: json.loads(command("store", "status", "--store", store, json_out=True))["parts"]
        self.assertEqual(parts(), 0)
        truepath.correct(job, part / "probe.txt", store=store)
        self.assertEqual(parts(), 1)
        truepath.identify(job, part / "probe.txt", store=store)
        self.assertEqual(parts(), 1)


class Arrays(Wheel):
    def test_columns_are_those_of_the_tables(self):
        part = PARTS / "corner-helix"
        done = truepath.correct(truepath.Job.read(part / "job.toml"), part / "probe.txt")
        table = np.genfromtxt(part / "correction.csv", delimiter=",", names=True)
        for name, array in [
            ("s_mm", done.s_mm),
            ("dx_mm", done.dx_mm),
            ("dy_mm", done.dy_mm),
            ("predicted_error_before_mm", done.error_before_mm),
            ("predicted_error_after_mm", done.error_after_mm),
            ("sigma_mm", done.sigma_mm),
        ]:
            np.testing.assert_array_equal(array, table[name], name)
        self.assertEqual(done.corrected_program.encode(), (part / "corrected.nc").read_bytes())
        self.assertIsNone(done.image)

    def test_a_trace_has_its_shapes_and_its_physics(self):
        part = PARTS / "corner"
        trace = truepath.simulate(truepath.Job.read(part / "job.toml"), part / "plant.toml")
        n = len(trace.s_mm)
        self.assertEqual((trace.force_xy_n.shape, trace.displacement_mm.shape), ((n, 2), (n, 2)))
        np.testing.assert_allclose(np.hypot(*trace.force_xy_n.T), trace.force_n, rtol=1e-3)
        # The papers' machine: a spring of 1150 N/mm in X and in Y, under the force against the cutter.
        np.testing.assert_allclose(np.abs(trace.displacement_mm) * 1150, np.abs(trace.force_xy_n), rtol=0.02, atol=2.0)

    def test_touches_as_an_array_are_those_of_the_file(self):
        for part in ["corner", "corner-helix"]:
            job, probe = truepath.Job.read(PARTS / part / "job.toml"), PARTS / part / "probe.txt"
            of_file, of_array = truepath.correct(job, probe), truepath.correct(job, touched(probe))
            for name in ["correction.csv", "wall.csv", "points.csv"]:
                self.assertEqual(of_array.files[name], of_file.files[name], name)
            # The program names the probe file by its checksum.
            lines = [c.corrected_program.splitlines() for c in (of_array, of_file)]
            self.assertLessEqual(sum(a != b for a, b in zip(*lines)), 1)
            np.testing.assert_array_equal(truepath.inspect(job, touched(probe)).error_mm, truepath.inspect(job, probe).error_mm)

    def test_normals_set_a_touch_of_another_wall_aside(self):
        job = truepath.Job.read(PARTS / "corner" / "job.toml")
        plain = touched(PARTS / "corner" / "probe.txt")
        turned = np.column_stack([plain, [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]])
        right = np.column_stack([plain, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
        self.assertEqual(len(truepath.inspect(job, right).s_mm), 2)
        self.assertEqual(len(truepath.inspect(job, turned).s_mm), 1)

    def test_touches_in_millimetres_stay_so_where_the_job_has_inches(self):
        part = PARTS / "corner"
        toml = (part / "job.toml").read_text()
        inches = toml.replace('format = "linuxcnc"', 'format = "columns"\nunit = "inch"')
        self.assertNotEqual(toml, inches)
        job = truepath.Job.from_text(inches, (part / "program.nc").read_text())
        done = truepath.correct(job, touched(part / "probe.txt"))
        self.assertEqual(done.files["correction.csv"], (part / "correction.csv").read_bytes())

    def test_what_is_identified_is_what_the_correction_is_made_from(self):
        for part in ["corner-helix", "plate"]:
            job, probe = truepath.Job.read(PARTS / part / "job.toml"), PARTS / part / "probe.txt"
            found, done = truepath.identify(job, probe), truepath.correct(job, probe)
            told = {name: truepath.Parameter(**values) for name, values in done.summary["identified"].items()}
            self.assertEqual(found.parameters, told)
            np.testing.assert_allclose(found.residual_mm, found.measured_mm - found.predicted_mm, atol=1e-9)
            self.assertLess(np.sqrt(np.mean(found.residual_mm**2)), 0.1)

    def test_the_wall_of_the_corrected_part_is_better(self):
        part = PARTS / "corner"
        job = truepath.Job.read(part / "job.toml")
        done = truepath.correct(job, part / "probe.txt")
        first, second = (truepath.simulate(job, part / "plant.toml", corrected=c) for c in [None, done])
        self.assertLess(second.summary["max_error_mm"], first.summary["max_error_mm"] / 10)


class Texts(Wheel):
    def test_a_job_of_texts_is_the_job_of_the_files(self):
        part = PARTS / "corner"
        texts = [(part / name).read_text() for name in ["job.toml", "program.nc", "probe.txt"]]
        job = truepath.Job.from_text(texts[0], texts[1])
        self.assertEqual(job.program_text, texts[1])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            done = truepath.correct(job, texts[2])
        # As if the command had been called in the folder of the job.
        out = self.folder / "out"
        words = [TRUEPATH, "-q", "correct", "job.toml", "--probe", "probe.txt", "-o", out]
        subprocess.run(words, check=True, cwd=part, stderr=subprocess.DEVNULL)
        self.same(done, out)
        self.assertEqual([str(w.message) for w in caught], done.summary["warnings"])
        self.assertTrue(all(w.category is truepath.TruepathWarning and w.filename == __file__ for w in caught))

    def test_names_that_lead_out_of_the_folder_are_refused(self):
        for name in ["../program.nc", "/tmp/program.nc"]:
            with self.assertRaises(ValueError):
                truepath.Job.from_text(f'version = 1\nprogram = "{name}"\n', "M30\n")


class Refused(Wheel):
    def error(self, work):
        with self.assertRaises(truepath.TruepathError) as caught:
            work()
        return caught.exception

    def test_a_wrong_job_has_code_place_and_hint(self):
        toml = (PARTS / "corner" / "job.toml").read_text()
        wrong = toml.replace("diameter_mm = 20.0", "diameter_mm = -20.0")
        error = self.error(lambda: truepath.Job.from_text(wrong, "M30\n"))
        line = wrong.splitlines().index("diameter_mm = -20.0") + 1
        self.assertEqual((error.code, error.file, error.line, error.column), ("J006", "job.toml", line, 15))
        self.assertTrue(error.hint)
        self.assertIn(f"J006: job.toml:{line}:15: ", str(error))
        self.assertIn(f"hint: {error.hint}", str(error))

    def test_other_mistakes(self):
        part = PARTS / "corner"
        job = truepath.Job.read(part / "job.toml")
        self.assertEqual(self.error(lambda: truepath.Job.read("nowhere/job.toml")).code, "F001")
        missing = self.error(lambda: truepath.Job.from_text('program = "a.nc"', "M30\n"))
        self.assertEqual(missing.code, "J004")
        self.assertEqual(self.error(lambda: truepath.correct(job, part / "probe.txt", route="both")).code, "C001")
        self.assertEqual(self.error(lambda: truepath.correct(job, part / "probe.txt", tolerance_mm=-1.0)).code, "C001")
        self.assertEqual(self.error(lambda: truepath.learn(job, self.folder, part / "probe.txt")).code[0], "Q")
        torn = self.error(lambda: truepath.correct(job, "27.0 50.0 -10.0\n1 2 3 4 broken\n"))
        self.assertEqual((torn.file, torn.line), ("probe.txt", 1))
        done = truepath.correct(job, part / "probe.txt")
        done.save(self.folder)
        self.assertEqual(self.error(lambda: done.save(self.folder)).code, "F003")
        done.save(self.folder, force=True)

    def test_arrays_of_another_shape(self):
        job = truepath.Job.read(PARTS / "corner" / "job.toml")
        for wrong in [np.zeros(3), np.zeros((2, 4)), np.zeros((0, 3)), [[1.0, math.nan, 0.0]], np.zeros((1, 6))]:
            with self.assertRaises(ValueError):
                truepath.inspect(job, wrong)

    def test_nothing_is_left_behind(self):
        job = truepath.Job.read(PARTS / "corner" / "job.toml")
        with tempfile.TemporaryDirectory() as own:
            code = (
                "import truepath, sys\n"
                "job = truepath.Job.from_text(open(sys.argv[1]).read(), open(sys.argv[2]).read())\n"
                "truepath.correct(job, sys.argv[3])\n"
            )
            part = PARTS / "corner"
            given = [job.path, part / "program.nc", part / "probe.txt"]
            words = [sys.executable, "-W", "ignore", "-c", code, *given]
            subprocess.run(words, check=True, env={**os.environ, "TMPDIR": own})
            self.assertEqual(os.listdir(own), [])


class AtWork(Wheel):
    def setUp(self):
        super().setUp()
        self.job = truepath.Job.read(PARTS / "plate" / "job.toml")
        self.probe = PARTS / "plate" / "probe.txt"

    def test_other_threads_run(self):
        ticks, stop = [], threading.Event()
        thread = threading.Thread(target=lambda: [ticks.append(1) or time.sleep(0.001) for _ in iter(stop.is_set, True)])
        thread.start()
        truepath.correct(self.job, self.probe)
        stop.set()
        thread.join()
        self.assertGreater(len(ticks), 50)

    def test_progress_is_told_and_may_stop_the_work(self):
        told = []
        truepath.correct(self.job, self.probe, progress=told.append)
        self.assertEqual((told, told[-1]), (sorted(told), 1.0))

        def enough(_):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            truepath.correct(self.job, self.probe, progress=enough)

    def test_ctrl_c_is_heard(self):
        # What is started in the background of a shell ignores it, and Python then does not listen.
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, before)
        timer = threading.Timer(0.1, interrupt_main)
        timer.start()
        began = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            while time.monotonic() < began + 60:
                truepath.correct(self.job, self.probe)


if __name__ == "__main__":
    unittest.main()
