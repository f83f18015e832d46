# SPDX-License-Identifier: GPL-2.0-or-later
"""A part milled as it comes, its wall touched, and the next one milled with what was learned from it.

The walls are cut elsewhere, along the recorded paths: between the sessions of this machine the harness lays the wall of
each part beside its program. `corrected.py` has the last session.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import hal

from machine import Machine
from notes import Notes
from steps import CORNER, POCKET, PROGRAMS, line_of, next_part, scenario

FRAME = tuple(f"truepath.{name}" for name in ("offset-x", "offset-y", "offset-z", "frame-cosine", "frame-sine"))
# [TRUEPATH]WALL of the INI file.
WALL = PROGRAMS.parent / "wall.csv"


def milled(m: Machine, notes: Notes, program: Path) -> None:
    """The whole program without a correction; the frame is that of the cut."""
    hal.set_p("truepath-config.enable-switch", "0")
    try:
        next_part(m, notes, program)
        m.run()
        # The spindle stands when a program begins: from here on it is this one that runs.
        m.while_running("the spindle", lambda: bool(m.pin("truepath.spindle-on")))
        m.while_running("the first arc", lambda: m.stat.motion_line == line_of(program, "G3 "))
        notes.pins(*FRAME)
        m.until_idle()
    finally:
        hal.set_p("truepath-config.enable-switch", "1")


def touched(m: Machine, notes: Notes, part: str, ball_diameter: float) -> None:
    """The probing program beside a wall."""
    shutil.copyfile(PROGRAMS / f"{part}-wall.csv", WALL)
    hal.set_p("truepath-wall.ball-radius", str(ball_diameter / 2))
    loads = m.pin("truepath-wall.loads")
    hal.set_p("truepath-wall.reload", "0")
    m.periods(3)
    hal.set_p("truepath-wall.reload", "1")
    m.wait("the wall read", lambda: m.pin("truepath-wall.loads") > loads and m.pin("truepath-wall.points") > 0)
    notes.value("points", m.pin("truepath-wall.points"))
    m.open(PROGRAMS / f"{part}-probe.ngc")
    m.run()
    m.wait("the wall touched at every place", m.is_idle, 400.0)
    # What LinuxCNC said, of a touch where nothing should be for instance.
    notes.value("messages", [text for _, text in m.said])


@scenario
def uncorrected_corner(m: Machine, notes: Notes) -> None:
    milled(m, notes, CORNER)


@scenario
def uncorrected_pocket(m: Machine, notes: Notes) -> None:
    milled(m, notes, POCKET)


@scenario
def touched_corner(m: Machine, notes: Notes) -> None:
    touched(m, notes, "corner", 6.0)


@scenario
def touched_pocket(m: Machine, notes: Notes) -> None:
    touched(m, notes, "pocket", 4.0)
