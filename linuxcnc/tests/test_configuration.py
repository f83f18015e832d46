# SPDX-License-Identifier: GPL-2.0-or-later
"""What in an INI file forbids a correction."""

import unittest
from pathlib import Path

from package import configuration as module

SAMPLE = Path(__file__).resolve().parents[1] / "sim" / "truepath-mill.ini"


class Ini:
    """An INI file as linuxcnc.ini reads it: the first value of a key."""

    def __init__(self, text):
        self.values, section = {}, ""
        for line in text.splitlines():
            line = line.strip()
            if line.startswith("["):
                section = line.strip("[]")
            elif line and not line.startswith("#"):
                key, value = line.split("=", 1)
                self.values.setdefault((section, key.strip()), value.strip())

    def find(self, section, key):
        return self.values.get((section, key)) or None

    def set(self, section, key, value):
        self.values[section, key] = value
        return self


def sample():
    return Ini(SAMPLE.read_text())


def load(ini):
    return module.load(ini, Path("/machine"))


class ConfigurationTest(unittest.TestCase):
    def test_the_sample_machine_has_no_problems(self):
        read = load(sample())
        self.assertEqual(read.problems, [])
        self.assertEqual((read.coordinates, read.setup, read.port), ("XYZ", None, ""))
        self.assertEqual(read.images, Path("/machine/programs"))

    def test_planner_and_correction_together_must_fit_into_the_joint(self):
        for key in ("MAX_VELOCITY", "MAX_ACCELERATION"):
            for joint in (0, 1):
                ini = sample().set("JOINT_%d" % joint, key, "51" if key == "MAX_VELOCITY" else "1200")
                problems = load(ini).problems
                self.assertEqual(len(problems), 1, problems)
                self.assertIn("[JOINT_%d]%s" % (joint, key), problems[0])
        self.assertEqual(load(sample().set("JOINT_2", "MAX_VELOCITY", "40")).problems, [])

    def test_exactly_as_much_as_the_joint_can_do_is_enough(self):
        self.assertEqual(load(sample().set("TRUEPATH", "MAX_CORRECTION_VEL", "20.0")).problems, [])
        self.assertEqual(len(load(sample().set("TRUEPATH", "MAX_CORRECTION_VEL", "20.01")).problems), 2)

    def test_a_missing_or_unreadable_limit_proves_nothing(self):
        for section, key in (("AXIS_X", "MAX_VELOCITY"), ("JOINT_1", "MAX_ACCELERATION")):
            self.assertEqual(len(load(sample().set(section, key, "fast")).problems), 1)
        for value in ("", "0", "-1", "nan"):
            self.assertTrue(load(sample().set("TRUEPATH", "MAX_CORRECTION_ACCEL", value)).problems, value)

    def test_only_trivial_kinematics_with_the_same_letters(self):
        for value in ("", "corexykins", "trivkins coordinates=XYYZ", "trivkins coordinates=XZY"):
            self.assertEqual(len(load(sample().set("KINS", "KINEMATICS", value)).problems), 1, value)
        self.assertEqual(load(sample().set("KINS", "KINEMATICS", "trivkins")).problems, [])

    def test_both_joints_of_a_gantry_are_looked_at(self):
        ini = sample().set("KINS", "KINEMATICS", "trivkins coordinates=XYYZ kinstype=BOTH")
        ini.set("TRUEPATH", "COORDINATES", "XYYZ").set("JOINT_2", "MAX_VELOCITY", "50").set("JOINT_3", "MAX_VELOCITY", "60")
        problems = load(ini).problems
        self.assertEqual(len(problems), 1, problems)
        self.assertIn("JOINT_2", problems[0])

    def test_what_truepath_config_cannot_run_without_is_said(self):
        for key, value in (("COORDINATES", "XY"), ("COORDINATES", "XYQ"), ("IMAGES", ""), ("IMAGE", ""), ("SETUP", "0"), ("SEVERAL_IMAGES", "newest")):
            with self.assertRaises(module.Wrong) as caught:
                load(sample().set("TRUEPATH", key, value))
            self.assertIn(key, str(caught.exception))

    def test_the_latest_of_several_images_wins_where_that_is_said(self):
        self.assertFalse(load(sample()).latest_wins)
        self.assertTrue(load(sample().set("TRUEPATH", "SEVERAL_IMAGES", "latest-wins")).latest_wins)

    def test_the_setup_is_a_number_or_that_of_the_work_offset(self):
        self.assertEqual(load(sample().set("TRUEPATH", "SETUP", "3")).setup, 3)

    def test_the_port_of_a_board_is_among_the_parameters_of_the_component(self):
        self.assertEqual(load(sample().set("TRUEPATH", "BOARD", "baud=115200 port=/dev/ttyS1")).port, "/dev/ttyS1")
