"""A gimbal in a real ArduPlane: its items held as meant, and obeyed on every pass.

Skipped unless ``SWATHPLAN_ARDUPLANE`` names the simulator's binary; see ``arduplane.py``.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from mavlink.dialects.mission import home_item, numbered
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.gimbal import parse_gimbal
from mavlink.encoding.payload import RelayPayload
from mavlink.links.link import open_link
from mavlink.rules.table import judge_parameters, names_to_read, needs_of
from mavlink.station.client import VehicleClient
from mavlink.wire.items import Command, Frame, MissionItem, MissionType
from tests.flows.arduplane import BINARY, PARAMETERS, arduplane, booted, fly
from tests.flows.flying import store
from tests.flows.gimbals import EVERY_US, SET_INTERVAL, STATUS, Watch, ends_of_passes, two_sided

pytestmark = [
    pytest.mark.ardupilot,
    pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator"),
]

SPEEDUP = 40.0
#: A servo gimbal: pitch, yaw and roll on outputs 5 to 7.
MOUNT = {"MNT1_TYPE": 1, "SERVO5_FUNCTION": 7, "SERVO6_FUNCTION": 6, "SERVO7_FUNCTION": 8}
RIGHT, LEFT, NEUTRAL = (-50, 90), (-50, -90), (0, 0)


async def test_the_gimbal_points_to_the_side_of_every_pass(tmp_path: Path) -> None:
    """Every form is held as meant; 40° from straight down is flown as a pitch of -50 abeam, then neutral."""
    plan = two_sided("ardupilot")
    watch = Watch()
    link = await open_link("udpin:127.0.0.1:0")
    port = int(link.url.rpartition(":")[2])
    with arduplane(tmp_path, port, plan.home, SPEEDUP, {**PARAMETERS, **MOUNT}):
        async with VehicleClient(link, tap=watch.frame) as client:
            await booted(client)
            for text in ("mount:tilt=44.6", "manager:tilt=44.6,yaw=course,device=1", "manager:tilt=40"):
                options = EncodeOptions(gimbal=parse_gimbal(text))
                mission = encode(plan, options=options)
                await store(client, mission)
            needs = needs_of(plan, mission, RelayPayload())
            names = [n for n in names_to_read("ardupilot", "fixed_wing", needs) if n.startswith("MNT")]
            values = {name: each.value for name, each in (await client.read_parameters(names)).items()}
            assert set(values) == set(names)
            assert judge_parameters("ardupilot", "fixed_wing", needs, values) == ()
            assert (await client.command(SET_INTERVAL, (float(STATUS), EVERY_US))).accepted
            await fly(client)
    passes = [watch.on_the_way_to(seq) for seq in ends_of_passes(mission.mission, Command.DO_SET_RELAY)]
    assert passes == [RIGHT, RIGHT, LEFT]
    assert watch.in_turn(RIGHT) == [RIGHT, LEFT, NEUTRAL]


async def test_the_item_that_takes_control_is_px4s_alone(tmp_path: Path) -> None:
    """ArduPilot refuses DO_GIMBAL_MANAGER_CONFIGURE in a mission, as the table says."""
    home = two_sided("ardupilot").home
    control = MissionItem(0, Frame.MISSION, Command.DO_GIMBAL_MANAGER_CONFIGURE, -2.0, -2.0, -1.0, -1.0)
    link = await open_link("udpin:127.0.0.1:0")
    port = int(link.url.rpartition(":")[2])
    with arduplane(tmp_path, port, home, SPEEDUP, PARAMETERS):
        async with VehicleClient(link) as client:
            await booted(client)
            items = numbered([home_item(home, 0.0), control])
            assert "UNSUPPORTED" in str(await client.upload(items, MissionType.MISSION))
