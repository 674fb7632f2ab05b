"""All vehicles the service knows: connected, uploaded to, commanded, let go."""

from __future__ import annotations

import asyncio
import json
import uuid
from collections.abc import AsyncGenerator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import structlog

from app.services.errors import (
    CommandRefusedError,
    ConflictError,
    LinkError,
    NotFoundError,
    RefusedError,
    ServiceError,
)
from app.services.hub import Hub
from app.services.metrics import UPLOADS, VEHICLES
from app.services.missions import PARTS, MissionChoice, PartName, encode_plan, plan_of
from app.services.planning import PlanningService
from app.services.records import HeldMission, SentMission, VehicleRecord
from app.services.store.flights import FlightStore
from app.services.store.uploads import UploadStore
from app.services.store.vehicles import VehicleStore
from app.services.vehicles.connection import Home, replayed_plan
from app.services.vehicles.inspection import ParameterReport, inspect, mission_needs, read_parameters
from app.services.vehicles.items import item_json
from app.services.vehicles.preflight import Preflight
from app.services.vehicles.recorder import HeldPlan, is_flying
from app.services.vehicles.recordings import RecordingFile, Recordings
from app.services.vehicles.uploads import (
    UploadReport,
    comparing,
    judge_upload,
    new_report,
    report_json,
    send_parts,
)
from app.services.vehicles.vehicle import Vehicle
from mavlink import errors as mavlink_errors
from mavlink.geometry import distance_m
from mavlink.mission import Mission
from mavlink.outputs import output_of
from mavlink.payload import parse_payload
from mavlink.transfer.command import CommandOutcome
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Outcome
from planner.errors import Finding
from planner.plan import Plan

log = structlog.get_logger(__name__)

CONNECT_S = 10.0
MAX_VEHICLES = 64
#: A simulated aircraft without a home of its own stands where its plan begins; further away, it moves.
AT_HOME_M = 50.0
_ENDING = "the service is ending"
#: Orders that make a vehicle fly a mission, and so not while one is being changed.
_FLYING_ORDERS = frozenset({"arm", "start", "resume", "goto_item"})


