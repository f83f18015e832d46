# SPDX-License-Identifier: GPL-2.0-or-later
"""Handing an image to the component, arming it, and the answer: steps that wait without stopping the loop of the service.

Each is a generator: it yields while it waits, once per round of the loop, and returns a Result.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Generator, Protocol

from . import image, words
from .board import Board
from .configuration import Configuration
from .image import Image, NoImage

# Refusals of truepath-config; those of the component are below 100.
CONFIGURATION, NO_IMAGE, IMAGE_NOT_TAKEN, FROM_MDI, NO_ANSWER = 100, 101, 102, 103, 104
BUSY, EXTERNAL_OFFSET, TOOL_OFFSET, NOT_PERMITTED, SERIAL, BOARD, OFFSETS = 105, 106, 107, 108, 109, 110, 111

# Reading and checking the image, writing the ledger to the disk: seconds on a busy one.
PATIENCE_S = 5.0
# A refusal that reads as the last one did is believed after this time.
SETTLED_S = 0.5
MOST_SERIAL = (1 << 32) - 1


@dataclass(frozen=True)
class Result:
    """0, or the code of a refusal; and what to tell."""

    code: int
    text: str


@dataclass(frozen=True)
class Request:
    """What is to be armed; None: whatever there is an image for."""

    feature: int | None
    pass_number: int | None
    serial: int


@dataclass(frozen=True)
class Situation:
    """What LinuxCNC is doing, as far as arming is concerned."""

    program_crc: int
    tool: int
    tool_offset: int
    mdi: bool
    external_offset: bool
    permitted: bool
    # False: the offsets of the status are not those in force.
    offsets_known: bool = True
    running: bool = True


class Component(Protocol):
    """The real-time component, and the pins to it; the board when there is one (Route B)."""

    board: Board | None

    def get(self, pin: str) -> int: ...

    def set(self, pin: str, value: int | bool) -> None: ...


Steps = Generator[None, None, Result]
Clock = Callable[[], float]


def choose(configuration: Configuration, situation: Situation, feature: int | None, pass_number: int | None) -> Image:
    """The image for what is loaded. Raises NoImage."""
    root = configuration.images
    wanted = (situation.program_crc, feature, pass_number, situation.tool)
    return image.choose(image.folder(root), *wanted, root, configuration.latest_wins)


def hand_over(component: Component, clock: Clock, configuration: Configuration, chosen: Image) -> Steps:
    """Until the component uses the image."""
    if component.get("image-ready") and component.get("image-crc") == chosen.crc:
        return Result(0, "")
    if component.board is not None:
        used = yield from component.board.use(chosen)
        return Result(0 if used.done else IMAGE_NOT_TAKEN, used.text)
    try:
        image.hand_over(chosen, configuration.image)
    except OSError as error:
        return Result(IMAGE_NOT_TAKEN, "%s cannot be copied to %s: %s" % (chosen.path.name, configuration.image, error))
    yield from _pulse(component, "reload")
    begin = clock()
    while clock() - begin < PATIENCE_S:
        if component.get("image-ready") and component.get("image-crc") == chosen.crc:
            return Result(0, "")
        if (error := component.get("image-error")) and clock() - begin > SETTLED_S:
            return Result(IMAGE_NOT_TAKEN, "%s is not used: %s" % (chosen.path.name, words.image_error(error)))
        yield
    return Result(IMAGE_NOT_TAKEN, "%s is not taken; nothing can change while a correction is armed or on" % chosen.path.name)


def forbidden(configuration: Configuration, situation: Situation, request: Request) -> Result | None:
    """What truepath-config itself refuses, before the component is asked."""
    if configuration.problems:
        return Result(CONFIGURATION, "; ".join(configuration.problems))
    if situation.mdi:
        return Result(FROM_MDI, "M160 works from a program; before it is started, use the panel")
    if situation.external_offset:
        return Result(EXTERNAL_OFFSET, "an external offset is on: it moves the axes off the program")
    if not situation.permitted:
        return Result(NOT_PERMITTED, "corrections are not permitted: see the switch on the panel")
    if not situation.offsets_known:
        return Result(OFFSETS, "LinuxCNC does not show the work offset in force: command G55 and G54 by hand (MDI), then again")
    if situation.tool_offset < 0:
        return Result(TOOL_OFFSET, "the number of the tool offset in force cannot be told: use G43 H or G49")
    if not 1 <= request.serial <= MOST_SERIAL:
        return Result(SERIAL, "no part has a number: press New part on the panel when the stock is clamped")
    return None


def arm(
    component: Component, clock: Clock, configuration: Configuration, situation: Situation, request: Request
) -> Steps:
    """From the request to armed or refused."""
    if refused := forbidden(configuration, situation, request):
        return refused
    try:
        chosen = choose(configuration, situation, request.feature, request.pass_number)
    except NoImage as error:
        return Result(NO_IMAGE, str(error))
    component.set("feature", chosen.feature)
    component.set("pass", chosen.pass_number)
    component.set("part-serial", request.serial)
    handed = yield from hand_over(component, clock, configuration, chosen)
    if handed.code:
        return handed
    before = component.get("refusal")
    if component.board is not None:
        asked = yield from component.board.arm(component.get)
        if not asked.done:
            return Result(BOARD, asked.text)
    else:
        yield from _pulse(component, "arm")
    begin = clock()
    while clock() - begin < PATIENCE_S:
        if component.get("state") in (words.ARMED, words.ACTIVE) and component.get("armed-serial") == request.serial:
            text = "armed: part %d, feature %d pass %d" % (request.serial, chosen.feature, chosen.pass_number)
            return Result(0, text)
        code = component.get("refusal")
        if code and (code != before or clock() - begin > SETTLED_S):
            return Result(code, words.refusal(code))
        yield
    # Whatever is late: what was said to be refused is not to be armed afterwards.
    yield from _pulse(component, "disarm")
    return Result(NO_ANSWER, "the component does not answer: is its function in the servo thread?")


def disarm(component: Component, clock: Clock) -> Steps:
    """Until nothing is armed any more, or the ramp has begun."""
    yield from _pulse(component, "disarm")
    begin = clock()
    while clock() - begin < SETTLED_S:
        if component.get("state") in (words.OFF, words.BYPASS):
            break
        yield
    if component.get("state") == words.ARMED:
        return Result(NO_ANSWER, "it is still armed: the component does not answer")
    return Result(0, "disarmed")


def _pulse(component: Component, pin: str) -> Generator[None, None, None]:
    """High for a round of the loop, which is longer than a servo cycle."""
    component.set(pin, True)
    yield
    yield
    component.set(pin, False)
    yield
