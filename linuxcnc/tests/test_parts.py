# SPDX-License-Identifier: GPL-2.0-or-later
"""The number of the part over restarts, and files that are none."""

import tempfile
import unittest
from pathlib import Path

from package import parts as module


class PartsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "truepath.part"

    def read(self):
        return module.Parts(self.path)

    def test_it_is_kept_over_restarts_and_so_is_that_it_was_armed(self):
        self.assertEqual((self.read().number, self.read().used), (0, True))
        self.assertEqual(self.read().next(), "part 1")
        again = self.read()
        self.assertEqual((again.number, again.used), (1, False))
        self.assertIn("keeps its number", again.next())
        self.assertEqual(again.armed(1), "")
        self.assertEqual(self.read().next(), "part 2")
        self.assertEqual([p.name for p in self.path.parent.iterdir()], ["truepath.part"])

    def test_a_number_armed_beside_it_is_counted_on_from_and_a_lower_one_is_not(self):
        parts = self.read()
        parts.armed(41)
        parts.armed(7)
        self.assertEqual(self.read().next(), "part 42")

    def test_a_file_that_is_no_number_is_told_and_not_believed(self):
        for text in ("", "many", "-3", "3 perhaps", "3 used twice", "\u00bd"):
            self.path.write_text(text, encoding="utf-8")
            found = self.read()
            self.assertEqual((found.number, found.used), (0, True), text)
            self.assertIn(str(self.path), found.trouble)
        self.path.unlink()
        self.path.mkdir()
        self.assertIn("cannot be read", self.read().trouble)

    def test_a_number_that_cannot_be_kept_is_used_and_told(self):
        parts = module.Parts(self.path.parent / "missing" / "truepath.part")
        self.assertIn("cannot be kept", parts.next())
        self.assertEqual(parts.number, 1)
