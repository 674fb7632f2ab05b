"""When a flight lifts off and where it waits, against the obvious reckoning."""

from __future__ import annotations

import math

import pytest

from planner.airspace.values import Wind
from planner.fleet.waiting import Due, holds, least_hold_s, timing
from planner.route import Pose
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.model import FlightModel


def test_the_first_wait_is_spent_on_the_ground() -> None:
    """A window that opens later than the flight could be there puts off the take-off, no circle is flown."""
    found = timing([Due(100.0, 130.0, 500.0, 600.0, 30.0), Due(200.0, 230.0)], 0.0)
    assert found.start_s == pytest.approx(400.0)
    assert found.waits_s == (0.0, 0.0)
    assert found.worst is None


def test_between_two_windows_it_waits_in_the_air_for_no_longer_than_it_must() -> None:
    """The first window closes before a take-off that would need no wait at the second."""
    found = timing([Due(100.0, 130.0, 0.0, 200.0, 30.0), Due(200.0, 230.0, 500.0, 600.0, 30.0)], 0.0)
    assert found.start_s == pytest.approx(70.0)
    assert found.waits_s == (0.0, pytest.approx(230.0))
    assert found.worst is None


def test_a_wait_is_one_whole_circle_at_least() -> None:
    """What would be waited in less time than a circle takes is a circle."""
    found = timing([Due(100.0, 130.0, 0.0, 130.0, 30.0), Due(200.0, 230.0, 210.0, 600.0, 30.0)], 0.0)
    assert found.waits_s == (0.0, 30.0)


def test_visits_of_one_flight_lie_apart() -> None:
    """The second begins so long behind the end of the first."""
    found = timing([Due(100.0, 130.0), Due(150.0, 180.0, held_s=30.0, behind=0, apart_s=400.0)], 0.0)
    second_s = found.start_s + math.fsum(found.waits_s) + 150.0
    assert second_s - (found.start_s + found.waits_s[0] + 130.0) == pytest.approx(400.0)


def test_what_is_late_is_said() -> None:
    """The stop that misses its window most, and by how much."""
    found = timing([Due(100.0, 130.0, 0.0, 120.0), Due(200.0, 230.0, 0.0, 180.0)], 0.0)
    assert (found.worst, found.late_s) == (1, pytest.approx(50.0))


@pytest.mark.parametrize("wind_m_s", [0.0, 8.0])
@pytest.mark.parametrize("wait_s", [40.0, 75.0, 131.0, 900.0])
def test_circles_take_as_long_as_is_waited(wind_m_s: float, wait_s: float) -> None:
    """Round and back to the pose, to either side, no tighter than the aircraft turns."""
    model = FlightModel.of(Aircraft("uav", "fixed_wing", "ardupilot", 20.0, 60.0), Wind(wind_m_s, 0.7))
    pose = Pose(10.0, -20.0, 0.4)
    expected_s = max(wait_s, least_hold_s(model))
    for circles in holds(pose, wait_s, model):
        assert model.duration_s(circles) == pytest.approx(expected_s)
        assert math.dist(circles.end.position, pose.position) < 1e-6
        assert circles.segments[0].radius_m >= model.turn_radius_m
