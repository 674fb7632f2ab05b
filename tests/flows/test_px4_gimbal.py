"""A gimbal in a real PX4: its items held as meant, and obeyed on every pass.

Skipped unless ``SWATHPLAN_PX4`` names the simulator's binary; see ``px4.py``.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.gimbal import parse_gimbal
from mavlink.encoding.payload import ActuatorPayload
from mavlink.links.link import open_link
from mavlink.rules.table import judge_parameters, names_to_read, needs_of
from mavlink.station.client import VehicleClient
from mavlink.wire.items import Command
from tests.flows.flying import store
from tests.flows.gimbals import EVERY_US, STATUS, Watch, ends_of_passes, two_sided
from tests.flows.px4 import (
    BINARY,
    FIRST_PORT,
    NOT_NEEDED,
    PARAMETERS,
    READY_S,
    SET_INTERVAL,
    fly,
    free_instance,
    px4,
)

pytestmark = [
    pytest.mark.px4,
    pytest.mark.skipif(not BINARY, reason="SWATHPLAN_PX4 names no simulator"),
]

SPEEDUP = 12.0
#: What SIH's aeroplane flies at without losing height.
AIRSPEED_M_S = 14.0
#: Servos that PX4 turns itself, far enough for straight down.
MOUNT = {"MNT_MODE_IN": 4, "MNT_MODE_OUT": 0, "MNT_RANGE_PITCH": 180, "MNT_RANGE_YAW": 360}
RIGHT, LEFT, NEUTRAL = (-50, 90), (-50, -90), (0, 0)


async def test_the_gimbal_points_to_the_side_of_every_pass(tmp_path: Path) -> None:
    """Every form is held as meant; 40° from straight down is flown as a pitch of -50 abeam, then neutral."""
    plan = two_sided("px4")
    plan = replace(plan, vehicles=(replace(plan.vehicles[0], airspeed_m_s=AIRSPEED_M_S),))
    watch = Watch()
    instance = free_instance()
    link = await open_link(f"udpin:127.0.0.1:{FIRST_PORT + instance}")
    async with VehicleClient(link, tap=watch.frame) as client:
        with px4(tmp_path, instance, plan.home, SPEEDUP, {**PARAMETERS, **MOUNT}):
            await client.connect(30.0)
            await client.wait_for(lambda state: state.home_lat_deg is not None, READY_S)
            for message_id in NOT_NEEDED:
                await client.command(SET_INTERVAL, (float(message_id), -1.0))
            for text in ("mount:tilt=44.6", "manager:tilt=44.6,yaw=course", "manager:tilt=40"):
                mission = encode(plan, options=EncodeOptions(gimbal=parse_gimbal(text)))
                await store(client, mission)
            needs = needs_of(plan, mission, ActuatorPayload(1))
            names = [n for n in names_to_read("px4", "fixed_wing", needs) if n.startswith("MNT")]
            values = {name: each.value for name, each in (await client.read_parameters(names)).items()}
            assert set(values) == set(MOUNT)
            assert judge_parameters("px4", "fixed_wing", needs, values) == ()
            assert (await client.command(SET_INTERVAL, (float(STATUS), EVERY_US))).accepted
            await fly(client)
    passes = [watch.on_the_way_to(seq) for seq in ends_of_passes(mission.mission, Command.DO_SET_ACTUATOR)]
    assert passes == [RIGHT, RIGHT, LEFT]
    assert watch.in_turn(RIGHT) == [RIGHT, LEFT, NEUTRAL]
