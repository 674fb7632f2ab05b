"""Whole flights in PX4's simulated aeroplane and multirotor take as long as planned.

Skipped unless ``SWATHPLAN_PX4`` names the simulator's binary and ``SWATHPLAN_PX4_ROMFS`` its ``etc`` folder;
see ``px4.py``. In wind where the simulator has one (SIH_WIND_N, SIH_WIND_E), which v1.16 has not.
``pytest --log-cli-level=INFO`` shows a row for each.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from mavlink.encoding.encode import encode
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.flows.flying import WIND, case_document, store
from tests.flows.phases import POWER_W, compared, small_case
from tests.flows.px4 import (
    AEROPLANE,
    BINARY,
    MULTIROTOR,
    PARAMETERS,
    ROMFS,
    fly,
    has_parameter,
    simulated,
    wind,
)

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
#: A take-off alone is flown so much later.
TAKE_OFF_S = 6.0
MARGINS = {"pointing_margin_deg": 3.0, "position_margin_m": 5.0}


@pytest.mark.parametrize("case", [1, 3])
async def test_an_aeroplane_takes_as_long_as_planned(tmp_path: Path, case: int) -> None:
    """From lift-off to touch-down within 3 %, each phase by itself within 5 %, the take-off within 6 s."""
    plan = make_plan(read_scenario(case_document(case, VEHICLE, MARGINS)))
    mission = encode(plan)
    async with simulated(tmp_path, plan.home, 15.0, {**PARAMETERS, **WING}, AEROPLANE) as client:
        await store(client, mission)
        flight = await fly(client)
    found = compared(flight, plan.paths[0], f"PX4, wing, case {case}", "none")
    assert found.share == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("mission") == pytest.approx(1.0, abs=WITHIN)
    # PX4 climbs out steeper than planned: it is high enough before the place where the take-off ends. Where
    # the first leg is long enough to climb on, no climb follows that makes up for it.
    planned_s = sum(phase.planned_s for phase in found.phases if phase.kind in ("take_off", "climb"))
    assert found.share_of("take_off", "climb") == pytest.approx(1.0, abs=max(0.05, TAKE_OFF_S / planned_s))
    assert found.share_of("landing") == pytest.approx(1.0, abs=0.05)


@pytest.mark.skipif(
    bool(BINARY and ROMFS) and not has_parameter("SIH_WIND_E"),
    reason="the simulator has no wind (SIH_WIND_N, SIH_WIND_E: PX4 after v1.17)",
)
async def test_in_wind_an_aeroplane_takes_as_long_as_planned(tmp_path: Path) -> None:
    """With twice the thrust at 16 m/s in 8: the whole flight and the mission within 3 %."""
    speed_m_s = 16.0
    # Slopes that PX4's rates allow with the wind behind, flown at the airspeed.
    part = speed_m_s / (speed_m_s + WIND[0])
    faster = dict.fromkeys(("FW_AIRSPD_TRIM", "FW_TKO_AIRSPD", "FW_LND_AIRSPD"), speed_m_s)
    rates = {"FW_T_CLMB_R_SP": 3.0 * part, "FW_T_SINK_R_SP": 2.0 * part}
    parameters = {**PARAMETERS, **faster, **rates, "SIH_T_MAX": 12.0, "FW_THR_TRIM": 0.6}
    vehicle = {**VEHICLE, "airspeed_m_s": speed_m_s}
    plan = make_plan(read_scenario(case_document(1, vehicle, MARGINS, WIND)))
    mission = encode(plan)
    async with simulated(tmp_path, plan.home, 12.0, parameters, AEROPLANE) as client:
        await store(client, mission)
        async with wind(client, *WIND):
            flight = await fly(client)
    found = compared(flight, plan.paths[0], "PX4, wing, case 1", f"{WIND[0]:g} m/s from {WIND[1]:g}°")
    assert found.share == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("mission") == pytest.approx(1.0, abs=WITHIN)


async def test_a_multirotor_takes_as_long_as_planned(tmp_path: Path) -> None:
    """Its corners, short legs and climbs are in the plan: the whole flight and the mission within 3 %."""
    plan = make_plan(read_scenario(small_case(autopilot="px4", airspeed_m_s=8.0)))
    mission = encode(plan)
    async with simulated(tmp_path, plan.home, 12.0, PARAMETERS, MULTIROTOR) as client:
        await store(client, mission)
        flight = await fly(client)
    found = compared(flight, plan.paths[0], "PX4, multirotor", "none")
    assert found.share == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("mission") == pytest.approx(1.0, abs=WITHIN)
    assert found.share_of("take_off", "climb") == pytest.approx(1.0, abs=0.1)
    assert found.share_of("landing") == pytest.approx(1.0, abs=0.1)
