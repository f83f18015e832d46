# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenarios in which a correction is on: to its end, broken off, held, at other speeds, in another place."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import hal

from machine import ACTIVE, HOLD, Machine, Stuck
from notes import Notes
from steps import CORNER, G54, POCKET, begin, into_contour, leave, same_part_again, scenario, until_out


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
def config_stopped(m: Machine, notes: Notes) -> None:
    """truepath-config hangs in the contour: the watchdog ends the correction, the program goes on."""
    into_contour(m, notes, POCKET)
    service = config_process()
    os.kill(service, signal.SIGSTOP)
    try:
        notes.mark("event")
        until_out(m)
        m.periods(300)
        leave(m, notes)
    finally:
        os.kill(service, signal.SIGCONT)
    m.wait("corrections permitted again", lambda: bool(m.pin("truepath-config.permitted")))


@scenario
def program_changed(m: Machine, notes: Notes) -> None:
    """The file of the program is written anew in the contour, with other bytes."""
    into_contour(m, notes, POCKET)
    before = POCKET.read_bytes()
    try:
        notes.mark("event")
        POCKET.write_bytes(before + b"(changed)\n")
        until_out(m)
        m.periods(300)
        leave(m, notes)
    finally:
        POCKET.write_bytes(before)
    m.open(CORNER)


def config_process() -> int:
    """Number of the process of truepath-config, by the name it was started with."""
    for process in Path("/proc").iterdir():
        words = (process / "cmdline").read_bytes().split(b"\0") if process.name.isdecimal() else []
        if len(words) > 1 and words[1].endswith(b"truepath-config"):
            return int(process.name)
    raise Stuck("truepath-config does not run")


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
def offset(m: Machine, notes: Notes) -> None:
    """Another work offset before arming, turned by ten degrees: the correction goes with it."""
    m.mdi("G10 L2 P1 X120.5 Y90.25 Z-119.75 R10")
    try:
        into_contour(m, notes, POCKET, 300)
        leave(m, notes)
    finally:
        m.mdi(G54)
