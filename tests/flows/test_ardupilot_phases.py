"""Whole flights in a real ArduPlane and ArduCopter take as long as planned.

Skipped unless ``SWATHPLAN_ARDUPLANE`` and ``SWATHPLAN_ARDUCOPTER`` name the simulators (``copter.parm``
beside it, or named by ``SWATHPLAN_ARDUCOPTER_PARAMS``). ``pytest --log-cli-level=INFO`` shows a row for each.
"""

from __future__ import annotations

import asyncio
import os
from pathlib import Path

import pytest

from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.station.client import VehicleClient
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.flows.arduplane import BINARY, HOME_ALTITUDE_M, aeroplane, arm, fly, in_wind
from tests.flows.flying import WIND, Flight, case_document, store, until_disarmed
from tests.flows.phases import POWER_W, compared, small_case

pytestmark = pytest.mark.ardupilot

COPTER = os.environ.get("SWATHPLAN_ARDUCOPTER", "")
#: Climbs and descents in turns are flown at these rates: what 8° are at 20 m/s, with the wind behind 28 m/s.
RATES = {"TECS_CLMB_MAX": 2.81, "TECS_SINK_MAX": 2.81}
MARGINS = {"pointing_margin_deg": 1.5, "position_margin_m": 5.0}
SET_MODE, MISSION_START = 176, 300
LOITER, AUTO = 5.0, 3.0
#: Until it knows where it is.
POSITION_TRIES = 400


@pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator")
@pytest.mark.parametrize("wind", [None, WIND, (8.0, 90.0)], ids=["still air", "west wind", "east wind"])
async def test_an_aeroplane_takes_as_long_as_planned(
    tmp_path: Path, wind: tuple[float, float] | None
) -> None:
    """From lift-off to touch-down within 3 %; a plan is all that was known before."""
    vehicle = {"settle_m": 150, "finish": "land", "cruise_power_w": POWER_W}
    document = case_document(1, vehicle, MARGINS, wind)
    plan = make_plan(read_scenario(document))
    mission = encode(plan, options=EncodeOptions(home_altitude_m=HOME_ALTITUDE_M))
    async with aeroplane(tmp_path, plan.home, 40.0, {**in_wind(wind), **RATES}) as client:
        await store(client, mission)
        flight = await fly(client)
    told = f"8 m/s from {wind[1]:g}°" if wind else "none"
    assert compared(flight, plan.paths[0], "ArduPlane", told).share == pytest.approx(1.0, abs=0.03)


@pytest.mark.skipif(not COPTER, reason="SWATHPLAN_ARDUCOPTER names no simulator")
async def test_a_multirotor_takes_as_long_as_planned(tmp_path: Path) -> None:
    """Its corners and jerk are in the plan: the whole flight within 3 %."""
    plan = make_plan(read_scenario(small_case()))
    mission = encode(plan, options=EncodeOptions(home_altitude_m=HOME_ALTITUDE_M))
    folder = os.environ.get("SWATHPLAN_ARDUCOPTER_PARAMS", str(Path(COPTER).with_name("copter.parm")))
    async with aeroplane(tmp_path, plan.home, 20.0, model="+", binary=COPTER, defaults=folder) as client:
        # It takes no mission while it still reads its storage.
        await client.wait_for(lambda state: state.home_lat_deg is not None, 60.0)
        await store(client, mission)
        flight = await hovering(client)
    assert compared(flight, plan.paths[0], "ArduCopter", "none").share == pytest.approx(1.0, abs=0.03)


async def hovering(client: VehicleClient) -> Flight:
    """Arm where it knows its position, start the mission, wait for the landing."""
    for _ in range(POSITION_TRIES):
        if (await client.command(SET_MODE, (1.0, LOITER))).accepted:
            break
        await asyncio.sleep(0.25)
    await arm(client)
    assert (await client.command(SET_MODE, (1.0, AUTO))).accepted
    recorder = client.start_recording()
    assert (await client.command(MISSION_START, (0.0, 0.0))).accepted
    texts = await until_disarmed(client)
    client.stop_recording(recorder)
    return Flight(recorder.track(), texts, client.state)
