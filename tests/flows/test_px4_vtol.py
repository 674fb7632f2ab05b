"""A plan in a real PX4 VTOL: up hovering, over to wings, its passes, and hovering down where the plan ends.

Skipped unless ``SWATHPLAN_PX4`` names the simulator's binary, built with its VTOL modules, and
``SWATHPLAN_PX4_ROMFS`` its ``etc`` folder; see ``px4.py``.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.payload import parse_payload
from mavlink.rules.table import judge_parameters, names_to_read, needs_of
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.flows.flying import case_document, figures, from_end_m, inside_fence, store
from tests.flows.px4 import BINARY, PARAMETERS, ROMFS, VTOL, fly, has_module, simulated

pytestmark = [
    pytest.mark.px4,
    pytest.mark.skipif(
        not (BINARY and ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name no simulator"
    ),
    pytest.mark.skipif(
        bool(BINARY) and not has_module("vtol_att_control"), reason="the simulator was built without VTOLs"
    ),
]

SPEEDUP = 12.0
#: What SIH's VTOL of 0.2 kg is: FW_AIRSPD_TRIM 10 m/s, FW_AIRSPD_MAX 12; it rolls by 1° at rest.
VEHICLE = {
    "type": "vtol",
    "autopilot": "px4",
    "airspeed_m_s": 10.0,
    "min_turn_radius_m": 60.0,
    "settle_m": 150.0,
}
MARGINS = {"pointing_margin_deg": 3.0, "position_margin_m": 5.0}
#: Outputs 5 to 8 are its rudder, flaps and pusher.
SENSOR = "main:9"


async def test_a_vtol_hovers_up_sees_its_regions_and_hovers_down(tmp_path: Path) -> None:
    """Read back equal; straight up, over to wings, every pass near its line, down on the plan's end."""
    scenario = read_scenario(case_document(1, VEHICLE, MARGINS))
    plan = make_plan(scenario)
    payload = parse_payload(SENSOR)
    mission = encode(plan, options=EncodeOptions(payload=payload))
    needs = needs_of(plan, mission, payload, 150.0)
    parameters = {**PARAMETERS, "PWM_MAIN_FUNC5": 201, "PWM_MAIN_FUNC9": 301}
    async with simulated(tmp_path, plan.home, SPEEDUP, parameters, VTOL) as client:
        assert client.state.type == "vtol"
        names = names_to_read("px4", "vtol", needs)
        values = {name: read.value for name, read in (await client.read_parameters(names)).items()}
        assert set(names) == set(values)
        findings = judge_parameters("px4", "vtol", needs, values)
        assert [finding for finding in findings if finding.severity == "error"] == []
        await store(client, mission)
        flight = await fly(client, payload)

    points = flight.track.points
    places = scenario.frame.to_local([(point.lon_deg, point.lat_deg) for point in points])
    home, end = scenario.frame.to_local([plan.home, plan.end])
    top = next(n for n, point in enumerate(points) if point.relative_m > 45.0)
    assert max(math.dist(place, home) for place in places[:top]) < 5.0
    down = max(n for n, point in enumerate(points) if point.relative_m > 25.0)
    assert max(math.dist(place, end) for place in places[down:]) < 5.0
    assert from_end_m(scenario, plan, flight.final) < 2.0
    assert flight.final.landed
    samples = flight.samples()
    assert inside_fence(scenario, plan, samples)
    judged = figures(scenario, plan, mission, samples)
    judged.tell("1", "PX4, VTOL", "none")
    assert plan.altitude_m - 5.0 < judged.heights_m[0] < judged.heights_m[1] < plan.altitude_m + 5.0
    assert max(judged.cross_track_p95_m) < 5.0
    assert judged.least_seen > 0.995
