# SPDX-License-Identifier: GPL-2.0-or-later
"""A running LinuxCNC as the scenarios see it: commands that have been carried out when they return.

Every wait is for a condition, with a time limit that only a machine that hangs reaches. What LinuxCNC says on its error
channel is kept, with the sequence number of the servo period in which it was read.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path

import hal
import linuxcnc

# Seconds. A loaded machine may take ten times as long as an idle one.
LIMIT = 90.0
POLL = 0.002

# How truepath-config answers a request to arm; with the code of the refusal.
ANSWER = re.compile(r"Truepath: (?:refused \((\d+)\)|armed: part)")

OFF, BYPASS, ARMED, ACTIVE, HOLD, FAULT = range(6)


class Stuck(Exception):
    """A condition did not come true in time, or a command was refused that has to work."""


class Machine:
    """LinuxCNC and the pins of the component."""

    def __init__(self, serial: int) -> None:
        self.command = linuxcnc.command()
        self.stat = linuxcnc.stat()
        self.errors = linuxcnc.error_channel()
        self.said: list[tuple[int, str]] = []
        self.serial = serial

    # Pins

    def pin(self, name: str) -> float:
        return hal.get_value(name)

    @property
    def state(self) -> int:
        return int(self.pin("truepath.state"))

    @property
    def sequence(self) -> int:
        return int(self.pin("truepath.sequence"))

    def correction(self) -> tuple[int, ...]:
        return tuple(int(self.pin(f"truepath.correction-nm-{axis}")) for axis in range(3))

    # Parts

    def new_serial(self) -> int:
        """The operator enters the number of the next part."""
        self.enter_serial(self.serial + 1)
        return self.serial

    def enter_serial(self, serial: int) -> None:
        self.serial = serial
        hal.set_p("truepath-config.serial-wanted", str(float(serial)))

    def press_arm(self) -> int:
        """The button on the panel, until truepath-config says what came of it: 0, or the code of the refusal."""
        self.poll()
        before = len(self.said)
        self.press("arm-button")
        self.wait("an answer to the button", lambda: any(ANSWER.search(text) for _, text in self.said[before:]))
        found = next(match for _, text in self.said[before:] if (match := ANSWER.search(text)))
        return int(found.group(1) or 0)

    def press(self, button: str) -> None:
        for value in ("0", "1"):
            hal.set_p(f"truepath-config.{button}", value)
            self.looks(3)

    def looks(self, count: int) -> None:
        """Lets truepath-config look at its pins some times."""
        for _ in range(count):
            before = self.pin("truepath-config.heartbeat")
            self.wait("truepath-config", lambda: self.pin("truepath-config.heartbeat") != before)

    # Waiting

    def poll(self) -> None:
        self.stat.poll()
        while (message := self.errors.poll()) is not None:
            self.said.append((self.sequence, str(message[1]).strip()))

    def wait(self, what: str, condition: Callable[[], bool], limit: float = LIMIT) -> None:
        end = time.monotonic() + limit
        self.poll()
        while not condition():
            if time.monotonic() > end:
                raise Stuck(f"waited {limit:g} s for: {what}; {self.situation()}")
            time.sleep(POLL)
            self.poll()

    def situation(self) -> str:
        s = self.stat
        return (
            f"state {self.state}, reason {self.pin('truepath.reason')}, refusal {self.pin('truepath.refusal')}, "
            f"line {s.motion_line}, position {[round(v, 3) for v in s.position[:3]]}, interpreter {s.interp_state}, "
            f"task {s.task_state}, mode {s.task_mode}, said {self.said[-3:]}"
        )

    def periods(self, count: int) -> None:
        """Lets servo periods pass."""
        start = self.sequence
        self.wait(f"{count} servo periods", lambda: (self.sequence - start) % 2**32 >= count)

    def while_running(self, what: str, condition: Callable[[], bool]) -> None:
        """A condition that has to come true before the program ends."""
        self.wait(what, lambda: condition() or self.is_idle())
        if not condition():
            raise Stuck(f"the program ended before: {what}; {self.situation()}")

    def until_state(self, *states: int) -> None:
        self.wait(f"state {states}", lambda: self.state in states)

    def until_idle(self) -> None:
        self.wait("the interpreter idle and the axes standing", self.is_idle)

    def is_idle(self) -> bool:
        s = self.stat
        executed = s.exec_state in (linuxcnc.EXEC_DONE, linuxcnc.EXEC_ERROR) and s.queue == 0
        return s.interp_state == linuxcnc.INTERP_IDLE and executed and bool(s.inpos) and self.is_heard()

    def is_heard(self) -> bool:
        # Messages of truepath-config are commands as well, with numbers of their own: the echo may be past ours.
        return self.stat.echo_serial_number >= self.command.serial

    # Commands

    def heard(self) -> None:
        """The last command has reached the controller's task."""
        self.wait("the command taken", self.is_heard)

    def switch_on(self) -> None:
        # Switched on before it has told its offsets, LinuxCNC never does.
        self.wait("the work offset shown", lambda: self.stat.g5x_index > 0)
        self.command.state(linuxcnc.STATE_ESTOP_RESET)
        self.wait("out of emergency stop", lambda: self.stat.task_state != linuxcnc.STATE_ESTOP)
        for _ in range(10):
            # On Route B truepath-config tells the board that the drives are off; before, they cannot be switched on, and a
            # servo thread that is held up takes them away again.
            self.wait("the component ready", lambda: self.state != OFF and not self.pin("truepath.link-lost"))
            self.command.state(linuxcnc.STATE_ON)
            self.heard()
            self.periods(10)
            self.poll()
            if self.stat.task_state == linuxcnc.STATE_ON:
                return
        raise Stuck(f"the drives do not stay on; {self.situation()}")

    def switch_off(self) -> None:
        self.command.state(linuxcnc.STATE_OFF)
        self.wait("drives off", lambda: self.stat.task_state == linuxcnc.STATE_ESTOP_RESET)

    def home(self) -> None:
        self.mode(linuxcnc.MODE_MANUAL)
        self.command.home(-1)
        joints = self.stat.joints
        self.wait("homed", lambda: all(self.stat.homed[:joints]) and bool(self.stat.inpos))

    def mode(self, mode: int) -> None:
        if self.stat.task_mode != mode:
            self.command.mode(mode)
            self.wait(f"mode {mode}", lambda: self.stat.task_mode == mode)

    def mdi(self, line: str) -> None:
        self.begin_mdi(line)
        self.until_idle()

    def begin_mdi(self, line: str) -> None:
        self.mode(linuxcnc.MODE_MDI)
        self.command.mdi(line)
        self.heard()

    def open(self, program: Path) -> None:
        self.mode(linuxcnc.MODE_AUTO)
        self.command.program_open(str(program))
        self.wait(f"{program} open", lambda: self.stat.file == str(program))

    def run(self, line: int = 0) -> None:
        self.mode(linuxcnc.MODE_AUTO)
        self.command.auto(linuxcnc.AUTO_RUN, line)
        self.heard()
        self.wait("the program running", lambda: self.stat.interp_state != linuxcnc.INTERP_IDLE)

    def pause(self) -> None:
        self.command.auto(linuxcnc.AUTO_PAUSE)
        self.heard()

    def resume(self) -> None:
        self.command.auto(linuxcnc.AUTO_RESUME)
        self.heard()

    def abort(self) -> None:
        self.command.abort()
        self.heard()

    def emergency_stop(self) -> None:
        self.command.state(linuxcnc.STATE_ESTOP)
        self.wait("emergency stop", lambda: self.stat.task_state == linuxcnc.STATE_ESTOP)

    def feed_override(self, factor: float) -> None:
        self.command.feedrate(factor)
        self.wait(f"feed override {factor}", lambda: abs(self.stat.feedrate - factor) < 1e-6)

    def spindle_override(self, factor: float) -> None:
        self.command.spindleoverride(factor)
        self.wait(f"spindle override {factor}", lambda: abs(self.stat.spindle[0]["override"] - factor) < 1e-6)
