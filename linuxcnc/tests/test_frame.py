# SPDX-License-Identifier: GPL-2.0-or-later
"""The frame is LinuxCNC's: g5x + R · (program + g92) + tool offset."""

import math
import unittest

from package import frame as module

frame, TURN_ONE = module.frame, module.TURN_ONE
ZERO = (0.0, 0.0, 0.0)


class FrameTest(unittest.TestCase):
    def test_without_a_turn_all_offsets_add_up(self):
        f = frame((150, 100, -120), (13, 7, 1), (0, 0, 40), 0.0)
        self.assertEqual(f.offset, (163, 107, -79))
        self.assertEqual((f.cosine, f.sine), (TURN_ONE, 0))

    def test_the_turn_applies_to_program_and_g92_not_to_g5x_and_tool(self):
        f = frame((100, 0, 0), (10, 0, 0), (1, 2, 3), 90.0)
        self.assertEqual(f.machine((5, 0, 0)), (101.0, 17.0, 3.0))

    def test_a_point_goes_where_linuxcnc_2_9_moved_its_joints(self):
        # joint.N.pos-cmd after G10 L2 P1 X150 Y100 Z-120 R30, G0 X10 Y20 Z90, G92 X-3 Y33 Z80, and what is named here.
        moved = (
            ("G0 X12 Y13 Z75", 0, (12, 13, 75), (171.65063509461098, 112.5, -35.0)),
            ("G43 H1, G0 X10 Y20 Z45", 40, (10, 20, 45), (166.41858428704208, 117.56217782649107, -25.0)),
        )
        for words, length, point, joints in moved:
            f = frame((150, 100, -120), (13, -13, 10), (0, 0, length), 30.0)
            for found, joint in zip(f.machine(point), joints):
                self.assertAlmostEqual(found, joint, delta=1e-7, msg=words)

    def test_quarter_turns_are_exact(self):
        for degrees, turn in ((90, (0, 1)), (180, (-1, 0)), (270, (0, -1)), (-90, (0, -1)), (360, (1, 0))):
            f = frame(ZERO, ZERO, ZERO, degrees)
            self.assertEqual((f.cosine, f.sine), (turn[0] * TURN_ONE, turn[1] * TURN_ONE))

    def test_cosine_and_sine_are_those_of_one_angle_as_the_core_asks(self):
        for tenths in range(0, 3600, 7):
            f = frame(ZERO, ZERO, ZERO, tenths / 10)
            self.assertLessEqual(abs(f.cosine**2 + f.sine**2 - TURN_ONE**2), TURN_ONE << 4)
            self.assertAlmostEqual(math.degrees(math.atan2(f.sine, f.cosine)) % 360, tenths / 10 % 360, places=6)
