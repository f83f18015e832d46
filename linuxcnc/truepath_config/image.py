# SPDX-License-Identifier: GPL-2.0-or-later
"""Correction images: which of a folder belongs to what runs, and its copy for the component.

Only the head is read here; the component checks the whole file before it uses it.
"""

from __future__ import annotations

import os
import struct
from dataclasses import dataclass
from pathlib import Path

from .files import replace

SUFFIX = ".tpi"
HEADER_BYTES = 288
MAGIC = b"TRUEPATH"
# Larger than any image a component takes; a file beyond it is not looked at.
MOST_BYTES = 64 << 20


@dataclass(frozen=True)
class Image:
    """A file and what it belongs to."""

    path: Path
    crc: int
    program_crc: int
    feature: int
    pass_number: int
    tool: int
    tool_offset: int
    setup: int
    clamp_nm: int
    slew_nm_per_s: int
    modified_ns: int


class NoImage(Exception):
    """Why none of the images fits; the text is for the operator. `several`: because more than one does."""

    def __init__(self, text: str, several: bool = False) -> None:
        super().__init__(text)
        self.several = several


def read(path: Path) -> Image | None:
    """The head of an image, or None when the file is none or cannot be read."""
    try:
        found = path.stat()
        size = found.st_size
        if not HEADER_BYTES + 4 <= size <= MOST_BYTES:
            return None
        with path.open("rb") as file:
            head = file.read(HEADER_BYTES)
            file.seek(-4, os.SEEK_END)
            tail = file.read(4)
    except OSError:
        return None
    if len(head) != HEADER_BYTES or len(tail) != 4 or not head.startswith(MAGIC):
        return None
    (length,) = struct.unpack_from("<I", head, 16)
    if length != size:
        return None
    binding = struct.unpack_from("<6I", head, 24)
    (clamp,) = struct.unpack_from("<q", head, 72)
    (slew,) = struct.unpack_from("<I", head, 96)
    (crc,) = struct.unpack("<I", tail)
    return Image(path, crc, *binding, clamp, slew, found.st_mtime_ns)


def folder(path: Path) -> list[Image]:
    """All images of a folder and below it, in the order of their paths."""
    found = (read(file) for file in sorted(path.rglob("*" + SUFFIX)) if file.is_file())
    return [image for image in found if image]


def name(image: Image, root: Path) -> str:
    """Its path below the folder of all images."""
    return image.path.relative_to(root).as_posix() if image.path.is_relative_to(root) else str(image.path)


def choose(
    images: list[Image],
    program_crc: int,
    feature: int | None,
    pass_number: int | None,
    tool: int,
    root: Path = Path(),
    latest_wins: bool = False,
) -> Image:
    """The image for a program, a feature and pass if they are asked for, and a tool. Copies of one image count once.
    With `latest_wins` the file written last is taken among several for the same feature, pass and tool.

    Raises NoImage when none fits, or more than one; their names count from `root`. An image for another tool is given when it is
    the only one: the component then says which tool it wants.
    """
    fit = [i for i in images if i.program_crc == program_crc]
    if not fit:
        raise NoImage("no image for this program: its CRC-32 is %08x. Was it changed after the correction was made?" % program_crc)
    if feature is not None:
        fit = [i for i in fit if i.feature == feature]
        if not fit:
            raise NoImage("no image for feature %d of this program" % feature)
    if pass_number is not None:
        fit = [i for i in fit if i.pass_number == pass_number]
        if not fit:
            raise NoImage("no image for pass %d of that feature" % pass_number)
    if len({i.crc for i in fit}) > 1:
        fit = [i for i in fit if i.tool == tool] or fit
    if len({i.crc for i in fit}) > 1:
        if len({(i.feature, i.pass_number, i.tool) for i in fit}) > 1:
            what = ", ".join("%s: feature %d pass %d tool %d" % (name(i, root), i.feature, i.pass_number, i.tool) for i in fit)
            raise NoImage("more than one image fits (%s): name feature and pass" % what, several=True)
        if not latest_wins:
            what = ", ".join(name(i, root) for i in fit)
            help = "move all but one out of %s, or let the latest win: [TRUEPATH]SEVERAL_IMAGES" % root
            raise NoImage("more than one image fits (%s): %s" % (what, help), several=True)
        return max(fit, key=lambda i: i.modified_ns)
    return fit[0]


def hand_over(image: Image, to: Path) -> None:
    """Copies it to the component's file, so that a reader sees the old file or the new one whole."""
    replace(to, image.path.read_bytes())
