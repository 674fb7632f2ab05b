"""Flights as they happen: from the first movement of an armed vehicle to its landing or disarming."""

from __future__ import annotations

import asyncio
import contextlib
import math
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Literal

import structlog

from app.services.errors import StorageError
from app.services.records import FlightEvent, FlightState, FlownEnergy, LinkEvent, SensorAction, TrackSample
from app.services.store.flights import FlightStore
from mavlink.encoding.gimbal import NO_GIMBAL
from mavlink.state.outputs import SensorOutput
from mavlink.state.telemetry import VehicleState
from mavlink.state.track import SensorEvent, Track, TrackPoint, TrackRecorder
from mavlink.station.client import VehicleClient

log = structlog.get_logger(__name__)

#: An armed vehicle that reports no landed state flies when it is faster than this.
MOVING_M_S = 3.0
#: An armed vehicle has landed when it says so at this many looks in turn: touching down, it may bounce.
LANDED_LOOKS = 3

#: What a flight drew is stored this often, for one that nobody watches to its end.
ENERGY_S = 10.0


def is_flying(state: VehicleState) -> bool:
    """Whether a vehicle is armed and on its way."""
    if not state.armed:
        return False
    if state.landed is not None:
        return not state.landed
    return (state.ground_speed_m_s or 0.0) > MOVING_M_S


@dataclass(frozen=True, slots=True)
class HeldPlan:
    """The plan a vehicle holds, and its name there.

    Parameters
    ----------
    payload
        How the sensor is switched, as the upload said it; None for the default.
    output
        Where the vehicle shows that; None where it shows it nowhere.
    gimbal
        What points the sensor, as the upload said it.
    sortie
        Which of the vehicle's flights in the plan.
    """

    plan_id: str
    plan_vehicle: str
    payload: str | None = None
    output: SensorOutput | None = None
    gimbal: str | None = None
    sortie: int = 1


@dataclass(frozen=True, slots=True)
class _Ending:
    """A flight that is over, with what of it is not stored."""

    flight_id: str
    state: FlightState
    samples: tuple[TrackSample, ...]
    events: tuple[FlightEvent, ...]
    ended_at: datetime | None
    energy: FlownEnergy | None


