"""Runs a stored mission: one navigation item at a time, with the DO items between them."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mavlink.sim.craft import Craft, Path, Vertex
from mavlink.sim.dynamics import AircraftState, FlightCommand
from mavlink.sim.geodesy import Place
from mavlink.sim.manoeuvres import Manoeuvre
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, Frame, MissionItem

_CONDITIONS = frozenset({Command.CONDITION_DELAY, Command.CONDITION_DISTANCE})
_MOST_JUMPS_AT_ONCE = 100
#: PX4 stores -1 repetitions as this.
_FOR_EVER = 65535


@dataclass(frozen=True, slots=True)
class Reached:
    """A navigation item is done."""

    seq: int


@dataclass(frozen=True, slots=True)
class Do:
    """A DO item is to be carried out now."""

    item: MissionItem


@dataclass(frozen=True, slots=True)
class Landed:
    """The aircraft stands after a landing."""


@dataclass(frozen=True, slots=True)
class Said:
    """Something for the operator; ``severity`` is MAV_SEVERITY."""

    severity: int
    text: str


Event = Reached | Do | Landed | Said


def place_of(item: MissionItem, home: Place) -> Place:
    """Where an item is; the ground is flat, so terrain altitudes count from home."""
    above_sea = item.frame in (Frame.GLOBAL, Frame.GLOBAL_INT)
    altitude_m = item.z if above_sea else home.altitude_m + item.z
    return Place(item.x / 1e7, item.y / 1e7, altitude_m)


class MissionRun:
    """A mission being flown.

    Attributes
    ----------
    current
        Sequence number of the navigation item being flown.
    finished
        Nothing is left to fly.
    returning
        It ended with an order to return.
    events
        What happened since the caller last emptied it.
    """

    def __init__(
        self, items: Sequence[MissionItem], settings: SimSettings, craft: Craft, home: Place
    ) -> None:
        self._items = [craft.flown_as(item) for item in items]
        self._settings = settings
        self._craft = craft
        self._home = home
        self._first = 1 if settings.autopilot is Flavour.ARDUPILOT else 0
        self._manoeuvre: Manoeuvre | None = None
        self._path: Path | None = None
        self._path_seqs: deque[int] = deque()
        self._last_vertex: Place | None = None
        self._pending: deque[MissionItem] = deque()
        self._wait_from_s: float | None = None
        self._jumps: dict[int, int] = {}
        self.current = self._first
        self.finished = False
        self.returning = False
        self.cross_track_m = 0.0
        self.events: list[Event] = []

    @property
    def first_navigation(self) -> MissionItem | None:
        """The first navigation item of the list."""
        return next(
            (item for item in self._items[self._first :] if item.command in self._craft.navigation), None
        )

    def begin(self, seq: int, state: AircraftState) -> None:
        """Fly on from an item."""
        self._path = self._last_vertex = None
        self._pending.clear()
        self._go(max(seq, self._first), state)

    def command(self, state: AircraftState, airspeed_m_s: float) -> FlightCommand:
        """What to do at this instant; level flight once finished."""
        if self.finished:
            return FlightCommand(0.0, airspeed_m_s, 0.0)
        self._run_pending(state)
        if self._manoeuvre is not None:
            command = self._manoeuvre.command(state, airspeed_m_s)
            if self._manoeuvre.done:
                if self._manoeuvre.lands:
                    self.events.append(Landed())
                self._reached(state)
            return command
        path = self._path
        if path is None:
            raise RuntimeError(f"mission item {self.current} has neither a path nor a manoeuvre")
        for _ in range(len(self._items)):
            item = self._items[self.current]
            if path.finished or not path.passed(state, self._craft.acceptance_m(item)):
                break
            self._last_vertex = place_of(item, self._home)
            stop_s = self._craft.stop_s(item)
            if stop_s > 0.0:
                self._path = None
                self._manoeuvre = self._craft.stop(self._placed(item, state), stop_s)
                return self.command(state, airspeed_m_s)
            self._reached(state)
            if self._path is not path or self._manoeuvre is not None or self.finished:
                return self.command(state, airspeed_m_s)
        command = path.command(state, airspeed_m_s)
        self.cross_track_m = path.cross_track_m
        return command

    def _reached(self, state: AircraftState) -> None:
        self.events.append(Reached(self.current))
        self._go(self.current + 1, state)

    def _go(self, seq: int, state: AircraftState) -> None:
        """Move on to the next navigation item at or after ``seq``, collecting the DO items before it."""
        self._flush(state)
        jumps = 0
        while seq < len(self._items):
            item = self._items[seq]
            if item.command == Command.NAV_RETURN_TO_LAUNCH:
                self.current = seq
                self._run_pending(state)
                self.finished = self.returning = True
                return
            if item.command in self._craft.navigation:
                self.current = seq
                self._start(item, state)
                self._run_pending(state)
                return
            if item.command == Command.DO_JUMP:
                jumps += 1
                target = self._jump(item)
                if target is not None and jumps < _MOST_JUMPS_AT_ONCE:
                    seq = target
                    continue
            else:
                self._pending.append(item)
            seq += 1
        self._run_pending(state)
        self.finished = True

    def _jump(self, item: MissionItem) -> int | None:
        # PX4 checks neither; a jump to nowhere is passed over.
        if not (0.0 <= item.param1 < len(self._items) and math.isfinite(item.param2)):
            return None
        repeat, used = int(item.param2), self._jumps.get(item.seq, 0)
        if 0 <= repeat < _FOR_EVER and used >= repeat:
            return None
        self._jumps[item.seq] = used + 1
        self._path = None
        return int(item.param1)

    def _flush(self, state: AircraftState) -> None:
        """DO items still waiting for a condition are dropped when the next navigation item begins."""
        self._run_pending(state)
        self._pending.clear()
        self._wait_from_s = None

    def _run_pending(self, state: AircraftState) -> None:
        while self._pending:
            item = self._pending[0]
            if item.command in _CONDITIONS:
                if self._wait_from_s is None:
                    self._wait_from_s = state.time_s
                if not self._condition_met(item, state):
                    return
                self._wait_from_s = None
                self._pending.popleft()
                continue
            self._pending.popleft()
            self.events.append(Do(item))

    def _condition_met(self, item: MissionItem, state: AircraftState) -> bool:
        if item.command == Command.CONDITION_DELAY:
            return self._wait_from_s is not None and state.time_s - self._wait_from_s >= item.param1
        if self._path is not None and not self._path.finished:
            return self._path.distance_to_target_m(state) <= item.param1
        return True

    def _start(self, item: MissionItem, state: AircraftState) -> None:
        place = self._placed(item, state)
        if item.command == Command.NAV_WAYPOINT:
            self._manoeuvre = None
            if self._path is None or not self._path_seqs or self._path_seqs[0] != item.seq:
                self._start_path(item.seq, state)
            self._path_seqs.popleft()
            return
        previous, self._path = self._last_vertex, None
        self._last_vertex = None
        match item.command:
            case Command.NAV_TAKEOFF:
                self._manoeuvre = self._craft.takeoff(item, place, state)
            case Command.NAV_LAND:
                self._manoeuvre = self._craft.land(previous or state.place, place)
            case _:
                self._manoeuvre = self._craft.loiter(item, place, state, self._next_place(item.seq))

    def _start_path(self, seq: int, state: AircraftState) -> None:
        """The polyline from here through the waypoints that follow, to a landing place if one does."""
        vertices: list[Vertex] = []
        self._path_seqs = deque()
        for item in self._items[seq:]:
            if item.command == Command.DO_JUMP:
                break
            if item.command not in self._craft.navigation:
                continue
            passes = item.command == Command.NAV_WAYPOINT
            if passes or (item.command == Command.NAV_LAND and self._craft.glides):
                vertices.append(Vertex(self._placed(item, state), self._craft.acceptance_m(item)))
                self._path_seqs.append(item.seq)
            if not passes or self._craft.stop_s(item) > 0.0:
                break
        self._path = self._craft.path(state.place, vertices)

    def _placed(self, item: MissionItem, state: AircraftState) -> Place:
        """Where an item is; without coordinates it is where the aircraft is, without altitude as high."""
        place = place_of(item, self._home)
        if not math.isfinite(place.altitude_m):
            landing = item.command == Command.NAV_LAND
            place = replace(place, altitude_m=self._home.altitude_m if landing else state.altitude_m)
        if item.x == 0 and item.y == 0:
            return Place(state.lat_deg, state.lon_deg, place.altitude_m)
        return place

    def _next_place(self, seq: int) -> Place | None:
        for item in self._items[seq + 1 :]:
            if item.command == Command.NAV_RETURN_TO_LAUNCH:
                return self._home
            if item.command in self._craft.navigation:
                return place_of(item, self._home)
        return None
