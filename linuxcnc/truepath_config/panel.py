# SPDX-License-Identifier: GPL-2.0-or-later
"""What the panel shows, and what is said when a correction begins or ends."""

from __future__ import annotations

from typing import Any

from . import words
from .arming import Component
from .status import Operator


class Edge:
    """A button: true once for every time it is pressed."""

    def __init__(self, pins: Any, name: str) -> None:
        self._pins, self._name = pins, name
        self._before = bool(pins[name])

    def pressed(self) -> bool:
        """Whether it was pressed since the last look."""
        now = bool(self._pins[self._name])
        rising = now and not self._before
        self._before = now
        return rising


class Panel:
    """State in words, correction in micrometres, its largest value since the last arming."""

    def __init__(self, pins: Any, component: Component) -> None:
        self._pins, self._component = pins, component
        self._state = words.BYPASS
        self._peak = 0.0

    def show(self, image_crc: int, refusal: int, permitted: bool, operator: Operator) -> None:
        """Once per look; `image_crc` is that of the image for the loaded program, 0 for none; `refusal` the last one."""
        get, pins = self._component.get, self._pins
        state = get("state")
        for number, name in enumerate(words.STATES):
            pins["is-" + name] = state == number
        reason = get("reason")
        for end in words.ENDS:
            pins["ended-" + end] = reason in words.END_OF[end]
        # Micrometres whatever the machine's unit.
        x, y = (get("correction-nm-%d" % axis) / 1000.0 for axis in (0, 1))
        if state == words.ARMED:
            self._peak = 0.0
        self._peak = max(self._peak, abs(x), abs(y))
        pins["correction-x-um"], pins["correction-y-um"], pins["peak-um"] = x, y, self._peak
        pins["reason"], pins["refusal"] = reason, refusal
        pins["armed-serial"] = get("armed-serial")
        pins["image-fits"] = bool(image_crc) and bool(get("image-ready")) and get("image-crc") == image_crc
        pins["permitted"] = permitted
        self._say(state, operator)

    def show_part(self, part: int, image_state: str) -> None:
        """The number of the part that is clamped, and why the image is none: one of IMAGE_STATES, or empty."""
        pins = self._pins
        pins["part"] = part
        for name in words.IMAGE_STATES:
            pins[name] = name == image_state

    def _say(self, state: int, operator: Operator) -> None:
        before, self._state = self._state, state
        was_on = before in (words.ARMED, words.ACTIVE, words.HOLD)
        if not was_on or state in (words.ARMED, words.ACTIVE, words.HOLD):
            return
        reason = self._component.get("reason")
        text = "part %d: %s" % (self._component.get("armed-serial"), words.reason(reason))
        if reason < words.FIRST_FAULT:
            operator.tell("%s; largest correction %.0f um" % (text, self._peak))
        else:
            operator.warn("%s; the correction is out, the rest of the part is not corrected" % text)
