"""Reading parameters: some by name, or all of them. Nothing here ever sets one.

Source: https://mavlink.io/en/services/parameter.html (PARAM_REQUEST_READ, PARAM_REQUEST_LIST, PARAM_VALUE,
parameter encoding).
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from mavlink.transfer.machine import DEFAULT_SETTINGS, Machine, Progress, TransferSettings
from mavlink.transfer.outcome import Accepted, Outcome, Unknown
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message

NAME_BYTES: Final = 16
#: This many are asked for before an answer; more would fill a slow radio.
WINDOW: Final = 16

#: MAV_PARAM_TYPE of whole numbers, and how their bytes lie in the float's.
_WHOLE: Final = {1: "<B3x", 2: "<b3x", 3: "<H2x", 4: "<h2x", 5: "<I", 6: "<i"}
_NO_INDEX: Final = 0xFFFF


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter as the vehicle holds it.

    Parameters
    ----------
    type
        MAV_PARAM_TYPE.
    index
        Its place in the vehicle's list; None when it was not said.
    """

    name: str
    value: float
    type: int
    index: int | None = None


def parameter_of(message: Message, bytewise: bool) -> Parameter:
    """The parameter in a PARAM_VALUE.

    Parameters
    ----------
    bytewise
        Whole numbers lie in the bytes of the float, as PX4 sends them; ArduPilot converts them.
    """
    value, kind = message.number("param_value"), message.integer("param_type")
    if bytewise and kind in _WHOLE:
        (value,) = struct.unpack(_WHOLE[kind], struct.pack("<f", value))
    index = message.integer("param_index")
    return Parameter(message.text("param_id"), float(value), kind, None if index == _NO_INDEX else index)


class _Reader(Machine[Outcome]):
    """What reading by name and reading all have in common.

    Attributes
    ----------
    values
        What has been read, by name.
    """

    def __init__(
        self, target_system: int, target_component: int, bytewise: bool, settings: TransferSettings
    ) -> None:
        super().__init__(MissionType.MISSION, target_system, target_component, settings)
        self.values: dict[str, Parameter] = {}
        self._bytewise = bytewise

    def cancel(self, now_s: float) -> list[Message]:
        """Stop asking; what was read stays."""
        if self.outcome is None:
            self._end(Unknown("cancelled"))
        return []

    def _parameter(self, message: Message) -> Parameter | None:
        """The parameter in a message, if it holds one of the target's and this machine runs."""
        if self.deadline_s == math.inf or message.name != "PARAM_VALUE" or not self._from_target(message):
            return None
        return parameter_of(message, self._bytewise)

    def _ask(self, name: str, index: int) -> Message:
        return self._addressed("PARAM_REQUEST_READ", param_id=name, param_index=index)


