"""What is waited in the air before a window, flown by the simulated aircraft as long as planned."""

from __future__ import annotations

import math

import pytest

from mavlink.encoding.encode import encode
from mavlink.encoding.holds import circling_s, is_hold
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, MissionType
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan, PlanWind
from tests.mavlink.sim.helpers import Station
from tests.planner.scenarios import of_two

STEP_S = 0.1


def waiting(autopilot: str, kind: str) -> Plan:
    """Two regions of which the second's window opens minutes after the first one's has closed."""
    document = of_two(altitude_m=120.0)
    one = document["vehicles"][0] | {"type": kind, "autopilot": autopilot, "airspeed_m_s": 20.0}
    document["vehicles"] = [one | {"min_turn_radius_m": 60.0}]
    for feature, window in zip(document["features"], ([0, 600], [1000, 1500]), strict=False):
        feature["properties"]["time_window_s"] = window
    return make_plan(read_scenario(document))


def sensor_on_s(plan: Plan, autopilot: str, kind: str) -> list[float]:
    """When the sensor goes on, seconds after lift-off."""
    mission = encode(plan)
    home = Place(plan.home[1], plan.home[0], 0.0)
    sim = SimSettings(home=home, autopilot=Flavour(autopilot), vehicle_type=kind, turn_radius_m=60.0)  # type: ignore[arg-type]
    station = Station(SimulatedAircraft(sim))
    assert station.upload(mission.items_of(MissionType.MISSION), MissionType.MISSION) == 0
    station.start()
    found: list[float] = []
    lifted_s, was_on = math.nan, False
    while len(found) < len(plan.collects):
        assert station.now_s < 3000.0, "still flying"
        station.wait(STEP_S)
        if math.isnan(lifted_s) and station.aircraft.state.place.altitude_m > 1.0:
            lifted_s = station.now_s
        is_on = station.aircraft.payload.sensor_on
        if is_on and not was_on:
            found.append(station.now_s - lifted_s)
        was_on = is_on
    return found


@pytest.mark.parametrize(
    ("autopilot", "command"),
    [("ardupilot", Command.NAV_LOITER_TURNS), ("px4", Command.NAV_LOITER_TIME)],
)
def test_wings_wait_as_long_as_planned(autopilot: str, command: int) -> None:
    """One item for the wait; between the two regions as long as the plan has it, to a circle."""
    plan = waiting(autopilot, "fixed_wing")
    assert plan.violations == ()
    turns = next(s for s in plan.paths[0].segments if is_hold(plan.paths[0], s))
    assert command in [item.command for item in encode(plan).mission]
    on_s = sensor_on_s(plan, autopilot, "fixed_wing")
    first, second = plan.collects[0], next(c for c in plan.collects if c.roi != plan.collects[0].roi)
    planned_s = second.start_s - first.start_s
    flown_s = on_s[plan.collects.index(second)] - on_s[0]
    assert turns.radius_m is not None
    assert flown_s == pytest.approx(planned_s, abs=math.tau * turns.radius_m / 20.0)


def test_what_hovers_flies_its_circles_point_by_point() -> None:
    """No item that it does not know, and waypoints all round."""
    plan = waiting("ardupilot", "multirotor")
    turns = next(s for s in plan.paths[0].segments if is_hold(plan.paths[0], s))
    assert turns.turn_deg is not None
    mission = encode(plan).mission
    assert {Command.NAV_LOITER_TURNS, Command.NAV_LOITER_TIME, Command.NAV_LOITER_TO_ALT}.isdisjoint(
        item.command for item in mission
    )
    points = sum(item.command == Command.NAV_WAYPOINT for item in mission)
    assert points > 8 * round(turns.turn_deg / 360.0)


def test_a_circle_in_a_wind_takes_longer() -> None:
    """As long as a sum over a fine division of it says."""
    wind = PlanWind(8.0, 30.0)
    steps = 20_000
    exact_s = 0.0
    for k in range(steps):
        course = math.tau * (k + 0.5) / steps
        along, across = 8.0 * math.cos(course), 8.0 * math.sin(course)
        exact_s += 400.0 / steps / (along + math.sqrt(20.0**2 - across**2))
    assert circling_s(400.0, 20.0, wind) == pytest.approx(exact_s, rel=1e-6)
    assert circling_s(400.0, 20.0, PlanWind()) == pytest.approx(20.0)
