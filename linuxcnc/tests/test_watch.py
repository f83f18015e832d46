# SPDX-License-Identifier: GPL-2.0-or-later
"""What truepath-config ends by itself: an arming belongs to the program for which it was asked."""

import unittest
from types import SimpleNamespace

from package import words
from truepath_config.service import Service


class WatchTest(unittest.TestCase):
    def setUp(self):
        self.ended = []
        self.service = Service.__new__(Service)
        self.service._hal = SimpleNamespace(get_value=lambda _: 0)
        self.service._permission = SimpleNamespace(wanted=True)
        self.service._requests = SimpleNamespace(busy=False, end=self.ended.append)
        self.service._other_program = False

    def watch(self, state, changed=False):
        self.service._watch(SimpleNamespace(), state, changed)
        return len(self.ended)

    def test_a_program_that_is_loaded_while_a_part_is_armed_ends_it(self):
        self.assertEqual(self.watch(words.ARMED), 0)
        self.assertEqual(self.watch(words.ARMED, changed=True), 1)

    def test_a_program_that_is_loaded_while_an_arming_is_under_way_ends_what_comes_of_it(self):
        self.service._requests.busy = True
        self.assertEqual(self.watch(words.BYPASS, changed=True), 0)
        self.assertEqual(self.watch(words.BYPASS), 0)
        self.assertEqual(self.watch(words.ARMED), 1)

    def test_a_program_that_was_loaded_before_does_not(self):
        self.watch(words.BYPASS, changed=True)
        self.service._requests.busy = True
        self.watch(words.BYPASS)
        self.assertEqual(self.watch(words.ARMED), 0)


if __name__ == "__main__":
    unittest.main()
