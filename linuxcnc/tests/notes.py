# SPDX-License-Identifier: GPL-2.0-or-later
"""What the recording does not hold: which scenario lies where, when what was done to the machine, what it answered."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from machine import Machine


class Notes:
    """Notes of a session, by scenario. Times are sequence numbers of the component: lines of the recording."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.scenarios: list[dict[str, Any]] = []

    @contextmanager
    def scenario(self, name: str) -> Iterator[None]:
        self.scenarios.append({"name": name, "from": self.machine.sequence, "marks": [], "values": {}})
        first_word = len(self.machine.said)
        try:
            yield
        finally:
            entry = self.scenarios[-1]
            entry["to"] = self.machine.sequence
            entry["said"] = [{"at": at, "text": text} for at, text in self.machine.said[first_word:]]

    def mark(self, what: str) -> None:
        """What comes next in the program happens after this line of the recording."""
        self.scenarios[-1]["marks"].append({"what": what, "at": self.machine.sequence})

    def value(self, name: str, value: Any) -> None:
        self.scenarios[-1]["values"][name] = value

    def pins(self, *names: str) -> None:
        """Keeps the values that pins have now."""
        for name in names:
            self.value(name, self.machine.pin(name))

    def failed(self, why: str) -> None:
        if not self.scenarios:
            self.scenarios.append({"name": "start", "from": 0, "to": 0, "marks": [], "values": {}, "said": []})
        self.scenarios[-1]["failed"] = why

    def all(self) -> dict[str, Any]:
        return {"scenarios": self.scenarios}
