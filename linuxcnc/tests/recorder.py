# SPDX-License-Identifier: GPL-2.0-or-later
"""Records pins of the machine in every servo period, with HAL's own sampler.

The columns are split over two samplers because one takes at most 21 pins; both begin with the sequence number of the
component, by which the lines are put together again and by which a lost period shows. The sampler prints floats with
six decimals: nanometres, for pins in millimetres.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

DEPTH = 60_000
SEQUENCE = ("sequence", "u", "truepath.sequence")
JOINTS = range(3)

# Column, type of the sampler, pin.
Column = tuple[str, str, str]


def joints(name: str, kind: str, pin: str) -> list[Column]:
    return [(f"{name}-{joint}", kind, pin.format(joint)) for joint in JOINTS]


FIRST: list[Column] = [
    SEQUENCE,
    ("state", "u", "truepath.state"),
    ("flags", "u", "truepath.flags"),
    ("reason", "u", "truepath.reason"),
    ("spindle-rpm", "f", "truepath.spindle-rpm"),
    ("motion-type", "s", "motion.motion-type"),
    ("line", "s", "motion.program-line"),
    ("inhibit", "b", "truepath.feed-inhibit"),
    *joints("correction-nm", "s", "truepath.correction-nm-{}"),
    *joints("setpoint", "f", "truepath.{}.pos-cmd"),
    *joints("motor-in", "f", "truepath.{}.motor-pos-cmd-in"),
    *joints("motor-out", "f", "truepath.{}.motor-pos-cmd"),
]
SECOND: list[Column] = [
    SEQUENCE,
    *joints("feedback-in", "f", "truepath.{}.motor-pos-fb-in"),
    *joints("feedback-out", "f", "truepath.{}.motor-pos-fb"),
    *joints("following-error", "f", "joint.{}.f-error"),
    ("drives-on", "b", "truepath.drives-on"),
    ("faded", "b", "truepath.faded"),
    ("spindle-on", "b", "truepath.spindle-on"),
    ("drive-enabled", "b", "truepath.0.amp-enable"),
    ("link-lost", "b", "truepath.link-lost"),
    ("link-misses", "u", "truepath.link-misses"),
    ("time-command", "s", "truepath.command.time"),
    ("time-feedback", "s", "truepath.feedback.time"),
    ("time-controller", "s", "motion-controller.time"),
]


def halcmd(*words: str) -> str:
    done = subprocess.run(["halcmd", *words], check=True, capture_output=True, text=True)
    return done.stdout


def signals() -> dict[str, str]:
    """The signal of every pin that has one."""
    found = {}
    for line in halcmd("-s", "show", "pin").splitlines():
        words = line.split()
        if len(words) >= 7 and words[5] in ("==>", "<==", "<=>"):
            found[words[4]] = words[6]
    return found


def parameters() -> set[str]:
    return {line.split()[4] for line in halcmd("-s", "show", "param").splitlines() if len(line.split()) >= 5}


class Recorder:
    """Two samplers and the programs that empty them, from now until `stop`."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        banks = [FIRST, SECOND]
        kinds = ",".join("".join(kind for _, kind, _ in bank) for bank in banks)
        halcmd("loadrt", "sampler", f"depth={DEPTH},{DEPTH}", f"cfg={kinds}")
        self.readers = [self.attach(bank, columns) for bank, columns in enumerate(banks)]

    def attach(self, bank: int, columns: list[Column]) -> subprocess.Popen[bytes]:
        wired = signals()
        for place, (_, _, pin) in enumerate(columns):
            signal = wired.get(pin, f"record-{pin}")
            words = [signal, f"sampler.{bank}.pin.{place}"]
            halcmd("net", *words) if pin in wired else halcmd("net", signal, pin, words[1])
            wired[pin] = signal
        file = self.folder / f"bank-{bank}.txt"
        (self.folder / f"bank-{bank}.columns").write_text(",".join(name for name, _, _ in columns) + "\n")
        reader = subprocess.Popen(["halsampler", "-c", str(bank), str(file)])
        halcmd("addf", f"sampler.{bank}", "servo-thread")
        return reader

    def stop(self) -> None:
        for bank, reader in enumerate(self.readers):
            halcmd("setp", f"sampler.{bank}.enable", "0")
        for bank, reader in enumerate(self.readers):
            while int(halcmd("getp", f"sampler.{bank}.curr-depth")) > 0:
                pass
            reader.terminate()
            reader.wait(timeout=30)
