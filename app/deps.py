"""What routes ask for, by name."""

from __future__ import annotations

from typing import Annotated, cast

from fastapi import Depends, Request

from app.services.desk import Desk
from app.services.flights.service import FlightService
from app.services.house import House, Whereabouts
from app.services.links.house import LinksHouse
from app.services.plans.planning import PlanningService
from app.services.scenarios.kept import ScenarioService
from app.services.store.audit import AuditStore
from app.services.terrain.service import TerrainService
from app.services.vehicles.checks import Checks
from app.services.vehicles.fleet import Fleet
from app.services.vehicles.permits import Permits
from app.services.vehicles.transfers import Transfers
from app.settings import Settings


async def _house(request: Request) -> House:
    return cast(House, request.app.state.house)


async def _settings(request: Request) -> Settings:
    return cast(Settings, request.app.state.settings)


async def _planning(house: Annotated[House, Depends(_house)]) -> PlanningService:
    return house.planning


async def _scenarios(house: Annotated[House, Depends(_house)]) -> ScenarioService:
    return house.scenarios


async def _links_house(request: Request) -> LinksHouse:
    return cast(LinksHouse, request.app.state.house)


async def _whereabouts(house: Annotated[House, Depends(_house)]) -> Whereabouts:
    return house.whereabouts


async def _fleet(house: Annotated[House | LinksHouse, Depends(_house)]) -> Fleet:
    return house.station.fleet


async def _transfers(house: Annotated[House | LinksHouse, Depends(_house)]) -> Transfers:
    return house.station.transfers


async def _checks(house: Annotated[House | LinksHouse, Depends(_house)]) -> Checks:
    return house.station.checks


async def _flights(house: Annotated[House, Depends(_house)]) -> FlightService:
    return house.flights


async def _audit(house: Annotated[House, Depends(_house)]) -> AuditStore:
    return house.audit


def _terrain(house: Annotated[House, Depends(_house)]) -> TerrainService:
    return house.terrain


async def _desk(house: Annotated[House, Depends(_house)]) -> Desk:
    return house.desk


HouseDep = Annotated[House, Depends(_house)]
SettingsDep = Annotated[Settings, Depends(_settings)]


def permits_of(settings: Settings) -> Permits:
    """Which links requests may open."""
    folders = settings.replay_folders
    if folders:
        # Its own recordings are always there to be watched.
        folders += (settings.log_dir or settings.database.parent / "logs",)
    return Permits(
        settings.link_kinds,
        settings.link_hosts,
        settings.serial_ports,
        folders,
        settings.allow_remote,
    )


async def _permits(settings: Annotated[Settings, Depends(_settings)]) -> Permits:
    return permits_of(settings)


DeskDep = Annotated[Desk, Depends(_desk)]
PlanningDep = Annotated[PlanningService, Depends(_planning)]
ScenariosDep = Annotated[ScenarioService, Depends(_scenarios)]
LinksHouseDep = Annotated[LinksHouse, Depends(_links_house)]
WhereaboutsDep = Annotated[Whereabouts, Depends(_whereabouts)]
FleetDep = Annotated[Fleet, Depends(_fleet)]
PermitsDep = Annotated[Permits, Depends(_permits)]
TransfersDep = Annotated[Transfers, Depends(_transfers)]
ChecksDep = Annotated[Checks, Depends(_checks)]
AuditDep = Annotated[AuditStore, Depends(_audit)]
FlightsDep = Annotated[FlightService, Depends(_flights)]
TerrainDep = Annotated[TerrainService, Depends(_terrain)]