class ParametersMachine(_Reader):
    """Reads some parameters by name.

    Autopilots are silent about names they do not know, as a radio that loses every answer is. A name that
    stays without answer while others are answered is therefore ``missing``; where none is answered, the
    outcome is unknown.

    Autopilots answer in the order they are asked. A name is therefore asked for again as soon as one asked
    for later is answered, and a name known to be answered is asked for once more behind the last: three
    round trips tell what is missing, where three times ``timeout_s`` would pass else.

    Attributes
    ----------
    missing
        Names without answer, once the machine has ended as accepted.
    """

    def __init__(
        self,
        names: Sequence[str],
        target_system: int,
        target_component: int,
        bytewise: bool = False,
        settings: TransferSettings = DEFAULT_SETTINGS,
    ) -> None:
        super().__init__(target_system, target_component, bytewise, settings)
        for name in names:
            if not name.isascii() or not 1 <= len(name) <= NAME_BYTES:
                raise ValueError(f"{name!r} is no parameter: names are 1 to {NAME_BYTES} ASCII characters")
        self.names = tuple(dict.fromkeys(names))
        self.missing: tuple[str, ...] = ()
        self._waiting = list(self.names)
        # How often each name on its way was asked for, in the order of asking.
        self._asked: dict[str, int] = {}
        self._silent: list[str] = []

    @property
    def progress(self) -> Progress:
        """Names answered or given up, of all."""
        return Progress(len(self.values) + len(self._silent), len(self.names))

    def start(self, now_s: float) -> list[Message]:
        """Ask for the first."""
        return self._go_on(now_s, [])

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take a value; ask again for what should have been answered before it, and for the next."""
        parameter = self._parameter(message)
        if parameter is None:
            return []
        name = parameter.name
        if name in self._silent:
            # Late, but not too late.
            self._silent.remove(name)
            self.values[name] = parameter
        if name not in self._asked:
            return []
        overtaken = list(self._asked)[: list(self._asked).index(name)]
        del self._asked[name]
        self.values[name] = parameter
        return self._go_on(now_s, self._again(overtaken), marker=name)

    def tick(self, now_s: float) -> list[Message]:
        """Ask again for what was not answered; give up what was asked for often enough."""
        if now_s < self.deadline_s:
            return []
        return self._go_on(now_s, self._again(list(self._asked)))

    def _again(self, names: Sequence[str]) -> list[str]:
        """Those of some unanswered names that are asked for once more; the others are given up."""
        again = []
        for name in names:
            times = self._asked.pop(name)
            if times <= self.settings.retries:
                self._asked[name] = times + 1
                again.append(name)
            elif name not in self.values:
                self._silent.append(name)
        return again

    def _go_on(self, now_s: float, again: list[str], marker: str | None = None) -> list[Message]:
        """Ask for what there is room for; ``marker`` is a name to be put behind the last of all."""
        while self._waiting and len(self._asked) < WINDOW:
            name = self._waiting.pop(0)
            self._asked[name] = 1
            again.append(name)
        if self._asked.keys() <= self.values.keys():
            self.missing = tuple(self._silent)
            self._end(Accepted() if self.values or not self.names else Unknown("timeout"))
            return []
        if marker is not None and not self._waiting and not self._asked.keys() & self.values.keys():
            self._asked[marker] = 1
            again.append(marker)
        if again or self.deadline_s == math.inf:
            self.deadline_s = now_s + self.settings.timeout_s
        return [self._ask(name, -1) for name in again]


class ParameterListMachine(_Reader):
    """Reads all parameters; those lost on the way are asked for by number."""

    def __init__(
        self,
        target_system: int,
        target_component: int,
        bytewise: bool = False,
        settings: TransferSettings = DEFAULT_SETTINGS,
    ) -> None:
        super().__init__(target_system, target_component, bytewise, settings)
        self._missing: set[int] | None = None
        self._total = 0
        self._retries_left = settings.retries

    @property
    def progress(self) -> Progress:
        """Parameters read, of all; none of none before the first says how many there are."""
        return Progress(self._total - len(self._missing or ()), self._total)

    def start(self, now_s: float) -> list[Message]:
        """Ask for the list."""
        self.deadline_s = now_s + self.settings.timeout_s
        return [self._addressed("PARAM_REQUEST_LIST")]

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Take a value."""
        parameter = self._parameter(message)
        if parameter is None or parameter.index is None:
            return []  # values sent for other reasons are not numbered
        if self._missing is None:
            self._total = message.integer("param_count")
            self._missing = set(range(self._total))
        if parameter.index in self._missing:
            self._missing.discard(parameter.index)
            self._retries_left = self.settings.retries
            self.values[parameter.name] = parameter
        self.deadline_s = now_s + self.settings.timeout_s
        if not self._missing:
            self._end(Accepted())
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Ask again: for the list while nothing came, else for what is missing."""
        if now_s < self.deadline_s:
            return []
        if self._retries_left == 0:
            self._end(Unknown("timeout"))
            return []
        self._retries_left -= 1
        if self._missing is None:
            return self.start(now_s)
        self.deadline_s = now_s + self.settings.timeout_s
        return [self._ask("", index) for index in sorted(self._missing)[:WINDOW]]
