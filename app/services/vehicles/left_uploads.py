"""Uploads that a crash left without an outcome: resolved by reading back, once their vehicle is heard."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import cast

import structlog

from app.services.errors import ConflictError, NotFoundError, RefusedError
from app.services.plans.library import PlanLibrary
from app.services.plans.missions import MissionChoice, PartName
from app.services.records import HeldMission, LeftUpload, VehicleRecord
from app.services.store.uploads import UploadStore
from app.services.vehicles.brief import brief_of
from app.services.vehicles.checks import for_vehicle
from app.services.vehicles.uploads import UploadReport, new_report, read_back
from app.services.vehicles.vehicle import Vehicle

log = structlog.get_logger(__name__)

_ENDED = "the service ended before it was settled"


class LeftUploads:
    """At most one for each vehicle: what an earlier one has put there, the latest has replaced."""

    def __init__(self, uploads: UploadStore, plans: PlanLibrary) -> None:
        self._uploads = uploads
        self._plans = plans
        self._left: dict[str, LeftUpload] = {}

    def __contains__(self, vehicle_id: str) -> bool:
        return vehicle_id in self._left

    async def open(self, vehicles: Iterable[VehicleRecord]) -> None:
        """Look for them; of those that nobody can ask about any more nobody can tell."""
        known = {vehicle.id for vehicle in vehicles if not vehicle.url.startswith("sim:")}
        for left in await self._uploads.pending():
            if left.vehicle_id not in known:
                await self._close(left, f"{_ENDED}, and the vehicle is not known any more")
                continue
            if (earlier := self._left.get(left.vehicle_id)) is not None:
                await self._close(earlier, f"{_ENDED}, and a later upload followed")
            self._left[left.vehicle_id] = left

    def believed(self, record: VehicleRecord) -> HeldMission | None:
        """What a vehicle is to be asked about first."""
        left = self._left.get(record.id)
        if left is None or ("mission" not in left.parts and record.held is not None):
            return record.held
        return left.meant

    async def read_back(self, vehicle: Vehicle) -> UploadReport | None:
        """The report on the one left for a vehicle, its parts as they are found; None where nobody can tell.

        Raises
        ------
        LinkError
            The vehicle does not answer; it may be asked again.
        """
        left = self._left[vehicle.id]
        meant = left.meant
        choice = MissionChoice.of_held(meant)
        try:
            plan_text = await self._plans.plan_text(meant.plan_id)
            scenario_text = await self._plans.scenario_text(meant.plan_id)
            brief = await self._plans.worked(brief_of, plan_text, scenario_text, for_vehicle(vehicle, choice))
        except (NotFoundError, ConflictError, RefusedError) as error:
            await self._close(left, f"{_ENDED}: {error}")
            return None
        parts = cast(Sequence[PartName], left.parts)
        report = new_report(left.number, meant.plan_id, brief.mission, parts, left.override_reason, ())
        report.choice = choice
        for part in report.parts.values():
            part.outcome, part.reason = "unknown", _ENDED
        await read_back(vehicle.client, report)
        del self._left[vehicle.id]
        log.info("upload left by a crash resolved", vehicle=vehicle.name, outcome=report.outcome)
        return report

    async def _close(self, left: LeftUpload, reason: str) -> None:
        self._left.pop(left.vehicle_id, None)
        await self._uploads.end(left.number, "unknown", {"reason": reason})
        log.warning("upload left by a crash", vehicle=left.vehicle_id, number=left.number, reason=reason)
