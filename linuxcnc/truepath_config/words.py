# SPDX-License-Identifier: GPL-2.0-or-later
"""Numbers of the component in words, with what to do. The numbers are those of reason.rs, refusal.rs, error.rs in
the core; refusals from 64 on are those of arming.rs in linuxcnc/abi."""

from __future__ import annotations

OFF, BYPASS, ARMED, ACTIVE, HOLD, FAULT = range(6)
STATES = ("off", "bypass", "armed", "active", "hold", "fault")

# Why the image for the loaded program is none: pins of the panel. While it is looked for, none of them is on.
IMAGE_STATES = ("image-missing", "image-several", "image-not-taken")

FIRST_FAULT = 16
REASONS = {
    0: "nothing happened",
    1: "the path was followed to its end",
    2: "disarmed by command",
    3: "the program ended",
    16: "emergency stop",
    17: "the program was aborted",
    18: "a tool change began",
    19: "the drives were disabled",
    20: "the frame changed after arming",
    21: "the image changed after arming",
    22: "a setpoint jumped farther than a feed move can",
    23: "the setpoint is farther from the path than its tolerance",
    24: "the setpoint went back along the path farther than its tolerance",
    25: "the cutter left the gate without going down to the pass",
    26: "the cutter rose out of the pass before the end of the path",
    27: "the cutter went below the pass",
    28: "the setpoint moved away during a feed hold",
    29: "setpoints were repeated, or more were lost than permitted",
    30: "the corrected position would pass a joint limit",
    31: "no setpoint came for too long",
    32: "setpoints came faster than the settings say",
}

# What the panel shows of a reason: in the order of its legends.
ENDS = ("not", "as-planned", "by-stop", "by-change", "off-path", "at-limit")
END_OF = {
    "not": (0,),
    "as-planned": (1, 2, 3),
    "by-stop": (16, 17, 19),
    "by-change": (18, 20, 21),
    "off-path": (22, 23, 24, 25, 26, 27, 28),
    "at-limit": (29, 30, 31, 32),
}

REFUSALS = {
    1: "not possible in this state: home, switch on, end what is armed",
    2: "there is no image in the component",
    3: "the drives are still enabled",
    4: "this part was armed for this pass before, and a second correction would gouge: press New part when the next stock is clamped",
    5: "the frame is damaged",
    6: "the turn of the work offset is damaged",
    7: "X, Y and Z are not three different joints: check COORDINATES",
    8: "no setpoints arrive: is truepath.command in the servo thread?",
    9: "setpoints come faster than the servo period says, or have only just begun",
    10: "the drives were dropped, and nobody has acknowledged since that they are disabled: switch the machine off and on again",
    16: "the image is for another program",
    17: "the image is for another feature",
    18: "the image is for another pass",
    19: "the image is for another tool than the one in the spindle",
    20: "the image is for another tool offset than the one in force: say offset_number in [tool] of the job",
    21: "the image is for another setup: say setup in [correct] of the job, or SETUP in [TRUEPATH]",
    64: "corrections are not permitted: see the switch on the panel, and whether truepath-config runs",
    65: "the kinematics are not trivial",
    66: "a probing move runs",
    67: "the ledger cannot be written, so the part would not be remembered: is the disk full, may LinuxCNC write there?",
    68: "an arming is under way",
    69: "while the ledger was written the program ended, a stop came, or it was disarmed",
}

IMAGE_ERRORS = {
    1: "it is too large for the component",
    2: "it is cut off, or has something behind its end",
    3: "it is not a correction image",
    4: "it has another format: make it again with this version",
    5: "it was made for another version of the arithmetic: make it again with this version",
    6: "it is damaged",
    7: "a reserved bit is set",
    8: "a value of its head is outside its range",
    9: "its table of the chip factor is wrong",
    10: "a node lies too far from the first",
    11: "two nodes are too close or too far apart",
    12: "a derived value is wrong",
    13: "its correction is larger than its clamp",
    14: "it is marked as closed and is not",
    15: "it is not signed, and a key is provisioned: sign it, or make it with truepath correct --sign",
    16: "it is signed with a key that is not trusted here",
    17: "its signature is wrong: it was changed, or signed by somebody else. Find out where it came from",
    18: "it is signed for another class of device: sign it again with --for",
    19: "a key is no sound public key",
    20: "a later one of its program was in use: use that, or to go back on purpose sign this one again with truepath image sign",
    21: "it is signed with a key that was revoked",
    22: "it is signed with a key that may log in, and not sign images: sign it with another key",
    32: "the limits of joint 0 are missing or wrong: min-limit, max-limit, max-correction-vel, max-correction-accel",
    33: "the limits of joint 1 are missing or wrong",
    34: "the limits of joint 2 are missing or wrong",
    35: "the limits of joint 3 are missing or wrong",
    36: "the limits of joint 4 are missing or wrong",
    37: "the limits of joint 5 are missing or wrong",
    40: "the limits do not go with the servo period: the correction could not move",
    41: "the image before is not yet taken",
    42: "the ledger cannot be written, so its counter would not be remembered: is the disk full, may LinuxCNC write there?",
    64: "the file cannot be read: see LinuxCNC's messages",
}


def reason(code: int) -> str:
    """Why a correction ended."""
    return REASONS.get(code, "reason %d" % code)


def refusal(code: int) -> str:
    """Why an arming was refused."""
    return REFUSALS.get(code, "refusal %d of the component, see docs/linuxcnc.md" % code)


def image_error(code: int) -> str:
    """Why an image is not in use."""
    return IMAGE_ERRORS.get(code, "error %d of the component, see docs/linuxcnc.md" % code)
