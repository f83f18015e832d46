# SPDX-License-Identifier: GPL-2.0-or-later
"""From program coordinates to machine coordinates, as LinuxCNC's canonical layer does it:

    machine = g5x + R · (program + g92) + tool offset

R turns the XY plane by the rotation of the work offset (`rotate_and_offset` of emccanon.cc). With the angle zero all
offsets simply add up. For the component: offset = g5x + R·g92 + tool offset, and R as cosine and sine in units of 2⁻³⁰.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Sequence

TURN_ONE = 1 << 30


@dataclass(frozen=True)
class Frame:
    """Offsets in machine units; cosine and sine of the turn, units of 2⁻³⁰."""

    offset: tuple[float, float, float]
    cosine: int
    sine: int

    def machine(self, point: Sequence[float]) -> tuple[float, float, float]:
        """Machine coordinates of a point in program coordinates."""
        c, s = self.cosine / TURN_ONE, self.sine / TURN_ONE
        x, y, z = point
        ox, oy, oz = self.offset
        return (ox + c * x - s * y, oy + s * x + c * y, oz + z)


def frame(g5x: Sequence[float], g92: Sequence[float], tool: Sequence[float], degrees: float) -> Frame:
    """The frame of LinuxCNC's status: g5x_offset, g92_offset, tool_offset, rotation_xy."""
    angle = math.radians(degrees)
    # Quarter turns are exact: cos(90°) of a float is not 0.
    quarter = degrees / 90.0
    if quarter == round(quarter):
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[int(quarter) % 4]
    else:
        c, s = math.cos(angle), math.sin(angle)
    offset = (
        g5x[0] + c * g92[0] - s * g92[1] + tool[0],
        g5x[1] + s * g92[0] + c * g92[1] + tool[1],
        g5x[2] + g92[2] + tool[2],
    )
    return Frame(offset, round(c * TURN_ONE), round(s * TURN_ONE))
