# SPDX-License-Identifier: GPL-2.0-or-later
"""What is done to the machine, one function a scenario. What has to come of it is checked on the recording, elsewhere.

Every scenario begins and ends with the machine on, idle, nothing armed. Marks name the moments that the checks need.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import hal

from machine import ACTIVE, ARMED, BYPASS, HOLD, Machine
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
    m.until_state(ACTIVE)
    notes.pins(*(f"truepath.{name}" for name in ("offset-x", "offset-y", "offset-z", "frame-cosine", "frame-sine")))


def into_contour(m: Machine, notes: Notes, program: Path, node: int = 40) -> None:
    """A new part, until its correction has been on for a while."""
    begin(m, notes, program)
    m.wait(f"node {node}", lambda: m.pin("truepath.node") >= node)


def until_out(m: Machine) -> None:
    m.wait("no correction", lambda: m.state == BYPASS and m.correction() == (0, 0, 0))


def leave(m: Machine, notes: Notes) -> None:
    """Ends what runs; the next scenario begins from a standing machine."""
    notes.mark("leave")
    m.abort()
    m.until_idle()
    until_out(m)


def same_part_again(m: Machine, notes: Notes) -> None:
    """The button on the panel once more, with the same serial number."""
    notes.mark("again")
    notes.value("refusal", m.press_arm())


def armed_by_hand(m: Machine, notes: Notes) -> None:
    """A new part armed with the button on the panel, as for a program without M160; the cutter turns in the contour."""
    next_part(m, notes, POCKET)
    for block in ("T2 M6", "G43 H2", "S3200 M3", "G0 Z30", "G0 X30 Y0", "G1 Z-12 F600"):
        m.mdi(block)
    m.open(POCKET)
    notes.value("refusal", m.press_arm())


@scenario
def corner(m: Machine, notes: Notes) -> None:
    begin(m, notes, CORNER)
    m.until_idle()
    until_out(m)


@scenario
def pocket(m: Machine, notes: Notes) -> None:
    begin(m, notes, POCKET)
    m.until_idle()
    until_out(m)
    same_part_again(m, notes)


@scenario
def repeated(m: Machine, notes: Notes) -> None:
    """The program once more for the part that was milled last; its serial number was not changed."""
    if not m.serial:
        m.new_serial()
    m.open(POCKET)
    m.run()
    m.wait("the program over, or in the contour", lambda: m.is_idle() or m.stat.motion_line > line_of(POCKET, "G1 X26"))
    leave(m, notes)


@scenario
def switched_off(m: Machine, notes: Notes) -> None:
    """Corrections not permitted: M160 lets the program run."""
    hal.set_p("truepath-desk.enable-switch", "0")
    try:
        next_part(m, notes, POCKET)
        m.run()
        m.wait("the second side", lambda: m.stat.motion_line >= line_of(POCKET, "G1 X30 Y16"))
        leave(m, notes)
    finally:
        hal.set_p("truepath-desk.enable-switch", "1")


@scenario
def dry_run(m: Machine, notes: Notes) -> None:
    """The whole program with a spindle that does not turn."""
    hal.set_p("spindle.0.inhibit", "1")
    try:
        begin(m, notes, POCKET)
        m.until_idle()
        until_out(m)
    finally:
        hal.set_p("spindle.0.inhibit", "0")


@scenario
def abort(m: Machine, notes: Notes) -> None:
    into_contour(m, notes, POCKET)
    notes.mark("event")
    m.abort()
    m.until_idle()
    until_out(m)
    same_part_again(m, notes)


@scenario
def emergency_stop(m: Machine, notes: Notes) -> None:
    into_contour(m, notes, POCKET)
    notes.mark("event")
    m.emergency_stop()
    until_out(m)
    m.periods(100)
    m.switch_on()
    m.until_idle()
    same_part_again(m, notes)


@scenario
def drives_off(m: Machine, notes: Notes) -> None:
    """The machine switched off in the contour, without emergency stop."""
    into_contour(m, notes, POCKET)
    notes.mark("event")
    m.switch_off()
    until_out(m)
    m.periods(100)
    m.switch_on()
    m.until_idle()
    same_part_again(m, notes)


@scenario
def disarm(m: Machine, notes: Notes) -> None:
    """The button on the panel in the contour: the program goes on, uncorrected."""
    into_contour(m, notes, POCKET)
    notes.mark("event")
    m.press("disarm-button")
    until_out(m)
    m.periods(300)
    leave(m, notes)


@scenario
def feed_hold(m: Machine, notes: Notes) -> None:
    into_contour(m, notes, POCKET)
    m.pause()
    m.until_state(HOLD)
    m.wait("the axes standing", lambda: m.pin("motion.current-vel") == 0.0)
    m.periods(50)
    notes.mark("standing")
    m.periods(300)
    notes.mark("resume")
    m.resume()
    m.until_state(ACTIVE)
    m.periods(400)
    leave(m, notes)


@scenario
def feed_override(m: Machine, notes: Notes) -> None:
    into_contour(m, notes, POCKET)
    try:
        for percent in (50, 120, 100):
            notes.mark(f"{percent} %")
            m.feed_override(percent / 100)
            m.periods(1500)
        leave(m, notes)
    finally:
        m.feed_override(1.0)


@scenario
def spindle_override(m: Machine, notes: Notes) -> None:
    into_contour(m, notes, POCKET)
    try:
        for percent in (80, 110, 100):
            notes.mark(f"{percent} %")
            m.spindle_override(percent / 100)
            m.periods(1200)
        leave(m, notes)
    finally:
        m.spindle_override(1.0)


@scenario
def spindle_stop(m: Machine, notes: Notes) -> None:
    """The spindle stops in the cut, and the axes go on."""
    into_contour(m, notes, POCKET)
    notes.mark("stop")
    hal.set_p("spindle.0.inhibit", "1")
    try:
        m.periods(1200)
    finally:
        notes.mark("go")
        hal.set_p("spindle.0.inhibit", "0")
    m.periods(1500)
    leave(m, notes)


@scenario
def restart(m: Machine, notes: Notes) -> None:
    """Armed with the button, begun in the middle of the contour."""
    armed_by_hand(m, notes)
    notes.mark("run")
    m.run(line_of(POCKET, "G1 X30 Y16"))
    m.wait("the next arc", lambda: m.stat.motion_line >= line_of(POCKET, "G3 X26 Y20"))
    m.periods(300)
    leave(m, notes)


@scenario
def offset(m: Machine, notes: Notes) -> None:
    """Another work offset before arming, turned by ten degrees: the correction goes with it."""
    m.mdi("G10 L2 P1 X120.5 Y90.25 Z-119.75 R10")
    try:
        into_contour(m, notes, POCKET, 300)
        leave(m, notes)
    finally:
        m.mdi(G54)


@scenario
def offset_while_armed(m: Machine, notes: Notes) -> None:
    armed_by_hand(m, notes)
    notes.mark("event")
    try:
        m.mdi("G10 L2 P1 X151 Y100 Z-120")
        m.until_state(BYPASS)
        m.run(line_of(POCKET, "G1 X26 Y-20"))
        m.wait("the next side", lambda: m.stat.motion_line >= line_of(POCKET, "G1 X30 Y16"))
        leave(m, notes)
    finally:
        m.mdi(G54)


@scenario
def probe_armed(m: Machine, notes: Notes) -> None:
    """A probing move with an image armed, through the gate of the contour and along it."""
    armed_by_hand(m, notes)
    m.mdi("G0 X0 Y-20 Z-11")
    notes.mark("probe")
    m.mdi("G38.3 Z-12 F300")
    m.mdi("G38.3 X8 F600")
    leave(m, notes)


@scenario
def probe_after(m: Machine, notes: Notes) -> None:
    """A probing move while a correction is still on its way out; the way is made long for it."""
    cap = "truepath.{}.max-correction-vel"
    before = [m.pin(cap.format(joint)) for joint in range(3)]
    try:
        # Parameters take effect with the next image.
        m.open(CORNER)
        for joint in range(3):
            hal.set_p(cap.format(joint), "0.05")
        into_contour(m, notes, POCKET, 80)
        m.abort()
        m.wait("the interpreter idle", m.is_idle)
        notes.mark("probe")
        m.mdi("G38.3 X20 F600")
        leave(m, notes)
    finally:
        for joint, value in enumerate(before):
            hal.set_p(cap.format(joint), str(value))
        m.open(CORNER)


@scenario
def killed(m: Machine, notes: Notes) -> None:
    """Into the contour; the harness kills LinuxCNC there."""
    into_contour(m, notes, POCKET)


@scenario
def spent(m: Machine, notes: Notes) -> None:
    """After a new start: the serial number of the part before is refused, the next is not."""
    for block in ("T2 M6", "G43 H2"):
        m.mdi(block)
    m.open(POCKET)
    same_part_again(m, notes)
    m.new_serial()
    notes.value("next-refusal", m.press_arm())
    notes.value("next-state", m.state)
    m.press("disarm-button")
    m.until_state(BYPASS)
