"""MAVSDK as the second ground station, behind a forward: it watches, reads, commands, or may not."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable

import pytest

from mavlink.links.link import memory_pair
from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve_link
from mavlink.sim.settings import SimSettings
from mavlink.sim.storage import as_stored
from mavlink.station.client import VehicleClient
from mavlink.station.forward.address import parse_forward
from mavlink.station.forward.hub import Forwards
from mavlink.station.forward.outlet import Outlet
from mavlink.wire.items import Command, MissionType
from tests.mavlink.sim.helpers import HOME, item, landing_mission, numbered, place_at, waypoint
from tests.mavlink.sim.test_mavsdk import fields

pytest.importorskip("mavsdk")
from mavsdk.asyncio.mavsdk import Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.asyncio.system import System
from mavsdk.plugins.action import ActionError

from tests.patience import PATIENCE_S

pytestmark = pytest.mark.mavsdk


async def until(condition: Callable[[], Awaitable[bool]]) -> None:
    """Wait for something MAVSDK or the aircraft says."""
    async with asyncio.timeout(PATIENCE_S):
        while not await condition():
            await asyncio.sleep(0.02)


@contextlib.asynccontextmanager
async def second_station(outlet: Outlet) -> AsyncIterator[System]:
    """MAVSDK, calling the port a forward listens on, as a station that says by itself that it is there."""
    # create_with_component_type is silent until it hears a vehicle, and who is called waits to be called.
    async with Mavsdk(Configuration.create_manual(245, 190, True)) as station:
        await station.add_any_connection(f"udpout://{outlet.url.removeprefix('udpin:')}")
        system = await station.first_autopilot(timeout_s=PATIENCE_S)
        assert system is not None
        yield system


@contextlib.asynccontextmanager
async def forwarded(flavour: Flavour, write: bool) -> AsyncIterator[tuple[VehicleClient, Forwards]]:
    """A client of a simulated aircraft in memory, forwarded to a free port."""
    ground, air = memory_pair()
    stop = asyncio.Event()
    settings = SimSettings(home=HOME, autopilot=flavour, speedup=60.0)
    flight = asyncio.create_task(serve_link(air, settings, stop=stop))
    forwards = Forwards()
    try:
        await forwards.set([parse_forward("udpin:0", write=write)])
        async with VehicleClient(ground, forwards=forwards) as client:
            await client.connect(30)
            yield client, forwards
    finally:
        stop.set()
        await flight
        await forwards.close()


@pytest.mark.parametrize("flavour", list(Flavour))
async def test_mavsdk_reads_and_flies(flavour: Flavour) -> None:
    """Through a read-write forward it reads the mission we uploaded, arms, flies, holds and returns."""
    takeoff = item(Command.NAV_TAKEOFF, place_at(0.0, 600.0, HOME.altitude_m + 50.0))
    body = [waypoint(0.0, 1000.0), waypoint(0.0, 60_000.0)]
    mission = numbered(landing_mission(body, home_row=flavour is Flavour.ARDUPILOT))
    mission = [takeoff if each.command == takeoff.command else each for each in mission]
    meant = tuple(as_stored(flavour, each, HOME) for each in numbered(mission))
    async with forwarded(flavour, write=True) as (client, forwards):
        verified = await client.upload_verified(meant, MissionType.MISSION, lambda *_: ())
        assert verified.held is not None
        (outlet,) = forwards.outlets
        async with second_station(outlet) as system:
            action, raw, telemetry = ActionAsync(system), MissionRawAsync(system), TelemetryAsync(system)
            held = await raw.download_mission()
            assert [fields(each) for each in held] == [fields(each) for each in verified.held]

            async def at_the_lists_no_more() -> bool:
                return forwards.exchanging is None

            await until(at_the_lists_no_more)

            async def heard_position() -> bool:
                return bool(
                    (await telemetry.position()).latitude_deg == pytest.approx(HOME.lat_deg, abs=1e-5)
                )

            await until(heard_position)
            await action.arm()
            await client.wait_for(lambda state: state.armed, PATIENCE_S)
            await raw.start_mission()

            async def under_way() -> bool:
                progress = await raw.mission_progress()
                return bool(await telemetry.in_air() and progress.total and progress.current >= 2)

            await until(under_way)
            assert client.state.mode in ("AUTO", "AUTO.MISSION")
            assert (await telemetry.flight_mode()).name == "MISSION"
            await action.hold()
            await client.wait_for(lambda state: state.mode in ("LOITER", "AUTO.LOITER"), PATIENCE_S)
            await action.return_to_launch()
            await client.wait_for(lambda state: state.mode in ("RTL", "AUTO.RTL"), PATIENCE_S)
            assert outlet.stations == [245]


async def test_mavsdk_on_a_read_only_forward_cannot_command() -> None:
    """Its orders are answered by nobody, the aircraft stays as it is, and telemetry goes on."""
    async with forwarded(Flavour.PX4, write=False) as (client, forwards):
        (outlet,) = forwards.outlets
        async with second_station(outlet) as system:
            telemetry = TelemetryAsync(system)
            with pytest.raises(ActionError):
                await ActionAsync(system).arm()
            assert (outlet.figures.refused > 0, outlet.figures.passed) == (True, 0)
            assert not client.state.armed

            async def heard_position() -> bool:
                return bool(
                    (await telemetry.position()).latitude_deg == pytest.approx(HOME.lat_deg, abs=1e-5)
                )

            await until(heard_position)
            assert not await telemetry.armed()
