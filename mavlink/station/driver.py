"""One task between a link and the machines: it reads, lets time pass, and sends.

Everything that goes out goes out from this task. Callers hand it machines and wait for their outcomes.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

from mavlink.errors import CodecError, LinkError, NotConnectedError
from mavlink.links.link import DirectLink, Link, ReplayLink
from mavlink.state.events import EVENT_MESSAGES, EventOrder
from mavlink.state.link_quality import LinkQuality
from mavlink.state.modes import GROUND_STATION_TYPE, NO_AUTOPILOT
from mavlink.state.mount import MOUNT_MESSAGES
from mavlink.state.outputs import SensorOutput
from mavlink.state.sensor import SensorWatch
from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import CAMERA_MESSAGES
from mavlink.station.believing import Believing
from mavlink.station.forward.hub import Forwards
from mavlink.station.identity import Identity
from mavlink.station.jobs import Job
from mavlink.station.list_ids import ListIds
from mavlink.station.restarts import Restarts
from mavlink.station.trust import Trust
from mavlink.station.under_way import UnderWay
from mavlink.station.watched import Watched
from mavlink.transfer.command import CommandMachine, CommandOutcome
from mavlink.transfer.items_wire import ITEM_REQUESTS
from mavlink.transfer.machine import Machine, Progress
from mavlink.transfer.outcome import Outcome
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message

_HEARTBEAT_EVERY_S: Final = 1.0
_ACTIVE: Final = 4  # MAV_STATE_ACTIVE
#: Frames of other ground stations wait for a slow link up to this number, ours among them.
_MOST_WAITING: Final = 256


class Driver(Watched, Believing):
    """Drives machines over a link on behalf of one ground station and one vehicle.

    Parameters
    ----------
    on_connect
        Called whenever the vehicle is first heard, or heard again after it was lost.
    vehicle_system
        The system to talk to; 0 takes the first autopilot heard.
    """

    def __init__(
        self,
        link: Link,
        codec: Codec,
        clock: Callable[[], float],
        on_connect: Callable[[], None],
        vehicle_system: int = 0,
        lost_after_s: float = 5.0,
        forwards: Forwards | None = None,
    ) -> None:
        super().__init__()
        self._link = link
        self.read_only = isinstance(link, ReplayLink)
        self._direct = link if isinstance(link, DirectLink) else None
        self._due_s = math.inf
        self._error: Exception | None = None
        self._codec = codec
        self._forwards = forwards
        if forwards is not None:
            codec.heard = forwards.heard
        self._clock = clock
        self._on_connect = on_connect
        self._identity = Identity(vehicle_system, lost_after_s)
        self._trust = Trust(link, vehicle_system, clock, self._doubt)
        self._trust.verify(codec.signing)
        codec.noted = self._trust.noted
        self._lost_after_s = lost_after_s
        self._task: asyncio.Task[None] | None = None
        self._timeout: asyncio.Timeout | None = None
        self._failure: str | None = None
        self._outgoing: deque[bytes] = deque()
        self._heard_s = -math.inf
        self._heartbeat_s = -math.inf
        self._under_way = UnderWay(clock, self._queue, self._wake)
        self.events = EventOrder()
        self.list_ids = ListIds()
        self.sensor = SensorWatch()
        self.quality = LinkQuality()
        self._restarts = Restarts()
        #: Changes with whatever may change the vehicle's lists unseen: a loss, a start, another aircraft.
        self.epoch = 0

    def start(self) -> None:
        """Begin to read and to send heartbeats; again is harmless."""
        if self._task is None and self._failure is None:
            if self._forwards is not None:
                self._forwards.join(self)
            self._task = asyncio.create_task(self._run(), name=f"mavlink {self._link.url}")

    async def close(self) -> None:
        """End the task, fail whoever waits, close the link."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
            self._task = None
        self._fail("the client is closed")
        await self._link.close()

    @property
    def failure(self) -> str | None:
        """Why the driver has ended; None while it runs."""
        return self._failure

    async def transfer(
        self, machine: Machine[Outcome], progress: Callable[[Progress], None] | None = None
    ) -> Outcome:
        """Run a transfer to its end. Raises BusyError when another one is under way."""
        self.require_free()
        return await self._under_way.transfer(machine, progress)

    async def command(self, machine: CommandMachine, unheard: bool = False) -> CommandOutcome:
        """Run a command to its end; those of the same number take turns, as their answers look alike.

        ``unheard`` gives it to a vehicle that has fallen silent, too.
        """
        if unheard:
            self.require_reachable()
        else:
            self.require_connected()
        return await self._under_way.command(machine, unheard)

    def post(self, machine: CommandMachine) -> Job[CommandOutcome]:
        """Queue a command without waiting for it."""
        return self._under_way.post(machine)

    def pass_on(self, frame: bytes) -> bool:
        """Send a frame as it is, and record it; False when too many wait."""
        if self._failure is not None or len(self._outgoing) >= _MOST_WAITING:
            return False
        signed = self._codec.signed(frame)
        if signed is None:
            return False
        if self._codec.tap is not None:
            self._codec.tap(signed)
        self._outgoing.append(signed)
        self._wake()
        return True

    def say(self, messages: list[Message]) -> None:
        """Send messages that nothing answers, unless too many wait."""
        if self._failure is None and len(self._outgoing) < _MOST_WAITING:
            self._outgoing.extend([self._codec.pack(message) for message in messages])
            self._wake()

    def reserved(self, *, changes: bool) -> contextlib.AbstractContextManager[None]:
        """Keep the vehicle's lists to this station while within.

        Raises
        ------
        BusyError
            Another ground station that is forwarded to is at work on them.
        """
        if self._forwards is None:
            return contextlib.nullcontext()
        return self._forwards.reserved(changes=changes)

    def list_changed(self, kind: MissionType) -> None:
        """How many items the mission has is not known until the vehicle says so anew.

        An autopilot that is asked in mid-upload tells how many have arrived by then.
        """
        if kind is MissionType.MISSION:
            self._change(replace(self.state, mission_total=None))

    def adopt(self, system_id: int) -> None:
        """Take the system heard in the vehicle's place for the vehicle, of which nothing is known yet.

        Raises
        ------
        NotConnectedError
            No such system is heard there.
        """
        if self._failure is not None:
            raise NotConnectedError(self._failure)
        if self.state.connected or self.state.other_system != system_id:
            raise NotConnectedError(f"no autopilot of system {system_id} is heard in the vehicle's place")
        self._under_way.abandon()
        self.events, self.list_ids, self.quality = EventOrder(), ListIds(), LinkQuality()
        self.sensor = SensorWatch()
        self._identity.adopt(system_id)
        self._restarts = Restarts()
        self.epoch += 1
        self._set_state(VehicleState())
        self._trust.adopt(system_id)

    @property
    def recording_clock(self) -> Callable[[], float | None] | None:
        """When what is heard was heard first, where the link is a recording; None of a live one."""
        link = self._link
        return (lambda: link.clock_s) if isinstance(link, ReplayLink) else None

    async def _run(self) -> None:
        if self._direct is not None:
            self._direct.listen(self._hear)
        try:
            while self._error is None:
                self._let_time_pass()
                await self._flush()
                for message in self._codec.feed(await self._wait()):
                    self._take(message)
                await self._flush()
            raise self._error
        except LinkError as error:
            self._fail(str(error))
        except Exception:
            self._fail("the driver has failed")
            raise
        finally:
            if self._direct is not None:
                self._direct.listen(None)

    def _hear(self, data: bytes) -> None:
        """Take in and answer at once what a direct link brings; the task only lets time pass."""
        try:
            for message in self._codec.feed(data):
                self._take(message)
            self._send_now()
        except Exception as error:  # noqa: BLE001 - raised again in the task, whose business it is
            self._error = error
        if self._error is not None or self._next_deadline_s() < self._due_s:
            self._wake()

    async def _wait(self) -> bytes:
        """Bytes, or none when something is due first."""
        if self._outgoing:
            return b""
        # Until when nothing is expected to happen here.
        self._due_s = self._next_deadline_s()
        delay_s = max(0.0, self._due_s - self._clock())
        try:
            async with asyncio.timeout(delay_s) as self._timeout:
                return await self._link.receive()
        except TimeoutError:
            return b""
        finally:
            self._timeout = None

    async def _flush(self) -> None:
        while self._outgoing:
            await self._link.send(self._outgoing.popleft())

    def _queue(self, messages: list[Message], job: Job[Any]) -> None:
        """Queue a job's messages for the task."""
        try:
            self._outgoing.extend([self._codec.pack(message) for message in messages])
        except CodecError as error:
            job.fail(error)
        self._send_now()

    def _send_now(self) -> None:
        """Send on a direct link without waiting for the task; then make ready what is likely to be next."""
        if self._direct is None:
            return
        try:
            while self._outgoing:
                self._direct.send_now(self._outgoing.popleft())
        except LinkError as error:
            self._error = error
            self._wake()
        likely = self._under_way.likely
        if likely is not None:
            self._codec.prepare(likely)

    def _wake(self) -> None:
        if self._timeout is not None and not self._timeout.expired():
            self._timeout.reschedule(asyncio.get_running_loop().time())

    def _next_deadline_s(self) -> float:
        deadline_s = self._heartbeat_s + _HEARTBEAT_EVERY_S
        if self.state.connected:
            deadline_s = min(deadline_s, self._heard_s + self._lost_after_s)
        return min(deadline_s, self._under_way.deadline_s)

    def _let_time_pass(self) -> None:
        now_s = self._clock()
        if now_s >= self._heartbeat_s + _HEARTBEAT_EVERY_S:
            self._heartbeat_s = now_s
            fields = {"type": GROUND_STATION_TYPE, "autopilot": NO_AUTOPILOT, "system_status": _ACTIVE}
            heartbeat = Message("HEARTBEAT", {**fields, "mavlink_version": 3})
            self._outgoing.append(self._codec.pack(heartbeat))
        # Time in which this process stood still is not the vehicle's silence.
        self._heard_s += max(0.0, now_s - self._due_s)
        self._due_s = math.inf
        if self.state.connected and now_s >= self._heard_s + self._lost_after_s:
            self._lose()
        self._change(self._identity.waited(self.state, now_s))
        self._trust.let_time_pass()
        self._doubt()
        self._under_way.let_time_pass(now_s)

    def _take(self, message: Message) -> None:
        now_s = self._clock()
        if not self._identity.speaks(message, self.state):
            beside = message.name in CAMERA_MESSAGES or message.name in MOUNT_MESSAGES
            if beside and message.system_id == self.state.system_id:
                for recorder in self._recorders:
                    recorder.take(message, self.state)
                self._change(self.sensor.watched(self.state, message, now_s))
            self._change(self._identity.watched(self.state, message, now_s))
            return
        asks = self.state.connected and message.name in ITEM_REQUESTS
        if asks:
            # It tells nothing but what it waits for, and the aircraft waits: it is answered before all else.
            self._answer(message, now_s)
        self._heard_s = now_s
        self.quality.heard(message.sequence, now_s)
        self._trust.heard(message, now_s)
        if message.name in EVENT_MESSAGES and not self._event_is_new(message):
            return
        state = self.list_ids.watched(updated(self.state, message, now_s), message, now_s)
        state = self.sensor.watched(state, message, now_s)
        if self._restarts.noticed(self.state, state, message):
            state = self._restarted(state)
        if not self.state.connected:
            self._trust.connected(message.system_id)
            self._set_state(self._trust.told(replace(state, connected=True, other_system=None)))
            self._on_connect()
        else:
            self._change(state)
        for recorder in self._recorders:
            recorder.take(message, self.state)
        if not asks:
            self._answer(message, now_s)

    def _answer(self, message: Message, now_s: float) -> None:
        """What machines say to the vehicle's message, unless it is meant for another ground station."""
        if message.fields.get("target_system", 0) in (0, self._codec.system_id):
            answers = self._under_way.receive(message, now_s)
            self._outgoing.extend([self._codec.pack(answer) for answer in answers])

    def _event_is_new(self, message: Message) -> bool:
        """Whether to read on; events that were lost on the way are asked for again."""
        new = self.events.take(message)
        # The vehicle tells its count now and then: often enough to ask, not so often as to flood the link.
        if message.name == "CURRENT_EVENT_SEQUENCE" and not self.read_only:
            requests = self.events.requests(message.system_id, message.component_id)
            self._outgoing.extend([self._codec.pack(request) for request in requests])
        return new

    def _restarted(self, state: VehicleState) -> VehicleState:
        """It began anew: it counts its events anew, and has to be asked for its telemetry again."""
        self.epoch += 1
        self.events = EventOrder()
        self.quality.forget()
        if self.state.connected:
            self._on_connect()
        return self.sensor.unknown(replace(state, restarts=state.restarts + 1))

    def _lose(self) -> None:
        """The vehicle has vanished: nobody can tell what it still took in."""
        self.epoch += 1
        self.quality.forget()
        self._trust.lost()
        self._set_state(self._trust.told(self.sensor.unknown(replace(self.state, connected=False))))
        self._under_way.abandon(silent=True)

    def show_sensor(self, output: SensorOutput | None) -> None:
        """Read from this output whether the sensor is on; what another one showed no longer counts."""
        if output != self.sensor.output:
            shown_by_itself = self.state.sensor_on
            self.sensor.output = output
            self._set_state(replace(self.sensor.unknown(self.state), sensor_on=shown_by_itself))

    def _fail(self, reason: str) -> None:
        if self._failure is not None:
            return
        if self._forwards is not None:
            self._forwards.leave(self)
        self._failure = reason
        self._set_state(self.sensor.unknown(replace(self.state, connected=False)))
        self._under_way.abandon()
