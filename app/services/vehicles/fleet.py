"""All vehicles the service knows: connected, watched, let go."""

from __future__ import annotations

import asyncio
import uuid
from collections import Counter
from collections.abc import AsyncGenerator, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import structlog

from app.services.errors import ConflictError, NotFoundError, ServiceError, StorageError, UnsafeError
from app.services.hub import Hub
from app.services.metrics import VEHICLES
from app.services.plans.library import PlanLibrary
from app.services.records import VehicleRecord
from app.services.store.flights import FlightStore
from app.services.store.vehicles import VehicleStore
from app.services.vehicles.audit import Audit
from app.services.vehicles.brief import first_vehicle, start_of
from app.services.vehicles.connection import CONNECT_S, Home, is_replay, replayed_plan, simulated_of
from app.services.vehicles.forwarding import read_forwards, refuse_loops
from app.services.vehicles.keys import KeyRing
from app.services.vehicles.recorder import HeldPlan, is_flying
from app.services.vehicles.recordings import RecordingFile, Recordings
from app.services.vehicles.times import DEFAULT_TIMES, LinkTimes
from app.services.vehicles.transfers import Transfers
from app.services.vehicles.vehicle import Vehicle
from mavlink.encoding.payload import parse_payload
from mavlink.state.outputs import output_of
from mavlink.station.forward.address import ForwardAddress
from mavlink.station.terrain import Heights
from planner.errors import Finding

log = structlog.get_logger(__name__)

MAX_VEHICLES = 64
_ENDING = "the service is ending"


