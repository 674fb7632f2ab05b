"""The free space of an area among obstacles, against geometry of the test's own."""

import numpy as np
import pytest
import shapely
from shapely.geometry import Point, Polygon, box

from planner.coverage.urban.area import Building, UrbanArea
from planner.coverage.urban.free import enlarged, free_space
from planner.errors import InfeasibleError


def urban(*buildings: Building, area: Polygon | None = None, **changes: float) -> UrbanArea:
    values = {"height_m": 25.0, "max_height_m": 150.0, "clearance_m": 10.0, "span_m": 1.0} | changes
    where = box(0, 0, 400, 300) if area is None else area
    return UrbanArea(where, buildings, 20.0, 30.0, start=(1.0, 1.0), end=(1.0, 1.0), **values)


def test_free_ground_keeps_the_clearance_and_the_span() -> None:
    """Every free place is at least D_safe from each hull and half the span from the edge."""
    corner = Polygon([(150, 100), (260, 100), (260, 140), (190, 140), (190, 200), (150, 200)])
    asked = urban(Building(corner, 60.0))
    ground = free_space(asked).ground
    assert ground.distance(corner.convex_hull) == pytest.approx(10.0, abs=1e-6)
    assert ground.distance(asked.area.boundary) == pytest.approx(0.5, abs=1e-6)
    raster = shapely.points(np.random.default_rng(1).uniform((1, 1), (399, 299), (4000, 2)))
    far = [p for p in raster if p.distance(corner.convex_hull) > 10.0 * 2.0**0.5 + 1e-6]
    assert all(ground.covers(p) for p in far)


def test_what_is_low_is_no_obstacle() -> None:
    """A building that the sweeps clear by D_safe takes no ground away; one metre more does."""
    outline = box(100, 100, 200, 200)
    whole = free_space(urban()).ground
    assert free_space(urban(Building(outline, 15.0))).ground.equals(whole)
    assert free_space(urban(Building(outline, 16.0))).ground.area < whole.area - 100.0**2


def test_near_obstacles_are_one_cluster_as_high_as_the_highest() -> None:
    """Gaps narrower than the aircraft are none; wider ones are flown through."""
    left, right = Building(box(100, 100, 150, 200), 30.0), Building(box(170.8, 100, 220, 200), 90.0)
    joined = free_space(urban(left, right)).clusters
    assert [cluster.top_m for cluster in joined] == [90.0]
    apart = Building(box(171.2, 100, 220, 200), 90.0)
    assert sorted(cluster.top_m for cluster in free_space(urban(left, apart)).clusters) == [30.0, 90.0]


def test_enclosed_ground_is_reached_over_what_is_low_enough() -> None:
    """A yard inside a ring of buildings is free where they may be climbed over, else left out and said."""
    ring = [box(100, 50, 300, 70), box(100, 230, 300, 250), box(100, 50, 120, 250), box(280, 50, 300, 250)]
    yard = Point(200, 150)
    low = free_space(urban(*(Building(wall, 140.0) for wall in ring)))
    assert low.ground.covers(yard)
    assert low.unreached_m2 == 0.0
    tall = free_space(urban(*(Building(wall, 141.0) for wall in ring)))
    assert not tall.ground.intersects(yard)
    assert tall.unreached_m2 == pytest.approx(140.0 * 140.0, rel=1e-6)


def test_an_area_that_is_full_is_refused_with_the_height_that_works() -> None:
    """Obstacles that fill the area are an error that names the height over them, or what else would do."""
    with pytest.raises(InfeasibleError) as low:
        free_space(urban(Building(box(-10, -10, 410, 310), 100.0)))
    assert "110 m" in low.value.relaxation
    with pytest.raises(InfeasibleError) as tall:
        free_space(urban(Building(box(-10, -10, 410, 310), 200.0)))
    assert "210 m" in tall.value.relaxation


def test_a_start_within_an_obstacle_is_refused() -> None:
    """The start is named where it lies too far from free ground."""
    with pytest.raises(InfeasibleError) as error:
        free_space(urban(Building(box(-50, -50, 100, 100), 100.0)))
    assert error.value.feature == "start"


def test_sharp_hulls_keep_the_clearance() -> None:
    """Where a mitre is cut off, the cut still keeps D_safe."""
    spike = Polygon([(0, 0), (100, 4), (100, -4)])
    assert enlarged(spike, 10.0).exterior.distance(spike) >= 10.0 - 1e-9
