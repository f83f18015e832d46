# SPDX-License-Identifier: GPL-2.0-or-later
"""Steps that several scenarios have in common, and the table of the scenarios."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from machine import ACTIVE, BYPASS, Machine
from notes import Notes

Scenario = Callable[[Machine, Notes], None]

ALL: dict[str, Scenario] = {}
PROGRAMS = Path(__file__).resolve().parent.parent / "sim" / "programs"
CORNER = PROGRAMS / "corner.ngc"
POCKET = PROGRAMS / "pocket.ngc"
G54 = "G10 L2 P1 X150 Y100 Z-120 R0"


def scenario(function: Scenario) -> Scenario:
    ALL[function.__name__.replace("_", "-")] = function
    return function


def line_of(program: Path, block: str) -> int:
    """Number of the line that begins with a block."""
    lines = program.read_text().splitlines()
    return 1 + next(place for place, line in enumerate(lines) if line.startswith(block))


def next_part(m: Machine, notes: Notes, program: Path) -> None:
    """The program open, the serial number of the next part entered."""
    m.open(program)
    notes.value("serial", m.new_serial())
    notes.value("program", program.stem)


def begin(m: Machine, notes: Notes, program: Path) -> None:
    """A new part, until its correction is on."""
    next_part(m, notes, program)
    m.run()
    m.while_running("a correction", lambda: m.state == ACTIVE)
    notes.pins(*(f"truepath.{name}" for name in ("offset-x", "offset-y", "offset-z", "frame-cosine", "frame-sine")))


def into_contour(m: Machine, notes: Notes, program: Path, node: int = 40) -> None:
    """A new part, until its correction has been on for a while."""
    begin(m, notes, program)
    m.while_running(f"node {node}", lambda: m.pin("truepath.node") >= node)


def until_out(m: Machine) -> None:
    m.wait("no correction", lambda: m.state == BYPASS and m.correction() == (0, 0, 0))


def leave(m: Machine, notes: Notes) -> None:
    """Ends what runs; the next scenario begins from a standing machine."""
    notes.mark("leave")
    m.abort()
    m.until_idle()
    until_out(m)


def same_part_again(m: Machine, notes: Notes) -> None:
    """The button on the panel once more, with the same serial number; everything else as it was when it was armed."""
    notes.mark("again")
    for block in ("T2 M6", "G43 H2"):
        m.mdi(block)
    m.open(POCKET)
    notes.value("refusal", m.press_arm())


def armed_by_hand(m: Machine, notes: Notes) -> None:
    """A new part armed with the button on the panel, as for a program without M160; the cutter turns in the contour."""
    next_part(m, notes, POCKET)
    for block in ("T2 M6", "G43 H2", "S3200 M3", "G0 Z30", "G0 X30 Y0", "G1 Z-12 F600"):
        m.mdi(block)
    m.open(POCKET)
    notes.value("refusal", m.press_arm())
