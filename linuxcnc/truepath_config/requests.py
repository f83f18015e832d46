# SPDX-License-Identifier: GPL-2.0-or-later
"""Requests of the panel, of M160 and M161, one at a time, and their answers."""

from __future__ import annotations

import math
import time
from typing import Any

from . import arming
from .arming import Component, Request, Result, Situation, Steps
from .configuration import Configuration
from .identity import feature_and_pass
from .image import name
from .panel import Edge
from .parts import Parts
from .status import Operator

ARM, DISARM = 160, 161
# The component's refusal of a part that it has armed before.
SPENT = 4


class Requests:
    """What is being done for whom; `image_crc` is the image for the loaded program, 0 while none is known."""

    def __init__(self, pins: Any, component: Component, operator: Operator, configuration: Configuration) -> None:
        self._pins, self._component = pins, component
        self._operator, self._configuration = operator, configuration
        self._arm, self._disarm = Edge(pins, "arm-button"), Edge(pins, "disarm-button")
        self._reload, self._new_part = Edge(pins, "reload-button"), Edge(pins, "new-part-button")
        self._parts = Parts(configuration.part)
        if self._parts.trouble:
            operator.warn(self._parts.trouble)
        self._answered = int(pins["mcode-request"])
        self._steps: Steps | None = None
        self._for_mcode = False
        self._ran = False
        self._quiet = False
        self._ending = False
        self._look_for_image = False
        self.image_crc = 0
        # Why there is no image for the loaded program: one of words.IMAGE_STATES; empty while it is not known, or there is one.
        self.image_state = ""
        # Of the last arming that was asked for, the component's or this program's; 0: none.
        self.refusal = 0

    @property
    def part(self) -> int:
        """The number of the part that is clamped; 0 before the first."""
        return self._parts.number

    @property
    def busy(self) -> bool:
        """Whether something is being done."""
        return self._steps is not None

    def program_changed(self) -> None:
        """Another program is loaded: its image is looked for as soon as nothing else is done."""
        self.image_crc, self.image_state = 0, ""
        self._look_for_image = True

    def end(self, why: str) -> None:
        """Ends what is armed or on, whatever else is asked for; may be called in every round."""
        if self._ending:
            return
        self._ending = True
        self._operator.warn("disarmed: " + why)
        self._begin(arming.disarm(self._component, time.monotonic), quiet=True)

    def update(self, situation: Situation, changeable: bool) -> None:
        """Takes a request, goes on with the one that runs. `changeable`: nothing is armed or on."""
        asked = int(self._pins["mcode-request"])
        disarm = self._disarm.pressed()
        arm, reload = self._arm.pressed(), self._reload.pressed()
        if self._new_part.pressed():
            self._operator.tell(self._parts.next() if changeable else "a correction is armed or on: disarm first")
        aborted = self._for_mcode and self._ran and not situation.running
        self._ran = situation.running
        if disarm or aborted:
            # The program that asked with M160 is gone: nobody waits for what it asked.
            self._begin(arming.disarm(self._component, time.monotonic), quiet=aborted)
        elif self._steps is None and asked != self._answered:
            self._answered = asked
            self._mcode(situation)
        elif self._steps is None and arm:
            feature, pass_number = feature_and_pass(self._pins["feature-wanted"])
            self._begin(self._armed(situation, Request(feature, pass_number, self._serial())))
        elif self._steps is None and (reload or self._look_for_image and changeable):
            self._look_for_image = False
            self._begin(self._image(situation), quiet=not reload)
        self._go_on()

    def _mcode(self, situation: Situation) -> None:
        code = int(self._pins["mcode-code"])
        if code == DISARM:
            self._begin(arming.disarm(self._component, time.monotonic), mcode=True)
            return
        if not self._pins["enable-switch"]:
            # The operator mills this part uncorrected, with the same program.
            self._operator.tell("corrections are switched off: the program runs uncorrected")
            self._for_mcode = True
            self._answer(Result(0, ""))
            return
        feature, pass_number = feature_and_pass(self._pins["mcode-p"])
        serial = self._pins["mcode-q"]
        serial = _whole(serial) if serial >= 0 else self._serial()
        self._begin(self._armed(situation, Request(feature, pass_number, serial)), mcode=True)

    def _serial(self) -> int:
        """Of the part that is clamped; another panel may give it a number of its own."""
        given = self._pins["serial-wanted"]
        return _whole(given) if given else self._parts.number

    def _armed(self, situation: Situation, request: Request) -> Steps:
        self.refusal = 0
        result = yield from arming.arm(self._component, time.monotonic, self._configuration, situation, request)
        self.refusal = result.code
        if result.code == 0:
            self.image_crc, self.image_state = self._component.get("image-crc"), ""
        if result.code in (0, SPENT) and (trouble := self._parts.armed(request.serial)):
            self._operator.warn(trouble)
        return result

    def _image(self, situation: Situation) -> Steps:
        """The image for what is loaded, handed over before anyone arms it."""
        feature, pass_number = feature_and_pass(self._pins["feature-wanted"])
        try:
            chosen = arming.choose(self._configuration, situation, feature, pass_number)
        except arming.NoImage as error:
            self.image_state = "image-several" if error.several else "image-missing"
            if error.several and self._quiet:
                # The program was meant to be corrected: said before anyone arms.
                self._operator.tell(str(error))
            return Result(arming.NO_IMAGE, str(error))
        result = yield from arming.hand_over(self._component, time.monotonic, self._configuration, chosen)
        if result.code == 0:
            self.image_crc, self.image_state = chosen.crc, ""
            return Result(0, "image of %s" % name(chosen, self._configuration.images))
        self.image_state = "image-not-taken"
        if self._quiet:
            self._operator.tell(result.text)
        return result

    def _begin(self, steps: Steps, mcode: bool = False, quiet: bool = False) -> None:
        if self._steps is not None:
            # Only a disarming interrupts.
            self._steps.close()
            for pin in ("arm", "reload"):
                self._component.set(pin, False)
            if self._for_mcode:
                self._answer(Result(arming.BUSY, "interrupted by a disarming"))
        self._steps, self._for_mcode, self._quiet = steps, mcode, quiet

    def _go_on(self) -> None:
        if self._steps is None:
            return
        try:
            next(self._steps)
        except StopIteration as end:
            self._steps, self._ending = None, False
            result: Result = end.value
            if result.code and not self._quiet:
                self._operator.warn("refused (%d): %s" % (result.code, result.text))
            elif not self._quiet:
                self._operator.tell(result.text)
            if self._for_mcode:
                self._answer(result)

    def _answer(self, result: Result) -> None:
        self._for_mcode = False
        self._pins["mcode-result"] = result.code
        self._pins["mcode-answered"] = self._answered


def _whole(number: float) -> int:
    """A pin's number as a whole one; 0, which no part has, when it is none."""
    return int(number) if math.isfinite(number) and number == int(number) and number >= 0 else 0
