# SPDX-License-Identifier: GPL-2.0-or-later
"""The image that belongs to a program, a feature, a pass and a tool is found, and copied whole."""

import os
import struct
import tempfile
import unittest
from pathlib import Path

from package import image as module


def write(path, program=1, feature=1, pass_number=1, tool=1, tool_offset=0, setup=1, tail=b"\0" * 16):
    """A file with the head of an image; the crc is what stands in its last four bytes."""
    body = bytearray(module.HEADER_BYTES) + tail
    body[:8] = module.MAGIC
    struct.pack_into("<I", body, 16, len(body))
    struct.pack_into("<6I", body, 24, program, feature, pass_number, tool, tool_offset, setup)
    struct.pack_into("<I", body, len(body) - 4, hash((program, feature, pass_number, tool)) & 0xFFFF_FFFF)
    path.write_bytes(body)
    return path


class ImageTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def choose(self, program=1, feature=None, pass_number=None, tool=1, latest_wins=False):
        images = module.folder(self.folder)
        return module.choose(images, program, feature, pass_number, tool, self.folder, latest_wins)

    def refused(self, **asked):
        with self.assertRaises(module.NoImage) as caught:
            self.choose(**asked)
        return str(caught.exception)

    def test_the_binding_of_the_head_is_read(self):
        found = module.read(write(self.folder / "a.tpi", 0xDEAD, 2, 3, 4, 5, 6))
        numbers = (found.program_crc, found.feature, found.pass_number, found.tool, found.tool_offset, found.setup)
        self.assertEqual(numbers, (0xDEAD, 2, 3, 4, 5, 6))

    def test_other_files_damaged_heads_and_cut_off_images_are_passed_over(self):
        whole = write(self.folder / "a.tpi").read_bytes()
        (self.folder / "cut.tpi").write_bytes(whole[:-1])
        (self.folder / "short.tpi").write_bytes(whole[:100])
        (self.folder / "other.tpi").write_bytes(b"X" + whole[1:])
        (self.folder / "empty.tpi").touch()
        (self.folder / "folder.tpi").mkdir()
        self.assertEqual([i.path.name for i in module.folder(self.folder)], ["a.tpi"])

    def test_the_program_decides_and_its_number_is_told_when_there_is_none(self):
        below = self.folder / "part"
        below.mkdir()
        write(below / "b.tpi", program=2)
        write(self.folder / "a.tpi", program=1)
        self.assertEqual(self.choose(program=2).path.name, "b.tpi")
        self.assertIn("0000002a", self.refused(program=42))

    def test_feature_and_pass_choose_among_several_and_are_asked_for_when_they_are_open(self):
        write(self.folder / "a.tpi", feature=1)
        write(self.folder / "b.tpi", feature=2)
        write(self.folder / "c.tpi", feature=2, pass_number=2)
        self.assertEqual(self.choose(feature=1).path.name, "a.tpi")
        self.assertEqual(self.choose(feature=2, pass_number=2).path.name, "c.tpi")
        self.assertIn("name feature and pass", self.refused(feature=2))
        self.assertIn("feature 3", self.refused(feature=3))
        self.assertIn("pass 9", self.refused(feature=2, pass_number=9))

    def test_the_tool_decides_between_two_and_a_single_image_for_another_tool_is_left_to_the_component(self):
        write(self.folder / "a.tpi", tool=1)
        self.assertEqual(self.choose(tool=7).tool, 1)
        write(self.folder / "b.tpi", tool=2)
        self.assertEqual(self.choose(tool=2).tool, 2)

    def test_several_for_one_program_are_named_with_their_folders_and_the_latest_wins_where_that_is_wanted(self):
        paths = [self.folder / part / "correction.tpi" for part in ("part-1", "part-2", "part-0")]
        for k, path in enumerate(paths):
            path.parent.mkdir()
            data = bytearray(write(path).read_bytes())
            data[-4] ^= k  # another crc: another correction of the same pass
            path.write_bytes(data)
            os.utime(path, ns=(0, 10 + (k == 1)))
        said = self.refused()
        self.assertTrue(all("part-%d/correction.tpi" % k in said for k in range(3)), said)
        self.assertIn("SEVERAL_IMAGES", said)
        self.assertEqual(self.choose(latest_wins=True).path, paths[1])
        # Another pass is none of several alternatives, whatever its age.
        write(self.folder / "b.tpi", pass_number=2)
        self.assertIn("name feature and pass", self.refused(latest_wins=True))
        self.assertEqual(self.choose(latest_wins=True, pass_number=1).path, paths[1])

    def test_two_copies_of_one_image_count_once(self):
        write(self.folder / "a.tpi")
        write(self.folder / "copy.tpi")
        self.assertEqual(self.choose().path.name, "a.tpi")

    def test_the_copy_is_whole_and_leaves_nothing_behind(self):
        source = write(self.folder / "a.tpi", tail=bytes(100_000))
        target = self.folder / "in-use"
        target.write_bytes(b"old")
        module.hand_over(module.read(source), target)
        self.assertEqual(target.read_bytes(), source.read_bytes())
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["a.tpi", "in-use"])
