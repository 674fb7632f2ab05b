"""Our mission files, read by MAVSDK's importers.

The importers belong to a connected system, so MAVSDK's own autopilot side plays one on loopback.
"""

from __future__ import annotations

import json
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from mavlink.dialects import Autopilot
from mavlink.dialects.mission import Mission
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.formats import read_mission, read_plan, write_plan, write_waypoints
from mavlink.wire.items import MissionItem
from tests.mavlink.formats.test_qgc_complex import CORRIDOR, SURVEY, TRANSECTS, plan_of, simple
from tests.mavlink.plans import make_plan

pytest.importorskip("mavsdk")
from mavsdk.asyncio.mavsdk import Configuration, Mavsdk
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.component_type import ComponentType

from tests.patience import PATIENCE_S

pytestmark = pytest.mark.mavsdk

FAULTS = Path(__file__).parents[2] / "faults"


@asynccontextmanager
async def importer() -> AsyncIterator[MissionRawAsync]:
    """The raw mission plugin of a ground station connected to an autopilot over loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    autopilot = Configuration.create_with_component_type(ComponentType.AUTOPILOT)
    station = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(station) as listening, Mavsdk(autopilot) as calling:
        await listening.add_any_connection(f"udpin://127.0.0.1:{port}")
        await calling.add_any_connection(f"udpout://127.0.0.1:{port}")
        system = await listening.first_autopilot(timeout_s=PATIENCE_S)
        assert system is not None
        yield MissionRawAsync(system)


def values(items: list[object]) -> list[tuple[object, ...]]:
    names = ("frame", "command", "param1", "param2", "param3", "param4", "x", "y", "z", "mission_type")
    return [tuple(repr(float(getattr(item, name))) for name in names) for item in items]


def ours(items: tuple[MissionItem, ...]) -> list[tuple[object, ...]]:
    return values(list(items))


def missions() -> list[tuple[Autopilot, Mission]]:
    options = EncodeOptions(rally_at_home=True, home_altitude_m=120.0)
    return [
        (autopilot, encode(make_plan(autopilot=autopilot), options=options))
        for autopilot in ("ardupilot", "px4")
    ]


async def test_mavsdk_reads_our_files_item_by_item() -> None:
    """Mission, fence and rally points of .plan, and the items of .waypoints, are the same for MAVSDK."""
    async with importer() as mission_raw:
        for autopilot, mission in missions():
            plan = await mission_raw.import_qgroundcontrol_mission_from_string(write_plan(mission))
            without_home = mission.mission[1:] if autopilot == "ardupilot" else mission.mission
            assert values(plan.mission_items) == ours(without_home)
            assert values(plan.geofence_items) == ours(mission.fence)
            assert values(plan.rally_items) == ours(mission.rally)
            file = await mission_raw.import_mission_planner_mission_from_string(write_waypoints(mission))
            ahead = 0 if autopilot == "ardupilot" else 1
            assert values(file.mission_items[ahead:]) == ours(mission.mission)


async def test_mavsdk_reads_the_files_of_others_like_us() -> None:
    """Repeated numbers, null yaws, comments: what MAVSDK takes of a file it takes as we do, item by item."""
    async with importer() as mission_raw:
        for name in ("07-same-jump-id-no-jump.plan", "09-null-yaw-ardupilot.plan"):
            text = (FAULTS / name).read_text()
            theirs = await mission_raw.import_qgroundcontrol_mission_from_string(text)
            assert values(theirs.mission_items) == ours(read_mission(text).mission[1:])
        rows = (FAULTS / "05-comments.waypoints").read_text()
        theirs = await mission_raw.import_mission_planner_mission_from_string(rows)
        assert values(theirs.mission_items) == ours(read_mission(rows).mission)


async def test_mavsdk_lays_surveys_out_like_us() -> None:
    """A survey among simple items, with fence and rally points, gives MAVSDK the items that we read.

    MAVSDK 4.1 takes no other complex item: a corridor scan is compared with its items in the list themselves.
    """
    take_off = simple(22, 47.3977, 8.5456, 50, 1)
    land = simple(21, 47.3977, 8.5456, 0, 10)
    with_survey, with_corridor, flat = (
        json.dumps(plan_of(take_off, *middle, land)) for middle in ([SURVEY], [CORRIDOR], TRANSECTS)
    )
    async with importer() as mission_raw:
        for text, theirs in ((with_survey, with_survey), (with_corridor, flat)):
            plan = await mission_raw.import_qgroundcontrol_mission_from_string(theirs)
            mission = read_plan(text)
            assert values(plan.mission_items) == ours(mission.mission)
            assert values(plan.geofence_items) == ours(mission.fence)
            assert values(plan.rally_items) == ours(mission.rally)
