"""MAVProxy as the second ground station, behind a forward of the link."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest

from mavlink.sim.modes import Flavour
from mavlink.wire.items import MissionType
from tests.mavlink.sim.helpers import landing_mission, numbered, waypoint
from tests.mavlink.station.test_mavproxy import assert_same, mavproxy

pytest.importorskip("mavsdk")
from tests.mavlink.station.forward.test_mavsdk import forwarded
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.skipif(find_spec("MAVProxy") is None, reason="MAVProxy is not installed")


async def test_mavproxy_lists_our_mission_and_arms(tmp_path: Path) -> None:
    """It lists the items as we uploaded them, and its order to arm is carried out and answered."""
    mission = tuple(numbered(landing_mission([waypoint(0.0, 1000.0), waypoint(0.0, 2000.0)], home_row=True)))
    async with forwarded(Flavour.ARDUPILOT, write=True) as (client, forwards):
        uploaded = await client.upload_verified(mission, MissionType.MISSION, lambda *_: ())
        assert uploaded.held is not None
        (outlet,) = forwards.outlets
        async with mavproxy(int(outlet.url.rpartition(":")[2]), tmp_path) as proxy:
            assert_same(await proxy.order("wp list", r"Saved \D+ to "), uploaded.held)
            await proxy.order("module load cmdlong", "Loaded module cmdlong")
            await proxy.order("long 400 1", "COMPONENT_ARM_DISARM: ACCEPTED")
            await client.wait_for(lambda state: state.armed, PATIENCE_S)
        assert outlet.stations == [255]
