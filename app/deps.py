"""What routes ask for, by name."""

from __future__ import annotations

from typing import Annotated, cast

from fastapi import Depends, Request

from app.services.desk import Desk
from app.services.flights.service import FlightService
from app.services.house import House, Whereabouts
from app.services.plans.filing import Filing
from app.services.plans.planning import PlanningService
from app.services.scenarios.kept import ScenarioService
from app.services.store.audit import AuditStore
from app.services.terrain.service import TerrainService
from app.settings import Settings


async def _house(request: Request) -> House:
    return cast(House, request.app.state.house)


async def _settings(request: Request) -> Settings:
    return cast(Settings, request.app.state.settings)


async def _planning(house: Annotated[House, Depends(_house)]) -> PlanningService:
    return house.planning


async def _filing(house: Annotated[House, Depends(_house)]) -> Filing:
    return house.filing


async def _scenarios(house: Annotated[House, Depends(_house)]) -> ScenarioService:
    return house.scenarios


async def _whereabouts(house: Annotated[House, Depends(_house)]) -> Whereabouts:
    return house.whereabouts


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
DeskDep = Annotated[Desk, Depends(_desk)]
PlanningDep = Annotated[PlanningService, Depends(_planning)]
FilingDep = Annotated[Filing, Depends(_filing)]
ScenariosDep = Annotated[ScenarioService, Depends(_scenarios)]
WhereaboutsDep = Annotated[Whereabouts, Depends(_whereabouts)]
AuditDep = Annotated[AuditStore, Depends(_audit)]
FlightsDep = Annotated[FlightService, Depends(_flights)]
TerrainDep = Annotated[TerrainService, Depends(_terrain)]
