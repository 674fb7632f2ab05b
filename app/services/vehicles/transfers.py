"""Missions into vehicles and out of them: judged, uploaded, read back, cleared, remembered."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Sequence
from dataclasses import replace
from typing import Any

import structlog

from app.services.errors import (
    ConflictError,
    LinkError,
    NotFoundError,
    RefusedError,
    StorageError,
    UnsafeError,
)
from app.services.metrics import UPLOADS
from app.services.plans.library import PlanLibrary
from app.services.plans.missions import PARTS, MissionChoice, PartName
from app.services.records import HeldMission, SentMission
from app.services.store.uploads import UploadStore
from app.services.store.vehicles import VehicleStore
from app.services.vehicles.aboard import Meant
from app.services.vehicles.audit import Audit
from app.services.vehicles.brief import Brief, brief_of
from app.services.vehicles.checks import for_vehicle
from app.services.vehicles.connection import CONNECT_S
from app.services.vehicles.inspection import inspect
from app.services.vehicles.items import item_json
from app.services.vehicles.left_uploads import LeftUploads
from app.services.vehicles.pointing import pointing_findings
from app.services.vehicles.preflight import Preflight
from app.services.vehicles.recorder import is_flying
from app.services.vehicles.replaced import replaced
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
from mavlink.dialects.mission import Mission
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Outcome
from mavlink.wire.geometry import distance_m
from planner.errors import Finding
from planner.plan import Plan

log = structlog.get_logger(__name__)

#: How long an aircraft just acknowledged is waited for.
HEARD_S = 3.0
#: A simulated aircraft without a home of its own stands where its plan begins; further away, it moves.
AT_HOME_M = 50.0


class Transfers:
    """Transfers to and from vehicles, and what is remembered of them over a restart."""

    def __init__(self, plans: PlanLibrary, uploads: UploadStore, kept: VehicleStore, audit: Audit) -> None:
        self._plans = plans
        self._uploads = uploads
        self._kept = kept
        self._audit = audit
        self.left = LeftUploads(uploads, plans)

    async def upload(
        self,
        vehicle: Vehicle,
        plan_id: str,
        parts: Sequence[PartName],
        choice: MissionChoice = MissionChoice(),  # noqa: B008 - a frozen value
        override: str | None = None,
    ) -> UploadReport:
        """Put a plan into a vehicle, read it back, compare.

        Raises
        ------
        UnsafeError
            The plan must not be flown without an override, or is stale.
        BusyError
            Another operation is at work on the vehicle.
        LinkError
            The vehicle is not there.
        """
        async with vehicle.turns.busy(f"upload of plan {plan_id}", changes=True):
            plan_text = await self._plans.plan_text(plan_id)
            # Now, as somebody may delete the plan meanwhile.
            scenario_text = await self._plans.scenario_text(plan_id)
            stale = (await self._plans.get(plan_id)).stale_reason
            if not vehicle.state.connected:
                raise LinkError(f"{vehicle.name}: {vehicle.client.absence}")
            brief = await self._plans.worked(brief_of, plan_text, scenario_text, for_vehicle(vehicle, choice))
            findings = _pointed(brief) if "mission" in parts else ()
            findings += judge_upload(brief.plan, brief.mission, parts, vehicle.state, override, stale)
            await _bring_home(vehicle, brief.plan)
            choice = replace(choice, payload=brief.payload)
            report = await self._begin(vehicle, plan_id, brief.mission, parts, override, findings, choice)

            def tell(part: PartName, made: Progress) -> None:
                vehicle.turns.progress = {"part": part, "done": made.done, "total": made.total}
                vehicle.tell()

            flying = is_flying(vehicle.state)
            if "mission" in parts:
                vehicle.holds_unknown()
                vehicle.aboard.meant = None
            try:
                await send_parts(vehicle.client, report, tell)
            finally:
                await self.record(vehicle)
            if flying and "mission" in parts and report.parts["mission"].outcome in ("accepted", "different"):
                with contextlib.suppress(mavlink_errors.MavlinkError):
                    report.replaced = await replaced(
                        vehicle.client, brief.mission, brief.plan, report.plan_vehicle, report.choice.payload
                    )
            if report.outcome == "accepted":
                report.preflight = await _preflight_behind(vehicle, brief, report)
        return report

    async def plan_text(self, plan_id: str) -> str:
        """The text of a plan; raises where there is none."""
        return await self._plans.plan_text(plan_id)

    async def download(self, vehicle: Vehicle, parts: Sequence[PartName]) -> dict[str, list[dict[str, Any]]]:
        """What a vehicle holds, part by part."""
        async with vehicle.turns.busy("download"):
            try:
                return {
                    name: [item_json(item) for item in await vehicle.client.download(PARTS[name])]
                    for name in parts
                }
            except mavlink_errors.TransferFailedError as error:
                raise LinkError(f"{vehicle.name}: {error}") from error

    async def clear(
        self, vehicle: Vehicle, parts: Sequence[PartName], in_flight: bool = False
    ) -> dict[str, Outcome]:
        """Empty a vehicle's lists.

        Parameters
        ----------
        in_flight
            Also of one that flies, which is left without a mission to land by, or a fence.

        Raises
        ------
        UnsafeError
            It flies, and nobody said that it may: rule ``in-flight``.
        ConflictError
            The vehicle refused; which part, and what was cleared, in words.
        """
        if not in_flight and is_flying(vehicle.state):
            message = (
                f"{vehicle.name} is in flight: cleared, it has nothing left to fly, land or be kept in by"
            )
            fix = "land it first; or say in_flight=true to clear it all the same"
            raise UnsafeError(message, (Finding("vehicle", "in-flight", message, fix),))
        async with vehicle.turns.busy("clearing", changes=True):
            outcomes: dict[str, Outcome] = {}
            entry = await self._audit.begin("clear", vehicle.id, vehicle.name, {"parts": list(parts)})
            try:
                for name in parts:
                    outcomes[name] = await vehicle.client.clear(PARTS[name])
                    if name == "mission":
                        vehicle.holds_unknown()
                        vehicle.aboard.meant = None
                        if outcomes[name].kind == "accepted":
                            vehicle.sent = None
                        await self._cleared(vehicle)
            finally:
                kinds = {outcomes[name].kind if name in outcomes else "unknown" for name in parts}
                worst = next(kind for kind in ("unknown", "refused", "accepted") if kind in kinds)
                words = "; ".join(f"{name}: {outcome}" for name, outcome in outcomes.items())
                self._audit.end(entry, worst, words)
            if worst == "refused":
                raise ConflictError(f"{vehicle.name}: {words}")
            return outcomes

    async def _cleared(self, vehicle: Vehicle) -> None:
        try:
            await self._kept.hold(vehicle.id, None)
            if vehicle.sent is None:
                await self._kept.send(vehicle.id, None)
        except StorageError as error:
            # After a restart the vehicle is read back, and found to hold another mission.
            log.error("clearing not kept", vehicle=vehicle.name, reason=str(error))

    async def record(self, vehicle: Vehicle) -> None:
        """Note what became of an upload, also once an unknown outcome has been resolved."""
        report = vehicle.upload
        assert report is not None
        mission = report.parts.get("mission")
        held = report.choice.held(report.plan_id, report.plan_vehicle)
        if mission is not None:
            meant = report.mission.items_of(PARTS["mission"])
            if mission.differences is not None:
                # Read back, and something else: whoever orders a flight is told what differs.
                vehicle.aboard.meant = Meant(held, tuple(meant), comparing(report.mission.dialect))
            if mission.verified:
                await vehicle.hold(held, meant)
            vehicle.found(None if mission.differences is None else not mission.differences)
            vehicle.sent = SentMission(report.plan_id, vehicle.sent_id if mission.verified else None)
        outcome = "unknown" if report.outcome == "not_attempted" else report.outcome
        UPLOADS.labels(outcome=outcome).inc()
        for entry in report.entries:
            self._audit.end(entry, outcome, "; ".join(part.reason for part in report.parts.values()))
        try:
            if mission is not None:
                await self._kept.send(vehicle.id, vehicle.sent)
                await self._kept.hold(vehicle.id, held if mission.verified else None)
            await self._uploads.end(report.number, outcome, report_json(report))
        except StorageError as error:
            # The vehicle holds what it holds: that is told, and the next start reads it back.
            log.error("outcome of an upload not kept", vehicle=vehicle.name, reason=str(error))
            report.notes += (f"this outcome could not be recorded: {error}",)
        log.info("upload ended", vehicle=vehicle.name, plan_id=report.plan_id, outcome=outcome)
        vehicle.tell()

    async def still_holds(self, vehicle: Vehicle, held: HeldMission) -> bool | None:
        """Read back whether a vehicle holds the plan it held before, and take it that it does if so.

        An upload that a crash left without an outcome gets it first. None when the plan is deleted: nobody
        can tell.
        """
        if vehicle.id in self.left:
            report = await self.left.read_back(vehicle)
            if report is not None:
                vehicle.upload = report
                await self.record(vehicle)
            if report is None or "mission" in report.parts:
                return None if report is None else report.parts["mission"].verified
        try:
            choice = for_vehicle(vehicle, MissionChoice.of_held(held))
            plan_text = await self._plans.plan_text(held.plan_id)
            scenario_text = await self._plans.scenario_text(held.plan_id)
            brief = await self._plans.worked(brief_of, plan_text, scenario_text, choice)
        except (NotFoundError, ConflictError):
            return None
        mission = brief.mission
        meant = mission.items_of(PARTS["mission"])
        vehicle.aboard.meant = Meant(held, tuple(meant), comparing(mission.dialect))
        found = await vehicle.client.download(PARTS["mission"])
        same = not comparing(mission.dialect)(meant, found)
        if same:
            vehicle.client.recognise(PARTS["mission"])
            await vehicle.hold(held, meant)
        else:
            await self._kept.hold(vehicle.id, None)
        return same

    async def identified(self, vehicle: Vehicle) -> None:
        """Note which system a vehicle is."""
        try:
            await self._kept.identify(vehicle.id, vehicle.system_id)
        except StorageError as error:
            log.error("system id not kept", vehicle=vehicle.name, reason=str(error))

    async def acknowledge(self, vehicle: Vehicle, system_id: int) -> None:
        """Take the aircraft that answers in a vehicle's place for the vehicle; nothing is known of it yet.

        Raises
        ------
        ConflictError
            No such system answers there, or it is a recording.
        BusyError
            Another operation is at work on the vehicle.
        LinkError
            There is no link.
        """
        async with vehicle.turns.busy("acknowledging another aircraft", changes=True):
            if vehicle.state.connected or vehicle.state.other_system != system_id:
                raise ConflictError(f"no system {system_id} answers in the place of {vehicle.name}")
            before = vehicle.system_id
            async with self._acknowledged(vehicle, {"system_id": system_id, "before": before}):
                await self._kept.hold(vehicle.id, None)
                await self._kept.send(vehicle.id, None)
                await vehicle.begin_anew()
                vehicle.client.adopt(system_id)
                vehicle.system_id = system_id
                await self.identified(vehicle)
            log.warning("another aircraft", vehicle=vehicle.name, before=before, system_id=system_id)
            with contextlib.suppress(TimeoutError):
                await vehicle.client.wait_for(lambda state: state.connected, HEARD_S)

    @contextlib.asynccontextmanager
    async def _acknowledged(self, vehicle: Vehicle, what: dict[str, Any]) -> AsyncIterator[None]:
        """An acknowledgement, in the audit before it is made."""
        entry = await self._audit.begin("acknowledgement", vehicle.id, vehicle.name, what)
        try:
            yield
        except BaseException as error:
            self._audit.end(entry, "refused", str(error) or type(error).__name__)
            raise
        self._audit.end(entry, "accepted")

    async def acknowledge_address(self, vehicle: Vehicle, address: str) -> None:
        """Take an address heard on a vehicle's port for the vehicle's.

        Raises
        ------
        ConflictError
            Nobody was heard from there lately, or it is a recording.
        BusyError
            Another operation is at work on the vehicle.
        """
        async with vehicle.turns.busy("acknowledging an address", changes=True):
            before = vehicle.state.address
            if address != before and address not in vehicle.state.strangers:
                raise ConflictError(f"{vehicle.name}: nobody is heard from {address}")
            async with self._acknowledged(vehicle, {"address": address, "before": before}):
                if address != before:
                    await self._kept.hold(vehicle.id, None)
                    await self._kept.send(vehicle.id, None)
                    await vehicle.begin_anew()
                vehicle.client.acknowledge(address)
            log.warning("address acknowledged", vehicle=vehicle.name, before=before, address=address)
            vehicle.tell()

    async def _begin(
        self,
        vehicle: Vehicle,
        plan_id: str,
        mission: Mission,
        parts: Sequence[PartName],
        override: str | None,
        findings: tuple[Finding, ...],
        choice: MissionChoice,
    ) -> UploadReport:
        meant = choice.held(plan_id, mission.vehicle)
        what: dict[str, Any] = {"plan_id": plan_id, "parts": list(parts), "plan_vehicle": mission.vehicle}
        what |= {"payload": choice.payload, "gimbal": choice.gimbal}
        what |= {"arcs": choice.arcs, "chord_error_m": choice.chord_error_m}
        entries = [await self._audit.begin("upload", vehicle.id, vehicle.name, what)]
        try:
            if override is not None:
                rules = [finding.rule for finding in findings]
                what = {"plan_id": plan_id, "reason": override, "rules": rules}
                entries.append(await self._audit.begin("override", vehicle.id, vehicle.name, what))
            number = await self._uploads.begin(vehicle.id, vehicle.name, plan_id, parts, override, meant)
        except BaseException:
            for entry in entries:
                self._audit.end(entry, "refused", "not sent: it could not be recorded")
            raise
        if override is not None:
            log.warning(
                "upload overrides", vehicle=vehicle.name, plan_id=plan_id, reason=override, rules=rules
            )
        report = new_report(number, plan_id, mission, parts, override, findings)
        report.choice, report.entries = choice, tuple(entries)
        vehicle.upload = report
        return report


def _pointed(brief: Brief) -> tuple[Finding, ...]:
    """What is worth knowing of the gimbal; RefusedError where the sensor would look elsewhere."""
    found = pointing_findings(brief.plan, brief.scenario, brief.mission, brief.needs)
    errors = tuple(finding for finding in found if finding.severity == "error")
    if errors:
        raise RefusedError(f"the gimbal would point elsewhere: {errors[0].message}", errors)
    return found


async def _bring_home(vehicle: Vehicle, plan: Plan) -> None:
    """A simulated aircraft that stands elsewhere, and was not told where, goes where the plan begins."""
    if vehicle.simulated is None or vehicle.simulated.home is not None or is_flying(vehicle.state):
        return
    state = vehicle.state
    place = (state.lon_deg or 0.0, state.lat_deg or 0.0)
    if distance_m(place, plan.home) < AT_HOME_M:
        return
    lon_deg, lat_deg = plan.home
    log.info("simulated aircraft moves to the plan's start", vehicle=vehicle.name)
    await vehicle.move((lat_deg, lon_deg, 0.0), CONNECT_S)


async def _preflight_behind(vehicle: Vehicle, brief: Brief, report: UploadReport) -> Preflight | None:
    """The check behind an upload; None when the vehicle vanished, which leaves the upload as it is."""
    try:
        return await inspect(vehicle.client, report.plan_id, brief, report)
    except (mavlink_errors.NotConnectedError, mavlink_errors.BusyError, LinkError):
        log.warning("no pre-flight check behind the upload", vehicle=vehicle.name)
        return None
