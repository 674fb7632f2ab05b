"""Obstacles as half-planes against shapely's polygons."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import Point, Polygon

from planner.airspace.zones import Disc, KeepOut, PolygonZone
from planner.transit.milp.obstacles import obstacles_of
from planner.transit.milp.values import convex, disc

CENTRE, RADIUS_M = (300.0, -200.0), 150.0


def about(directions: int) -> Polygon:
    """The regular polygon about the disc: 4 (L - 1) sides that touch it, the first to the east."""
    sides = 4 * (directions - 1)
    corner_m = RADIUS_M / math.cos(math.pi / sides)
    angles = 2.0 * math.pi * (np.arange(sides) + 0.5) / sides
    return Polygon(
        np.column_stack([CENTRE[0] + corner_m * np.cos(angles), CENTRE[1] + corner_m * np.sin(angles)])
    )


@pytest.mark.parametrize("printed", [False, True])
@pytest.mark.parametrize("directions", [2, 3, 4, 7])
def test_a_disc_is_the_polygon_about_it(directions: int, printed: bool) -> None:
    """Points are inside where shapely has them inside the regular polygon, by either choice of binaries."""
    obstacle = disc(CENTRE, RADIUS_M, directions, printed=printed)
    assert obstacle.normals.shape == ((directions, 4, 2) if printed else (4 * (directions - 1), 1, 2))
    points = np.random.default_rng(3).uniform(-300.0, 300.0, (4000, 2)) + CENTRE
    inside = shapely.contains_xy(about(directions), points[:, 0], points[:, 1])
    assert np.array_equal(obstacle.depths(points) > 0.0, inside)


def test_four_directions_are_the_printed_angles() -> None:
    """With L = 4 the half-planes are those of eqs 41 to 44 as printed: sines and cosines of (l - 1) π/6."""
    obstacle = disc((0.0, 0.0), 1.0, 4, printed=True)
    for l_number in range(4):
        sine, cosine = math.sin(l_number * math.pi / 6.0), math.cos(l_number * math.pi / 6.0)
        printed = [(sine, cosine), (-sine, -cosine), (sine, -cosine), (-sine, cosine)]
        # (c - w) times these is at least R
        np.testing.assert_allclose(-obstacle.normals[l_number], printed, atol=1e-12)


def test_one_direction_has_two_sides() -> None:
    """With L = 1 a point is outside to the north or to the south alone."""
    obstacle = disc(CENTRE, RADIUS_M, 1)
    depths = obstacle.depths(np.array([[300.0, 0.0], [300.0, -400.0], [900.0, -200.0]]))
    assert depths == pytest.approx([-50.0, -50.0, 150.0])


def test_zones_and_the_area_become_obstacles() -> None:
    """A bent zone, a round one of many corners, a bent area: free are the points that shapely finds free."""
    bent = Polygon([(0, 0), (400, 0), (400, 100), (100, 100), (100, 400), (0, 400)])
    many = Point(-400.0, 300.0).buffer(120.0)
    area = Polygon([(-900, -900), (900, -900), (900, 900), (200, 900), (200, 600), (-900, 600)])
    zones = KeepOut(
        (Disc("d", -300.0, -400.0, 150.0, True),),
        (PolygonZone("bent", bent, True), PolygonZone("many", many, True)),
        area,
    )
    obstacles, box = obstacles_of(zones, ((-800.0, 0.0), (800.0, 0.0)), 0.0, 4)
    assert box == area.bounds
    points = np.random.default_rng(5).uniform(-900.0, 900.0, (6000, 2))
    held = np.max([obstacle.depths(points) for obstacle in obstacles], axis=0) > 0.0
    forbidden = shapely.union_all([bent, many, Point(-300.0, -400.0).buffer(150.0)])
    truly = shapely.contains_xy(forbidden, points[:, 0], points[:, 1])
    truly |= ~shapely.contains_xy(area, points[:, 0], points[:, 1])
    assert held[truly].all()
    # the polygons about what is round are 3.5 % larger at their corners
    near = shapely.distance(forbidden, shapely.points(points)) < 6.0
    assert not held[~truly & ~near].any()


def test_ends_that_touch_a_zone_stay_outside() -> None:
    """An end on a disc, or within the margin of a polygon, is outside the obstacle made of it."""
    ends = ((-100.0 * math.cos(0.26), -100.0 * math.sin(0.26)), (500.0, 0.0))
    zones = KeepOut(
        (Disc("d", 0.0, 0.0, 100.0, True),),
        (PolygonZone("z", shapely.box(501.0, -50.0, 600.0, 50.0), True),),
    )
    obstacles, _ = obstacles_of(zones, ends, 10.0, 4)
    assert all((obstacle.depths(np.array(ends)) <= 1e-9).all() for obstacle in obstacles)
    assert obstacles[0].depths(np.array([[0.0, 0.0]]))[0] > 80.0


def test_convex_polygons_by_their_edges() -> None:
    """A triangle's points are those that shapely has inside it."""
    ring = np.array([(0.0, 0.0), (300.0, 50.0), (100.0, 250.0)])
    points = np.random.default_rng(1).uniform(-50.0, 350.0, (2000, 2))
    inside = shapely.contains_xy(Polygon(ring), points[:, 0], points[:, 1])
    assert np.array_equal(convex(ring).depths(points) > 0.0, inside)
