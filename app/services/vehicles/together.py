"""All vehicles of a plan sent their missions at once, with one verdict."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from app.services.errors import LinkError, RefusedError, ServiceError
from app.services.plans.missions import MissionChoice, PartName, plan_of
from app.services.vehicles.fleet import Fleet
from app.services.vehicles.transfers import Transfers
from app.services.vehicles.uploads import UploadReport
from planner.errors import Finding


@dataclass(frozen=True, slots=True)
class Told:
    """What became of one vehicle of the plan: its report, or why there is none."""

    vehicle_id: str
    report: UploadReport | None
    failure: ServiceError | None = None

    @property
    def outcome(self) -> str:
        """As of one upload; what was refused before it was sent is refused."""
        return "refused" if self.report is None else self.report.outcome


@dataclass(frozen=True, slots=True)
class FleetReport:
    """What became of all vehicles of a plan, by their names in it."""

    plan_id: str
    vehicles: Mapping[str, Told]

    @property
    def outcome(self) -> str:
        """The worst of all: what nobody can tell first, then what was refused, then what differs."""
        found = {told.outcome for told in self.vehicles.values()}
        for outcome in ("unknown", "refused", "not_attempted", "different"):
            if outcome in found:
                return outcome
        return "accepted"

    @property
    def failings(self) -> tuple[Finding, ...]:
        """Vehicles that do not hold what was meant, and why, by their names in the plan."""
        found: list[Finding] = []
        for name, told in self.vehicles.items():
            if told.report is not None:
                found += [replace(each, feature=f"{name}: {each.feature}") for each in told.report.failings]
            elif isinstance(told.failure, RefusedError):
                found += [replace(each, feature=f"{name}: {each.feature}") for each in told.failure.findings]
            else:
                found.append(Finding(name, "not-sent", str(told.failure), "mend that and upload again"))
        return tuple(found)

    @property
    def verified(self) -> bool:
        """Whether every vehicle was read back and holds what was meant."""
        return all(told.report is not None and told.report.verified for told in self.vehicles.values())


async def upload_all(
    fleet: Fleet,
    transfers: Transfers,
    plan_text: str,
    plan_id: str,
    vehicles: Mapping[str, str],
    sorties: Mapping[str, int],
    parts: Sequence[PartName],
    choice: MissionChoice,
    override: str | None,
) -> FleetReport:
    """Send every vehicle of a plan its mission, all at once.

    Parameters
    ----------
    vehicles
        Ids of connected vehicles by the names of the plan's.
    sorties
        Which flight of a vehicle; the first where nothing is said.

    Raises
    ------
    RefusedError
        Where not every vehicle of the plan has one that is its own; nothing is sent then.
    NotFoundError
        Where there is no such vehicle.
    LinkError
        Where one is not heard: nothing is sent to any.
    """
    names = [vehicle.name for vehicle in plan_of(plan_text).vehicles]
    _check(names, vehicles, sorties)
    connected = {name: fleet.get(vehicles[name]) for name in names}
    silent = [vehicle for vehicle in connected.values() if not vehicle.state.connected]
    if silent:
        absences = "; ".join(f"{vehicle.name}: {vehicle.client.absence}" for vehicle in silent)
        raise LinkError(f"nothing is sent to any vehicle of the plan: {absences}")

    async def one(name: str) -> Told:
        own = replace(choice, vehicle=name, sortie=sorties.get(name, 1))
        try:
            report = await transfers.upload(connected[name], plan_id, parts, own, override)
        except ServiceError as error:
            return Told(vehicles[name], None, error)
        return Told(vehicles[name], report)

    told = await asyncio.gather(*(one(name) for name in names))
    return FleetReport(plan_id, dict(zip(names, told, strict=True)))


def _check(names: Sequence[str], vehicles: Mapping[str, str], sorties: Mapping[str, int]) -> None:
    found: list[Finding] = []
    for name in names:
        if name not in vehicles:
            said = "is a vehicle of the plan, and none is named for it"
            found.append(Finding(name, "vehicle-missing", said, "Name a connected vehicle for it."))
    for name in {*vehicles, *sorties} - set(names):
        known = f"Use: {', '.join(names)}."
        found.append(Finding(name, "unknown-vehicle", "is no vehicle of the plan", known))
    ids = list(vehicles.values())
    for name, vehicle_id in vehicles.items():
        if ids.count(vehicle_id) > 1:
            said = f"is to be flown by {vehicle_id}, and so is another vehicle of the plan"
            found.append(Finding(name, "vehicle-twice", said, "Name each its own."))
    if found:
        raise RefusedError("not every vehicle of the plan has one that is its own", tuple(found))
