"""Zones against shapely on finely sampled lines."""

from __future__ import annotations

import dataclasses
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, MultiPoint, MultiPolygon, Point, Polygon, box

from planner.airspace.values import NoFlyZone, Obstacle, Threat
from planner.airspace.zones import TOUCH_M, Disc, KeepOut, PolygonZone, keep_out
from planner.dubins.path import Path, Segment
from planner.dubins.words import shortest
from planner.frames import LocalFrame
from planner.route import Pose, Terminal
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.vehicle.aircraft import Aircraft

coordinate = st.floats(-600.0, 600.0)
lines = st.builds(
    lambda start, goal: shortest(start, goal, 100.0),
    st.builds(Pose, coordinate, coordinate, st.floats(-3.0, 3.0)),
    st.builds(Pose, coordinate, coordinate, st.floats(-3.0, 3.0)),
)
hulls = st.lists(st.tuples(coordinate, coordinate), min_size=3, max_size=8).map(
    lambda points: MultiPoint(points).convex_hull
)
polygons = hulls.filter(lambda hull: hull.geom_type == "Polygon" and hull.area > 1.0)


def sampled(path: Path) -> LineString:
    """Points on the line at most 5 cm off it between neighbours."""
    points = path.sample(2.0, 2.0)[:, :2]
    return LineString(points if len(points) > 1 else np.repeat(points, 2, axis=0))


def deepest_m(path: Path, zone: Polygon) -> float:
    """Depth of the deepest sampled point inside the polygon, by shapely."""
    points = [Point(*p) for p in path.sample(2.0, 2.0)[:, :2]]
    return max((zone.exterior.distance(p) for p in points if zone.contains(p)), default=0.0)


@settings(deadline=None)
@given(lines, coordinate, coordinate, st.floats(1.0, 400.0))
def test_disc_depth_is_the_distance_to_the_line(path: Path, east_m: float, north_m: float, r: float) -> None:
    """A disc is entered as deep as shapely's distance from its centre to the sampled line says."""
    depth_m = r - sampled(path).distance(Point(east_m, north_m))
    zones = KeepOut((Disc("d", east_m, north_m, r, True),))
    conflict = zones.conflict(path)
    if conflict is None:
        assert depth_m < 0.01
        assert zones.clear(path)
    else:
        assert not zones.clear(path)
        assert conflict.depth_m == pytest.approx(depth_m, abs=0.01)
        assert r - math.dist(conflict.where, (east_m, north_m)) == pytest.approx(conflict.depth_m, abs=1e-6)


# GEOS raises the floating-point flag on odd shapes; what it gives back is held against the line itself.
@pytest.mark.filterwarnings("ignore:invalid value encountered in buffer:RuntimeWarning")
@settings(deadline=None)
@given(lines, polygons)
def test_polygon_conflict_is_shapelys(path: Path, polygon: Polygon) -> None:
    """A polygon is entered when, where and as deep as shapely finds on the sampled line."""
    conflict = KeepOut((), (PolygonZone("p", polygon, True),)).conflict(path)
    depth_m = deepest_m(path, polygon)
    if conflict is None:
        assert depth_m <= TOUCH_M + 1e-9
    else:
        assert conflict.depth_m >= depth_m - 0.01
        where = Point(*conflict.where)
        assert polygon.distance(where) < 1e-6
        assert polygon.exterior.distance(where) == pytest.approx(conflict.depth_m, abs=1e-6)
        assert sampled(path).distance(where) < 0.01


@settings(deadline=None)
@given(lines, polygons)
def test_leaving_the_area_is_shapelys(path: Path, polygon: Polygon) -> None:
    """A line leaves the area when shapely says that a sampled point is not within it."""
    conflict = KeepOut(area=polygon).conflict(path)
    outside_m = max(polygon.distance(Point(*p)) for p in path.sample(2.0, 2.0)[:, :2])
    if conflict is None:
        assert outside_m <= TOUCH_M + 1e-9
    else:
        assert conflict.zone == "area"
        assert conflict.hard
        assert polygon.distance(Point(*conflict.where)) == pytest.approx(conflict.depth_m, abs=1e-6)
        assert conflict.depth_m >= outside_m - 0.01