class FlightRecorder:
    """Records the flights of one vehicle.

    Parameters
    ----------
    interval_s
        Vehicle time between two recorded places; changes of the sensor are always recorded.
    """

    def __init__(self, store: FlightStore, vehicle_id: str, vehicle_name: str, interval_s: float) -> None:
        self._store = store
        self._vehicle_id = vehicle_id
        self._vehicle_name = vehicle_name
        self._interval_s = interval_s
        self._client: VehicleClient | None = None
        self._recorder: TrackRecorder | None = None
        self._plan: HeldPlan | None = None
        self._events_saved = 0
        #: Places and ends that the database has not taken yet.
        self._unsaved: list[TrackSample] = []
        self._endings: list[_Ending] = []
        self._failing = False
        self._landed_looks = 0
        self._energy_due_s = 0.0
        self._lost = False
        self._thinner = Thinner(interval_s)
        self.flight_id: str | None = None
        self._latest_id: str | None = None
        # A link that is lost ends the flight while a look at it may be waiting for the database.
        self._turn = asyncio.Lock()

    async def look(self, client: VehicleClient, plan: HeldPlan | None) -> None:
        """Begin, go on with or end a flight, as the vehicle's state says; call about once a second.

        A plan uploaded in flight ends one flight and begins another: each is judged by the plan it followed.
        Before a flight, what the vehicle sends is recorded from one look to the next, so that a flight has
        its very beginning however late it is looked at. What the database does not take is kept and tried
        again at the next look.
        """
        try:
            await self._look(client, plan)
            self._failing = False
        except StorageError as error:
            if not self._failing:
                log.error("track not stored yet", vehicle=self._vehicle_name, reason=str(error))
            self._failing = True

    async def _look(self, client: VehicleClient, plan: HeldPlan | None) -> None:
        async with self._turn:
            await self._close()
            state = client.state
            if self.flight_id is None:
                if client.failure is not None or not state.connected:
                    return
                recorder = self._listening(client, plan)
                if is_flying(state):
                    await self._begin(plan)
                else:
                    recorder.forget()
                return
            await self._note_link(client)
            if client.failure is not None:
                await self._end("interrupted")
            elif state.connected and self._landed(state):
                await self._end("ended")
            elif state.connected and plan is not None and plan != self._plan:
                await self._change(client, plan)
            else:
                await self._save()

    async def _note_link(self, client: VehicleClient) -> None:
        """Note a loss of the link, by when it was last heard, and its end; the end of a recording is none."""
        if _moment(self._recorder, 0) is not None:
            return
        state, lost = client.state, client.failure is not None or not client.state.connected
        if lost == self._lost or self.flight_id is None:
            return
        silent_s = client.silent_s if lost and math.isfinite(client.silent_s) else 0.0
        at = datetime.now(UTC) - timedelta(seconds=silent_s)
        event = LinkEvent("lost" if lost else "back", at, state.time_s)
        await self._store.heard(self.flight_id, event)
        self._lost = lost
        log.warning("link of a flight", vehicle=self._vehicle_name, link=event.kind, at=at.isoformat())

    def _landed(self, state: VehicleState) -> bool:
        """Whether a flight under way is over; one that does not say whether it has landed ends disarmed."""
        on_ground = state.armed and state.landed is True
        self._landed_looks = self._landed_looks + 1 if on_ground else 0
        return not state.armed or self._landed_looks >= LANDED_LOOKS

    def _listening(self, client: VehicleClient, plan: HeldPlan | None) -> TrackRecorder:
        """A recorder on a link, for what shows a plan's payload; the one there is, where it suits."""
        if self._recorder is None or self._client is not client or self._plan != plan:
            self._stop_listening()
            self._client, self._plan = client, plan
            self._recorder = _recording(client, plan)
        return self._recorder

    def _stop_listening(self) -> None:
        if self._client is not None and self._recorder is not None:
            self._client.stop_recording(self._recorder)
        self._client = self._recorder = self._plan = None

    async def _change(self, client: VehicleClient, plan: HeldPlan) -> None:
        """End the flight under way and begin another; nothing is missed while the first is being stored."""
        recorder = _recording(client, plan)
        try:
            await self._end("ended")
        except BaseException:
            client.stop_recording(recorder)
            raise
        self._client, self._recorder, self._plan = client, recorder, plan
        await self._begin(plan)

    async def _begin(self, plan: HeldPlan | None) -> None:
        try:
            self.flight_id = await self._store.begin(
                self._vehicle_id,
                self._vehicle_name,
                plan.plan_id if plan else None,
                plan.plan_vehicle if plan else None,
                plan.payload if plan else None,
                _moment(self._recorder, 0),
                plan.sortie if plan else 1,
            )
        except StorageError:
            # What is heard is kept: the flight begins with it once the database takes it.
            raise
        except BaseException:
            self._stop_listening()
            raise
        self._latest_id = self.flight_id
        untold = plan is None or (plan.payload is None and plan.output is None)
        self._thinner = Thinner(self._interval_s, by_relays=untold)
        self._landed_looks = self._events_saved = 0
        self._energy_due_s, self._lost = 0.0, False
        log.info("flight begun", vehicle=self._vehicle_name, flight_id=self.flight_id)

    async def _save(self) -> None:
        if self._recorder is None or self.flight_id is None:
            return
        track = self._recorder.track()
        events = self._gather(track)
        await self._store.add(self.flight_id, self._unsaved)
        self._unsaved = []
        await self._store.add_events(self.flight_id, events)
        self._events_saved += len(events)
        energy, now_s = _energy(track), asyncio.get_running_loop().time()
        if energy is not None and now_s >= self._energy_due_s:
            await self._store.draw(self.flight_id, energy)
            self._energy_due_s = now_s + ENERGY_S

    def _gather(self, track: Track) -> list[FlightEvent]:
        """Events that are not saved yet; places join those that are not."""
        self._unsaved += self._thinner.more(track)
        return [flight_event(event) for event in track.events[self._events_saved :]]

    async def act(self, action: SensorAction) -> None:
        """Note what the service did by itself, in the flight under way or the one that has just ended."""
        if self._latest_id is not None:
            await self._store.act(self._latest_id, action)

    async def end(self, state: FlightState) -> None:
        """Close the flight, if there is one."""
        async with self._turn:
            await self._end(state)

    async def _end(self, state: FlightState) -> None:
        if self.flight_id is None:
            self._stop_listening()
            return
        track = Track() if self._recorder is None else self._recorder.track()
        events = self._gather(track)
        ended_at = _moment(self._recorder, 1)
        self._stop_listening()
        self._endings.append(
            _Ending(self.flight_id, state, tuple(self._unsaved), tuple(events), ended_at, _energy(track))
        )
        self._unsaved, self.flight_id = [], None
        with contextlib.suppress(StorageError):
            await self._close()

    async def _close(self) -> None:
        """Store the ends of flights; those that the database does not take stay for the next look."""
        while self._endings:
            ending = self._endings[0]
            await self._store.end(
                ending.flight_id, ending.state, ending.samples, ending.events, ending.ended_at, ending.energy
            )
            self._endings.pop(0)
            log.info(
                "flight ended", vehicle=self._vehicle_name, flight_id=ending.flight_id, state=ending.state
            )


