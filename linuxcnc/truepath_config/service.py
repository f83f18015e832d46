# SPDX-License-Identifier: GPL-2.0-or-later
"""The loop: looks at LinuxCNC a hundred times a second, says what runs, takes requests, watches over what is armed."""

from __future__ import annotations

import time
from typing import Any

from . import words
from .arming import Situation
from .board import Board
from .configuration import Configuration
from .identity import Program
from .panel import Panel
from .permission import Permission
from .requests import Requests
from .status import Operator, Source, Status

PERIOD_S = 0.01


class Pins:
    """Pins of truepath, read by name, and the pins of truepath-config to it."""

    def __init__(self, hal: Any, pins: Any, board: Board | None) -> None:
        self._hal, self._pins, self.board = hal, pins, board

    def get(self, pin: str) -> int:
        """A pin of the real-time component; of the image, what the board says when there is one."""
        if self.board is not None and pin in ("image-ready", "image-crc"):
            return self.board.image_crc
        return self._hal.get_value("truepath." + pin)

    def set(self, pin: str, value: int | bool) -> None:
        """A pin of truepath-config."""
        self._pins[pin] = value


class Service:
    """Everything between LinuxCNC's status, the component, the panel and the M-codes."""

    def __init__(self, hal: Any, pins: Any, source: Source, operator: Operator, configuration: Configuration) -> None:
        self._hal, self._pins, self._source = hal, pins, source
        self._operator, self._configuration = operator, configuration
        board = Board(configuration, time.monotonic) if configuration.port else None
        self._component = Pins(hal, pins, board)
        self._panel = Panel(pins, self._component)
        self._permission = Permission(hal, pins, operator, configuration)
        self._requests = Requests(pins, self._component, operator, configuration)
        self._program = Program()
        self._selected: tuple[int, int, float] | None = None
        # Another program came since the last request began.
        self._other_program = False

    def run(self) -> None:
        """For ever, until LinuxCNC unloads the component."""
        while True:
            self.round(time.monotonic())
            time.sleep(PERIOD_S)

    def round(self, now: float) -> None:
        """One look. Without LinuxCNC's status there is no heartbeat, and the watchdog ends what is on."""
        status = self._source.look()
        if status is None:
            return
        changed = self._program.update(status.program)
        self._publish(status)
        permitted = self._permission.update(status, now)
        state = self._component.get("state")
        self._watch(status, state, changed)
        if self._component.board is not None:
            self._component.board.acknowledge(self._component.get)
        selected = (self._program.crc, status.tool, self._pins["feature-wanted"])
        if selected != self._selected:
            self._selected = selected
            self._requests.program_changed()
        self._requests.update(self._situation(status, permitted), state in (words.OFF, words.BYPASS))
        requests = self._requests
        self._panel.show(requests.image_crc, requests.refusal, permitted, self._operator)
        self._panel.show_part(requests.part, requests.image_state)

    def _publish(self, status: Status) -> None:
        pins, frame = self._pins, status.frame
        pins["offset-x"], pins["offset-y"], pins["offset-z"] = frame.offset
        pins["frame-cosine"], pins["frame-sine"] = frame.cosine, frame.sine
        pins["program-crc"] = self._program.crc
        pins["setup"] = self._configuration.setup or status.work_offset
        pins["tool"], pins["tool-offset"] = status.tool, status.tool_offset
        pins["program-running"] = status.running

    def _watch(self, status: Status, state: int, program_changed: bool) -> None:
        """What is armed is for the program that was loaded then. (Moves by hand never enter: no program runs.)"""
        self._other_program |= program_changed
        if state not in (words.ARMED, words.ACTIVE, words.HOLD):
            # While an arming is under way it is remembered: it ends what comes of it.
            self._other_program &= self._requests.busy
            return
        if not self._permission.wanted:
            self._requests.end("corrections are not permitted any more")
        elif self._other_program:
            self._requests.end("another program is loaded, or its file has changed")
        elif self._external_offset():
            self._requests.end("an external offset is on")

    def _external_offset(self) -> bool:
        return bool(self._hal.get_value("motion.eoffset-active"))

    def _situation(self, status: Status, permitted: bool) -> Situation:
        return Situation(
            program_crc=self._program.crc,
            tool=status.tool,
            tool_offset=status.tool_offset,
            mdi=status.mdi,
            external_offset=self._external_offset(),
            permitted=permitted,
            offsets_known=status.work_offset > 0,
            running=status.running,
        )