def test_holes_are_free() -> None:
    """A line in the hole of a polygon is clear, one through its rim is not."""
    ring = PolygonZone("ring", box(-500, -500, 500, 500).difference(box(-400, -400, 400, 400)), True)
    zones = KeepOut((), (ring,))
    assert zones.clear(Path((Segment("left", Pose(0.0, -100.0, 0.0), 628.0, 100.0),)))
    conflict = zones.conflict(Path((Segment("straight", Pose(0.0, 0.0, 0.0), 460.0),)))
    assert conflict is not None
    assert conflict.depth_m == pytest.approx(50.0, abs=2.0)


def test_touching_is_clear() -> None:
    """Lines along an edge and arcs along a circle are clear; a centimetre further in they are not."""
    zones = KeepOut((Disc("d", 0.0, 0.0, 200.0, True),), (PolygonZone("p", box(300, -50, 400, 50), True),))
    round_disc = Path((Segment("left", Pose(0.0, -200.0, 0.0), 1000.0, 200.0),))
    along_edge = Path((Segment("straight", Pose(300.0, -200.0, math.pi / 2), 400.0),))
    assert zones.clear(round_disc)
    assert zones.clear(along_edge)
    assert not zones.clear(Path((Segment("left", Pose(0.0, -199.99, 0.0), 1000.0, 199.99),)))
    assert not zones.clear(Path((Segment("straight", Pose(300.01, -200.0, math.pi / 2), 400.0),)))


def test_worst_first_and_without() -> None:
    """Hard zones come before deeper soft ones, and a zone taken away no longer counts."""
    zones = KeepOut(
        (Disc("soft", 500.0, 0.0, 300.0, False), Disc("hard", 1500.0, 0.0, 100.0, True)),
        area=box(-100, -100, 3000, 100),
    )
    path = Path((Segment("straight", Pose(0.0, 0.0, 0.0), 2000.0),))
    assert [c.zone for c in zones.conflicts(path)] == ["hard", "soft"]
    conflict = zones.without({"hard"}).conflict(path)
    assert conflict is not None
    assert conflict.zone == "soft"
    assert conflict.where == pytest.approx((500.0, 0.0))
    assert zones.without({"hard", "soft"}).clear(path)
    assert pickle.loads(pickle.dumps(zones)) == zones


def scenario() -> Scenario:
    """All kinds of zones, flown at 500 m above home."""
    return Scenario(
        name="s",
        frame=LocalFrame(10.0, 50.0),
        regions=(),
        aircraft=(Aircraft("a", "fixed_wing", "px4", 20.0, 100.0),),
        sensors=(SarSensor("sar", math.radians(45), math.radians(30), math.radians(10)),),
        start=Terminal("start", (0.0, 0.0)),
        end=Terminal("end", (0.0, 0.0)),
        altitude_m=500.0,
        altitude_reference="home",
        area=box(-1000, -1000, 1000, 1000),
        threats=(
            Threat("soft", "radar", (0.0, 0.0), 100.0),
            Threat("hard", "missile", (10.0, 0.0), 200.0, hard=True),
            Threat("low", "missile", (20.0, 0.0), 300.0, height_m=499.0, hard=True),
        ),
        no_fly=(
            NoFlyZone("disc", None, (30.0, 0.0), 50.0),
            NoFlyZone("band", box(0, 0, 10, 10), floor_m=600.0, ceiling_m=900.0),
        ),
        obstacles=(
            Obstacle("mast", box(0, 0, 2, 2), height_m=480.0),
            Obstacle("shed", box(5, 5, 9, 9), height_m=20.0),
        ),
        clearance_m=30.0,
    )


