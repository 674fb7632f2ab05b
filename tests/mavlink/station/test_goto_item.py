"""Sending an aircraft in flight to any item of its mission, on both simulated autopilots."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from mavlink.links.link import memory_pair
from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve_link
from mavlink.sim.settings import SimSettings
from mavlink.station.client import VehicleClient
from mavlink.transfer.machine import DEFAULT_SETTINGS
from mavlink.transfer.outcome import Accepted, Unknown
from mavlink.wire.items import Command, Frame, MissionItem, MissionType
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time

HASTY = replace(DEFAULT_SETTINGS, timeout_s=0.2, retries=1)
SPEED, WAYPOINT = 3, 4


def mission(flavour: Flavour) -> tuple[MissionItem, ...]:
    """Take-off, way, a change of speed, a far waypoint and a landing; ArduPilot's begins with home."""
    home = SimSettings().home
    x, y = round(home.lat_deg * 1e7), round(home.lon_deg * 1e7)

    def at(seq: int, command: int, north: int) -> MissionItem:
        frame = Frame.GLOBAL_RELATIVE_ALT
        return MissionItem(seq, frame, command, 0.0, 0.0, 0.0, 0.0, x + north * 100_000, y, 80.0)

    home_row = replace(at(0, 16, 0), frame=Frame.GLOBAL)
    first = home_row if flavour is Flavour.ARDUPILOT else at(0, Command.NAV_TAKEOFF, 1)
    speed = MissionItem(SPEED, Frame.MISSION, Command.DO_CHANGE_SPEED, 0.0, 20.0, -1.0, 0.0, 0, 0, 0.0)
    second = Command.NAV_TAKEOFF if flavour is Flavour.ARDUPILOT else Command.NAV_WAYPOINT
    return (first, at(1, second, 2), at(2, 16, 20), speed, at(4, 16, 40), at(5, Command.NAV_LAND, 60))


@asynccontextmanager
async def in_flight(flavour: Flavour) -> AsyncIterator[VehicleClient]:
    """A client of an aircraft that flies the mission, which it was sent but not asked for."""
    ground, air = memory_pair()
    simulator = asyncio.create_task(serve_link(air, SimSettings(autopilot=flavour, speedup=20.0)))
    try:
        async with VehicleClient(ground, settings=HASTY, clock=loop_time_s) as client:
            await client.connect(5.0)
            assert await client.upload(mission(flavour), MissionType.MISSION) == Accepted()
            assert (await client.arm()).accepted
            assert (await client.start_mission()).accepted
            await client.wait_for(lambda state: (state.relative_altitude_m or 0.0) > 20.0, PATIENCE_S)
            yield client
    finally:
        simulator.cancel()
        await asyncio.gather(simulator, return_exceptions=True)


@pytest.mark.parametrize("flavour", list(Flavour))
@pytest.mark.parametrize("known", [True, False], ids=["mission read", "mission not read"])
async def test_an_item_that_is_no_place_is_answered_by_the_next(flavour: Flavour, known: bool) -> None:
    """Sent to a change of speed, the aircraft flies to the waypoint behind it: accepted, not unknown."""
    async with in_flight(flavour) as client:
        if known:
            assert len(await client.download(MissionType.MISSION)) == len(mission(flavour))
        assert await client.goto_item(SPEED) == Accepted()
        assert client.state.mission_current == WAYPOINT


async def test_an_item_past_the_end_stays_unknown() -> None:
    """The aircraft says nothing to a number it has not, and so does the client say that it knows nothing."""
    async with in_flight(Flavour.ARDUPILOT) as client:
        assert await client.goto_item(77) == Unknown("timeout")
