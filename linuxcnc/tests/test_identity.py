# SPDX-License-Identifier: GPL-2.0-or-later
"""What runs is told by the bytes of the program, the tool offset by the table, feature and pass by the P word."""

import tempfile
import unittest
import zlib
from pathlib import Path

from package import identity

TABLE = ((1, (0.0, 0.0, 40.0)), (2, (0.0, 0.0, 35.5)), (3, (0.0, 0.0, 35.5)))
G43, G49 = (0, 430, 540), (0, 490, 540)


class ProgramTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "p.ngc"
        self.path.write_bytes(b"G0 X1\n")
        self.program = identity.Program()

    def test_the_crc_is_that_of_the_bytes(self):
        self.assertTrue(self.program.update(str(self.path)))
        self.assertEqual(self.program.crc, zlib.crc32(b"G0 X1\n"))
        self.assertFalse(self.program.update(str(self.path)))

    def test_a_file_written_anew_is_another_program_unless_it_is_the_same_to_the_byte(self):
        self.program.update(str(self.path))
        self.path.unlink()
        self.path.write_bytes(b"G0 X1\n")
        self.assertFalse(self.program.update(str(self.path)))
        self.path.write_bytes(b"G0 X10\n")
        self.assertTrue(self.program.update(str(self.path)))

    def test_no_file_and_a_file_that_is_gone_have_the_crc_0(self):
        self.program.update(str(self.path))
        self.path.unlink()
        self.assertTrue(self.program.update(str(self.path)))
        self.assertEqual(self.program.crc, 0)
        self.assertTrue(self.program.update(""))


class WorkOffsetTest(unittest.TestCase):
    def test_it_is_the_index_when_the_modal_code_says_the_same(self):
        for number, code in enumerate((540, 550, 560, 570, 580, 590, 591, 592, 593), start=1):
            self.assertEqual(identity.work_offset(number, (0, code, 490)), number)

    def test_a_status_that_contradicts_itself_is_0(self):
        for index, codes in ((0, (540,)), (2, (540,)), (1, ()), (1, (540, 550))):
            self.assertEqual(identity.work_offset(index, codes), 0)


class ToolOffsetTest(unittest.TestCase):
    def number(self, gcodes, offset, spindle):
        return identity.tool_offset_number(gcodes, offset, spindle, TABLE)

    def test_g49_is_0(self):
        self.assertEqual(self.number(G49, (0.0, 0.0, 0.0), 1), 0)

    def test_g43_is_the_tool_in_the_spindle_when_its_entry_is_the_offset(self):
        self.assertEqual(self.number(G43, (0.0, 0.0, 40.0), 1), 1)
        self.assertEqual(self.number(G43, (0.0, 0.0, 35.5), 3), 3)

    def test_g43_with_the_h_of_another_tool_is_that_tool_if_only_one_has_the_offset(self):
        self.assertEqual(self.number(G43, (0.0, 0.0, 40.0), 2), 1)
        self.assertEqual(self.number(G43, (0.0, 0.0, 35.5), 1), identity.UNKNOWN)

    def test_an_offset_that_no_tool_has_cannot_be_told(self):
        self.assertEqual(self.number(G43, (0.0, 0.0, 12.3), 1), identity.UNKNOWN)
        self.assertEqual(self.number((0, 431), (0.0, 0.0, 12.3), 1), identity.UNKNOWN)


class FeatureTest(unittest.TestCase):
    def test_p_is_the_feature_and_its_tenths_the_pass(self):
        self.assertEqual(identity.feature_and_pass(3.0), (3, None))
        self.assertEqual(identity.feature_and_pass(3.2), (3, 2))
        self.assertEqual(identity.feature_and_pass(12.9), (12, 9))

    def test_no_p_asks_for_nothing(self):
        for p in (-1.0, 0.0, 0.5, 1e9, float("nan"), float("inf")):
            self.assertEqual(identity.feature_and_pass(p), (None, None), p)
