"""Whether two aircraft speak under one system id on one stream, where no address keeps them apart.

Every sender numbers its frames. Two of them make two runs of numbers that go on in turns, which one alone
never does: frames lost leave a run for good, frames overtaken fill its gaps, frames doubled say the same. One
aircraft heard by two of its own channels makes two runs as well: they must differ in what they say, too, in
the time since boot or in the place.

Source: https://mavlink.io/en/guide/serialization.html (a sequence number counts each sender's frames).
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from typing import Final

from mavlink.wire.messages import Message

_NUMBERS: Final = 256
#: So far ahead of a run a frame still belongs to it, and so far behind it was overtaken.
_REACH: Final = 24
#: What a number said so many frames ago is still known to be of the same round of numbers.
_REMEMBERED: Final = 64
#: A run is returned to so often before it is a sender's, and that counts so long.
_RETURNS: Final = 3
_WINDOW_S: Final = 10.0
#: One aircraft's clock as its two channels tell it differs by the delay of a slow radio; its places at one
#: time do not differ, but for what it flies between two tellings and what its estimate is corrected by.
_CLOCKS_APART_S: Final = 2.0
_PLACES_APART_M: Final = 5.0
_SPEED_ERROR_M_S: Final = 5.0
_METRES_PER_DEGREE: Final = 111_195.0


@dataclass(slots=True)
class _Run:
    """Numbers that go on from each other, and what their frames told last."""

    last: int
    frames: int = 0
    returns: deque[float] = field(default_factory=lambda: deque(maxlen=_RETURNS))
    boot_s: float | None = None
    clock_heard_s: float = 0.0
    place: Message | None = None


class Twins:
    """Watches the frames of one sender's ids for a second sender."""

    def __init__(self) -> None:
        self._runs: list[_Run] = []
        self._current: _Run | None = None
        self._said: dict[int, tuple[int, Message]] = {}
        self._count = 0
        self._differed_s = -math.inf

    def heard(self, message: Message, now_s: float) -> None:
        """Take one frame of the vehicle."""
        sequence = message.sequence
        if sequence is None:
            return
        self._count += 1
        run = self._run_of(message, sequence)
        if run is None:
            return
        if run is not self._current:
            if run.frames:
                run.returns.append(now_s)
            self._current = run
        run.last = sequence
        run.frames += 1
        self._said[sequence] = self._count, message
        others = [other for other in self._runs if other is not run]
        if others and _differ(run, others[0], message, now_s):
            self._differed_s = now_s

    def told(self, now_s: float) -> bool:
        """Whether two aircraft were heard lately."""
        return (
            len(self._runs) == 2
            and now_s < self._differed_s + _WINDOW_S
            and all(len(run.returns) == _RETURNS and now_s < run.returns[0] + _WINDOW_S for run in self._runs)
        )

    def _run_of(self, message: Message, sequence: int) -> _Run | None:
        """The run that a frame belongs to; None where it tells nothing of runs."""
        at, said = self._said.get(sequence, (-_REMEMBERED, None))
        lately = said is not None and self._count - at <= _REMEMBERED
        if lately and said == message:
            return None
        if len(self._runs) == 1 and (sequence - self._runs[0].last) % _NUMBERS == 1:
            return self._runs[0]
        near = [
            (ahead, run) for run in self._runs if 0 < (ahead := (sequence - run.last) % _NUMBERS) <= _REACH
        ]
        if near:
            return min(near, key=lambda pair: pair[0])[1]
        behind = any((run.last - sequence) % _NUMBERS <= _REACH for run in self._runs)
        if behind and not lately:
            return None
        run = _Run(sequence)
        # The one that was not gone on with lately is a run that ended.
        self._runs = [*(kept for kept in self._runs if kept is self._current), run]
        return run


def _differ(run: _Run, other: _Run, message: Message, now_s: float) -> bool:
    """Note what a frame tells; whether the other run tells something that the same aircraft would not."""
    if "time_boot_ms" not in message.fields:
        return False
    run.boot_s, run.clock_heard_s = message.number("time_boot_ms") / 1000.0, now_s
    if message.name == "GLOBAL_POSITION_INT":
        run.place = message
        if other.place is not None and _apart(message, other.place):
            return True
    if other.boot_s is None:
        return False
    return abs((run.boot_s - other.boot_s) - (now_s - other.clock_heard_s)) > _CLOCKS_APART_S


def _apart(one: Message, other: Message) -> bool:
    """Whether two positions are further apart than one aircraft gets in the time between them."""
    between_s = abs(one.number("time_boot_ms") - other.number("time_boot_ms")) / 1000.0
    if between_s > _CLOCKS_APART_S:
        return False
    lat_deg, lon_deg = ((one.number(name) - other.number(name)) / 1e7 for name in ("lat", "lon"))
    east_m = lon_deg * _METRES_PER_DEGREE * math.cos(math.radians(one.number("lat") / 1e7))
    speed_m_s = math.hypot(one.number("vx"), one.number("vy")) / 100.0
    return (
        math.hypot(lat_deg * _METRES_PER_DEGREE, east_m)
        > _PLACES_APART_M + (speed_m_s + _SPEED_ERROR_M_S) * between_s
    )
