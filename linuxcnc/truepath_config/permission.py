# SPDX-License-Identifier: GPL-2.0-or-later
"""Whether a correction is permitted at all: the master switch of the component, through the watchdog.

LinuxCNC's watchdog lets go when the heartbeat stays away while `enable` is high, and begins again with a rising edge of
`enable`; a low `enable` alone leaves its output as it is, whatever its manual says. So what forbids a correction stops
the heartbeat; and as that takes its time, the service disarms as well, and arms nothing in between.
"""

from __future__ import annotations

from typing import Any

from .configuration import Configuration
from .status import Operator, Status

# Low for so long before the watchdog is asked to begin again; many servo cycles.
REST_S = 0.2
# What is found while LinuxCNC starts is told only if it stays.
STAYS_S = 1.0


class Permission:
    """Sets `enable` and `trivial-kinematics`; says once what forbids a correction."""

    def __init__(self, hal: Any, pins: Any, operator: Operator, configuration: Configuration) -> None:
        self._hal, self._pins, self._operator = hal, pins, operator
        self._configuration = configuration
        self._told: list[str] = []
        self._found: list[str] = []
        self._found_at = 0.0
        self._rest_until = 0.0
        self._alive = 0.0
        # The switch is on, and nothing is wrong.
        self.wanted = False

    def problems(self, status: Status) -> list[str]:
        """What is wrong with the configuration or the machine as it runs."""
        found = list(self._configuration.problems)
        if not status.identity_kinematics:
            found.append("the kinematics that run are not trivial")
        unit = self._hal.get_value("truepath.nm-per-unit")
        if abs(unit - 1e6 * status.mm_per_unit) > 1e-3:
            found.append("truepath.nm-per-unit is %.0f and has to be %.0f here" % (unit, 1e6 * status.mm_per_unit))
        return found

    def update(self, status: Status, now: float) -> bool:
        """Whether anything may be armed now; renews the heartbeat while nothing forbids it."""
        pins, problems = self._pins, self.problems(status)
        self._tell(problems, now)
        pins["trivial-kinematics"] = not problems
        self.wanted = bool(pins["enable-switch"]) and not problems
        if self.wanted:
            pins["heartbeat"] = not pins["heartbeat"]
        if not self.wanted:
            # Only while it is high does the watchdog look for the heartbeat.
            pins["enable"] = bool(pins["enabled"])
        elif now < self._rest_until:
            pins["enable"] = False
        elif pins["enabled"] or not pins["enable"]:
            pins["enable"] = True
            self._alive = now
        elif now - self._alive > REST_S:
            # The watchdog has tripped: this process was not heard for too long. A rising edge starts it again.
            self._operator.warn("truepath-config was held up; a correction that was on has been ended")
            self._rest_until = now + REST_S
            pins["enable"] = False
        return self.wanted and bool(pins["enabled"])

    def _tell(self, problems: list[str], now: float) -> None:
        if problems != self._found:
            self._found, self._found_at = problems, now
        if problems != self._told and now - self._found_at > STAYS_S:
            self._told = problems
            for problem in problems:
                self._operator.warn("nothing can be armed: " + problem)
