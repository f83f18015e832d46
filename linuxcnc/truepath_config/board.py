# SPDX-License-Identifier: GPL-2.0-or-later
"""Route B: what truepath-config asks of the board over its configuration link, with `truepath device`.

One question at a time, each a process of its own, so that a board that does not answer stops nothing here: every
function is a generator that yields while it waits, once per round of its loop.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

from .configuration import Configuration
from .image import Image

# The longest: an upload that has to erase the flash first.
PATIENCE_S = 40.0
# Between two acknowledgements that were refused.
AGAIN_S = 1.0
OFF, ARMED, ACTIVE = 0, 2, 3
Clock = Callable[[], float]


@dataclass(frozen=True)
class Answer:
    """What the board said; `text` is the reason when it refused."""

    done: bool
    text: str
    value: Any = None


Asking = Generator[None, None, Answer]


class Board:
    """The board at the configuration port."""

    def __init__(self, configuration: Configuration, clock: Clock) -> None:
        self._words = [configuration.truepath, "--json", "device", "--port", configuration.config_port]
        self._words += ["--baud", str(configuration.config_baud)]
        self._clock, self._running = clock, False
        self._acknowledging: Asking | None = None
        self._acknowledged = -AGAIN_S
        # The image the board uses, as far as it is known.
        self.image_crc = 0

    def ask(self, *words: str) -> Asking:
        """Until the answer is there."""
        begin = self._clock()
        while self._running:
            yield
        self._running = True
        process = None
        try:
            process = subprocess.Popen([*self._words, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while process.poll() is None:
                if self._clock() - begin > PATIENCE_S:
                    return Answer(False, "the board does not answer on its configuration link")
                yield
            out, error = process.communicate()
            if process.returncode:
                return Answer(False, refusal(error) or "truepath device ended with %d" % process.returncode)
            return Answer(True, "", json.loads(out))
        except (OSError, ValueError) as error:
            return Answer(False, "truepath device: %s" % error)
        finally:
            self._running = False
            if process is not None and process.poll() is None:
                process.kill()
                process.communicate()

    def use(self, chosen: Image) -> Asking:
        """Until the board uses an image; it keeps two, so one it has already is not sent again."""
        listed = yield from self.ask("list")
        if not listed.done:
            return listed
        for number, slot in enumerate(listed.value):
            there = slot.get("Image") if isinstance(slot, dict) else None
            if there and there["crc"] == chosen.crc:
                answer = Answer(True, "") if there["active"] else (yield from self.ask("activate", str(number)))
                break
        else:
            answer = yield from self.ask("upload", str(chosen.path), "--activate")
        self.image_crc = chosen.crc if answer.done else 0
        return answer

    def arm(self, get: Callable[[str], Any]) -> Asking:
        """Arms for what the pins of the component say: the same that it sends in every period."""
        unit = get("nm-per-unit")
        offset = ",".join(str(nearest_nm(get("offset-" + axis) * unit)) for axis in "xyz")
        words = ["--part", get("part-serial"), "--program-crc", "%08x" % get("program-crc"), "--feature", get("feature")]
        words += ["--pass", get("pass"), "--tool", get("tool"), "--tool-offset", get("tool-offset")]
        words += ["--setup", get("setup"), "--cosine=%d" % get("frame-cosine"), "--sine=%d" % get("frame-sine")]
        return (yield from self.ask("arm", *map(str, words), "--offset-nm=" + offset))

    def acknowledge(self, get: Callable[[str], Any]) -> None:
        """Once per round: a board that is off, with the drives off, is told that they are."""
        if self._acknowledging is None:
            due = self._clock() - self._acknowledged >= AGAIN_S and not self._running
            if due and get("state") == OFF and not get("link-lost") and not get("drives-on"):
                self._acknowledging = self.ask("acknowledge")
                # It was reset: which image it uses has to be asked again.
                self.image_crc = 0
        if self._acknowledging is not None:
            try:
                next(self._acknowledging)
            except StopIteration:
                self._acknowledging, self._acknowledged = None, self._clock()


def refusal(error: str) -> str:
    """What an error of `truepath --json` says was found; the text itself when it is something else."""
    try:
        return str(json.loads(error)["error"]["found"])
    except (ValueError, LookupError, TypeError):
        return " ".join(error.split())


def nearest_nm(nm: float) -> int:
    """The whole nanometre that the component takes for a length."""
    return int(nm - 0.5) if nm < 0 else int(nm + 0.5)
