# SPDX-License-Identifier: GPL-2.0-or-later
"""The switch, the configuration and a service that is held up: each takes the permission away, and gives it back."""

import unittest
from pathlib import Path
from types import SimpleNamespace

from package import configuration, permission

STATUS = SimpleNamespace(identity_kinematics=True, mm_per_unit=1.0)
TIMEOUT = 1.0


class Watchdog:
    """LinuxCNC's component as it is: without enable it looks at nothing, and leaves its output alone."""

    def __init__(self, pins):
        self.pins, self.heartbeat, self.heard, self.enable = pins, None, 0.0, False

    def period(self, now):
        rising = self.pins["enable"] and not self.enable
        self.enable = self.pins["enable"]
        if rising:
            self.pins["enabled"], self.heard = True, now
        if self.pins["heartbeat"] != self.heartbeat:
            self.heartbeat, self.heard = self.pins["heartbeat"], now
        if self.enable and now - self.heard > TIMEOUT:
            self.pins["enabled"] = False


class PermissionTest(unittest.TestCase):
    def setUp(self):
        self.pins = dict.fromkeys(("enable", "enabled", "heartbeat", "trivial-kinematics"), False)
        self.pins["enable-switch"] = True
        self.said = []
        read = configuration.Configuration("XYZ", Path(), Path(), None, "", "", 921600, "truepath")
        self.problems = read.problems
        self.watchdog, self.now, self.status = Watchdog(self.pins), 0.0, STATUS
        hal = SimpleNamespace(get_value=lambda _: 1_000_000.0)
        operator = SimpleNamespace(warn=self.said.append, tell=self.said.append)
        self.permission = permission.Permission(hal, self.pins, operator, read)

    def run_for(self, seconds, alive=True):
        permitted = False
        for _ in range(round(seconds / 0.01)):
            self.now += 0.01
            if alive:
                permitted = self.permission.update(self.status, self.now)
            self.watchdog.period(self.now)
        return permitted

    def test_it_is_given_within_a_moment_and_stays(self):
        self.assertTrue(self.run_for(0.1))
        self.assertTrue(self.run_for(10))
        self.assertTrue(self.pins["enabled"])
        self.assertEqual(self.said, [])

    def test_the_switch_takes_it_at_once_and_the_watchdog_after_its_time(self):
        self.run_for(1)
        self.pins["enable-switch"] = False
        self.assertFalse(self.run_for(0.02))
        self.run_for(TIMEOUT + 0.1)
        self.assertFalse(self.pins["enabled"])
        self.pins["enable-switch"] = True
        self.assertTrue(self.run_for(0.2))
        self.assertEqual(self.said, [])

    def test_a_short_flick_of_the_switch_does_no_harm(self):
        self.run_for(1)
        self.pins["enable-switch"] = False
        self.run_for(0.3)
        self.pins["enable-switch"] = True
        self.assertTrue(self.run_for(0.1))

    def test_a_service_that_was_held_up_says_so_and_begins_again(self):
        self.run_for(1)
        self.run_for(2, alive=False)
        self.assertFalse(self.pins["enabled"])
        self.assertTrue(self.run_for(1))
        self.assertEqual(len(self.said), 1)
        self.assertIn("held up", self.said[0])

    def test_a_problem_takes_it_and_is_told_once(self):
        self.problems.append("limits")
        self.assertFalse(self.run_for(5))
        self.assertFalse(self.pins["trivial-kinematics"])
        self.assertEqual(self.said, ["nothing can be armed: limits"])

    def test_kinematics_and_unit_that_run_are_looked_at(self):
        for status in (
            SimpleNamespace(identity_kinematics=False, mm_per_unit=1.0),
            SimpleNamespace(identity_kinematics=True, mm_per_unit=25.4),
        ):
            self.status = status
            self.assertFalse(self.run_for(2))
        self.assertEqual(len(self.said), 2)
        self.status = STATUS
        self.assertTrue(self.run_for(2))
