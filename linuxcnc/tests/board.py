# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenarios of Route B: the correction is computed by the virtual board, on serial ports, at a slower servo period.

TRUEPATH_LINKS names the folder in which the board's process number (`pid`) and its configuration port (`config`) are.
"""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import hal

from machine import BYPASS, Machine
from notes import Notes
from steps import CORNER, G54, POCKET, begin, into_contour, same_part_again, scenario, until_out

LINKS = Path(os.environ.get("TRUEPATH_LINKS", "."))
COUNTED = ("link-misses", "link-late", "link-damaged", "link-time-max")


def is_lost(m: Machine) -> bool:
    return bool(m.pin("truepath.link-lost"))


def note_link(notes: Notes) -> None:
    notes.pins(*(f"truepath.{name}" for name in COUNTED))


def lost_and_found(m: Machine, notes: Notes) -> None:
    """The machine stops; the board is heard again, and nothing is corrected until the next part is armed."""
    m.wait("the link there again, the board in bypass", lambda: not is_lost(m) and m.state == BYPASS)
    m.switch_on()
    m.until_idle()
    notes.mark("on")
    m.mdi("G53 G0 Z0")
    m.mdi("G0 X0 Y0")
    m.open(POCKET)
    same_part_again(m, notes)
    note_link(notes)


@contextmanager
def event(m: Machine, notes: Notes) -> Iterator[None]:
    """In the contour something happens to the link, which is lost by it; afterwards it is undone."""
    m.mdi(G54)
    into_contour(m, notes, POCKET)
    notes.mark("event")
    try:
        yield
        m.wait("the link lost", lambda: is_lost(m))
        m.wait("the drives off", lambda: not m.pin("truepath.drives-on"))
        notes.pins("truepath.link-cause")
        m.periods(30)
    finally:
        m.abort()
        notes.mark("back")


@scenario
def board_corner(m: Machine, notes: Notes) -> None:
    # LinuxCNC's status knows the work offset once it was set in this run.
    m.mdi(G54)
    begin(m, notes, CORNER)
    m.until_idle()
    until_out(m)
    note_link(notes)


@scenario
def board_pocket(m: Machine, notes: Notes) -> None:
    m.mdi(G54)
    begin(m, notes, POCKET)
    m.until_idle()
    until_out(m)
    same_part_again(m, notes)
    note_link(notes)


@scenario
def board_stopped(m: Machine, notes: Notes) -> None:
    """The board stands still in the cut, as if its supply had failed, and goes on later."""
    process = int((LINKS / "pid").read_text())
    try:
        with event(m, notes):
            os.kill(process, signal.SIGSTOP)
    finally:
        os.kill(process, signal.SIGCONT)
    lost_and_found(m, notes)


@scenario
def board_late(m: Machine, notes: Notes) -> None:
    """No time is left to wait for an answer, so that each comes too late."""
    before = m.pin("truepath.link-wait")
    try:
        with event(m, notes):
            hal.set_p("truepath.link-wait", "0")
    finally:
        hal.set_p("truepath.link-wait", str(before))
    lost_and_found(m, notes)


@scenario
def board_reset(m: Machine, notes: Notes) -> None:
    with event(m, notes):
        restart = ["truepath", "device", "--port", str(LINKS / "config"), "restart"]
        subprocess.run(restart, check=True, capture_output=True, timeout=60)
    lost_and_found(m, notes)
