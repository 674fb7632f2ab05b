"""What routes ask for, by name."""

from __future__ import annotations

from typing import Annotated, cast

from fastapi import Depends, Request

from app.services.house import House
from app.services.planning import PlanningService
from app.settings import Settings


def _house(request: Request) -> House:
    return cast(House, request.app.state.house)


def _settings(request: Request) -> Settings:
    return cast(Settings, request.app.state.settings)


def _planning(house: Annotated[House, Depends(_house)]) -> PlanningService:
    return house.planning


HouseDep = Annotated[House, Depends(_house)]
SettingsDep = Annotated[Settings, Depends(_settings)]
PlanningDep = Annotated[PlanningService, Depends(_planning)]
