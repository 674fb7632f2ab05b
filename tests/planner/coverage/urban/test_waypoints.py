"""Joins of sweeps: left, right or over obstacles by equations 7 and 8, judged by shapely."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Point, box

from planner.coverage.urban.area import Building, UrbanArea
from planner.coverage.urban.free import free_space
from planner.coverage.urban.majeed import Majeed2019, least_gap, with_gap
from planner.coverage.urban.measures import measure
from planner.coverage.urban.waypoints import Joiner
from planner.errors import InfeasibleError
from tests.planner.coverage.urban.shapes import SHAPES, random_area, unseen


def one_box(height_m: float, **changes: float) -> UrbanArea:
    """A building 40 m wide and 100 m deep in a wide area: enlarged, from 90 to 150 m and from 50 to 170 m."""
    values = {"height_m": 25.0, "max_height_m": 150.0, "clearance_m": 10.0} | changes
    building = Building(box(100, 60, 140, 160), height_m)
    return UrbanArea(box(0, 0, 240, 220), (building,), 20.0, 30.0, start=(5, 5), end=(5, 5), **values)


def eq8(
    a: tuple[float, float], c: tuple[float, float], d: tuple[float, float], b: tuple[float, float]
) -> float:
    return math.dist(a, c) + math.dist(c, d) + math.dist(d, b)


def test_the_way_round_a_box_is_the_lesser_sum_of_equation_8() -> None:
    """Past a tall box: three pieces over its two corners on the nearer side."""
    joiner = Joiner.among(one_box(250.0), free_space(one_box(250.0)))
    a, b = (90.0, 130.0), (150.0, 125.0)
    join = joiner.join(a, b)
    left, right = eq8(a, (90, 170), (150, 170), b), eq8(a, (90, 50), (150, 50), b)
    assert join.avoidance == "left"
    assert join.length_m == pytest.approx(min(left, right), abs=1e-3)
    assert joiner.join(b, a).avoidance == "right"


def test_a_low_obstacle_is_flown_over_where_that_is_shorter() -> None:
    """d_top: 15 m up, 60 m over, 15 m down for a building 30 m high; the highest height is kept."""
    urban = one_box(30.0)
    join = Joiner.among(urban, free_space(urban)).join((90.0, 110.0), (150.0, 110.0))
    assert join.avoidance == "top"
    assert join.length_m == pytest.approx(15.0 + 60.0 + 15.0, abs=0.05)
    assert join.line[:, 2].max() == 40.0
    capped = replace(urban, max_height_m=39.0)
    assert Joiner.among(capped, free_space(capped)).join((90.0, 110.0), (150.0, 110.0)).avoidance != "top"


def test_a_climb_that_is_too_steep_is_not_flown() -> None:
    """An aircraft that climbs at ten degrees goes round what stands close before it."""
    urban = replace(one_box(30.0), max_climb_rad=math.radians(10.0))
    assert Joiner.among(urban, free_space(urban)).join((90.0, 110.0), (150.0, 110.0)).avoidance != "top"


@pytest.mark.parametrize("shape", SHAPES)
def test_the_whole_flight_sees_everything_and_hits_nothing(shape: str) -> None:
    """From start to end: no place unseen, in the area, over or clear of every building by D_safe."""
    urban = random_area(shape, 11)
    free = free_space(urban)
    flown = Majeed2019()(urban)
    assert unseen(flown.sweeps, free.ground, 20.0, 15.0, 2.0) == 0
    assert measure(urban, free, flown).coverage == pytest.approx(1.0, abs=1e-6)
    assert flown.line[0, :2] == pytest.approx(urban.start)
    assert flown.line[-1, :2] == pytest.approx(urban.end)
    for before, after in zip(flown.line[:-1], flown.line[1:], strict=True):
        low_m = min(before[2], after[2])
        piece = LineString([before[:2], after[:2]]) if math.dist(before[:2], after[:2]) else Point(before[:2])
        assert urban.area.covers(piece)
        assert max(before[2], after[2]) <= 150.0
        near = [b for b in urban.buildings if b.outline.convex_hull.distance(piece) < 10.0 - 5e-3]
        # level over them, or straight up and down beside them: never lower than D_safe above
        assert all(b.height_m + 10.0 <= low_m + 1e-6 for b in near)


def test_highs_orders_the_same_sweeps() -> None:
    """By HiGHS the same ground is swept by the same sweeps."""
    urban = random_area("rectangle", 11)
    ants, highs = Majeed2019()(urban), Majeed2019("highs")(urban)
    ends = [sorted(sorted((s.start, s.end)) for s in flown.sweeps) for flown in (ants, highs)]
    assert ends[0] == ends[1]


def test_patterns_fly_each_sweep_once_with_their_gap() -> None:
    """Back and forth skips g - 1 sweeps; zamboni goes g on and g - 1 back."""
    assert list(with_gap(5, 1, "zamboni")) == [0, 1, 2, 3, 4]
    assert list(with_gap(7, 2, "back-and-forth")) == [0, 2, 4, 6, 5, 3, 1]
    assert list(with_gap(7, 3, "zamboni"))[:6] == [0, 3, 1, 4, 2, 5]
    for count in range(1, 20):
        for gap in (2, 3):
            for pattern in ("back-and-forth", "zamboni"):
                assert sorted(with_gap(count, gap, pattern)) == list(range(count))


def test_a_fixed_wing_turns_with_its_radius() -> None:
    """Lanes of an open area joined by turns of 18 m: tangent, no tighter, with the gap that takes them."""
    urban = replace(one_box(8.0), turn_radius_m=18.0)
    assert least_gap(urban) == 2
    flown = Majeed2019()(urban)
    assert flown.turns is not None
    steps = np.diff(flown.line[:, :2], axis=0)
    lengths = np.hypot(*steps.T)
    turn = np.abs((np.diff(np.arctan2(steps[:, 1], steps[:, 0])) + np.pi) % (2 * np.pi) - np.pi)
    tightest = np.max(turn / np.maximum((lengths[1:] + lengths[:-1]) / 2.0, 1e-9))
    assert tightest < 1.0 / 18.0 * 1.05 + 1e-6
    assert measure(urban, free_space(urban), flown).coverage == pytest.approx(1.0, abs=1e-6)


def test_a_turn_that_finds_no_room_is_refused() -> None:
    """A wide turn between tall buildings is an error that names the radius and the place."""
    walls = [Building(box(x, 20, x + 10, 200), 250.0) for x in (60, 100, 140, 180)]
    urban = replace(one_box(8.0), buildings=tuple(walls), turn_radius_m=60.0, clearance_m=5.0)
    with pytest.raises(InfeasibleError) as error:
        Majeed2019()(urban)
    assert error.value.constraint == "turn-radius"
    assert error.value.where_enu_m is not None
    assert shapely.Point(error.value.where_enu_m).within(urban.area)
