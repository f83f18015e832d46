# SPDX-License-Identifier: GPL-2.0-or-later
"""From a request to armed or refused: every refusal has its number, and nothing waits for ever."""

import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

from package import arming, configuration, image, words
from test_image import write

SITUATION = arming.Situation(program_crc=1, tool=1, tool_offset=0, mdi=False, external_offset=False, permitted=True)
REQUEST = arming.Request(feature=1, pass_number=None, serial=7)


class Component:
    """The real-time component, as truepath-config sees it: takes an image and an arming some rounds after the edge."""

    def __init__(self, folder):
        self.board = None
        self.pins = dict.fromkeys(("image-ready", "image-crc", "image-error", "state", "refusal", "armed-serial"), 0)
        self.pins["state"] = words.BYPASS
        self.folder, self.refuses, self.deaf, self.late, self.error = folder, 0, False, 3, 0
        self.due = []

    def get(self, pin):
        return self.pins[pin]

    def set(self, pin, value):
        rising = value is True and not self.pins.get(pin)
        self.pins[pin] = value
        if rising and not self.deaf:
            self.due.append([self.late, pin])

    def round(self):
        for entry in self.due:
            entry[0] -= 1
            if entry[0] == 0:
                getattr(self, "do_" + entry[1])()

    def do_reload(self):
        found = image.read(self.folder / "in-use")
        self.pins.update({"image-ready": not self.error, "image-error": self.error, "image-crc": found.crc})

    def do_arm(self):
        self.pins["refusal"] = self.refuses
        if not self.refuses:
            self.pins.update({"state": words.ARMED, "armed-serial": self.pins["part-serial"]})

    def do_disarm(self):
        self.pins["state"] = words.BYPASS


class ArmingTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        write(self.folder / "a.tpi", program=1, feature=1)
        write(self.folder / "b.tpi", program=1, feature=2, pass_number=3)
        self.component = Component(self.folder)
        self.configuration = configuration.Configuration(
            "XYZ", self.folder, self.folder / "in-use", None, "", "", 921600, "truepath"
        )

    def run_steps(self, steps):
        """To the end; the time in seconds and the result."""
        for rounds in range(2000):
            try:
                next(steps)
            except StopIteration as end:
                return rounds * 0.01, end.value
            self.now = rounds * 0.01
            self.component.round()
        self.fail("the steps do not end")

    def arm(self, situation=SITUATION, request=REQUEST):
        self.now = 0.0
        steps = arming.arm(self.component, lambda: self.now, self.configuration, situation, request)
        return self.run_steps(steps)

    def test_the_image_is_handed_over_and_the_part_is_armed(self):
        seconds, result = self.arm(request=replace(REQUEST, feature=2))
        self.assertEqual(result.code, 0, result.text)
        self.assertLess(seconds, 0.3)
        self.assertEqual([self.component.pins[p] for p in ("feature", "pass", "part-serial")], [2, 3, 7])
        self.assertEqual([self.component.pins[p] for p in ("arm", "reload")], [False, False])
        self.assertEqual((self.folder / "in-use").read_bytes(), (self.folder / "b.tpi").read_bytes())

    def test_an_image_in_use_is_not_handed_over_again(self):
        self.arm()
        self.component.pins["state"] = words.BYPASS
        (self.folder / "in-use").unlink()
        self.assertEqual(self.arm(request=replace(REQUEST, serial=8))[1].code, 0)
        self.assertFalse((self.folder / "in-use").exists())

    def test_the_component_s_refusal_is_the_answer_also_when_it_is_the_same_as_last_time(self):
        for before in (0, 19, 4):
            self.component.pins["refusal"], self.component.refuses = before, 4
            seconds, result = self.arm()
            self.assertEqual(result.code, 4)
            self.assertIn("gouge", result.text)
            self.assertLess(seconds, 1.0)

    def test_a_refusal_of_last_time_is_not_taken_for_one_of_now(self):
        self.component.pins["refusal"], self.component.late = 4, 20
        self.assertEqual(self.arm()[1].code, 0)

    def test_a_component_that_does_not_answer_is_told_and_not_waited_for(self):
        self.component.pins.update({"image-ready": 1, "image-crc": image.read(self.folder / "a.tpi").crc})
        self.component.deaf = True
        seconds, result = self.arm()
        self.assertEqual(result.code, arming.NO_ANSWER)
        self.assertLess(seconds, arming.PATIENCE_S + 1)

    def test_what_was_not_answered_in_time_is_taken_back(self):
        self.component.pins.update({"image-ready": 1, "image-crc": image.read(self.folder / "a.tpi").crc})
        self.component.late = 1_000_000
        self.assertEqual(self.arm()[1].code, arming.NO_ANSWER)
        self.assertEqual([pin for _, pin in self.component.due], ["arm", "disarm"])

    def test_a_disarming_that_does_nothing_is_not_told_as_done(self):
        self.component.pins["state"] = words.ARMED
        self.component.deaf, self.now = True, 0.0
        self.assertEqual(self.run_steps(arming.disarm(self.component, lambda: self.now))[1].code, arming.NO_ANSWER)

    def test_an_image_that_is_not_taken_or_not_used_is_told(self):
        self.component.error = 6
        result = self.arm()[1]
        self.assertEqual(result.code, arming.IMAGE_NOT_TAKEN)
        self.assertIn("damaged", result.text)
        self.component.deaf, self.component.pins["image-error"] = True, 0
        self.assertEqual(self.arm(request=replace(REQUEST, feature=2))[1].code, arming.IMAGE_NOT_TAKEN)

    def test_what_truepath_config_refuses_is_never_sent_to_the_component(self):
        self.configuration.problems.clear()
        cases = (
            (arming.FROM_MDI, replace(SITUATION, mdi=True), REQUEST),
            (arming.EXTERNAL_OFFSET, replace(SITUATION, external_offset=True), REQUEST),
            (arming.NOT_PERMITTED, replace(SITUATION, permitted=False), REQUEST),
            (arming.OFFSETS, replace(SITUATION, offsets_known=False), REQUEST),
            (arming.TOOL_OFFSET, replace(SITUATION, tool_offset=-1), REQUEST),
            (arming.SERIAL, SITUATION, replace(REQUEST, serial=0)),
            (arming.SERIAL, SITUATION, replace(REQUEST, serial=1 << 32)),
            (arming.NO_IMAGE, replace(SITUATION, program_crc=2), REQUEST),
            (arming.NO_IMAGE, SITUATION, replace(REQUEST, feature=9)),
        )
        for code, situation, request in cases:
            self.assertEqual(self.arm(situation, request)[1].code, code)
        self.configuration.problems.append("limits")
        self.assertEqual(self.arm()[1].code, arming.CONFIGURATION)
        self.assertEqual(self.component.due, [])

    def test_disarming_ends_when_nothing_is_armed_or_after_half_a_second(self):
        self.arm()
        self.assertLess(self.run_steps(arming.disarm(self.component, lambda: self.now))[0], 0.2)
        self.component.pins["state"], self.component.deaf = words.ACTIVE, True
        self.now = 0.0
        self.assertEqual(self.run_steps(arming.disarm(self.component, lambda: self.now))[1].code, 0)
