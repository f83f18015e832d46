# SPDX-License-Identifier: GPL-2.0-or-later
"""LinuxCNC's status, as far as Truepath needs it, and the messages to its operator."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

from .frame import Frame, frame
from .identity import tool_offset_number, work_offset


@dataclass(frozen=True)
class Status:
    """One look at LinuxCNC."""

    frame: Frame
    # Number of the work offset, 1 for G54; 0 when the status does not show the one that is in force.
    work_offset: int
    tool: int
    tool_offset: int
    program: str
    # The loaded program runs, not a line of MDI.
    running: bool
    mdi: bool
    identity_kinematics: bool
    mm_per_unit: float


class Source:
    """linuxcnc.stat, opened when LinuxCNC is there."""

    def __init__(self, linuxcnc: Any) -> None:
        self._linuxcnc = linuxcnc
        self._stat: Any = None

    def look(self) -> Status | None:
        """The status now, or None while LinuxCNC cannot be asked."""
        try:
            if self._stat is None:
                self._stat = self._linuxcnc.stat()
            self._stat.poll()
        except self._linuxcnc.error:
            self._stat = None
            return None
        # Until motion has reported, everything is 0.
        return self._read(self._stat) if self._stat.linear_units > 0 and self._stat.joints > 0 else None

    def _read(self, s: Any) -> Status:
        table = [(t.id, (t.xoffset, t.yoffset, t.zoffset)) for t in s.tool_table if t.id > 0]
        return Status(
            frame=frame(s.g5x_offset, s.g92_offset, s.tool_offset, s.rotation_xy),
            work_offset=work_offset(s.g5x_index, s.gcodes),
            tool=max(s.tool_in_spindle, 0),
            tool_offset=tool_offset_number(s.gcodes, s.tool_offset[:3], s.tool_in_spindle, table),
            program=s.file,
            running=s.interp_state != self._linuxcnc.INTERP_IDLE and s.task_mode == self._linuxcnc.MODE_AUTO,
            mdi=s.task_mode == self._linuxcnc.MODE_MDI,
            identity_kinematics=s.kinematics_type == self._linuxcnc.KINEMATICS_IDENTITY,
            mm_per_unit=1.0 / s.linear_units,
        )


class Operator:
    """Messages that LinuxCNC shows in its window, and that stand in its log."""

    def __init__(self, linuxcnc: Any) -> None:
        self._linuxcnc = linuxcnc
        self._command: Any = None

    def tell(self, text: str) -> None:
        """Something that is as it should be."""
        self._send("text_msg", text)

    def warn(self, text: str) -> None:
        """Something to be seen to."""
        self._send("error_msg", text)

    def _send(self, kind: str, text: str) -> None:
        text = "Truepath: " + text
        try:
            if self._command is None:
                self._command = self._linuxcnc.command()
            # LinuxCNC takes 254 bytes, and reads a percent sign as the begin of a format.
            getattr(self._command, kind)(text.replace("%", "%%").encode()[:250].decode(errors="ignore"))
        except self._linuxcnc.error:
            self._command = None
            print(text, file=sys.stderr, flush=True)
