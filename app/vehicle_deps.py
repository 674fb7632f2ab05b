"""What routes of vehicles ask for, by name: of the service, or of the process that holds its links."""

from __future__ import annotations

from typing import Annotated, Protocol, cast

from fastapi import Depends, Request

from app.services.links.house import LinksHouse
from app.services.vehicles.checks import Checks
from app.services.vehicles.fleet import Fleet
from app.services.vehicles.permits import Permits
from app.services.vehicles.station import Station
from app.services.vehicles.transfers import Transfers
from app.settings import Settings


class WithStation(Protocol):
    """Services with vehicles among them."""

    @property
    def station(self) -> Station:
        """All that talks to vehicles."""


async def _house(request: Request) -> WithStation:
    return cast(WithStation, request.app.state.house)


async def _links_house(request: Request) -> LinksHouse:
    return cast(LinksHouse, request.app.state.house)


async def _fleet(house: Annotated[WithStation, Depends(_house)]) -> Fleet:
    return house.station.fleet


async def _transfers(house: Annotated[WithStation, Depends(_house)]) -> Transfers:
    return house.station.transfers


async def _checks(house: Annotated[WithStation, Depends(_house)]) -> Checks:
    return house.station.checks


async def _settings(request: Request) -> Settings:
    return cast(Settings, request.app.state.settings)


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


LinksHouseDep = Annotated[LinksHouse, Depends(_links_house)]
FleetDep = Annotated[Fleet, Depends(_fleet)]
TransfersDep = Annotated[Transfers, Depends(_transfers)]
ChecksDep = Annotated[Checks, Depends(_checks)]
PermitsDep = Annotated[Permits, Depends(_permits)]
