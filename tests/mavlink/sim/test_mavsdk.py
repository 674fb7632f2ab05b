"""MAVSDK as an independent ground station of the simulated aircraft."""

from __future__ import annotations

import asyncio
import socket
from dataclasses import replace

import pytest

from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve
from mavlink.sim.settings import SimSettings
from mavlink.sim.storage import as_stored
from mavlink.wire.items import Command, MissionItem
from tests.mavlink.sim.helpers import HOME, item, landing_mission, numbered, place_at, waypoint

pytest.importorskip("mavsdk")
from mavsdk.asyncio.mavsdk import Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.mission_raw import MissionItem as PeerItem
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.component_type import ComponentType

from tests.patience import PATIENCE_S

pytestmark = pytest.mark.mavsdk


def fields(each: MissionItem | PeerItem) -> tuple[float, ...]:
    parameters = (each.param1, each.param2, each.param3, each.param4)
    return (each.seq, each.frame, each.command, *parameters, each.x, each.y, each.z)


def peer_item(each: MissionItem) -> PeerItem:
    parameters = (each.param1, each.param2, each.param3, each.param4)
    return PeerItem(
        *(each.seq, each.frame, each.command, int(each.seq == 0), 1), *parameters, each.x, each.y, each.z, 0
    )


@pytest.mark.parametrize("flavour", list(Flavour))
async def test_mavsdk_uploads_reads_back_flies_and_watches(flavour: Flavour) -> None:
    """MAVSDK finds the aircraft, uploads, reads the same back, starts it and sees it climb away."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    takeoff = item(Command.NAV_TAKEOFF, place_at(0.0, 600.0, HOME.altitude_m + 50.0))
    body = [waypoint(0.0, 1000.0), waypoint(0.0, 2000.0)]
    sent = numbered(landing_mission(body, home_row=flavour is Flavour.ARDUPILOT))
    sent = [takeoff if each.command == takeoff.command else each for each in sent]
    sent = numbered([replace(each, z=float(round(each.z))) for each in sent])
    stop = asyncio.Event()
    station = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(station) as ground:
        await ground.add_any_connection(f"udpin://127.0.0.1:{port}")
        settings = SimSettings(home=HOME, autopilot=flavour, speedup=20.0)
        server = asyncio.create_task(serve(f"udpout:127.0.0.1:{port}", settings, stop=stop))
        system = await ground.first_autopilot(timeout_s=PATIENCE_S)
        assert system is not None
        raw, action, telemetry = MissionRawAsync(system), ActionAsync(system), TelemetryAsync(system)
        await raw.upload_mission([peer_item(each) for each in sent])
        held = await raw.download_mission()
        kept = [as_stored(flavour, each, HOME) for each in sent]
        assert [fields(each) for each in held] == [fields(each) for each in kept]
        await action.arm()
        await raw.start_mission()
        async with asyncio.timeout(PATIENCE_S):
            position = await telemetry.position()
            # NaN until the first position arrives.
            while not position.relative_altitude_m >= 40.0:
                await asyncio.sleep(0.1)
                position = await telemetry.position()
        assert position.latitude_deg > HOME.lat_deg + 0.0005
        assert position.longitude_deg == pytest.approx(HOME.lon_deg, abs=1e-4)
        await action.return_to_launch()
        stop.set()
        await asyncio.wait_for(server, PATIENCE_S)
