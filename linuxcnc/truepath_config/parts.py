# SPDX-License-Identifier: GPL-2.0-or-later
"""The number of the part that is clamped. It counts up when the operator says that a new part is, never by itself: a program
that is run again on the same part must be refused. It is kept over restarts."""

from __future__ import annotations

from pathlib import Path

from .files import replace


class Parts:
    """`number` is 0 until the first part; `used` says that it was armed, so that the next part takes another."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.number, self.used = 0, True
        # What was wrong with the file, for the operator; empty: nothing.
        self.trouble = ""
        try:
            words = path.read_text(encoding="ascii").split()
        except FileNotFoundError:
            return
        except (OSError, UnicodeDecodeError) as error:
            self.trouble = "%s cannot be read (%s): the parts are counted from 1 again" % (path, error)
            return
        if len(words) in (1, 2) and words[0].isdecimal() and words[1:] in ([], ["used"]):
            self.number, self.used = int(words[0]), len(words) == 2
        else:
            self.trouble = "%s holds no number of a part: the parts are counted from 1 again" % path

    def next(self) -> str:
        """Another part is clamped; what to tell. A number that was never armed stays, however often the button is pressed."""
        if not self.used:
            return "part %d is not milled yet: it keeps its number" % self.number
        return self._set(self.number + 1, False) or "part %d" % self.number

    def armed(self, serial: int) -> str:
        """A part was armed, or was known to have been; what to tell, or nothing."""
        if serial < self.number or serial == self.number and self.used:
            return ""
        return self._set(serial, True)

    def _set(self, number: int, used: bool) -> str:
        self.number, self.used = number, used
        try:
            replace(self._path, ("%d%s\n" % (number, " used" if used else "")).encode("ascii"))
        except OSError as error:
            return "part %d; its number cannot be kept in %s: %s" % (number, self._path, error)
        return ""
