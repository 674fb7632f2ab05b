"""Slow passes within a flight: their speed, the way on which it brakes, and all else as it was."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from shapely.geometry import box

from planner.airspace.values import STILL_AIR
from planner.check.times import edges_s
from planner.dubins.path import Path, Segment
from planner.profile.flight import Flight, Stretch, whole_flight
from planner.profile.heights import Heights
from planner.profile.slowed import slowed
from planner.profile.times import rotor_times
from planner.route import CollectPass, Pose, Slow
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.manners import Manners, manners_of

ROTOR = Manners(2.5, 1.5, 2.5, 1.0, 1.0, 0.5, 10.0)
CRUISE_M_S, SLOW_M_S, BRAKING_M = 8.0, 2.0, 20.0


def times(stretches: list[Stretch]) -> list[float]:
    """Of an aircraft at 8 m/s."""
    return rotor_times(stretches, CRUISE_M_S, ROTOR)


def flown(before_m: float, slow: Slow | None) -> tuple[Flight, Flight]:
    """A straight, a pass of 60 m and 100 m behind it at 50 m: as it would be, and with the pass slowed."""
    ends_m = (0.0, before_m, before_m + 60.0, before_m + 160.0)
    pieces = [
        Segment("straight", Pose(begin_m, 0.0, 0.0), end_m - begin_m)
        for begin_m, end_m in itertools.pairwise(ends_m)
    ]
    whole_m = ends_m[-1]
    heights = Heights(((0.0, 50.0), (whole_m, 50.0)))
    spans_m = [(ends_m[1], ends_m[2])]
    flight = whole_flight(
        Path(tuple(pieces)), heights, (0.0, 0.0, whole_m, whole_m), spans_m, 0.0, times, 10.0
    )
    footprint = box(ends_m[1], -20.0, ends_m[2], 20.0)
    collect = CollectPass(
        ("R",), "eye", "down", (ends_m[1], 0.0), (ends_m[2], 0.0), 0.0, footprint, 10.0, slow=slow
    )
    return flight, slowed(flight, [collect], spans_m, times)


@pytest.mark.parametrize("before_m", [200.0, 22.0])
def test_a_slow_pass_is_flown_at_its_speed_and_braked_for_before(before_m: float) -> None:
    """60 m at 2 m/s take 30 s; the straight before is slow where it brakes, all of it where that is short."""
    whole, slow = flown(before_m, Slow(SLOW_M_S, BRAKING_M))
    (_, begun_s), (_, ended_s) = slow.along(before_m), slow.along(before_m + 60.0)
    assert ended_s - begun_s == pytest.approx(60.0 / SLOW_M_S)
    told = [(s.at_m, s.ground_m, s.most_m_s) for s in slow.stretches if s.ground_m > 0.0]
    cut_m = before_m - BRAKING_M if before_m > 100.0 else 0.0
    slow_from_m = min(at_m for at_m, _, most_m_s in told if most_m_s == SLOW_M_S)
    assert slow_from_m == pytest.approx(cut_m)
    assert {at_m for at_m, _, most_m_s in told if math.isinf(most_m_s)} >= {before_m + 60.0}
    assert slow.length_m == pytest.approx(whole.length_m)
    assert slow.path == whole.path
    assert sum(length_m for _, length_m, _ in told) == pytest.approx(whole.path.length_m)
    assert slow.duration_s > whole.duration_s + 60.0 / SLOW_M_S - 60.0 / CRUISE_M_S


def test_a_flight_without_slow_passes_stays_as_it_is() -> None:
    """The same flight."""
    whole, slow = flown(200.0, None)
    assert slow is whole


def test_the_judge_reckons_with_the_speeds_told() -> None:
    """By its own way of counting an edge of 60 m at 2 m/s takes 30 s, and those beside it what they took."""
    uav = Aircraft("uav", "multirotor", "ardupilot", CRUISE_M_S, 2.0)
    assert manners_of(uav).accel_m_s2 > 0.0
    line_m = np.array([[0.0, 0.0], [200.0, 0.0], [260.0, 0.0], [400.0, 0.0]])
    altitudes_m = np.full(4, 50.0)
    told_m_s = np.array([np.inf, SLOW_M_S, np.inf])
    found_s = edges_s(line_m, altitudes_m, uav, STILL_AIR, 0.0, told_m_s)
    plain_s = edges_s(line_m, altitudes_m, uav, STILL_AIR, 0.0)
    assert found_s[1] == pytest.approx(30.0)
    assert (found_s[[0, 2]] > plain_s[[0, 2]]).all()
    assert (found_s[[0, 2]] < plain_s[[0, 2]] + 3.0).all()
