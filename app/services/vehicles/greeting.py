"""Vehicles that a fresh service connects by itself."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count

import structlog

from app.services.errors import ServiceError
from app.services.vehicles.fleet import Fleet

log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True)
class Wishes:
    """Vehicles to connect at the start.

    Parameters
    ----------
    vehicle
        Address of a vehicle to connect unless it is known already; kept for the next start.
    forward
        Where to forward its link to, or else that of the simulated aircraft: addresses, and whether stations
        there may command.
    """

    simulated: int = 0
    sim_url: str = "sim:"
    vehicle: str | None = None
    forward: tuple[tuple[str, bool], ...] = ()


async def greet(fleet: Fleet, wishes: Wishes) -> None:
    """Connect what is wished for and not there yet; what cannot be is logged."""
    try:
        forward = wishes.forward
        if wishes.vehicle is not None:
            await _connect(fleet, wishes.vehicle, forward)
            forward = ()
        there = {vehicle.name for vehicle in fleet.all() if vehicle.simulated is not None}
        for name in (f"sim-{number}" for number in range(1, wishes.simulated + 1)):
            if name not in there:
                await fleet.connect(name, wishes.sim_url, keep=False, forward=forward)
    except ServiceError as error:
        log.error("start-up wish not fulfilled", reason=str(error))


async def _connect(fleet: Fleet, url: str, forward: tuple[tuple[str, bool], ...]) -> None:
    """Connect a vehicle; one known from before is only forwarded, where that is wished for."""
    known = {vehicle.url: vehicle for vehicle in fleet.all()}
    if url in known:
        if forward:
            await fleet.forward(known[url].id, forward)
        return
    names = {vehicle.name for vehicle in known.values()}
    name = next(name for number in count(1) if (name := f"uav-{number}") not in names)
    await fleet.connect(name, url, forward=forward)
