"""One connected vehicle: its link, its state, and one operation at a time."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime, timedelta

import structlog

from app.services.errors import BusyError, ConflictError, LinkError, ServiceError
from app.services.records import HeldMission, VehicleRecord
from app.services.store.flights import FlightStore
from app.services.vehicles.aboard import Aboard
from app.services.vehicles.audit import Audit
from app.services.vehicles.connection import Connection, Home, connect, is_replay, simulated_of
from app.services.vehicles.forwarding import changes_mission, tell_forwards, tell_order
from app.services.vehicles.heard import Heard, LastWord
from app.services.vehicles.keys import KeyRing
from app.services.vehicles.memory import Memory
from app.services.vehicles.order_book import OrderBook
from app.services.vehicles.recorder import FlightRecorder, HeldPlan
from app.services.vehicles.recordings import Recordings, Tape
from app.services.vehicles.safety import SensorSafety
from app.services.vehicles.simulated import SimulatedAircraft
from app.services.vehicles.standing import Shown, Standing, standing_of
from app.services.vehicles.times import DEFAULT_TIMES, TELL_S, LinkTimes
from app.services.vehicles.turns import Turns
from app.services.vehicles.uploads import UploadReport, read_back
from mavlink import errors as mavlink_errors
from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.encoding.payload import parse_payload
from mavlink.state.passes import landing_of, passes_of
from mavlink.station.client import VehicleClient
from mavlink.station.forward.address import ForwardAddress
from mavlink.station.forward.hub import Forwards
from mavlink.station.forward.outlet import Outlet
from mavlink.station.terrain import Heights
from mavlink.wire.items import MissionItem, MissionType
from mavlink.wire.messages import Message

log = structlog.get_logger(__name__)

#: An upload's unknown outcome is read back so often each time the vehicle comes back.
RESOLVE_TRIES = 3


class Vehicle(Heard):
    """A vehicle the service knows, connected or not.

    Parameters
    ----------
    record
        What it is called and where it is; with ``held`` the plan it held before the service was restarted.
    publish
        Called when its state has changed, no more often than ``times.telemetry_s``.
    memory
        What remembers for it over restarts.
    audit
        Where orders are written before they are sent.
    recordings
        Where the link is recorded; None not to. A recording is not recorded again.
    heights
        Where the ground's heights come from, if it asks; None for nowhere.
    keys
        Where the key it signs with is found; None: nothing is signed.
    """

    def __init__(
        self,
        record: VehicleRecord,
        flights: FlightStore,
        track_interval_s: float,
        publish: Callable[[Vehicle], None],
        memory: Memory,
        audit: Audit,
        recordings: Recordings | None = None,
        times: LinkTimes = DEFAULT_TIMES,
        heights: Heights | None = None,
        keys: KeyRing | None = None,
    ) -> None:
        self.keys = keys
        self.id = record.id
        self.name = record.name
        self.url = url = record.url
        self.created_at = record.created_at
        self.link_failure: str | None = None
        self.held: HeldPlan | None = None
        self.upload: UploadReport | None = None
        self._gone = False
        self.simulated: SimulatedAircraft | None = simulated_of(url)
        self.replay = is_replay(url)
        #: Another system is not taken for it; 0 while it was not heard, and for what is no aircraft.
        self.system_id = record.system_id if self._is_itself else 0
        self._memory = memory
        self._heights = heights
        self.forwards = Forwards(self._station_said)
        self.turns = Turns(record.name, self.replay, self.forwards)
        self._forward = record.forward
        self.tape = Tape(None if self.replay else recordings, record.id)
        self._times = times
        self._look_now = asyncio.Event()
        self._recorder = FlightRecorder(flights, record.id, record.name, track_interval_s)
        self.book = OrderBook()
        self.audit = audit
        self.safety = SensorSafety(record.id, record.name, self._recorder, audit, self.tell)
        self.aboard = Aboard()
        #: Other vehicles with its system id, on links of their own.
        self.namesakes: tuple[str, ...] = ()
        self.lost_since: datetime | None = None
        self._told_s = -math.inf
        # A simulated aircraft is a new one, and holds nothing.
        self._believed = None if self.simulated is not None else record.held
        self.sent = None if self.simulated is not None else record.sent
        self.read_back_at: datetime | None = None
        self._found: bool | None = None
        self._publish = publish
        self._connection: Connection | None = None
        self._last_word: LastWord | None = None
        self._tasks: list[asyncio.Task[None]] = []

    @property
    def _is_itself(self) -> bool:
        """Whether it is an aircraft of its own: simulated ones and recordings are whatever answers."""
        return self.simulated is None and not self.replay

    @property
    def pending(self) -> bool:
        """Whether an upload's outcome is unknown and waits for the vehicle to come back."""
        return self.upload is not None and any(p.outcome == "unknown" for p in self.upload.parts.values())

    @property
    def flight_id(self) -> str | None:
        """The flight under way."""
        return self._recorder.flight_id

    def tell(self) -> None:
        """Show everybody who watches how it stands now."""
        self._told_s = time.monotonic()
        self._publish(self)

    async def open(self, home: Home | None, timeout_s: float) -> None:
        """Open the link, start the simulator where one is asked for, wait for a heartbeat.

        A vehicle that stays silent is not an error: the service goes on listening.

        Raises
        ------
        RefusedError
            The address has none of the known forms.
        LinkError
            The link cannot be opened, or the simulator ended.
        ConflictError
            An address to forward to cannot be opened.
        """
        self.tape.begin()
        await self.forward_to(self._forward)
        connection = await self._connect(home, timeout_s)
        if self._gone:
            await connection.close()
            raise LinkError(f"{self.name} was let go")
        self._connection = connection
        self._tasks = [asyncio.create_task(self._watch()), asyncio.create_task(self._record())]

    def resume(self, home: Home | None, timeout_s: float) -> None:
        """Open the link in the background, again and again until it opens; so with its forwards."""
        self.forwards.begin(self._forward)
        self.tape.begin()
        self._tasks = [
            asyncio.create_task(self._resume(home, timeout_s)),
            asyncio.create_task(self._record()),
        ]

    async def _resume(self, home: Home | None, timeout_s: float) -> None:
        await self._reopen(home, timeout_s)
        await self._watch()

    async def _reopen(self, home: Home | None, timeout_s: float) -> None:
        """Open the link; when it cannot be, say why once and try again."""
        while self._connection is None:
            try:
                self._connection = await self._connect(home, timeout_s)
            except ServiceError as error:
                if self.link_failure != str(error):
                    log.warning("link not open", vehicle=self.name, url=self.url, reason=str(error))
                self.link_failure = str(error)
                self.tell()
                await asyncio.sleep(self._times.reopen_s)
        self.link_failure = None
        self.tell()

    async def _connect(self, home: Home | None, timeout_s: float) -> Connection:
        signing = self.keys.signing_of(self.name, self.id) if self.keys and self._is_itself else None
        connection = await connect(
            self.url, home, timeout_s, self.tape.write, self.forwards, self.system_id, self._times, signing
        )
        if self._is_itself:
            self.system_id = connection.client.state.system_id or self.system_id
        if self._heights is not None:
            connection.client.serve_terrain(self._heights)
        return connection

    async def close(self) -> None:
        """Let it go for good: close the link, end the simulator, close the flight."""
        self._gone = True
        await self._shut()
        await self.forwards.close()

    async def _shut(self) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._tasks = []
        await self._drop()
        await self.book.close()
        await asyncio.to_thread(self.tape.end)

    async def forward_to(self, addresses: tuple[ForwardAddress, ...]) -> None:
        """Forward the link to these addresses and no others.

        Raises
        ------
        ConflictError
            One cannot be opened; all is as before.
        """
        before = {outlet.address for outlet in self.forwards.outlets}
        try:
            await self.forwards.set(addresses)
        except mavlink_errors.LinkError as error:
            raise ConflictError(f"forward {error}") from error
        self._forward = addresses
        tell_forwards(self.name, addresses, before)

    def _station_said(self, outlet: Outlet, message: Message) -> None:
        """Another ground station has spoken to it: tell what it orders, and doubt what it changes."""
        tell_order(self.name, outlet, message)
        if changes_mission(message):
            self._doubt_held("another ground station changes it")

    def _doubt_held(self, reason: str) -> None:
        """Believe no more that it holds what it held, until it is read back."""
        log.warning("mission in doubt", vehicle=self.name, reason=reason)
        meant = self.aboard.meant
        believed = meant.held if self._believed is None and meant is not None else self._believed
        self.holds_unknown()
        self._believed = believed
        self.tell()

    def holds_unknown(self) -> None:
        """Believe nothing about the mission it holds: it is being changed."""
        self.held = self._believed = None
        self.safety.release()
        self.found(None)

    async def begin_anew(self) -> None:
        """Another aircraft is in its place: what was known of this one is not that one's."""
        await self._recorder.end("interrupted")
        self._last_word = None
        self.holds_unknown()
        self.sent = self.upload = self.aboard.meant = None

    def found(self, same: bool | None) -> None:
        """Reading back has shown whether it holds what was sent; None: it has not."""
        self._found = same
        self.read_back_at = None if same is None else datetime.now(UTC)

    @property
    def sent_id(self) -> int | None:
        """The id it gave the mission sent to it in this life of the service."""
        return None if self._connection is None else self._connection.client.sent_id(MissionType.MISSION)

    def standing(self) -> tuple[Standing, Shown | None]:
        """Whether it holds the mission last sent to it, and what shows it; unknown of one that is silent."""
        if self.sent is None or not self.state.connected or self.turns.changing:
            return "unknown", None
        return standing_of(self.sent, self.client, self._found)

    async def _drop(self) -> None:
        connection, self._connection = self._connection, None
        await self._recorder.end("interrupted")
        if connection is not None:
            await connection.close()

    async def move(self, home: Home, timeout_s: float) -> None:
        """Put a simulated aircraft somewhere else: a new one on a new link."""
        await self._shut()
        await self.open(home, timeout_s)

    async def _watch(self) -> None:
        """Follow the vehicle; open the link anew when it fails, as a TCP peer that restarts makes it do."""
        while True:
            client = self.client
            async with asyncio.TaskGroup() as both:
                both.create_task(self._follow(client))
                if not self.replay:
                    both.create_task(self.safety.watch(client))
            self.tell()
            if self.simulated is not None or self.replay:
                return
            log.warning("link lost", vehicle=self.name, url=self.url)
            self.link_failure = client.failure
            self._broken_off(client)
            await self._drop()
            await asyncio.sleep(self._times.reopen_s)
            await self._reopen(None, self._times.reopen_s)

    async def _follow(self, client: VehicleClient) -> None:
        tries = RESOLVE_TRIES
        async with contextlib.aclosing(client.states()) as states:
            async for state in states:
                if state.connected:
                    self.lost_since = self._last_word = None
                elif self.lost_since is None and math.isfinite(client.silent_s):
                    self.lost_since = datetime.now(UTC) - timedelta(seconds=client.silent_s)
                self.tell()
                why = None if self.turns.changing else self.aboard.lost(state, client.now_s)
                if why is not None and self.sent is not None:
                    tries = RESOLVE_TRIES
                    self._doubt_held(why)
                if not state.connected:
                    tries = RESOLVE_TRIES
                    # What comes back may be another aircraft, or this one with another mission.
                    self.found(None)
                elif self._is_itself and state.system_id != self.system_id:
                    self.system_id = state.system_id
                    await self._memory.identified(self)
                elif self.turns.operation is not None or self.forwards.exchanging is not None:
                    pass  # somebody is at the lists: what they hold is read afterwards
                elif self.pending and tries:
                    tries -= 1
                    await self._resolve(client)
                elif self._believed is not None:
                    tries -= 1
                    await self._confirm(self._believed, last=tries <= 0)
                await asyncio.sleep(self._times.telemetry_s)

    async def _confirm(self, held: HeldMission, *, last: bool) -> None:
        """Read back whether it holds what it held before; a vehicle that does not answer is not believed."""
        try:
            async with self.turns.busy("reading back the mission it held"):
                self.found(await self._memory.still_holds(self, held))
        except (ServiceError, mavlink_errors.TransferFailedError) as error:
            log.warning("mission not read back", vehicle=self.name, reason=str(error))
            if not last:
                return
        log.info("mission read back", vehicle=self.name, plan_id=self.held and self.held.plan_id)
        self._believed = None
        self.tell()

    async def hold(self, held: HeldMission, items: Sequence[MissionItem]) -> None:
        """Take it that the vehicle holds a plan as these items, and find out where it shows its payload."""
        payload = DEFAULT_PAYLOAD if held.payload is None else parse_payload(held.payload)
        output = await self.safety.output(self.client, payload)
        self.held = HeldPlan(held.plan_id, held.plan_vehicle, held.payload, output, held.gimbal, held.sortie)
        self.safety.hold(payload, passes_of(items, payload, self.state.autopilot), len(items))
        self.client.show_sensor(output)
        # It may fly at once: what shows its payload must be listened to by then.
        self._look_now.set()

    @property
    def mission_lands(self) -> bool | None:
        """Whether the mission it holds has a landing; None where that is not known."""
        known = None if self.held is None or self._connection is None else self.client.mission_known
        return None if known is None else landing_of(known) is not None

    async def _resolve(self, client: VehicleClient) -> None:
        """Read back what an upload left whose outcome is unknown."""
        report = self.upload
        assert report is not None
        with contextlib.suppress(LinkError, BusyError):
            async with self.turns.busy("reading back an upload whose outcome is unknown"):
                await read_back(client, report)
        if not self.pending:
            log.info("unknown upload resolved", vehicle=self.name, outcome=report.outcome)
            await self._memory.record(self)

    async def _record(self) -> None:
        while True:
            try:
                # A flight that begins is filed under the plan held, so that has to be known first.
                if self._connection is not None and self._believed is None:
                    await self._recorder.look(self._connection.client, self.held)
                if time.monotonic() - self._told_s >= TELL_S:
                    self.tell()
            except Exception as error:
                # A track with a gap is better than none.
                log.error("track not recorded", vehicle=self.name, exc_info=error)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(self._times.replay_look_s if self.replay else self._times.look_s):
                    await self._look_now.wait()
            self._look_now.clear()
