# SPDX-License-Identifier: GPL-2.0-or-later
"""Buttons and M-codes: one thing at a time, every M-code gets an answer, a disarming interrupts everything."""

import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

from package import arming, configuration, requests, words
from test_arming import SITUATION, Component
from test_image import write

BUTTONS = ("arm-button", "disarm-button", "reload-button", "new-part-button")


class RequestsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        write(self.folder / "a.tpi", program=1, feature=1)
        self.component = Component(self.folder)
        self.pins = dict.fromkeys(BUTTONS, False)
        self.pins |= {"mcode-request": 4, "mcode-code": 0, "mcode-p": -1.0, "mcode-q": -1.0, "mcode-answered": 4}
        self.pins |= {"mcode-result": 0, "serial-wanted": 7.0, "feature-wanted": 0.0, "enable-switch": True}
        self.said = []
        operator = SimpleNamespace(warn=self.said.append, tell=self.said.append)
        read = configuration.Configuration("XYZ", self.folder, self.folder / "in-use", None, "", "", 921600, "truepath", self.folder / "part")
        self.situation, self.changeable = SITUATION, True
        self.requests = requests.Requests(self.pins, self.component, operator, read)

    def rounds(self, count=40):
        for _ in range(count):
            self.requests.update(self.situation, self.changeable)
            self.component.round()

    def press(self, name):
        self.pins[name] = True
        self.rounds()
        self.pins[name] = False
        self.rounds(2)

    def mcode(self, code, p=-1.0, q=-1.0):
        self.pins |= {"mcode-code": code, "mcode-p": p, "mcode-q": q}
        self.pins["mcode-request"] += 1
        self.rounds(120)
        self.assertEqual(self.pins["mcode-answered"], self.pins["mcode-request"])
        return self.pins["mcode-result"]

    def test_the_button_arms_the_part_of_the_panel(self):
        self.press("arm-button")
        self.assertEqual((self.component.pins["state"], self.component.pins["part-serial"]), (words.ARMED, 7))
        self.assertEqual(self.said, ["armed: part 7, feature 1 pass 1"])
        self.assertEqual(self.requests.refusal, 0)

    def test_a_button_held_down_arms_once(self):
        self.pins["arm-button"] = True
        self.rounds()
        self.component.pins["state"] = words.BYPASS
        self.rounds(200)
        self.assertEqual(self.component.pins["state"], words.BYPASS)

    def test_m160_takes_p_and_q_or_the_panel_s_number(self):
        self.assertEqual(self.mcode(160, p=1.0, q=9.0), 0)
        self.assertEqual(self.component.pins["part-serial"], 9)
        self.component.pins["state"] = words.BYPASS
        self.assertEqual(self.mcode(160), 0)
        self.assertEqual(self.component.pins["part-serial"], 7)

    def test_every_refusal_of_m160_is_answered_and_told(self):
        self.component.refuses = 4
        self.assertEqual(self.mcode(160), 4)
        self.assertEqual(self.mcode(160, p=3.0), arming.NO_IMAGE)
        self.assertEqual(self.mcode(160, q=1.5), arming.SERIAL)
        self.situation = replace(SITUATION, mdi=True)
        self.assertEqual(self.mcode(160), arming.FROM_MDI)
        self.assertEqual(self.requests.refusal, arming.FROM_MDI)
        self.assertEqual(len(self.said), 4)

    def test_with_the_switch_off_m160_lets_the_program_run_and_arms_nothing(self):
        self.pins["enable-switch"] = False
        self.assertEqual(self.mcode(160), 0)
        self.assertEqual(self.component.due, [])
        self.assertIn("uncorrected", self.said[0])

    def test_m161_disarms(self):
        self.mcode(160)
        self.assertEqual(self.mcode(161), 0)
        self.assertEqual(self.component.pins["state"], words.BYPASS)

    def test_a_disarming_interrupts_an_arming_which_is_answered_as_refused(self):
        self.component.deaf = True
        self.pins |= {"mcode-code": 160, "mcode-request": 5}
        self.rounds(10)
        self.press("disarm-button")
        self.assertEqual((self.pins["mcode-answered"], self.pins["mcode-result"]), (5, arming.BUSY))
        self.assertFalse(self.component.pins.get("arm") or self.component.pins.get("reload"))

    def test_an_arming_whose_program_was_aborted_meanwhile_is_taken_back(self):
        self.component.late = 30
        self.pins |= {"mcode-code": 160, "mcode-request": 5}
        self.rounds(50)
        self.situation = replace(SITUATION, running=False)
        self.rounds(200)
        self.assertEqual((self.pins["mcode-answered"], self.pins["mcode-result"]), (5, arming.BUSY))
        self.assertEqual(self.component.pins["state"], words.BYPASS)
        self.assertIn("disarm", [pin for _, pin in self.component.due])

    def test_what_must_end_is_ended_once_and_told_once(self):
        self.press("arm-button")
        self.component.deaf = True
        for _ in range(10):
            self.requests.end("another program")
            self.rounds(1)
        self.assertEqual([s for s in self.said if "another program" in s], ["disarmed: another program"])

    def test_the_image_of_a_program_is_handed_over_before_anyone_arms_but_not_while_something_is_on(self):
        self.changeable = False
        self.requests.program_changed()
        self.rounds()
        self.assertEqual((self.requests.image_crc, self.component.pins["image-ready"]), (0, 0))
        self.changeable = True
        self.rounds()
        self.assertEqual(self.requests.image_crc, self.component.pins["image-crc"])
        self.assertEqual(self.said, [])

    def test_a_new_part_counts_up_after_the_one_before_was_armed_and_a_program_run_again_does_not(self):
        self.pins["serial-wanted"] = 0.0
        self.assertEqual(self.mcode(160), arming.SERIAL)
        self.press("new-part-button")
        self.press("new-part-button")
        self.assertEqual(self.said[1:], ["part 1", "part 1 is not milled yet: it keeps its number"])
        self.assertEqual((self.mcode(160), self.component.pins["part-serial"]), (0, 1))
        self.component.pins["state"] = words.BYPASS
        self.assertEqual((self.requests.part, self.mcode(160)), (1, 0))
        self.component.pins["state"] = words.BYPASS
        self.press("new-part-button")
        self.assertEqual((self.requests.part, self.mcode(160), self.component.pins["part-serial"]), (2, 0, 2))

    def test_no_number_is_counted_while_something_is_armed(self):
        self.pins["serial-wanted"] = 0.0
        self.changeable = False
        self.press("new-part-button")
        self.assertEqual((self.requests.part, self.said), (0, ["a correction is armed or on: disarm first"]))

    def test_a_number_of_another_panel_is_taken_and_counted_on_from(self):
        self.press("arm-button")
        self.component.pins["state"] = words.BYPASS
        self.pins["serial-wanted"] = 0.0
        self.press("new-part-button")
        self.assertEqual(self.requests.part, 8)

    def test_a_part_that_the_ledger_knows_already_has_its_number_behind_it(self):
        self.pins["serial-wanted"] = 0.0
        self.press("new-part-button")
        self.component.refuses = 4
        self.assertEqual(self.mcode(160), 4)
        self.press("new-part-button")
        self.assertEqual(self.requests.part, 2)

    def test_why_there_is_no_image_is_shown_and_several_are_named_before_anyone_arms(self):
        self.situation = replace(SITUATION, program_crc=3)
        self.requests.program_changed()
        self.rounds()
        self.assertEqual((self.requests.image_state, self.said), ("image-missing", []))
        (self.folder / "later").mkdir()
        write(self.folder / "later" / "b.tpi", program=1, feature=1, pass_number=2)
        self.situation = SITUATION
        self.requests.program_changed()
        self.rounds()
        self.assertEqual(self.requests.image_state, "image-several")
        self.assertTrue(len(self.said) == 1 and "later/b.tpi" in self.said[0], self.said)
        (self.folder / "a.tpi").unlink()
        self.requests.program_changed()
        self.rounds()
        self.assertEqual((self.requests.image_state, self.requests.image_crc != 0), ("", True))

    def test_reload_says_what_came_of_it(self):
        self.press("reload-button")
        self.assertEqual(self.said, ["image of a.tpi"])
        self.situation = replace(SITUATION, program_crc=3)
        self.press("reload-button")
        self.assertIn("00000003", self.said[1])
