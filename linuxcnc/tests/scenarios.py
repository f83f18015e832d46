# SPDX-License-Identifier: GPL-2.0-or-later
"""What is done to the machine, one function a scenario. What has to come of it is checked on the recording, elsewhere.

Every scenario begins and ends with the machine on, idle, nothing armed. Marks name the moments that the checks need.
"""

from __future__ import annotations

# Importing them puts them into the table.
import board  # noqa: F401
import corrected  # noqa: F401
import story  # noqa: F401
import uncorrected  # noqa: F401
from steps import ALL

__all__ = ["ALL"]