def _recording(client: VehicleClient, plan: HeldPlan | None) -> TrackRecorder:
    if plan is None:
        return client.start_recording()
    return client.start_recording(plan.output, plan.gimbal not in (None, NO_GIMBAL))


def _moment(recorder: TrackRecorder | None, which: Literal[0, 1]) -> datetime | None:
    """When a recording's track begins or ends, by its own clock; None of what is flown now."""
    recorded = None if recorder is None else recorder.recorded
    return None if recorded is None else datetime.fromtimestamp(recorded[which], UTC)


def _energy(track: Track) -> FlownEnergy | None:
    """What a flight drew so far, as flights keep it."""
    told = track.energy
    return None if told is None else FlownEnergy(told.used_wh, told.source, told.complete)


def flight_event(event: SensorEvent) -> FlightEvent:
    """An event of the track as flights keep it."""
    return FlightEvent(
        time_s=event.time_s,
        kind=event.kind,
        source=event.source,
        index=event.index,
        lon_deg=event.lon_deg,
        lat_deg=event.lat_deg,
        altitude_amsl_m=event.amsl_m,
        altitude_home_m=event.relative_m,
        heading_deg=event.heading_deg,
        roll_deg=event.roll_deg,
        pitch_deg=event.pitch_deg,
        attitude_of=event.attitude_of if event.kind == "photo" else None,
    )


class Thinner:
    """New places of a growing track, no closer together than an interval unless the sensor changed.

    Parameters
    ----------
    by_relays
        Whether any relay tells of a sensor that nothing else tells of: nobody said what switches it.
    """

    def __init__(self, interval_s: float, *, by_relays: bool = True) -> None:
        self._interval_s = interval_s
        self._by_relays = by_relays
        self._taken = 0
        self._kept: TrackSample | None = None

    def more(self, track: Track) -> list[TrackSample]:
        """What has been added since the last call."""
        kept: list[TrackSample] = []
        switches = [
            (event.time_s, event.kind == "on")
            for event in track.events
            if self._by_relays and event.source == "relay" and event.kind != "photo"
        ]
        # A recorder that has run for many hours drops every second place and gets shorter.
        new = track.points[self._taken :]
        self._taken = len(track.points)
        for point in new:
            sample = _sample(point, switches)
            last = self._kept
            if (
                last is None
                or sample.sensor_on != last.sensor_on
                or not 0.0 <= sample.time_s - last.time_s < self._interval_s
            ):
                self._kept = sample
                kept.append(sample)
        return kept


def _sample(point: TrackPoint, switches: list[tuple[float, bool]]) -> TrackSample:
    sensor_on = point.sensor_on
    if sensor_on is None and switches:
        # Autopilots that do not report the payload report its relay.
        sensor_on = next((on for time_s, on in reversed(switches) if time_s <= point.time_s), False)
    return TrackSample(
        time_s=point.time_s,
        lon_deg=point.lon_deg,
        lat_deg=point.lat_deg,
        altitude_amsl_m=point.amsl_m,
        altitude_home_m=point.relative_m,
        heading_deg=point.heading_deg,
        roll_deg=point.roll_deg,
        ground_speed_m_s=point.ground_speed_m_s,
        mission_seq=point.mission_current,
        sensor_on=sensor_on,
        pitch_deg=point.pitch_deg,
        mount_roll_deg=None if point.mount is None else point.mount.roll_deg,
        mount_pitch_deg=None if point.mount is None else point.mount.pitch_deg,
        mount_yaw_deg=None if point.mount is None else point.mount.yaw_deg,
    )