class Fleet:
    """The vehicles of one service.

    They are known until they are let go, also over a restart. Recordings and aircraft simulated by the
    start-up's wish are not: a recording would be flown and recorded anew by every restart.
    """

    def __init__(
        self,
        plans: PlanLibrary,
        transfers: Transfers,
        flights: FlightStore,
        kept: VehicleStore,
        audit: Audit,
        track_interval_s: float,
        recordings: Recordings | None = None,
        times: LinkTimes = DEFAULT_TIMES,
        heights: Heights | None = None,
        keys: KeyRing | None = None,
    ) -> None:
        self._keys = keys
        self._heights = heights
        self._plans = plans
        self._transfers = transfers
        self._flights = flights
        self._kept = kept
        self._audit = audit
        self._track_interval_s = track_interval_s
        self._recordings = recordings
        self._times = times
        self._vehicles: dict[str, Vehicle] = {}
        self._hub: Hub[Vehicle] = Hub()
        self._opening: dict[str, asyncio.Task[None]] = {}
        self._ended = False

    async def open(self) -> None:
        """Close the flights an earlier service left open; listen for its vehicles, commanding nothing."""
        await self._flights.recover()
        await self._audit.open()
        kept = await self._kept.all()
        await self._transfers.left.open(kept)
        for record in kept:
            try:
                vehicle = self._vehicle(replace(record, held=self._transfers.left.believed(record)))
            except ServiceError as error:
                log.error("vehicle forgotten", vehicle=record.name, url=record.url, reason=str(error))
                await self._kept.forget(record.id)
                continue
            self._vehicles[vehicle.id] = vehicle
            vehicle.resume(await self._default_home(record.url), CONNECT_S)
            log.info("vehicle known from before", vehicle=vehicle.name, url=vehicle.url)

    async def close(self) -> None:
        """Let every vehicle go, and give up those still being opened; once is enough, again is harmless."""
        self._ended = True
        for opening in tuple(self._opening.values()):
            _give_up(opening)
        await asyncio.gather(*(vehicle.close() for vehicle in self._vehicles.values()))
        self._vehicles.clear()
        await self._audit.close()

    def all(self) -> tuple[Vehicle, ...]:
        """Every vehicle, oldest first."""
        return tuple(self._vehicles.values())

    def get(self, vehicle_id: str) -> Vehicle:
        """One vehicle, by id; raises NotFoundError."""
        vehicle = self._vehicles.get(vehicle_id)
        if vehicle is None:
            raise NotFoundError("vehicle", vehicle_id)
        return vehicle

    async def connect(
        self,
        name: str,
        url: str,
        timeout_s: float = CONNECT_S,
        *,
        keep: bool = True,
        forward: Sequence[tuple[str, bool]] = (),
    ) -> Vehicle:
        """Connect a vehicle; when it stays silent it is known all the same, and listened for.

        Parameters
        ----------
        keep
            Whether the next service shall know it too.
        forward
            Where to forward its link to: addresses, and whether stations there may command it.

        Raises
        ------
        ConflictError
            The name or an address is in use.
        RefusedError, LinkError
            An address is malformed, or the link cannot be opened.
        """
        if self._ended:
            raise ConflictError(_ENDING)
        if len(self._vehicles) >= MAX_VEHICLES:
            raise ConflictError(f"{MAX_VEHICLES} vehicles are connected already")
        for other in self._vehicles.values():
            if other.name == name:
                raise ConflictError(f"there is a vehicle called {name} already")
            if other.url == url and other.simulated is None:
                raise ConflictError(f"{url} is in use by {other.name}")
        addresses = read_forwards(forward, replay=is_replay(url))
        record = VehicleRecord(str(uuid.uuid4()), name, url, datetime.now(UTC), forward=addresses)
        vehicle = self._vehicle(record)
        self._refuse_loops(vehicle, addresses)
        # Named before anything is waited for: two of one name must not pass the check above together.
        self._vehicles[vehicle.id] = vehicle
        opening = asyncio.create_task(self._open_link(vehicle, timeout_s))
        self._opening[vehicle.id] = opening
        try:
            await asyncio.wait((opening,))
            if self._ended:
                raise ConflictError(_ENDING)
            if vehicle.id not in self._vehicles:
                raise ConflictError(f"{name} was let go while it was being connected")
            opening.result()
        except BaseException:
            self._vehicles.pop(vehicle.id, None)
            # Waited for, not gathered: whoever is cancelled once more leaves it to close its link.
            _give_up(opening)
            await asyncio.wait((opening,))
            if not opening.cancelled():
                opening.exception()
            await vehicle.close()
            raise
        finally:
            del self._opening[vehicle.id]
        if keep and not vehicle.replay:
            try:
                await self._kept.add(replace(record, system_id=vehicle.system_id))
            except BaseException:
                self._vehicles.pop(vehicle.id, None)
                await vehicle.close()
                raise
        log.info("vehicle added", vehicle=name, url=url, connected=vehicle.state.connected)
        return vehicle

    async def _open_link(self, vehicle: Vehicle, timeout_s: float) -> None:
        if vehicle.replay:
            vehicle.held = await self._flown_plan(vehicle.url)
        await vehicle.open(await self._default_home(vehicle.url), timeout_s)

    async def forward(self, vehicle_id: str, forward: Sequence[tuple[str, bool]]) -> Vehicle:
        """Forward a vehicle's link to these addresses and no others; the same again changes nothing.

        Raises
        ------
        RefusedError
            An address is malformed, or would send frames round for ever.
        ConflictError
            An address cannot be opened; all is as before.
        StorageError
            It cannot be kept for the next start; all is as before.
        """
        vehicle = self.get(vehicle_id)
        addresses = read_forwards(forward, replay=vehicle.replay)
        self._refuse_loops(vehicle, addresses)
        before = tuple(outlet.address for outlet in vehicle.forwards.outlets)
        await vehicle.forward_to(addresses)
        self._share_forwards()
        try:
            await self._kept.forward(vehicle_id, addresses)
        except StorageError:
            await vehicle.forward_to(before)
            raise
        vehicle.tell()
        return vehicle

    def _refuse_loops(self, vehicle: Vehicle, addresses: tuple[ForwardAddress, ...]) -> None:
        others = [other for other in self._vehicles.values() if other is not vehicle]
        theirs = [outlet.address for other in others for outlet in other.forwards.outlets]
        refuse_loops([vehicle.url, *(other.url for other in others)], [*addresses, *theirs])

    async def disconnect(self, vehicle_id: str, in_flight: bool = False) -> None:
        """Let a vehicle go.

        Parameters
        ----------
        in_flight
            Whether it may be one that flies.

        Raises
        ------
        NotFoundError
            There is none.
        UnsafeError
            It flies, and nobody said that it may: rule ``in-flight``.
        """
        vehicle = self.get(vehicle_id)
        if not in_flight and not vehicle.replay and (vehicle.flight_id or is_flying(vehicle.state)):
            message = f"{vehicle.name} is in flight: let go, it is neither heard nor recorded any more"
            fix = "land it first; or say in_flight=true to let it go all the same"
            raise UnsafeError(message, (Finding("vehicle", "in-flight", message, fix),))
        await self._kept.forget(vehicle_id)
        if self._vehicles.pop(vehicle_id, None) is None:
            raise NotFoundError("vehicle", vehicle_id)
        if vehicle_id in self._opening:
            _give_up(self._opening[vehicle_id])
        await vehicle.close()
        self._hub.publish(vehicle_id, vehicle)
        log.info("vehicle let go", vehicle=vehicle.name)

    async def telemetry(self, vehicle_id: str) -> AsyncGenerator[Vehicle, None]:
        """The vehicle now and at every change, until it is let go."""
        async with self._hub.listen(vehicle_id) as queue:
            yield self.get(vehicle_id)
            while vehicle_id in self._vehicles:
                vehicle = await queue.get()
                while not queue.empty():
                    vehicle = queue.get_nowait()
                yield vehicle

    def heard(self) -> bool:
        """Whether a vehicle is heard that is neither simulated nor a recording."""
        return any(vehicle.state.connected for vehicle in self._real())

    def in_use(self) -> tuple[str, ...]:
        """Names of those vehicles, of them, that are armed or in flight, also where they are out of reach."""
        return tuple(v.name for v in self._real() if v.state.armed or v.flight_id is not None)

    def _real(self) -> list[Vehicle]:
        return [v for v in self._vehicles.values() if v.simulated is None and not v.replay]

    async def place_in_flight(self, flight_id: str) -> tuple[float, float, float | None] | None:
        """Longitude, latitude and course in degrees of the vehicle on a flight; None when none is."""
        for vehicle in self._vehicles.values():
            state = vehicle.state
            if vehicle.flight_id != flight_id or not state.connected or vehicle.replay:
                continue
            if state.lon_deg is not None and state.lat_deg is not None:
                return state.lon_deg, state.lat_deg, state.course_deg
        return None

    async def recordings(self, vehicle_id: str) -> tuple[RecordingFile, ...]:
        """Recordings of a vehicle's link, also of one let go; raises NotFoundError when there is neither."""
        vehicle = self._vehicles.get(vehicle_id)
        if vehicle is not None:
            await asyncio.to_thread(vehicle.tape.flush)
        files = (
            () if self._recordings is None else await asyncio.to_thread(self._recordings.files, vehicle_id)
        )
        if vehicle is None and not files:
            raise NotFoundError("vehicle", vehicle_id)
        return files

    async def recording(self, vehicle_id: str, name: str) -> Path:
        """Where one recording lies; raises NotFoundError."""
        if name not in {file.name for file in await self.recordings(vehicle_id)} or self._recordings is None:
            raise NotFoundError("recording", name)
        return self._recordings.path(vehicle_id, name)

    async def _flown_plan(self, url: str) -> HeldPlan | None:
        """The plan that a recording's address says was flown."""
        _, plan_id, payload = replayed_plan(url)
        if plan_id is None:
            return None
        name = await self._plans.worked(first_vehicle, await self._plans.plan_text(plan_id))
        # The output of an actuator is known from parameters, which a recording cannot be asked for.
        output = None if payload is None else output_of(parse_payload(payload), "generic")
        return HeldPlan(plan_id, name, payload, output)

    async def _default_home(self, url: str) -> Home | None:
        """Where a simulated aircraft stands at first that is not told: the start of the newest scenario."""
        aircraft = simulated_of(url)
        if aircraft is None or aircraft.home is not None:
            return None
        try:
            for record in await self._plans.newest(1):
                start = await self._plans.worked(start_of, await self._plans.scenario_text(record.id))
                if start is not None:
                    return start[1], start[0], 0.0
        except ServiceError as error:
            log.warning("start of the newest scenario not known", reason=str(error))
        return None

    def _vehicle(self, record: VehicleRecord) -> Vehicle:
        return Vehicle(
            record,
            self._flights,
            self._track_interval_s,
            self._publish,
            self._transfers,
            self._audit,
            self._recordings,
            self._times,
            self._heights,
            self._keys,
        )

    def _publish(self, vehicle: Vehicle) -> None:
        connected = sum(other.state.connected for other in self._vehicles.values())
        VEHICLES.labels(state="connected").set(connected)
        VEHICLES.labels(state="silent").set(len(self._vehicles) - connected)
        self._tell_namesakes(vehicle)
        self._hub.publish(vehicle.id, vehicle)

    def _tell_namesakes(self, vehicle: Vehicle) -> None:
        """Say which others have its system id, on links of their own: each gets its own orders."""
        same = [
            other
            for other in self._vehicles.values()
            if other.state.connected and other.system_id == vehicle.system_id != 0
        ]
        for one in same if vehicle in same else [vehicle]:
            names = tuple(other.name for other in same if other is not one) if one in same else ()
            if names and names != one.namesakes:
                log.warning("one system id twice", vehicle=one.name, system_id=one.system_id, others=names)
            one.namesakes = names
        self._share_forwards()

    def _share_forwards(self) -> None:
        """Have orders of stations refused that reach two aircraft of one system id by their forwards."""
        commanded = [
            one
            for one in self._vehicles.values()
            if one.state.connected and any(outlet.address.write for outlet in one.forwards.outlets)
        ]
        ids = Counter(one.system_id for one in commanded)
        for one in self._vehicles.values():
            shared = one in commanded and ids[one.system_id] > 1
            if shared and not one.forwards.shared:
                log.warning(
                    "stations may command two of one system id", vehicle=one.name, system_id=one.system_id
                )
            one.forwards.shared = shared


def _give_up(opening: asyncio.Task[None]) -> None:
    """Cancel it once: cancelled again, it would leave what it is just closing."""
    if not opening.cancelling():
        opening.cancel()