def test_keep_out_takes_what_counts_at_the_flight_altitude() -> None:
    """Low threats, low obstacles and bands above or below the flight do not count, in either datum."""
    asked = dataclasses.replace(scenario(), clearance_m=0.0)
    zones = keep_out(asked.airspace, asked.level)
    assert [disc.name for disc in zones.discs] == ["soft", "hard", "disc"]
    assert [disc.hard for disc in zones.discs] == [False, True, True]
    assert [zone.name for zone in zones.polygons] == []
    assert [disc.name for disc in keep_out(asked.airspace, asked.level, soft=False).discs] == ["hard", "disc"]
    high = dataclasses.replace(asked, home_amsl_m=200.0)
    assert [zone.name for zone in keep_out(high.airspace, high.level).polygons] == ["band"]
    amsl = dataclasses.replace(asked, altitude_reference="amsl", home_amsl_m=460.0)
    assert [zone.name for zone in keep_out(amsl.airspace, amsl.level).polygons] == ["mast"]
    assert "low" in [disc.name for disc in keep_out(amsl.airspace, amsl.level).discs]


def test_what_is_kept_counts_over_and_under_too() -> None:
    """With 30 m kept a threat, a mast and a band count as much higher and lower, a soft threat does not."""
    zones = keep_out(scenario().airspace, scenario().level)
    radii_m = {disc.name: disc.radius_m for disc in zones.discs}
    assert radii_m == {"soft": 100.0, "hard": 230.0, "low": 330.0, "disc": 80.0}
    assert [zone.name for zone in zones.polygons] == ["mast"]
    under = dataclasses.replace(scenario(), home_amsl_m=71.0)
    assert [zone.name for zone in keep_out(under.airspace, under.level).polygons] == ["band", "mast"]
    low = dataclasses.replace(scenario(), altitude_reference="amsl", home_amsl_m=460.0)
    assert [zone.name for zone in keep_out(low.airspace, low.level).polygons] == ["mast", "shed"]
    far_under = dataclasses.replace(scenario(), home_amsl_m=69.0)
    assert [zone.name for zone in keep_out(far_under.airspace, far_under.level).polygons] == ["mast"]


def test_margins_hold_the_buffered_shapes() -> None:
    """With a margin discs grow, polygons hold shapely's round buffer, the area shrinks into its inverse."""
    asked = scenario()
    asked = dataclasses.replace(asked, home_amsl_m=200.0)
    zones = keep_out(asked.airspace, asked.level, margin_m=15.0)
    assert zones.discs[0].radius_m == 115.0
    band, mast = (zone.polygon for zone in zones.polygons)
    assert band.buffer(1e-9).covers(asked.no_fly[1].area.buffer(45.0))
    assert mast.buffer(1e-9).covers(asked.obstacles[0].area.buffer(45.0))
    assert zones.area is not None
    assert zones.area.equals(box(-985, -985, 985, 985))


def test_seam_between_adjoining_zones_is_closed() -> None:
    """A line along the edge that two polygons share, or along one on the area's edge, enters them."""
    zones = KeepOut(
        (),
        (PolygonZone("north", box(0, 0, 100, 100), True), PolygonZone("south", box(0, -100, 100, 0), False)),
        box(-200, -300, 300, 100),
    )
    along_seam = Path((Segment("straight", Pose(-50.0, 0.0, 0.0), 200.0),))
    assert [conflict.zone for conflict in zones.conflicts(along_seam)] == ["north", "south"]
    along_area = Path((Segment("straight", Pose(-50.0, 100.0, 0.0), 200.0),))
    conflict = zones.conflict(along_area)
    assert conflict is not None
    assert conflict.zone == "north"
    assert zones.without({"north"}).clear(along_seam)


def test_area_of_two_parts() -> None:
    """In an area of two parts each part is free, and what lies between them is not."""
    zones = KeepOut(area=MultiPolygon([box(0, 0, 100, 100), box(200, 0, 300, 100)]))
    assert zones.area_edges().shape == (8, 4)
    for east_m, length_m, free in ((10.0, 80.0, True), (210.0, 80.0, True), (10.0, 280.0, False)):
        assert zones.clear(Path((Segment("straight", Pose(east_m, 50.0, 0.0), length_m),))) is free
