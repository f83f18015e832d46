# SPDX-License-Identifier: GPL-2.0-or-later
"""What LinuxCNC is about to run: program, tool offset, setup."""

from __future__ import annotations

import os
import zlib
from typing import Iterable, Sequence

# Active G codes of LinuxCNC's status, times ten.
G43, G49 = 430, 490
# The number of a tool offset that cannot be told: no image has it.
UNKNOWN = -1
# More than any program; the interpreter itself reads line by line.
MOST_BYTES = 256 << 20


class Program:
    """CRC-32 of the loaded file, computed again when the file changes."""

    def __init__(self) -> None:
        self.path = ""
        self.crc = 0
        self._seen: tuple[int, ...] | None = None

    def update(self, path: str) -> bool:
        """Looks at the file that is loaded now; True if what would run is another one. Without a file the CRC is 0."""
        before = (self.path, self.crc)
        if not path:
            self.path, self.crc, self._seen = "", 0, None
            return (self.path, self.crc) != before
        try:
            status = os.stat(path)
            seen = (status.st_ino, status.st_size, status.st_mtime_ns)
            if path != self.path or seen != self._seen:
                self.crc = crc32_of(path)
            self._seen = seen
        except OSError:
            self.crc, self._seen = 0, None
        self.path = path
        return (self.path, self.crc) != before


def crc32_of(path: str) -> int:
    """CRC-32 (ISO-HDLC) of the bytes of a file.

    Raises OSError when it cannot be read or is too large.
    """
    crc, left = 0, MOST_BYTES
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            left -= len(block)
            if left < 0:
                raise OSError("%s is larger than %d bytes" % (path, MOST_BYTES))
            crc = zlib.crc32(block, crc)
    return crc


def work_offset(index: int, gcodes: Iterable[int]) -> int:
    """Number of the work offset, 1 for G54 to 9 for G59.3, or 0 when the status contradicts itself.

    A LinuxCNC that is switched on in the moment of its start keeps its offsets to itself: the status then has 0 for
    index and offsets, while the interpreter works with those of its file. The modal code tells.
    """
    modal = {code: number for number, code in enumerate((540, 550, 560, 570, 580, 590, 591, 592, 593), start=1)}
    active = [modal[code] for code in gcodes if code in modal]
    return index if active == [index] else 0


def tool_offset_number(
    gcodes: Iterable[int], offset: Sequence[float], in_spindle: int, table: Iterable[tuple[int, Sequence[float]]]
) -> int:
    """Number of the tool offset in force: 0 with G49, else the H of G43.

    LinuxCNC's status has the offset but not its H. It is the tool in the spindle when its entry in the tool table is
    that offset, else the only entry that is, else UNKNOWN. `table`: number and offset of each tool.
    """
    codes = set(gcodes)
    if G49 in codes or G43 not in codes:
        # G43.1 and G43.2 have no entry of their own.
        return 0 if G49 in codes or not any(offset) else UNKNOWN
    same = {number for number, entry in table if _equal(entry, offset)}
    if in_spindle in same:
        return in_spindle
    return same.pop() if len(same) == 1 else UNKNOWN


def _equal(a: Sequence[float], b: Sequence[float]) -> bool:
    return len(a) == len(b) and all(abs(p - q) < 1e-9 for p, q in zip(a, b))


def feature_and_pass(number: float) -> tuple[int | None, int | None]:
    """The P word of M160: P3 is feature 3, P3.2 its pass 2; below 1, as when there is no P, nothing is asked for."""
    if not 1 <= number <= 1e6:
        return None, None
    tenths = round(number * 10)
    feature, pass_number = divmod(tenths, 10)
    return feature, pass_number or None
