"""How missions begin and end in a real ArduPlane: hovering up and down, and a return that does not land.

Skipped unless ``SWATHPLAN_ARDUPLANE`` names the simulator's binary; see ``arduplane.py``.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Sequence
from pathlib import Path

import pytest

from mavlink.encoding.encode import encode
from mavlink.encoding.payload import RelayPayload
from mavlink.rules.table import judge_parameters, names_to_read, needs_of
from mavlink.state.telemetry import VehicleState
from mavlink.state.track import TrackPoint
from mavlink.wire.items import Command
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.flows.arduplane import BINARY, QUADPLANE, aeroplane, arm, fly
from tests.flows.flying import case_document, figures, from_end_m, inside_fence, store
from tests.patience import PATIENCE_S

pytestmark = [
    pytest.mark.ardupilot,
    pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator"),
]

SPEEDUP = 40.0
MARGINS = {"pointing_margin_deg": 1.5, "position_margin_m": 5.0}
#: What the simulator's quadplane is: AIRSPEED_CRUISE 25 m/s, and a bank of some 23° at 150 m.
VTOL = {"type": "vtol", "airspeed_m_s": 25.0, "min_turn_radius_m": 150.0, "settle_m": 150.0}
#: WP_LOITER_RAD 80 m, which it keeps within some metres.
CIRCLES_WITHIN_M = 130.0
#: So long it is watched there.
CIRCLING_S = 200.0


def away_m(frame: LocalFrame, points: Sequence[TrackPoint], place: tuple[float, float]) -> list[float]:
    """Distances of places of a track from another."""
    (centre,) = frame.to_local([place])
    places = frame.to_local([(point.lon_deg, point.lat_deg) for point in points])
    return [math.dist(here, centre) for here in places]


def is_over(frame: LocalFrame, state: VehicleState, place: tuple[float, float]) -> bool:
    """Whether it has come as near to a place as it circles."""
    if state.lon_deg is None or state.lat_deg is None:
        return False
    here, centre = frame.to_local([(state.lon_deg, state.lat_deg), place])
    return math.dist(here, centre) < CIRCLES_WITHIN_M


def lasts_s(points: Sequence[TrackPoint]) -> float:
    """By the autopilot's clock."""
    return points[-1].time_s - points[0].time_s if points else 0.0


@pytest.mark.skipif(not QUADPLANE.is_file(), reason="no quadplane.parm beside the simulator")
async def test_a_vtol_hovers_up_sees_its_regions_and_hovers_down(tmp_path: Path) -> None:
    """It leaves the ground straight up, flies its passes on wings, and disarms where the plan ends."""
    scenario = read_scenario(case_document(1, {**VTOL, "finish": "land"}, MARGINS))
    plan = make_plan(scenario)
    mission = encode(plan)
    async with aeroplane(tmp_path, plan.home, SPEEDUP, model="quadplane") as client:
        await client.wait_for(lambda state: state.type == "vtol", PATIENCE_S)
        needs = needs_of(plan, mission, RelayPayload(), 150.0)
        names = names_to_read("ardupilot", "vtol", needs)
        values = {name: read.value for name, read in (await client.read_parameters(names)).items()}
        assert {"Q_ENABLE", "Q_TRANS_DECEL"} <= values.keys()
        findings = judge_parameters("ardupilot", "vtol", needs, values)
        assert [finding for finding in findings if finding.severity == "error"] == []
        await store(client, mission)
        flight = await fly(client)

    points = flight.track.points
    top = next(n for n, point in enumerate(points) if point.relative_m > 45.0)
    assert max(away_m(scenario.frame, points[:top], plan.home)) < 5.0
    down = max(n for n, point in enumerate(points) if point.relative_m > 25.0)
    assert max(away_m(scenario.frame, points[down:], plan.end)) < 5.0
    assert from_end_m(scenario, plan, flight.final) < 2.0
    samples = flight.samples()
    assert inside_fence(scenario, plan, samples)
    judged = figures(scenario, plan, mission, samples)
    judged.tell("1", "ArduPlane, VTOL", "none")
    assert max(judged.cross_track_p95_m) < 5.0
    assert judged.least_seen > 0.995


async def test_a_return_circles_over_home_and_stays_armed(tmp_path: Path) -> None:
    """A plan that ends at home is left to the return, which does not land: as the mission's notes say."""
    scenario = read_scenario(case_document(4, {"finish": "return"}))
    plan = make_plan(scenario)
    mission = encode(plan)
    assert mission.mission[-1].command == Command.NAV_RETURN_TO_LAUNCH
    assert any("left to the pilot" in note for note in mission.notes)
    async with aeroplane(tmp_path, plan.home, SPEEDUP) as client:
        await store(client, mission)
        await arm(client)
        assert (await client.start_mission()).accepted
        await client.wait_for(lambda state: (state.mission_current or 0) >= 5, 120.0)
        assert (await client.goto_item(len(mission.mission) - 1)).kind == "accepted"
        await client.wait_for(lambda state: state.mode == "RTL", PATIENCE_S)
        # A busy machine flies slower than asked: it is over home when it is as near as it circles.
        await client.wait_for(lambda state: is_over(scenario.frame, state, plan.home), PATIENCE_S)
        recorder = client.start_recording()
        while lasts_s(recorder.track().points) < CIRCLING_S:
            await asyncio.sleep(1.0)
        client.stop_recording(recorder)
        points = recorder.track().points
        assert max(away_m(scenario.frame, points, plan.home)) < CIRCLES_WITHIN_M
        assert min(point.relative_m for point in points) > 50.0
        assert client.state.armed
        assert client.state.mode == "RTL"
