"""What the service asks of the process that holds the links; nobody else reaches these."""

from __future__ import annotations

import asyncio
import os
import time
from typing import Any

from fastapi import APIRouter, Depends, Request
from prometheus_client import generate_latest
from pydantic import BaseModel

from app.services.vehicles.greeting import Wishes, greet
from app.vehicle_deps import LinksHouseDep


async def _needed(house: LinksHouseDep) -> None:
    house.needed_s = time.monotonic()


router = APIRouter(prefix="/links", dependencies=[Depends(_needed)])


class WishesIn(BaseModel):
    """Vehicles to connect at the start."""

    simulated: int
    sim_url: str
    vehicle: str | None
    forward: tuple[tuple[str, bool], ...]


@router.get("")
async def state(house: LinksHouseDep) -> dict[str, Any]:
    """How the process stands."""
    fleet = house.fleet
    return {"pid": os.getpid(), "vehicles": len(fleet.all()), "in_use": list(fleet.in_use())}


@router.get("/flights/{flight_id}")
async def place_in_flight(flight_id: str, house: LinksHouseDep) -> dict[str, Any]:
    """Where the vehicle on a flight is."""
    return {"place": await house.fleet.place_in_flight(flight_id)}


@router.post("/greet")
async def greeting(body: WishesIn, house: LinksHouseDep) -> dict[str, Any]:
    """Connect what is wished for, which takes until it is heard and is not waited for."""
    wishes = Wishes(body.simulated, body.sim_url, body.vehicle, body.forward)
    house.begin(asyncio.create_task(greet(house.fleet, wishes)))
    return {}


@router.get("/metrics")
async def metrics() -> dict[str, Any]:
    """Figures for Prometheus."""
    return {"text": generate_latest().decode()}


@router.post("/end")
async def end(request: Request) -> dict[str, Any]:
    """End the process in good order."""
    request.app.state.end()
    return {}
