# SPDX-License-Identifier: GPL-2.0-or-later
"""What truepath-config asks of a board, with a program in place of `truepath device` that writes down what it was asked."""

import json
import tempfile
import time
import unittest
from pathlib import Path
from types import SimpleNamespace

import package  # noqa: F401 (where the package is)
from truepath_config import board

ASKED = "#!/bin/sh\nshift 6\necho \"$*\" >> %s/asked\ncase $1 in %s esac\n"


class BoardTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.now = 0.0

    def board(self, answers):
        program = self.folder / "truepath"
        program.write_text(ASKED % (self.folder, " ".join("%s) %s ;;" % item for item in answers.items())))
        program.chmod(0o755)
        configuration = SimpleNamespace(truepath=str(program), config_port="/dev/null", config_baud=9600)
        return board.Board(configuration, lambda: self.now)

    def end(self, steps):
        for _ in range(2000):
            try:
                next(steps)
            except StopIteration as end:
                return end.value
            time.sleep(0.005)
        self.fail("the steps do not end")

    def asked(self):
        return (self.folder / "asked").read_text().splitlines()

    def test_an_image_the_board_has_is_activated_and_another_is_sent(self):
        slots = json.dumps(["Empty", {"Image": {"crc": 5, "active": False}}])
        made = self.board({"list": "echo '%s'" % slots, "activate": "echo '{}'", "upload": "echo '{}'"})
        there, other = SimpleNamespace(crc=5, path=Path("a.tpi")), SimpleNamespace(crc=6, path=Path("b.tpi"))
        self.assertTrue(self.end(made.use(there)).done)
        self.assertEqual((self.asked(), made.image_crc), (["list", "activate 1"], 5))
        self.assertTrue(self.end(made.use(other)).done)
        self.assertEqual((self.asked()[2:], made.image_crc), (["list", "upload b.tpi --activate"], 6))

    def test_a_refusal_is_told_in_the_words_of_the_device(self):
        made = self.board({"list": "echo 'error H004: the device\nrefuses' >&2; exit 1"})
        answer = self.end(made.use(SimpleNamespace(crc=5, path=Path("a.tpi"))))
        self.assertEqual(answer, board.Answer(False, "error H004: the device refuses"))
        self.assertEqual(made.image_crc, 0)

    def test_of_an_error_in_json_what_was_found_is_told(self):
        made = self.board({"list": "echo '{\"error\": {\"code\": \"H004\", \"found\": \"the device refuses\"}}' >&2; exit 1"})
        self.assertEqual(self.end(made.ask("list")).text, "the device refuses")

    def test_a_program_that_is_missing_says_something_else_or_hangs_is_a_refusal(self):
        made = self.board({"list": "echo no JSON", "arm": "sleep 60"})
        self.assertFalse(self.end(made.ask("list")).done)
        asking = made.ask("arm")
        next(asking)
        self.now += board.PATIENCE_S + 1
        self.assertIn("does not answer", self.end(asking).text)
        (self.folder / "truepath").unlink()
        self.assertFalse(self.end(made.ask("list")).done)

    def test_the_arming_says_what_the_component_sends(self):
        made = self.board({"arm": "echo '{}'"})
        pins = {"nm-per-unit": 1e6, "offset-x": 150.0000004, "offset-y": -0.0000015, "offset-z": -120.0}
        pins.update({"part-serial": 7, "program-crc": 0xAB, "feature": 1, "pass": 2, "tool": 3, "tool-offset": 4})
        pins.update({"setup": 5, "frame-cosine": 0, "frame-sine": -(1 << 30)})
        self.assertTrue(self.end(made.arm(pins.get)).done)
        self.assertEqual(
            self.asked(),
            [
                "arm --part 7 --program-crc 000000ab --feature 1 --pass 2 --tool 3 --tool-offset 4 --setup 5"
                " --cosine=0 --sine=-1073741824 --offset-nm=150000000,-2,-120000000"
            ],
        )

    def test_a_board_that_is_off_is_acknowledged_once_the_drives_are_off_and_the_link_is_there(self):
        made = self.board({"acknowledge": "echo '{}'"})
        made.image_crc = 9
        for state, lost, drives in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
            made.acknowledge({"state": state, "link-lost": lost, "drives-on": drives}.get)
        self.assertEqual((made.image_crc, (self.folder / "asked").exists()), (9, False))
        for _ in range(200):
            made.acknowledge({"state": board.OFF, "link-lost": 0, "drives-on": 0}.get)
            time.sleep(0.002)
        self.assertEqual((self.asked(), made.image_crc), (["acknowledge"], 0))


if __name__ == "__main__":
    unittest.main()
