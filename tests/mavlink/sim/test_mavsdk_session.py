"""MAVSDK's plugins against the simulated aircraft: what an operator's program does in a session."""

from __future__ import annotations

import asyncio
import contextlib
import math
import socket
from collections.abc import AsyncIterator

import pytest

from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve
from mavlink.sim.settings import SimSettings
from tests.mavlink.sim.helpers import HOME

pytest.importorskip("mavsdk")
from mavsdk.asyncio.mavsdk import Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.camera import CameraAsync
from mavsdk.asyncio.plugins.geofence import GeofenceAsync
from mavsdk.asyncio.plugins.gimbal import GimbalAsync
from mavsdk.asyncio.plugins.mission import MissionAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.component_type import ComponentType
from mavsdk.plugins.geofence.geofence import Circle, FenceType, GeofenceData, Point, Polygon
from mavsdk.plugins.gimbal.gimbal import ControlMode, GimbalMode, SendMode
from mavsdk.plugins.mission.mission import MissionItem, MissionPlan
from mavsdk.system import System

from tests.patience import PATIENCE_S

pytestmark = pytest.mark.mavsdk

SPEEDUP = 10.0
RETURN_HEIGHT = {Flavour.PX4: "RTL_RETURN_ALT", Flavour.ARDUPILOT: "RTL_ALT"}


@contextlib.asynccontextmanager
async def session(flavour: Flavour, kind: str) -> AsyncIterator[System]:
    """MAVSDK as a ground station, and a simulated aircraft that calls it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    stop = asyncio.Event()
    station = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(station) as ground:
        await ground.add_any_connection(f"udpin://127.0.0.1:{port}")
        settings = SimSettings(home=HOME, autopilot=flavour, vehicle_type=kind, speedup=SPEEDUP)
        server = asyncio.create_task(serve(f"udpout:127.0.0.1:{port}", settings, stop=stop))
        try:
            system = await ground.first_autopilot(timeout_s=PATIENCE_S)
            assert system is not None
            yield system
        finally:
            stop.set()
            await asyncio.wait_for(server, PATIENCE_S)


async def height_m(telemetry: TelemetryAsync) -> float:
    return float((await telemetry.position()).relative_altitude_m)


@pytest.mark.parametrize("flavour", list(Flavour))
async def test_it_sets_parameters_takes_off_and_lands(flavour: Flavour) -> None:
    """A multirotor takes off by order to the height set, tells all that MAVSDK shows, and lands disarmed."""
    async with session(flavour, "multirotor") as system, asyncio.timeout(PATIENCE_S):
        action, telemetry, parameters = ActionAsync(system), TelemetryAsync(system), ParamAsync(system)
        await parameters.set_param_float(RETURN_HEIGHT[flavour], 77.0)
        assert await parameters.get_param_float(RETURN_HEIGHT[flavour]) == 77.0
        await action.set_takeoff_altitude(30.0)
        await action.arm()
        await action.takeoff()
        await telemetry.set_rate_attitude_quaternion(10.0)
        await telemetry.set_rate_altitude(2.0)
        await telemetry.set_rate_home(1.0)
        # NaN until the first arrives.
        while not abs((await telemetry.altitude()).altitude_amsl_m - (HOME.altitude_m + 30.0)) < 1.0:
            await asyncio.sleep(0.05)
        upright = await telemetry.attitude_quaternion()
        assert math.hypot(upright.w, upright.x, upright.y, upright.z) == pytest.approx(1.0, abs=1e-3)
        assert (await telemetry.home()).absolute_altitude_m == pytest.approx(HOME.altitude_m, abs=0.01)
        # A time of our days, in microseconds.
        assert await telemetry.unix_epoch_time() > 1.7e15
        assert await telemetry.in_air()
        await action.land()
        while await telemetry.armed():
            await asyncio.sleep(0.05)
        assert abs(await height_m(telemetry)) < 0.5


@pytest.mark.parametrize("kind", ["multirotor", "fixed_wing"])
async def test_it_uploads_its_own_missions_and_fences(kind: str) -> None:
    """PX4 takes a mission and a fence of MAVSDK's own making, gimbal and photos among the items."""
    north_deg = 0.003
    async with session(Flavour.PX4, kind) as system, asyncio.timeout(PATIENCE_S):
        mission, fence = MissionAsync(system), GeofenceAsync(system)
        corners = [Point(HOME.lat_deg + a, HOME.lon_deg + b) for a, b in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
        outside = Circle(Point(HOME.lat_deg + 0.5, HOME.lon_deg), 100.0, FenceType.EXCLUSION)
        await fence.upload_geofence(GeofenceData([Polygon(corners, FenceType.INCLUSION)], [outside]))
        photo, nan = MissionItem.CameraAction.TAKE_PHOTO, math.nan
        sent = [
            MissionItem(
                *(HOME.lat_deg + north_deg * number, HOME.lon_deg, 60.0, 15.0, True, -45.0, 10.0),
                *(photo, nan, 1.0, 3.0, nan, 10.0, MissionItem.VehicleAction.NONE),
            )
            for number in (1, 2, 3)
        ]
        await mission.upload_mission(MissionPlan(sent))
        held = (await mission.download_mission()).mission_items
        assert [each.latitude_deg for each in held] == pytest.approx([e.latitude_deg for e in sent], abs=1e-7)
        assert [(each.gimbal_pitch_deg, each.camera_action) for each in held] == [(-45.0, photo)] * 3


async def test_it_finds_camera_and_gimbal() -> None:
    """Both are components of their own: found, asked, pointed and told to take a photo."""
    async with session(Flavour.PX4, "multirotor") as system, asyncio.timeout(PATIENCE_S):
        camera, gimbal = CameraAsync(system), GimbalAsync(system)
        while not (cameras := (await camera.camera_list()).cameras):
            await asyncio.sleep(0.1)
        assert (cameras[0].horizontal_resolution_px, cameras[0].vertical_resolution_px) == (6000, 4000)
        await camera.take_photo(cameras[0].component_id)
        while not (gimbals := (await gimbal.gimbal_list()).gimbals):
            await asyncio.sleep(0.1)
        number = gimbals[0].gimbal_id
        await gimbal.take_control(number, ControlMode.PRIMARY)
        await gimbal.set_angles(number, 0.0, -45.0, 30.0, GimbalMode.YAW_FOLLOW, SendMode.ONCE)
        while True:
            turned = (await gimbal.get_attitude(number)).euler_angle_forward
            if abs(turned.pitch_deg + 45.0) < 0.5 and abs(turned.yaw_deg - 30.0) < 0.5:
                return
            await asyncio.sleep(0.1)
