# SPDX-License-Identifier: GPL-2.0-or-later
"""The machine's INI file, as far as Truepath is concerned, and what in it forbids a correction."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol


class Ini(Protocol):
    """What linuxcnc.ini offers."""

    def find(self, section: str, key: str) -> str | None: ...


class Wrong(Exception):
    """The configuration cannot be used; the text says what was found and what to write."""


@dataclass(frozen=True)
class Configuration:
    """[TRUEPATH] and what follows from the rest."""

    coordinates: str
    images: Path
    image: Path
    setup: int | None
    port: str
    config_port: str
    config_baud: int
    truepath: str
    # Keeps the number of the part over restarts.
    part: Path = Path("truepath.part")
    # Among several images for the same feature, pass and tool the file written last is taken.
    latest_wins: bool = False
    problems: list[str] = field(default_factory=list)


def load(ini: Ini, folder: Path) -> Configuration:
    """Reads it; relative paths count from the folder of the INI file.

    Raises Wrong for what truepath-config cannot run without. Problems that only forbid arming are listed.
    """
    coordinates = "".join(_text(ini, "COORDINATES").split()).upper()
    if not coordinates or set(coordinates) - set("XYZABCUVW") or not {"X", "Y", "Z"} <= set(coordinates):
        raise Wrong("[TRUEPATH]COORDINATES = %s: the axis letter of each joint is expected, XYZ at least" % coordinates)
    return Configuration(
        coordinates=coordinates,
        images=folder / _text(ini, "IMAGES"),
        image=folder / _text(ini, "IMAGE"),
        setup=_setup(ini),
        port=_parameter(ini.find("TRUEPATH", "BOARD") or "", "port"),
        config_port=ini.find("TRUEPATH", "CONFIG_PORT") or "",
        config_baud=int(_number(ini, "TRUEPATH", "CONFIG_BAUD", 921600)),
        truepath=ini.find("TRUEPATH", "TRUEPATH") or "truepath",
        part=folder / (ini.find("TRUEPATH", "PART") or "truepath.part"),
        latest_wins=_latest_wins(ini),
        problems=kinematics(ini, coordinates) + headroom(ini, coordinates) + board(ini),
    )


def kinematics(ini: Ini, coordinates: str) -> list[str]:
    """Why a joint is not simply an axis; empty when it is."""
    words = (ini.find("KINS", "KINEMATICS") or "").split()
    if not words or words[0] != "trivkins":
        return ["[KINS]KINEMATICS = %s: only trivkins can be corrected" % " ".join(words)]
    given = [w.split("=", 1)[1].upper() for w in words[1:] if w.lower().startswith("coordinates=")]
    joints = given[0] if given else "XYZABCUVW"[: int(_number(ini, "KINS", "JOINTS", 3))]
    if joints != coordinates:
        return ["[TRUEPATH]COORDINATES = %s, but the joints of [KINS] are %s" % (coordinates, joints)]
    return []


def headroom(ini: Ini, coordinates: str) -> list[str]:
    """Where the planner's limits and the correction's together are more than a joint's; empty when nowhere.

    The correction moves X and Y only.
    """
    problems = []
    for key, limit in (("MAX_VELOCITY", "MAX_CORRECTION_VEL"), ("MAX_ACCELERATION", "MAX_CORRECTION_ACCEL")):
        correction = _number(ini, "TRUEPATH", limit, math.nan)
        if not correction > 0:
            problems.append("[TRUEPATH]%s is missing or not above 0" % limit)
            continue
        for joint, letter in enumerate(coordinates):
            if letter not in "XY":
                continue
            axis = _number(ini, "AXIS_" + letter, key, math.nan)
            most = _number(ini, "JOINT_%d" % joint, key, math.nan)
            # Not <=: with a number missing nothing is proved.
            if not axis + correction <= most * (1 + 1e-9):
                problems.append(
                    "[AXIS_%s]%s %g and [TRUEPATH]%s %g are more than [JOINT_%d]%s %g: lower one of the first two"
                    % (letter, key, axis, limit, correction, joint, key, most)
                )
    return problems


def board(ini: Ini) -> list[str]:
    """What is missing for a board (Route B); empty without one."""
    if _parameter(ini.find("TRUEPATH", "BOARD") or "", "port") and not ini.find("TRUEPATH", "CONFIG_PORT"):
        return ["[TRUEPATH]CONFIG_PORT is missing: the port over which the board is asked to arm"]
    return []


def _parameter(words: str, name: str) -> str:
    """The value of name=value among the parameters of the component."""
    return next((w.split("=", 1)[1] for w in words.split() if w.startswith(name + "=")), "")


def _setup(ini: Ini) -> int | None:
    """A fixed number of the setup, or None: that of the work offset."""
    text = ini.find("TRUEPATH", "SETUP") or "work-offset"
    if text == "work-offset":
        return None
    if text.isdecimal() and 1 <= int(text) <= 99_999:
        return int(text)
    raise Wrong("[TRUEPATH]SETUP = %s: work-offset, or a number from 1 to 99999 is expected" % text)


def _latest_wins(ini: Ini) -> bool:
    text = ini.find("TRUEPATH", "SEVERAL_IMAGES") or "refused"
    if text in ("refused", "latest-wins"):
        return text == "latest-wins"
    raise Wrong("[TRUEPATH]SEVERAL_IMAGES = %s: refused or latest-wins is expected" % text)


def _text(ini: Ini, key: str) -> str:
    text = ini.find("TRUEPATH", key)
    if not text:
        raise Wrong("[TRUEPATH]%s is missing in the INI file" % key)
    return text


def _number(ini: Ini, section: str, key: str, otherwise: float) -> float:
    text = ini.find(section, key)
    if text is None:
        return otherwise
    try:
        return float(text)
    except ValueError:
        return math.nan
