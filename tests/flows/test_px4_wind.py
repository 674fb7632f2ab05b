"""The shared cases in a real PX4 aeroplane in a wind of 8 m/s, where its simulator has wind.

Skipped unless ``SWATHPLAN_PX4`` names a simulator whose SIH model has SIH_WIND_N and SIH_WIND_E, as PX4's has
after v1.17, and ``SWATHPLAN_PX4_ROMFS`` its ``etc`` folder; see ``px4.py``.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from mavlink.encoding.encode import encode
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.flows.flying import CASES, WIND, case_document, figures, from_end_m, inside_fence, store
from tests.flows.px4 import BINARY, ROMFS, fly, has_parameter, simulated, wind

pytestmark = [
    pytest.mark.px4,
    pytest.mark.skipif(
        not (BINARY and ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name no simulator"
    ),
    pytest.mark.skipif(
        bool(BINARY and ROMFS) and not has_parameter("SIH_WIND_E"),
        reason="the simulator has no wind (SIH_WIND_N, SIH_WIND_E: PX4 after v1.17)",
    ),
]

SPEEDUP = 12.0
VEHICLE = {"autopilot": "px4", "airspeed_m_s": 14.0, "min_turn_radius_m": 100.0, "settle_m": 150.0}
MARGINS = {"pointing_margin_deg": 3.0, "position_margin_m": 5.0}


@pytest.mark.parametrize("case", CASES)
async def test_in_wind_lines_are_held_and_regions_seen(tmp_path: Path, case: int) -> None:
    """The plan knows the wind: passes near their lines, inside the fence; every region seen; landed."""
    scenario = read_scenario(case_document(case, VEHICLE, MARGINS, WIND))
    plan = make_plan(scenario)
    mission = encode(plan)
    async with simulated(tmp_path, plan.home, SPEEDUP) as client:
        await store(client, mission)
        async with wind(client, *WIND):
            flight = await fly(client)
    samples = flight.samples()
    assert inside_fence(scenario, plan, samples)
    assert from_end_m(scenario, plan, flight.final) < 200.0
    judged = figures(scenario, plan, mission, samples)
    judged.tell(str(case), "PX4", f"{WIND[0]:g} m/s")
    assert max(judged.cross_track_p95_m) < 10.0
    assert judged.least_seen > 0.995
