"""Speeds of single collects in missions: told before they begin, taken back behind, and flown."""

from __future__ import annotations

import math
from unittest import mock

import numpy as np
import pytest

from mavlink.dialects import Autopilot
from mavlink.encoding.encode import encode
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks import collect
from tests.mavlink.sim.helpers import Station
from tests.planner.tasks.blocks import among_blocks

INTERVAL_S = 1.4
CRUISE_M_S = 8.0


def slow_plan(autopilot: Autopilot) -> tuple[Scenario, Plan]:
    """Sweeps among buildings one of which is too short for two photos at full speed, none moved for it."""
    document = among_blocks(36, INTERVAL_S, CRUISE_M_S, required=False)
    document["vehicles"][0] |= {"autopilot": autopilot, "settle_m": 0.0}
    document["sensors"][0] |= {"pointing_margin_deg": 0.0, "position_margin_m": 0.0}
    scenario = read_scenario(document)
    with mock.patch.object(collect, "in_time_for_photos", return_value=None):
        return scenario, make_plan(scenario)


def test_a_slow_collect_is_told_before_it_begins_and_flown_so() -> None:
    """Each photo in time along the line as flown; the way before and behind it at full speed."""
    scenario, plan = slow_plan("ardupilot")
    (slow,) = (each for each in plan.collects if each.speed_m_s is not None)
    assert slow.speed_m_s is not None
    assert slow.speed_m_s < CRUISE_M_S
    mission = encode(plan)
    speed_m_s, begun, orders = math.nan, 0, 0
    behind: list[float] = []
    for item in mission.mission:
        if item.command == Command.DO_CHANGE_SPEED:
            assert item.param1 == 1.0
            speed_m_s, orders = item.param2, orders + 1
        if item.command == Command.DO_SET_CAM_TRIGG_DIST and item.param1 > 0.0:
            begun += 1
            assert speed_m_s == pytest.approx(slow.speed_m_s if begun == slow.seq else CRUISE_M_S)
        elif item.command == Command.NAV_WAYPOINT and begun == slow.seq:
            behind.append(speed_m_s)
    assert orders == 3
    assert begun == len(plan.collects)
    # Its end, and what lies between it and the next one.
    assert behind[0] == pytest.approx(slow.speed_m_s)
    assert set(behind[1:]) == {CRUISE_M_S}
    assert least_gap_s(scenario, plan, slow.seq) > 0.99 * INTERVAL_S


def least_gap_s(scenario: Scenario, plan: Plan, seq: int) -> float:
    """How long the simulated aircraft takes at least from one photo's place to the next."""
    collect = next(each for each in plan.collects if each.seq == seq)
    home = Place(plan.home[1], plan.home[0], 40.0)
    settings = SimSettings(
        home=home,
        heading_deg=None,
        autopilot=Flavour("ardupilot"),
        vehicle_type="multirotor",
        airspeed_m_s=CRUISE_M_S,
    )
    station = Station(SimulatedAircraft(settings))
    assert station.upload(encode(plan).mission) == 0
    station.start()
    places, at_s = [], []
    while station.aircraft.armed and station.now_s < 1.5 * collect.end_s:
        station.wait(0.1)
        place = station.aircraft.state.place
        places.append((place.lon_deg, place.lat_deg))
        at_s.append(station.now_s)
    start, end = scenario.frame.to_local([each[:2] for each in collect.line])
    track = scenario.frame.to_local(places)
    ahead = (end - start) / np.hypot(*(end - start))
    along_m, beside_m = (track - start) @ ahead, (track - start) @ np.array([-ahead[1], ahead[0]])
    length_m = float(np.hypot(*(end - start)))
    near = (np.abs(beside_m) < 2.0) & (along_m > -3.0) & (along_m < length_m + 3.0)
    # It may cross the line elsewhere in its flight.
    by = np.flatnonzero(near)
    runs = np.split(by, np.flatnonzero(np.diff(by) > 1) + 1)
    gaps = []
    for run in runs:
        if along_m[run[0]] < 0.0 and along_m[run[-1]] > length_m:
            passed_s = np.interp(np.linspace(0.0, length_m, 2), along_m[run], np.array(at_s)[run])
            gaps.append(float(np.diff(passed_s).min()))
    assert gaps
    photos = next(each for each in plan.photos if each.seq == seq)
    return min(gaps) / (len(photos.places) - 1)


def test_the_speed_is_kept_in_a_written_plan() -> None:
    """Read back as it was; other collects say nothing of one."""
    _, plan = slow_plan("ardupilot")
    again = read_plan(write_plan(plan))
    assert [each.speed_m_s for each in again.collects] == [each.speed_m_s for each in plan.collects]
    written = [f["properties"] for f in write_plan(plan)["features"] if f["properties"]["role"] == "collect"]
    assert sum("speed_m_s" in each for each in written) == 1
