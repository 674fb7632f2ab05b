"""Whole flights in a real ArduPlane and ArduCopter take as long as planned.

Skipped unless ``SWATHPLAN_ARDUPLANE`` and ``SWATHPLAN_ARDUCOPTER`` name the simulators (``copter.parm``
beside it, or named by ``SWATHPLAN_ARDUCOPTER_PARAMS``). ``pytest --log-cli-level=INFO`` shows a row for each.
"""

from __future__ import annotations

import asyncio
import math
import os
from collections.abc import Mapping
from pathlib import Path

import pytest

from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.station.client import VehicleClient
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.vehicle.atmosphere import true_over_equivalent
from tests.flows.arduplane import BINARY, HOME_ALTITUDE_M, aeroplane, arm, fly, in_wind
from tests.flows.flying import WIND, Flight, case_document, figures, store, until_disarmed
from tests.flows.phases import POWER_W, compared, small_case
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.ardupilot

COPTER = os.environ.get("SWATHPLAN_ARDUCOPTER", "")
#: Of the shared cases' vehicle.
AIRSPEED_M_S, CLIMB_RAD = 20.0, math.radians(8.0)
#: Cases, and where the wind comes from.
WINGS = [(1, None), (1, 270.0), (2, 0.0), (2, 90.0), (3, 225.0)]
#: Of duration; and of each region.
WITHIN, LEAST_SEEN = 0.03, 0.999
#: Of the simulator's pitot, unless it is set.
SITL_PITOT_RATIO = 1.99
SET_MODE, MISSION_START = 176, 300
LOITER, AUTO = 5.0, 3.0
#: Until it knows where it is.
POSITION_TRIES = 400


def told(from_deg: float | None) -> str:
    """The wind in words."""
    return "none" if from_deg is None else f"{WIND[0]:g} m/s from {from_deg:g}°"


@pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator")
@pytest.mark.parametrize(("case", "from_deg"), WINGS)
async def test_an_aeroplane_takes_as_long_as_planned(
    tmp_path: Path, case: int, from_deg: float | None
) -> None:
    """From lift-off to touch-down within 3 %, and 99.9 % seen with its autopilot's own margins."""
    wind = None if from_deg is None else (WIND[0], from_deg)
    document = case_document(case, {"finish": "land", "cruise_power_w": POWER_W}, wind=wind)
    del document["vehicles"][0]["settle_m"]
    for name in ("pointing_margin_deg", "position_margin_m"):
        del document["sensors"][0][name]
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    mission = encode(plan, options=EncodeOptions(home_altitude_m=HOME_ALTITUDE_M))
    parameters = {**in_wind(wind), **rates(wind), **calibrated(HOME_ALTITUDE_M + plan.altitude_m)}
    heading_deg = plan.paths[0].take_off_heading_deg
    assert heading_deg is not None
    async with aeroplane(tmp_path, plan.home, 40.0, parameters, heading_deg=heading_deg) as client:
        await store(client, mission)
        flight = await fly(client)
    found = compared(flight, plan.paths[0], f"ArduPlane, case {case}", told(from_deg))
    seen = figures(scenario, plan, mission, flight.samples())
    seen.tell(str(case), told(from_deg))
    assert found.share == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("mission") == pytest.approx(1.0, abs=WITHIN)
    assert seen.least_seen >= LEAST_SEEN


def rates(wind: tuple[float, float] | None) -> Mapping[str, float]:
    """What the plan's climb is at its fastest, with the wind behind: more than pre-flight counts."""
    fastest_m_s = (AIRSPEED_M_S + (0.0 if wind is None else wind[0])) * math.tan(CLIMB_RAD)
    return {"TECS_CLMB_MAX": round(fastest_m_s, 2), "TECS_SINK_MAX": round(fastest_m_s, 2)}


def calibrated(altitude_amsl_m: float) -> Mapping[str, float]:
    """The pitot's ratio that is right at a height in this simulator.

    It divides the true airspeed by that over the equivalent one twice (``Aircraft::update_wind``,
    ``SITL_State::_update_airspeed``): uncorrected it flies so much faster than a real one.
    """
    return {"ARSPD_RATIO": SITL_PITOT_RATIO * true_over_equivalent(altitude_amsl_m) ** 2}


@pytest.mark.skipif(not COPTER, reason="SWATHPLAN_ARDUCOPTER names no simulator")
@pytest.mark.parametrize("from_deg", [None, 270.0, 0.0])
async def test_a_multirotor_takes_as_long_as_planned(tmp_path: Path, from_deg: float | None) -> None:
    """Its corners and jerk are in the plan, and what the wind leaves of its speed: within 3 %."""
    wind = None if from_deg is None else (WIND[0], from_deg)
    document = small_case(autopilot="ardupilot")
    if wind is not None:
        document["wind"] = {"speed_m_s": wind[0], "from_deg": wind[1]}
    plan = make_plan(read_scenario(document))
    mission = encode(plan, options=EncodeOptions(home_altitude_m=HOME_ALTITUDE_M))
    folder = os.environ.get("SWATHPLAN_ARDUCOPTER_PARAMS", str(Path(COPTER).with_name("copter.parm")))
    async with aeroplane(
        tmp_path, plan.home, 20.0, in_wind(wind), model="+", binary=COPTER, defaults=folder
    ) as client:
        # It takes no mission while it still reads its storage.
        await client.wait_for(lambda state: state.home_lat_deg is not None, PATIENCE_S)
        await store(client, mission)
        flight = await hovering(client)
    found = compared(flight, plan.paths[0], "ArduCopter", told(from_deg))
    assert found.share == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("mission") == pytest.approx(1.0, abs=WITHIN)


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
