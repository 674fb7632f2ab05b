"""Simulated aircraft on one clock, each with a ground station's end of its link: no socket, no waiting.

What passes between the two ends passes as frames; transfers and orders are the library's own machines, told
the time. Time goes on for all aircraft alike, also while one of them is talked to.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from typing import Any, TypeVar

from app.services.records import TrackSample
from app.services.vehicles.recorder import Thinner, is_flying
from mavlink.dialects.compare import differences
from mavlink.dialects.mission import Mission
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.settings import SimSettings
from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import TrackRecorder
from mavlink.transfer.clear import SetCurrentMachine, flown_for
from mavlink.transfer.command import CommandMachine
from mavlink.transfer.download import DownloadMachine
from mavlink.transfer.machine import Machine
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.codec import Codec
from mavlink.wire.items import Command, MissionItem, MissionType
from mavlink.wire.messages import Message

#: Time of day when a sky's clock begins.
EPOCH_S = datetime(2026, 1, 1, tzinfo=UTC).timestamp()
#: Between two looks at every aircraft.
STEP_S = 0.05
#: Vehicle time between two places of a record, as the service keeps them by default.
RECORDED_S = 0.2

End = TypeVar("End")


class FlightError(RuntimeError):
    """An aircraft refused an order, or holds something else than it was given."""


class Linked:
    """One simulated aircraft, and what its ground station knows of it.

    Parameters
    ----------
    tap
        Called with every frame that passes, either way; None to do without.

    Attributes
    ----------
    target
        System and component of its autopilot.
    state
        As its telemetry tells it.
    places
        Where it really was while it flew: rows of seconds, latitude and longitude in degrees, altitude in
        metres above sea level.
    texts, given
        What it said, and the missions it was given.
    """

    def __init__(self, name: str, settings: SimSettings, tap: Callable[[bytes], None] | None = None) -> None:
        self.name = name
        self.aircraft = SimulatedAircraft(settings)
        self.state = VehicleState()
        self.places: list[tuple[float, float, float, float]] = []
        self.texts: list[str] = []
        self.given: list[tuple[MissionItem, ...]] = []
        self.target = (settings.system_id, settings.component_id)
        self._aboard: dict[tuple[int, int], Codec] = {}
        self._ground = Codec()
        self._ground.tap = tap
        self._machine: Machine[Any] | None = None
        self._begin_record()

    def pass_time(self, now_s: float) -> None:
        """Fly up to a time, hear what is sent meanwhile, and let what is under way go on."""
        self._talk(self.aircraft.advance(now_s), (), now_s)
        state = self.aircraft.state
        if not state.on_ground:
            self.places.append((now_s, state.lat_deg, state.lon_deg, state.altitude_m))
        if self._machine is not None and now_s >= self._machine.deadline_s:
            self._talk((), self._machine.tick(now_s), now_s)

    def begin(self, machine: Machine[Any], now_s: float) -> None:
        """Start a machine; it goes on whenever something is heard, and while time passes."""
        self._machine = machine
        self._talk((), machine.start(now_s), now_s)

    def _talk(self, down: Sequence[Message], up: Sequence[Message], now_s: float) -> None:
        """Carry messages of both ends to the other, and the answers, until nobody has anything to say."""
        falling, rising = deque(down), deque(up)
        while falling or rising:
            while falling:
                message = falling.popleft()
                for heard in self._ground.feed(self._codec_of(message).pack(message)):
                    rising.extend(self._hear(heard, now_s))
            while rising:
                for ordered in self._codec_of(None).feed(self._ground.pack(rising.popleft())):
                    falling.extend(self.aircraft.receive(ordered, now_s))

    def _hear(self, message: Message, now_s: float) -> list[Message]:
        if (message.system_id, message.component_id) == self.target:
            self.state = updated(self.state, message, now_s)
            if message.name == "STATUSTEXT":
                self.texts.append(message.text("text"))
        self._recorder.take(message, self.state)
        if not self._flew:
            # What stands before its take-off is no part of the flight.
            self._flew = is_flying(self.state)
            if not self._flew:
                self._recorder.forget()
        return [] if self._machine is None else self._machine.receive(message, now_s)

    def _codec_of(self, message: Message | None) -> Codec:
        """The sender's: the autopilot's own, or that of a component beside it."""
        named = self.target
        if message is not None and message.system_id:
            named = message.system_id, message.component_id
        return self._aboard.setdefault(named, Codec(*named))

    def _begin_record(self) -> None:
        self._recorder = TrackRecorder()
        self._flew = False

    def record(self) -> tuple[TrackSample, ...]:
        """The flight as it was recorded so far."""
        return tuple(Thinner(RECORDED_S).more(self._recorder.track()))

    def cut_record(self) -> tuple[TrackSample, ...]:
        """The same; what is flown from now on is a record of its own."""
        samples = self.record()
        self._begin_record()
        return samples


class Sky:
    """Aircraft that fly at once.

    Attributes
    ----------
    now_s
        Seconds since it began.
    """

    def __init__(self) -> None:
        self.aircraft: dict[str, Linked] = {}
        self.now_s = 0.0
        self._steps = 0

    def add(self, linked: Linked) -> None:
        """One aircraft more, switched on now."""
        self.aircraft[linked.name] = linked
        linked.pass_time(self.now_s)

    def clock_s(self) -> float:
        """The time of day of records, seconds since 1970."""
        return EPOCH_S + self.now_s

    def until(self, time_s: float) -> None:
        """Let time pass for all of them, up to a time or the step behind it."""
        while self.now_s < time_s - 1e-9:
            self._step()

    def until_landed(self, most_s: float) -> None:
        """Let time pass until all that are armed have landed and are not."""
        while armed := [each.name for each in self.aircraft.values() if each.aircraft.armed]:
            if self.now_s > most_s:
                raise FlightError(f"{', '.join(armed)} flies still after {most_s:.0f} s")
            self._step()

    def _step(self) -> None:
        self._steps += 1
        self.now_s = self._steps * STEP_S
        for each in self.aircraft.values():
            each.pass_time(self.now_s)

    def carry_out(self, linked: Linked, machine: Machine[End]) -> End:
        """Run a machine to its end; all fly on meanwhile."""
        linked.begin(machine, self.now_s)
        while machine.outcome is None:
            self._step()
        return machine.outcome

    def give(self, name: str, mission: Mission) -> None:
        """Upload a mission and read it back; what is flying goes on with it from its beginning.

        Raises
        ------
        FlightError
            It was not accepted, or what is read back is not what was meant.
        """
        linked = self.aircraft[name]
        items, target = mission.items_of(MissionType.MISSION), linked.target
        outcome = self.carry_out(linked, UploadMachine(items, MissionType.MISSION, *target))
        linked.given.append(items)
        if outcome.kind != "accepted":
            raise FlightError(f"{name} did not take its mission: {outcome}")
        held = self._held(linked)
        if found := differences(items, held, mission.dialect):
            raise FlightError(f"{name} holds another mission: {'; '.join(map(str, found))}")
        if linked.state.armed:
            # A mission shorter than the one flown may have sent it home: it is ordered back as well.
            first = 1 if mission.dialect.home_row else 0
            chosen = self.carry_out(linked, SetCurrentMachine(first, *target, answers=flown_for(held, first)))
            if chosen.kind != "accepted":
                raise FlightError(f"{name} did not begin its new mission: {chosen}")
            self._order(linked, Command.MISSION_START)

    def _held(self, linked: Linked) -> tuple[MissionItem, ...]:
        machine = DownloadMachine(MissionType.MISSION, *linked.target)
        outcome = self.carry_out(linked, machine)
        if outcome.kind != "accepted":
            raise FlightError(f"{linked.name} did not tell its mission: {outcome}")
        return machine.items

    def start(self, name: str) -> None:
        """Arm, and begin the mission."""
        self._order(self.aircraft[name], Command.COMPONENT_ARM_DISARM, 1.0)
        self._order(self.aircraft[name], Command.MISSION_START)

    def _order(self, linked: Linked, command: Command, *values: float) -> None:
        outcome = self.carry_out(linked, CommandMachine(command, values, *linked.target))
        if not outcome.accepted:
            raise FlightError(f"{linked.name} refused {command.name}: {outcome}; {linked.texts[-3:]}")
