"""Whole flights in PX4's simulated aeroplane and multirotor take as long as planned.

Skipped unless ``SWATHPLAN_PX4`` names the simulator's binary and ``SWATHPLAN_PX4_ROMFS`` its ``etc`` folder;
see ``px4.py``. In still air: the model of v1.16 has no wind. ``pytest --log-cli-level=INFO`` shows a row for
each.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from mavlink.encoding.encode import encode
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.flows.flying import case_document, store
from tests.flows.phases import POWER_W, compared, small_case
from tests.flows.px4 import AEROPLANE, BINARY, MULTIROTOR, PARAMETERS, ROMFS, fly, simulated

pytestmark = [
    pytest.mark.px4,
    pytest.mark.skipif(
        not (BINARY and ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name no simulator"
    ),
]

WITHIN = 0.03
#: At 14 m/s the model's aeroplane is at full throttle; it climbs and takes off at this speed as well.
SPEED_M_S, CLIMB_DEG = 12.0, 8.0
RATE_M_S = SPEED_M_S * math.tan(math.radians(CLIMB_DEG))
#: What the pre-flight check asks of a vehicle for such a plan; the throttle that holds this speed.
WING = {
    "FW_AIRSPD_TRIM": SPEED_M_S,
    "FW_THR_TRIM": 0.73,
    "FW_T_CLMB_R_SP": RATE_M_S,
    "FW_T_SINK_R_SP": RATE_M_S,
    "FW_TKO_AIRSPD": SPEED_M_S,
    "FW_LND_AIRSPD": SPEED_M_S,
}
VEHICLE = {
    "autopilot": "px4",
    "airspeed_m_s": SPEED_M_S,
    "min_turn_radius_m": 100.0,
    "max_climb_deg": CLIMB_DEG,
    "settle_m": 150.0,
    "cruise_power_w": POWER_W,
}
MARGINS = {"pointing_margin_deg": 2.0, "position_margin_m": 5.0}


@pytest.mark.parametrize("case", [1, 3])
async def test_an_aeroplane_takes_as_long_as_planned(tmp_path: Path, case: int) -> None:
    """From lift-off to touch-down within 3 %, and each phase but the take-off by itself within 5 %."""
    plan = make_plan(read_scenario(case_document(case, VEHICLE, MARGINS)))
    mission = encode(plan)
    async with simulated(tmp_path, plan.home, 15.0, {**PARAMETERS, **WING}, AEROPLANE) as client:
        await store(client, mission)
        flight = await fly(client)
    found = compared(flight, plan.paths[0], f"PX4, wing, case {case}", "none")
    assert found.share == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("mission") == pytest.approx(1.0, abs=WITHIN)
    # PX4 climbs out steeper than planned: it is high enough before the place where the take-off ends.
    assert found.share_of("take_off", "climb") == pytest.approx(1.0, abs=0.05)
    assert found.share_of("landing") == pytest.approx(1.0, abs=0.05)


async def test_a_multirotor_takes_as_long_as_planned(tmp_path: Path) -> None:
    """Its corners, short legs and climbs are in the plan: the whole flight and the mission within 3 %."""
    plan = make_plan(read_scenario(small_case(autopilot="px4")))
    mission = encode(plan)
    async with simulated(tmp_path, plan.home, 12.0, PARAMETERS, MULTIROTOR) as client:
        await store(client, mission)
        flight = await fly(client)
    found = compared(flight, plan.paths[0], "PX4, multirotor", "none")
    assert found.share == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("mission") == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("take_off", "climb") == pytest.approx(1.0, abs=0.1)
    assert found.share_of("landing") == pytest.approx(1.0, abs=0.1)
