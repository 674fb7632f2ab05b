"""When a sensor that is on has to go off: whenever the aircraft is not in a pass of the mission it was given.

It decides and sends nothing, knows no clock, and never has a sensor switched on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from mavlink.encoding.payload import Payload
from mavlink.state.modes import MISSION_MODES
from mavlink.state.telemetry import VehicleState

#: Reports of mode, item and output overtake each other: so long may a sensor seem to be on out of a pass,
#: where the aircraft was seen to leave none, and where its mission is about to switch it off by itself.
SEEMS_S: Final = 1.0
ITEM_S: Final = 3.0
#: An order that shows no effect is given again after this time, so often.
AGAIN_S: Final = 2.0
MOST_TRIES: Final = 5
#: From place to place a mission goes on by no more items than this: orders to sensor and speed lie between.
NEXT_ITEMS: Final = 6


class SensorGuard:
    """Watches one vehicle's states for a sensor left on.

    Attributes
    ----------
    payload
        How the sensor is switched; None while nothing was sent to the vehicle from here: what somebody else
        has it do is not judged.
    """

    def __init__(self) -> None:
        self.payload: Payload | None = None
        self._passes: tuple[range, ...] = ()
        self._items: int | None = None
        self._changing = False
        self._interrupted: str | None = None
        self._flown = False
        self._in_pass = False
        self._absent = False
        self._since_s: float | None = None
        self._tries = 0
        self._next_s = -math.inf
        self._at: int | None = None
        self._before: int | None = None
        self._at_since_s = -math.inf
        self._left: int | None = None

    def hold(self, payload: Payload, passes: Sequence[range], items: int) -> None:
        """The vehicle holds a mission.

        Parameters
        ----------
        passes
            Numbers of the items current within each pass.
        items
            How many the mission has, home row included.
        """
        self.payload, self._passes, self._items, self._changing = payload, tuple(passes), items, False
        self._at, self._before, self._at_since_s, self._left = None, None, -math.inf, None

    def release(self) -> None:
        """Its mission is being replaced or cleared: no pass is known until the next is held."""
        self._passes, self._items, self._changing = (), None, True

    def interrupt(self, reason: str) -> None:
        """A pass is broken off in a way that the vehicle does not show: until the sensor is off."""
        self._interrupted = reason

    @property
    def passes(self) -> tuple[range, ...]:
        """Those held, by the numbers of their items."""
        return self._passes

    def pass_at(self, current: int | None) -> range | None:
        """The pass that an item belongs to; None where it is in none."""
        return next((each for each in self._passes if current in each), None)

    def left_out(self, current: int | None) -> tuple[range, ...]:
        """Passes between where the aircraft left its mission and the item that it would go on with.

        PX4's Return takes up the mission's landing and goes on with that: what lies between is not flown.
        """
        if self._left is None or current is None:
            return ()
        return tuple(each for each in self._passes if self._left <= each[-1] < current)

    def _follow(self, state: VehicleState, now_s: float) -> None:
        """Which item was flown to when the mission was left: an item told just before is the return's."""
        if state.mode in MISSION_MODES and state.armed:
            self._left = None
            if state.mission_current != self._at:
                self._at, self._before, self._at_since_s = state.mission_current, self._at, now_s
        elif self._left is None and self._at is not None:
            recent = self._before is not None and now_s < self._at_since_s + ITEM_S
            jumped = recent and self._at - (self._before or 0) > NEXT_ITEMS
            self._left = self._before if jumped else self._at

    def look(self, state: VehicleState, now_s: float, *, replaced: bool = False) -> str | None:
        """Why the sensor must be switched off now; None while it need not be.

        Parameters
        ----------
        replaced
            The vehicle says by its mission's id that it holds another one than that held here.
        """
        if self.payload is None:
            return None
        if not state.connected:
            self._absent = True
            return None
        self._follow(state, now_s)
        self._flown |= state.armed
        outside, passing = self._outside(state, replaced)
        on = state.sensor_shown
        if outside is None:
            self._calm(in_pass=True)
            return None
        if on is False or not self._flown:
            self._flown &= state.armed
            self._calm(in_pass=False)
            return None
        if on is None:
            # Nothing shows it: it may be on where a pass was broken off, and once is all that can be done.
            broken_off, self._in_pass = self._in_pass and not passing, False
            # A first photo is told of before the item that it is taken in: from then on it counts as on.
            self._interrupted, self._since_s = None, None
            return self._worded(outside) if broken_off else None
        if self._since_s is None:
            self._since_s = now_s
        waits_s = ITEM_S if passing else 0.0 if self._in_pass or self._absent else SEEMS_S
        if self._tries >= MOST_TRIES or now_s < max(self._since_s + waits_s, self._next_s):
            return None
        self._tries += 1
        self._next_s = now_s + AGAIN_S
        return self._worded(outside)

    def _calm(self, *, in_pass: bool) -> None:
        """Nothing is amiss: what comes next is judged anew."""
        self._in_pass, self._absent, self._interrupted = in_pass, False, None
        self._since_s, self._tries, self._next_s = None, 0, -math.inf

    @property
    def given_up(self) -> bool:
        """Whether the sensor stays on whatever is ordered."""
        return self._tries >= MOST_TRIES

    def _worded(self, outside: str) -> str:
        return f"{outside} when it was heard again" if self._absent else outside

    def _outside(self, state: VehicleState, replaced: bool) -> tuple[str | None, bool]:
        """Why the aircraft is in no pass, None when it is in one; and whether that may just have ended."""
        if not state.armed:
            return "disarmed", False
        if state.mode not in MISSION_MODES:
            return f"mode {state.mode or 'unknown'} instead of the mission's", False
        if state.mission_state == "paused":
            return "the mission is paused", False
        if self._interrupted is not None:
            return self._interrupted, False
        if self._changing:
            return "the mission is being replaced or cleared", False
        if replaced or (
            self._items is not None and state.mission_total is not None and state.mission_total != self._items
        ):
            return "the vehicle holds another mission", False
        if self.pass_at(state.mission_current) is not None:
            return None, False
        return f"item {state.mission_current} is in no pass", True
