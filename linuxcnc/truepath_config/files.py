# SPDX-License-Identifier: GPL-2.0-or-later
"""Files that are read by others, or again after a power cut: the old one or the new one, whole."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def replace(to: Path, data: bytes) -> None:
    """Writes a file beside it and renames, so that a reader sees the old file or the new one. Raises OSError."""
    handle, name = tempfile.mkstemp(dir=to.parent, prefix=to.name + ".")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(name, to)
    except BaseException:
        os.unlink(name)
        raise
