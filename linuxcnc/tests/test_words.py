# SPDX-License-Identifier: GPL-2.0-or-later
"""The words for reasons, refusals and errors of images are there for every number of the core."""

import re
import unittest
from pathlib import Path

from package import arming, words

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "core" / "wire" / "src"
COMPONENT = ROOT / "linuxcnc" / "abi" / "src" / "pc" / "arming.rs"


def codes(file, pattern):
    return {int(n) for n in re.findall(pattern, file.read_text(), re.MULTILINE)}


@unittest.skipUnless(CORE.is_dir(), "the repository is not there")

class WordsTest(unittest.TestCase):
    def test_every_reason_of_the_core_has_the_words_of_the_core(self):
        text = (CORE / "rewrite/reason.rs").read_text()
        numbers = dict(re.findall(r"^    (\w+) = (\d+),", text, re.MULTILINE))
        sentences = dict(re.findall(r'Self::(\w+) => "([^"]+)"', text))
        self.assertGreater(len(numbers), 20)
        self.assertEqual(words.REASONS, {int(n): sentences[name] for name, n in numbers.items()})

    def test_every_reason_is_one_of_the_ends_the_panel_shows(self):
        shown = [n for end in words.ENDS for n in words.END_OF[end]]
        self.assertEqual(sorted(shown), sorted(words.REASONS))

    def test_every_refusal_of_core_and_component_has_words_and_no_number_is_that_of_truepath_config(self):
        found = codes(CORE / "rewrite/refusal.rs", r"=> (\d+),$") | codes(COMPONENT, r"=> (\d+),$")
        self.assertGreater(len(found), 20)
        self.assertEqual(found, set(words.REFUSALS))
        self.assertLess(max(words.REFUSALS), arming.CONFIGURATION)

    def test_every_error_of_an_image_has_words(self):
        pattern = r'= "I0*(\d+)"'
        found = codes(CORE / "image/error.rs", pattern) | codes(CORE / "image/signature.rs", pattern)
        self.assertGreater(len(found), 18)
        self.assertLessEqual(found, set(words.IMAGE_ERRORS))

    def test_a_number_of_a_later_version_is_told_as_a_number(self):
        self.assertIn("77", words.reason(77) + words.refusal(77))
        self.assertIn("88", words.image_error(88))
