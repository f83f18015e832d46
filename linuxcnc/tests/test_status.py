# SPDX-License-Identifier: GPL-2.0-or-later
"""LinuxCNC's status as truepath-config reads it."""

import unittest
from types import SimpleNamespace

import package  # noqa: F401
from truepath_config.status import Source


class StatusTest(unittest.TestCase):
    def setUp(self):
        zero = (0.0,) * 9
        self.stat = SimpleNamespace(
            poll=lambda: None, linear_units=1.0, joints=3, tool_table=(), g5x_index=2, gcodes=(550, 490), g5x_offset=zero,
            g92_offset=zero, tool_offset=zero, rotation_xy=0.0, tool_in_spindle=3, file="a.ngc", interp_state=2, task_mode=2,
            kinematics_type=1,
        )  # fmt: skip
        linuxcnc = SimpleNamespace(
            stat=lambda: self.stat, error=RuntimeError, INTERP_IDLE=1, MODE_AUTO=2, MODE_MDI=3, KINEMATICS_IDENTITY=1
        )
        self.source = Source(linuxcnc)

    def test_everything_that_is_asked_for_is_read(self):
        status = self.source.look()
        self.assertEqual((status.work_offset, status.tool, status.tool_offset, status.program), (2, 3, 0, "a.ngc"))
        self.assertTrue(status.running and status.identity_kinematics)

    def test_before_motion_has_reported_there_is_nothing(self):
        self.stat.joints = 0
        self.assertIsNone(self.source.look())


if __name__ == "__main__":
    unittest.main()