class Fleet:
    """The vehicles of one service.

    They are known until they are let go, also over a restart. Recordings and aircraft simulated by the
    start-up's wish are not: a recording would be flown and recorded anew by every restart.
    """

    def __init__(
        self,
        planning: PlanningService,
        uploads: UploadStore,
        flights: FlightStore,
        kept: VehicleStore,
        track_interval_s: float,
        recordings: Recordings | None = None,
    ) -> None:
        self._planning = planning
        self._uploads = uploads
        self._flights = flights
        self._kept = kept
        self._track_interval_s = track_interval_s
        self._recordings = recordings
        self._vehicles: dict[str, Vehicle] = {}
        self._hub: Hub[Vehicle] = Hub()
        self._opening: dict[str, asyncio.Task[None]] = {}
        self._ended = False

    async def open(self) -> None:
        """Close the flights an earlier service left open; listen for its vehicles, commanding nothing."""
        await self._flights.recover()
        home = await self._default_home()
        for record in await self._kept.all():
            try:
                vehicle = self._vehicle(record)
            except ServiceError as error:
                log.error("vehicle forgotten", vehicle=record.name, url=record.url, reason=str(error))
                await self._kept.forget(record.id)
                continue
            self._vehicles[vehicle.id] = vehicle
            vehicle.resume(home, CONNECT_S)
            log.info("vehicle known from before", vehicle=vehicle.name, url=vehicle.url)

    async def close(self) -> None:
        """Let every vehicle go, and give up those still being opened; once is enough, again is harmless."""
        self._ended = True
        for opening in tuple(self._opening.values()):
            opening.cancel()
        await asyncio.gather(*(vehicle.close() for vehicle in self._vehicles.values()))
        self._vehicles.clear()

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
        self, name: str, url: str, timeout_s: float = CONNECT_S, *, keep: bool = True
    ) -> Vehicle:
        """Connect a vehicle; when it stays silent it is known all the same, and listened for.

        Parameters
        ----------
        keep
            Whether the next service shall know it too.

        Raises
        ------
        ConflictError
            The name or the address is in use.
        RefusedError, LinkError
            The address is malformed, or the link cannot be opened.
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
        vehicle = self._vehicle(VehicleRecord(str(uuid.uuid4()), name, url, datetime.now(UTC)))
        if vehicle.replay:
            vehicle.held = await self._flown_plan(url)
        self._vehicles[vehicle.id] = vehicle
        opening = asyncio.create_task(vehicle.open(await self._default_home(), timeout_s))
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
            opening.cancel()
            await asyncio.gather(opening, return_exceptions=True)
            await vehicle.close()
            raise
        finally:
            del self._opening[vehicle.id]
        if keep and not vehicle.replay:
            await self._kept.add(VehicleRecord(vehicle.id, name, url, vehicle.created_at))
        log.info("vehicle added", vehicle=name, url=url, connected=vehicle.state.connected)
        return vehicle

    async def disconnect(self, vehicle_id: str) -> None:
        """Let a vehicle go; raises NotFoundError."""
        vehicle = self.get(vehicle_id)
        del self._vehicles[vehicle_id]
        if vehicle_id in self._opening:
            self._opening[vehicle_id].cancel()
        await self._kept.forget(vehicle_id)
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

    async def upload(
        self,
        vehicle_id: str,
        plan_id: str,
        parts: Sequence[PartName],
        choice: MissionChoice = MissionChoice(),  # noqa: B008 - a frozen value
        override: str | None = None,
    ) -> UploadReport:
        """Put a plan into a vehicle, read it back, compare.

        Raises
        ------
        UnsafeError
            The plan must not be flown without an override.
        BusyError
            Another operation is at work on the vehicle.
        LinkError
            The vehicle is not there.
        """
        vehicle = self.get(vehicle_id)
        async with vehicle.busy(f"upload of plan {plan_id}", changes=True):
            plan = plan_of(await self._planning.plan_text(plan_id))
            # Now, as somebody may delete the plan meanwhile.
            scenario = json.loads(await self._planning.scenario_text(plan_id))
            if not vehicle.state.connected:
                raise LinkError(f"{vehicle.name} is not connected")
            mission = await asyncio.to_thread(encode_plan, plan, _for_vehicle(vehicle, choice))
            findings = judge_upload(plan, mission, parts, vehicle.state, override)
            await self._bring_home(vehicle, plan)
            report = await self._begin_upload(vehicle, plan_id, mission, parts, override, findings)
            report.payload = choice.payload

            def tell(part: PartName, made: Progress) -> None:
                vehicle.progress = {"part": part, "done": made.done, "total": made.total}
                self._publish(vehicle)

            if "mission" in parts:
                vehicle.holds_unknown()
            try:
                await send_parts(vehicle.client, report, tell)
            finally:
                await self._record_upload(vehicle)
            if report.outcome == "accepted":
                report.preflight = await self._preflight_behind(vehicle, plan, scenario, report, choice)
        return report

    async def preflight(self, vehicle_id: str, plan_id: str, choice: MissionChoice) -> Preflight:
        """Ask the vehicle whether it is ready to fly a plan; changes nothing in it."""
        vehicle = self.get(vehicle_id)
        async with vehicle.busy(f"pre-flight check for plan {plan_id}"):
            plan = plan_of(await self._planning.plan_text(plan_id))
            choice = _for_vehicle(vehicle, choice)
            mission = await asyncio.to_thread(encode_plan, plan, choice)
            scenario = json.loads(await self._planning.scenario_text(plan_id))
            return await inspect(vehicle.client, plan_id, plan, scenario, mission, choice)

    async def _preflight_behind(
        self,
        vehicle: Vehicle,
        plan: Plan,
        scenario: dict[str, Any],
        report: UploadReport,
        choice: MissionChoice,
    ) -> Preflight | None:
        """The check behind an upload; None when the vehicle vanished, which leaves the upload as it is."""
        try:
            return await inspect(
                vehicle.client, report.plan_id, plan, scenario, report.mission, choice, report
            )
        except (mavlink_errors.NotConnectedError, mavlink_errors.BusyError, LinkError):
            log.warning("no pre-flight check behind the upload", vehicle=vehicle.name)
            return None

    async def parameters(
        self, vehicle_id: str, names: Sequence[str], plan_id: str | None, choice: MissionChoice
    ) -> ParameterReport:
        """Parameters by name; with a plan also those it needs, judged.

        Raises
        ------
        RefusedError
            A name cannot be one, or neither names nor a plan are given.
        LinkError
            The vehicle is not there, or answers about none of them.
        """
        vehicle = self.get(vehicle_id)
        async with vehicle.busy("reading parameters"):
            if plan_id is None:
                return await read_parameters(vehicle.client, names, None)
            plan = plan_of(await self._planning.plan_text(plan_id))
            choice = _for_vehicle(vehicle, choice)
            mission = await asyncio.to_thread(encode_plan, plan, choice)
            scenario = json.loads(await self._planning.scenario_text(plan_id))
            needs = mission_needs(plan, scenario, mission, choice)
            return await read_parameters(vehicle.client, names, (mission, needs))

    async def download(self, vehicle_id: str, parts: Sequence[PartName]) -> dict[str, list[dict[str, Any]]]:
        """What a vehicle holds, part by part."""
        vehicle = self.get(vehicle_id)
        async with vehicle.busy("download"):
            try:
                return {
                    name: [item_json(item) for item in await vehicle.client.download(PARTS[name])]
                    for name in parts
                }
            except mavlink_errors.TransferFailedError as error:
                raise LinkError(f"{vehicle.name}: {error}") from error

    async def clear(self, vehicle_id: str, parts: Sequence[PartName]) -> dict[str, Outcome]:
        """Empty a vehicle's lists."""
        vehicle = self.get(vehicle_id)
        async with vehicle.busy("clearing", changes=True):
            outcomes: dict[str, Outcome] = {}
            for name in parts:
                outcomes[name] = await vehicle.client.clear(PARTS[name])
                if name == "mission":
                    vehicle.holds_unknown()
                    await self._kept.hold(vehicle.id, None)
                    if outcomes[name].kind == "accepted":
                        vehicle.sent = None
                        await self._kept.send(vehicle.id, None)
            return outcomes

    async def command(self, vehicle_id: str, command: str, seq: int | None) -> CommandOutcome | Outcome:
        """An explicit flight command; raises CommandRefusedError when the vehicle says no."""
        vehicle = self.get(vehicle_id)
        vehicle.require_orders(command)
        log.info("flight command", vehicle=vehicle.name, command=command, seq=seq)
        try:
            if command in _FLYING_ORDERS:
                with vehicle.ordering(command):
                    outcome = await self._order(vehicle, command, seq)
            else:
                outcome = await self._order(vehicle, command, seq)
        except (mavlink_errors.NotConnectedError, mavlink_errors.LinkError) as error:
            raise LinkError(f"{vehicle.name}: {error}") from error
        except mavlink_errors.BusyError as error:
            raise ConflictError(f"{vehicle.name} is busy: {error}") from error
        if isinstance(outcome, CommandOutcome):
            if outcome.result is not None and not outcome.accepted:
                said = vehicle.state.texts[-1].text if vehicle.state.texts else ""
                raise CommandRefusedError(f"{vehicle.name} refused {outcome}{said and f'; it says: {said}'}")
        elif outcome.kind == "refused":
            raise CommandRefusedError(f"{vehicle.name}: {outcome}")
        return outcome

    async def _order(self, vehicle: Vehicle, command: str, seq: int | None) -> CommandOutcome | Outcome:
        client = vehicle.client
        match command:
            case "arm":
                return await client.arm()
            case "disarm":
                return await client.disarm()
            case "start":
                return await client.start_mission()
            case "pause":
                return await client.pause()
            case "resume":
                return await client.resume()
            case "rtl":
                return await client.return_to_launch()
            case "goto_item" if seq is not None:
                return await client.goto_item(seq)
        message = f"{command} needs the number of an item in seq"
        raise RefusedError(message, (Finding("seq", "seq-missing", message, "send seq"),))

    def place_in_flight(self, flight_id: str) -> tuple[float, float, float | None] | None:
        """Longitude, latitude and course in degrees of the vehicle on a flight; None when none is."""
        for vehicle in self._vehicles.values():
            state = vehicle.state
            if vehicle.flight_id != flight_id or not state.connected or vehicle.replay:
                continue
            if state.lon_deg is not None and state.lat_deg is not None:
                return state.lon_deg, state.lat_deg, state.course_deg
        return None

    def recordings(self, vehicle_id: str) -> tuple[RecordingFile, ...]:
        """Recordings of a vehicle's link, also of one let go; raises NotFoundError when there is neither."""
        vehicle = self._vehicles.get(vehicle_id)
        if vehicle is not None:
            vehicle.show_recording()
        files = () if self._recordings is None else self._recordings.files(vehicle_id)
        if vehicle is None and not files:
            raise NotFoundError("vehicle", vehicle_id)
        return files

    def recording(self, vehicle_id: str, name: str) -> Path:
        """Where one recording lies; raises NotFoundError."""
        if name not in {file.name for file in self.recordings(vehicle_id)} or self._recordings is None:
            raise NotFoundError("recording", name)
        return self._recordings.path(vehicle_id, name)

    async def _flown_plan(self, url: str) -> HeldPlan | None:
        """The plan that a recording's address says was flown."""
        _, plan_id, payload = replayed_plan(url)
        if plan_id is None:
            return None
        plan = plan_of(await self._planning.plan_text(plan_id))
        # The output of an actuator is known from parameters, which a recording cannot be asked for.
        output = None if payload is None else output_of(parse_payload(payload), "generic")
        return HeldPlan(plan_id, plan.vehicles[0].name, payload, output)

    async def _default_home(self) -> Home | None:
        """Where a simulated aircraft stands at first: the start of the newest scenario."""
        for record in await self._planning.newest(1, 0, None):
            scenario = json.loads(await self._planning.scenario_text(record.id))
            for feature in scenario["features"]:
                if (feature.get("properties") or {}).get("role") == "start":
                    lon_deg, lat_deg = feature["geometry"]["coordinates"][:2]
                    return float(lat_deg), float(lon_deg), 0.0
        return None

    async def _bring_home(self, vehicle: Vehicle, plan: Plan) -> None:
        """A simulated aircraft that stands elsewhere, and was not told where, goes where the plan begins."""
        if vehicle.simulated is None or vehicle.simulated.home is not None or is_flying(vehicle.state):
            return
        state = vehicle.state
        place = (state.lon_deg or 0.0, state.lat_deg or 0.0)
        if distance_m(place, plan.home) < AT_HOME_M:
            return
        log.info("simulated aircraft moves to the plan's start", vehicle=vehicle.name)
        await vehicle.move(_home_of(plan), CONNECT_S)

    async def _begin_upload(
        self,
        vehicle: Vehicle,
        plan_id: str,
        mission: Mission,
        parts: Sequence[PartName],
        override: str | None,
        findings: tuple[Finding, ...],
    ) -> UploadReport:
        number = await self._uploads.begin(vehicle.id, vehicle.name, plan_id, parts, override)
        if override is not None:
            rules = [finding.rule for finding in findings]
            log.warning(
                "upload overrides", vehicle=vehicle.name, plan_id=plan_id, reason=override, rules=rules
            )
        report = new_report(number, plan_id, mission, parts, override, findings)
        vehicle.upload = report
        return report

    async def _record_upload(self, vehicle: Vehicle) -> None:
        report = vehicle.upload
        assert report is not None
        mission = report.parts.get("mission")
        if mission is not None:
            held = HeldMission(report.plan_id, report.plan_vehicle, report.payload)
            if mission.verified:
                await vehicle.hold(held)
            vehicle.found(None if mission.differences is None else not mission.differences)
            vehicle.sent = SentMission(report.plan_id, vehicle.sent_id if mission.verified else None)
            await self._kept.send(vehicle.id, vehicle.sent)
            await self._kept.hold(vehicle.id, held if mission.verified else None)
        outcome = "unknown" if report.outcome == "not_attempted" else report.outcome
        UPLOADS.labels(outcome=outcome).inc()
        await self._uploads.end(report.number, outcome, report_json(report))
        log.info("upload ended", vehicle=vehicle.name, plan_id=report.plan_id, outcome=outcome)
        self._publish(vehicle)

    async def _resolved(self, vehicle: Vehicle) -> None:
        await self._record_upload(vehicle)

    def _vehicle(self, record: VehicleRecord) -> Vehicle:
        return Vehicle(
            record,
            self._flights,
            self._track_interval_s,
            self._publish,
            self._resolved,
            self._still_holds,
            self._recordings,
        )

    async def _still_holds(self, vehicle: Vehicle, held: HeldMission) -> bool | None:
        """Read back whether a vehicle holds the plan it held before; None when that plan is deleted."""
        try:
            plan = plan_of(await self._planning.plan_text(held.plan_id))
        except (NotFoundError, ConflictError):
            return None
        choice = _for_vehicle(vehicle, MissionChoice(held.plan_vehicle, None, held.payload))
        mission = await asyncio.to_thread(encode_plan, plan, choice)
        meant = mission.items_of(PARTS["mission"])
        found = await vehicle.client.download(PARTS["mission"])
        same = not comparing(mission.dialect)(meant, found)
        if same:
            vehicle.client.recognise(PARTS["mission"])
        else:
            await self._kept.hold(vehicle.id, None)
        return same

    def _publish(self, vehicle: Vehicle) -> None:
        connected = sum(other.state.connected for other in self._vehicles.values())
        VEHICLES.labels(state="connected").set(connected)
        VEHICLES.labels(state="silent").set(len(self._vehicles) - connected)
        self._hub.publish(vehicle.id, vehicle)


def _home_of(plan: Plan) -> Home:
    lon_deg, lat_deg = plan.home
    return lat_deg, lon_deg, 0.0


def _for_vehicle(vehicle: Vehicle, choice: MissionChoice) -> MissionChoice:
    """The choice, encoded for the autopilot that is really there."""
    autopilot = vehicle.state.autopilot
    if choice.autopilot is not None or autopilot == "generic":
        return choice
    return MissionChoice(choice.vehicle, autopilot, choice.payload)
