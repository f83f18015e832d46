# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenarios in which there must be no correction: not permitted, spent, in another place, probing, after a new start."""

from __future__ import annotations

import hal

from machine import BYPASS, Machine
from notes import Notes
from steps import (
    CORNER,
    G54,
    POCKET,
    armed_by_hand,
    begin,
    into_contour,
    leave,
    line_of,
    next_part,
    same_part_again,
    scenario,
    until_out,
)


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
    hal.set_p("truepath-config.enable-switch", "0")
    try:
        next_part(m, notes, POCKET)
        m.run()
        m.wait("the second side", lambda: m.stat.motion_line >= line_of(POCKET, "G1 X30 Y16"))
        leave(m, notes)
    finally:
        hal.set_p("truepath-config.enable-switch", "1")


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
def restart(m: Machine, notes: Notes) -> None:
    """Armed with the button, begun in the middle of the contour."""
    armed_by_hand(m, notes)
    notes.mark("run")
    m.run(line_of(POCKET, "G1 X30 Y16"))
    m.wait("the next arc", lambda: m.stat.motion_line >= line_of(POCKET, "G3 X26 Y20"))
    m.periods(300)
    leave(m, notes)


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
    # No program ran: what was armed stays so until it is ended by hand.
    m.press("disarm-button")
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
    m.enter_serial(m.serial)
    same_part_again(m, notes)
    m.new_serial()
    notes.value("next-refusal", m.press_arm())
    notes.value("next-state", m.state)
    m.press("disarm-button")
    m.until_state(BYPASS)
