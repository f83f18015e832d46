# SPDX-License-Identifier: GPL-2.0-or-later
"""Whether a correction is permitted at all: the master switch of the component, through the watchdog."""

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
        self._since = 0.0

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
        """Whether anything may be armed now."""
        pins, problems = self._pins, self.problems(status)
        if problems != self._found:
            self._found, self._found_at = problems, now
        if problems != self._told and now - self._found_at > STAYS_S:
            self._told = problems
            for problem in problems:
                self._operator.warn("nothing can be armed: " + problem)
        pins["trivial-kinematics"] = not problems
        wanted = bool(pins["enable-switch"]) and not problems and now >= self._rest_until
        if not wanted:
            pins["enable"] = False
            self._since = now
        elif pins["enabled"]:
            pins["enable"] = True
            self._since = now
        elif now - self._since > REST_S and pins["enable"]:
            # The watchdog has tripped: this process was not heard for too long. It begins again with a rising edge.
            self._operator.warn("truepath-desk was held up, a correction that was on has been ended")
            self._rest_until = now + REST_S
            pins["enable"] = False
        else:
            pins["enable"] = True
        return bool(pins["enabled"]) and bool(pins["enable"])
