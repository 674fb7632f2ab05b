"""Approach angles of eq 21."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.coverage.strips.choices import choices
from planner.coverage.strips.room import Room
from planner.route import Anchor
from planner.routing.greedy.approach import best_approach, turning_rad
from tests.planner.coverage.shapes import HEIGHT_M, as_merged, box, paper_sensor

OPEN = Room(None, shapely.MultiPolygon(), shapely.MultiPolygon(), 100.0, 0.0)
ANGLES = st.floats(-math.pi, math.pi)


def turned_between(one: np.ndarray, other: np.ndarray) -> float:
    """Turning angle of eq 7."""
    cosine = float(one @ other) / float(np.linalg.norm(one) * np.linalg.norm(other))
    return math.acos(max(-1.0, min(1.0, cosine)))


@settings(max_examples=100)
@given(ANGLES, st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4)), ANGLES, st.booleans())
def test_turning_is_two_turning_angles(
    leave_rad: float, entry: tuple[float, float], angle_rad: float, free: bool
) -> None:
    """γ + β is the sum of eq 7's angles at both ends of the connecting line; a free start has no γ."""
    if math.hypot(*entry) < 1.0:
        return
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    line = np.array([entry, np.array(entry) + 500.0 * ahead])
    expected = turned_between(np.array(entry), ahead)
    if not free:
        expected += turned_between(np.array([math.cos(leave_rad), math.sin(leave_rad)]), np.array(entry))
    found = turning_rad(Anchor(0.0, 0.0, None if free else leave_rad), line[None])
    assert found[0] == pytest.approx(expected, abs=1e-6)


def test_next_collect_where_the_last_ended() -> None:
    """Where the next collect begins at the last one's end, the turn between the two directions counts."""
    line = np.array([[[10.0, 10.0], [10.0, 500.0]]])
    assert turning_rad(Anchor(10.0, 10.0, 0.0), line)[0] == pytest.approx(math.pi / 2.0)


@pytest.mark.parametrize(
    ("width_m", "depth_m", "look"),
    [(300.0, 300.0, "right"), (1200.0, 400.0, "left"), (850.0, 750.0, "right")],
)
def test_least_of_all_feasible_angles(width_m: float, depth_m: float, look: str) -> None:
    """The chosen angle has the least γ + β of Θ, measured on the passes themselves at η = 0.5."""
    sensor = paper_sensor("left" if look == "left" else "right")
    region = choices(as_merged(box(width_m, depth_m, 0.4)), sensor, HEIGHT_M, OPEN)
    origin = Anchor(-4000.0, 1500.0, 0.2)
    number, index = best_approach(origin, region)
    around = region.sides[number].neighbourhood

    def cost_rad(candidate: int) -> float:
        collect = around.collect(candidate, 0.5)
        return float(turning_rad(origin, np.array([[collect.start, collect.end]]))[0])

    every = [cost_rad(candidate) for candidate in range(len(around.angles_rad))]
    assert cost_rad(index) == pytest.approx(min(every), abs=1e-9)
    assert max(every) > min(every) + 0.1


def test_both_sides_are_compared() -> None:
    """A sensor that looks to both sides is used on the side that turns less."""
    region = as_merged(box(300.0, 300.0))
    origin = Anchor(-4000.0, 1500.0, 1.2)
    costs = {}
    for looks in (("left",), ("right",), ("left", "right")):
        found = choices(region, paper_sensor(*looks), HEIGHT_M, OPEN)  # type: ignore[arg-type]
        number, index = best_approach(origin, found)
        collect = found.sides[number].neighbourhood.collect(index, 0.5)
        costs[looks] = float(turning_rad(origin, np.array([[collect.start, collect.end]]))[0])
    assert costs[("left", "right")] == pytest.approx(min(costs.values()))


def test_only_angles_with_room() -> None:
    """Angles whose collects are graded worse are left out, however little they turn."""
    area = box(300.0, 300.0)
    origin = Anchor(-4000.0, -2000.0, 0.0)
    free = choices(as_merged(area), paper_sensor(), HEIGHT_M, OPEN)
    free_index = best_approach(origin, free)[1]
    line = free.sides[0].neighbourhood.lines(free.etas)[free_index]
    wall = shapely.MultiPoint(line.reshape(-1, 2)).convex_hull.buffer(20.0)
    walled = choices(
        as_merged(area), paper_sensor(), HEIGHT_M, Room(None, wall, shapely.MultiPolygon(), 100.0, 0.0)
    )
    number, index = best_approach(origin, walled)
    assert index != free_index
    lines = walled.sides[number].neighbourhood.lines(walled.etas)[index]
    assert any(not wall.intersects(shapely.LineString(candidate)) for candidate in lines)
