"""Lines between waypoints, flown by the multirotor's model as both autopilots round corners."""

from __future__ import annotations

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from mavlink.sim.dynamics import FlightCommand, Limits, Wind
from mavlink.sim.legs import Agility, LegFollower, speed_to_stop_m_s
from mavlink.sim.multirotor import MultirotorModel
from tests.mavlink.sim.helpers import HOME, east_north_m, place_at

RADIUS_M = 2.0
LEGS = st.lists(
    st.tuples(st.floats(0.0, 2.0 * math.pi), st.floats(0.5, 150.0), st.floats(-15.0, 15.0)),
    min_size=1,
    max_size=6,
)


@settings(max_examples=40, deadline=None)
@given(legs=LEGS, speed_m_s=st.floats(3.0, 20.0), abeam=st.booleans(), wind_m_s=st.floats(0.0, 2.5))
def test_every_waypoint_is_reached_near_its_lines(
    legs: list[tuple[float, float, float]], speed_m_s: float, abeam: bool, wind_m_s: float
) -> None:
    """Whatever the corners: all are reached, no faster than ordered, near the lines, to a stop."""
    corners = [(0.0, 0.0, HOME.altitude_m + 100.0)]
    for angle_rad, length_m, climb_m in legs:
        east_m, north_m, altitude_m = corners[-1]
        corners.append(
            (
                east_m + length_m * math.cos(angle_rad),
                north_m + length_m * math.sin(angle_rad),
                altitude_m + climb_m,
            )
        )
    limits = Limits(speed_m_s, math.radians(35.0), 1.0, 5.0, 4.0)
    model = MultirotorModel(limits, HOME, 0.0, wind=Wind(wind_m_s, 40.0, 0.0, 1), ground_m=HOME.altitude_m)
    while model.state.altitude_m < corners[0][2]:
        model.step(model.step_s, FlightCommand(climb_m_s=5.0, launch=True))
    places = [place_at(*corner) for corner in corners]
    agility = Agility(speed_m_s, 2.5 if abeam else 3.0, 5.0, 4.0, abeam)
    path = LegFollower(agility, places, [RADIUS_M] * len(places))
    lines = LineString([corner[:2] for corner in corners])
    # Stopping at every corner and climbing straight up would take no longer than this.
    most_s = 60.0 + sum(
        30.0 + length_m / min(speed_m_s, 3.0) + abs(climb_m) / 2.0 for _, length_m, climb_m in legs
    )
    start_s = model.state.time_s
    while not path.finished:
        state = model.state
        assert state.time_s - start_s < most_s, "a waypoint is never reached"
        if path.passed(state, 0.0):
            continue
        model.step(model.step_s, path.command(state, speed_m_s))
        assert model.state.ground_speed_m_s <= speed_m_s + 1.0
        assert lines.distance(Point(east_north_m(model.state.lat_deg, model.state.lon_deg))) < 4.0
    assert math.dist(east_north_m(model.state.lat_deg, model.state.lon_deg), corners[-1][:2]) <= RADIUS_M


@given(distance_m=st.floats(0.01, 1000.0), braking_m_s2=st.floats(0.5, 5.0), end_m_s=st.floats(0.1, 10.0))
def test_speeds_to_stop_can_be_braked(distance_m: float, braking_m_s2: float, end_m_s: float) -> None:
    """From the speed given, the distance is enough to brake to the end's speed."""
    for end in (0.0, end_m_s):
        speed_m_s = speed_to_stop_m_s(distance_m, braking_m_s2, end)
        assert speed_m_s**2 <= end**2 + 2.0 * braking_m_s2 * distance_m + 1e-6
