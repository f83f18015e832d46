#!/usr/bin/python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Takes the place of the screen: starts the recording, goes through the scenarios, ends LinuxCNC by ending itself.

What to do stands in the environment, because LinuxCNC starts this program without arguments:

- TRUEPATH_SCENARIOS: names, separated by commas
- TRUEPATH_RECORDINGS: folder for the recording and for notes.json, which says where in it each scenario lies
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
import traceback
from pathlib import Path

import hal

import scenarios
import steps
from machine import Machine, Stuck
from notes import Notes
from recorder import Recorder

# In the machine's folder: parts count up over several runs of LinuxCNC.
SERIAL = Path("last-serial")


def last_serial() -> int:
    return int(SERIAL.read_text()) if SERIAL.exists() else 0


def gone_through(name: str, machine: Machine, notes: Notes) -> bool:
    """One scenario. After one that got stuck the machine is brought back to where the next may begin."""
    print(f"scenario {name}", flush=True)
    try:
        with notes.scenario(name):
            scenarios.ALL[name](machine, notes)
        return True
    except Stuck as stuck:
        notes.failed(str(stuck))
        machine.abort()
        machine.switch_on()
        machine.until_idle()
        return False


def main() -> int:
    folder = Path(os.environ["TRUEPATH_RECORDINGS"])
    names = os.environ["TRUEPATH_SCENARIOS"].split(",")
    # Pins can be read and set by a component only.
    component = hal.component("truepath-tests")
    component.ready()
    # By this number the harness finds the real-time process after a crash.
    real_time = subprocess.run(["pidof", "rtapi_app"], capture_output=True, text=True).stdout
    (folder.parent.parent / "rtapi_app.pid").write_text(real_time)
    machine = Machine(last_serial())
    recorder = Recorder(folder)
    notes = Notes(machine)
    try:
        machine.switch_on()
        machine.home()
        # LinuxCNC's status may hold no work offset until the first program has ended: its first message about it is
        # lost when the machine is switched on before it was carried out.
        machine.mdi(steps.G54)
        done = [gone_through(name, machine, notes) for name in names]
        return 0 if all(done) else 1
    except Exception:
        notes.failed(traceback.format_exc())
        return 1
    finally:
        # The machine that is about to be killed stays in the contour.
        if names[-1] != "killed":
            machine.abort()
        recorder.stop()
        SERIAL.write_text(str(machine.serial))
        (folder / "notes.json").write_text(json.dumps(notes.all(), indent=1))
        # Last of all: the harness may end the machine from here on.
        (folder / "finished").touch()
        if names[-1] == "killed":
            time.sleep(60)


if __name__ == "__main__":
    sys.exit(main())
