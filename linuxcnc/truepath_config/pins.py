# SPDX-License-Identifier: GPL-2.0-or-later
"""Pins of truepath-config. What each is connected to stands in truepath.hal and in the panel's HAL file."""

from __future__ import annotations

from typing import Any

COMPONENT = "truepath-config"

# To the real-time component.
FLOATS_OUT = ("offset-x", "offset-y", "offset-z")
SIGNED_OUT = ("frame-cosine", "frame-sine", "tool", "tool-offset")
UNSIGNED_OUT = ("program-crc", "feature", "pass", "setup", "part-serial")
BITS_OUT = (
    "trivial-kinematics", "program-running", "arm", "disarm", "reload",
    "heartbeat",  # changes with every look at LinuxCNC's status, while a correction is permitted
    "enable",  # to the watchdog: begins with its rising edge
)  # fmt: skip

# For the panel.
PANEL_BITS_OUT = (
    "is-off", "is-bypass", "is-armed", "is-active", "is-hold", "is-fault", "image-fits", "permitted",
    "image-missing", "image-several", "image-not-taken",  # why the image does not fit
    "ended-not", "ended-as-planned", "ended-by-stop", "ended-by-change", "ended-off-path", "ended-at-limit",
)  # fmt: skip
PANEL_FLOATS_OUT = ("correction-x-um", "correction-y-um", "peak-um")
PANEL_UNSIGNED_OUT = ("reason", "refusal", "armed-serial", "part")

# From the panel, or buttons of the machine: buttons act on a rising edge. `serial-wanted` 0: the part that is counted here.
BITS_IN = ("arm-button", "disarm-button", "reload-button", "new-part-button", "enable-switch", "enabled")
FLOATS_IN = ("serial-wanted", "feature-wanted")

# From M160 and M161: a request is a new number; the answer repeats it, with 0 or the code of the refusal.
MCODE_UNSIGNED_IN = ("mcode-request",)
MCODE_SIGNED_IN = ("mcode-code",)
MCODE_FLOATS_IN = ("mcode-p", "mcode-q")
MCODE_UNSIGNED_OUT = ("mcode-answered",)
MCODE_SIGNED_OUT = ("mcode-result",)


def make(hal: Any) -> Any:
    """The component with all its pins, not yet ready."""
    component = hal.component(COMPONENT)
    kinds = (
        (FLOATS_OUT + PANEL_FLOATS_OUT, hal.HAL_FLOAT, hal.HAL_OUT),
        (SIGNED_OUT + MCODE_SIGNED_OUT, hal.HAL_S32, hal.HAL_OUT),
        (UNSIGNED_OUT + PANEL_UNSIGNED_OUT + MCODE_UNSIGNED_OUT, hal.HAL_U32, hal.HAL_OUT),
        (BITS_OUT + PANEL_BITS_OUT, hal.HAL_BIT, hal.HAL_OUT),
        (BITS_IN, hal.HAL_BIT, hal.HAL_IN),
        (FLOATS_IN + MCODE_FLOATS_IN, hal.HAL_FLOAT, hal.HAL_IN),
        (MCODE_UNSIGNED_IN, hal.HAL_U32, hal.HAL_IN),
        (MCODE_SIGNED_IN, hal.HAL_S32, hal.HAL_IN),
    )
    for names, kind, direction in kinds:
        for name in names:
            component.newpin(name, kind, direction)
    component["enable-switch"] = True
    component["frame-cosine"] = 1 << 30
    return component
