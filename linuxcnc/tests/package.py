# SPDX-License-Identifier: GPL-2.0-or-later
"""Lets the tests import the package of truepath-config, from wherever they are started."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from truepath_config import arming, configuration, frame, identity, image, parts, permission, requests, words  # noqa: E402, F401
