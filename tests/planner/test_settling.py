"""What is flown straight is kept clear: the settling run before each collect, and the collect."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from pyproj import Transformer
from shapely.affinity import rotate
from shapely.geometry import LineString, Point, Polygon, box

from planner.check import judge
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from tests.planner.scenarios import feature

LON, LAT = 8.5, 47.0
METHODS = ("joint", "li2018", "li2018-threat-aware")
#: Of the sensor below from 500 m: where its strip begins and ends beside the track, and half its aperture.
NEAR_M, FAR_M = 500.0 * math.tan(math.radians(30.0)), 500.0 * math.tan(math.radians(60.0))
HALF_APERTURE_M = 500.0 * math.radians(10.0) / math.cos(math.radians(45.0)) / 2.0
RADIUS_M = 100.0

FRAME = Transformer.from_crs(
    "EPSG:4326", f"+proj=aeqd +lat_0={LAT} +lon_0={LON} +datum=WGS84", always_xy=True
)


def degrees(east_m: float, north_m: float) -> list[float]:
    """Longitude and latitude of a place near the middle."""
    return [float(value) for value in FRAME.transform(east_m, north_m, direction="INVERSE")]


def polygon(name: str, role: str, shape: Polygon, **properties: object) -> dict[str, object]:
    """A polygon of the local frame as a feature."""
    ring = [degrees(east, north) for east, north in shape.exterior.coords]
    return feature(name, role, "Polygon", [ring], **properties)


def document(
    settle_m: float, half_m: float, *more: dict[str, object], routing: str = "joint"
) -> dict[str, object]:
    """One square region, seen by one pass on the way from west to east or by one across it."""
    return {
        "type": "FeatureCollection",
        "features": [
            polygon("R", "roi", box(-half_m, -half_m, half_m, half_m)),
            feature("start", "start", "Point", degrees(-2500.0, 0.0)),
            feature("end", "end", "Point", degrees(2500.0, 0.0)),
            *more,
        ],
        "vehicles": [
            {"name": "uav", "airspeed_m_s": 20, "min_turn_radius_m": RADIUS_M, "settle_m": settle_m}
        ],
        "sensors": [
            {
                "name": "sar",
                "type": "sar",
                "incidence_deg": 45,
                "elevation_beamwidth_deg": 30,
                "azimuth_beamwidth_deg": 10,
                "look": "both",
            }
        ],
        "altitude_m": 500,
        "method": {"routing": routing},
    }


def flown(plan: Plan) -> LineString:
    """The path, by a projection of the test's own."""
    return LineString([FRAME.transform(lon, lat) for lon, lat, _ in plan.paths[0].line])


def straight_runs(plan: Plan, settle_m: float) -> list[LineString]:
    """Settling run and collect of each collect."""
    runs = []
    for collect in plan.collects:
        (east0, north0), (east1, north1) = (FRAME.transform(lon, lat) for lon, lat, _ in collect.line)
        scale = settle_m / math.hypot(east1 - east0, north1 - north0)
        begin = (east0 - scale * (east1 - east0), north0 - scale * (north1 - north0))
        runs.append(LineString([begin, (east1, north1)]))
    return runs


@pytest.mark.parametrize("routing", METHODS)
@pytest.mark.parametrize("seed", range(4))
def test_settling_runs_keep_out_of_hard_zones(routing: str, seed: int) -> None:
    """A disc or polygon put on the run to the pass otherwise flown is kept out of, with as long a run."""
    rng = np.random.default_rng(seed)
    settle_m, half_m = float(rng.uniform(150.0, 900.0)), float(rng.uniform(20.0, 280.0))
    free = make_plan(read_scenario(document(settle_m, half_m, routing=routing)))
    place = straight_runs(free, settle_m)[0].interpolate(float(rng.uniform(0.0, settle_m)))
    size_m = float(rng.uniform(10.0, 120.0))
    if seed % 2:
        shape = rotate(box(-size_m, -20.0, size_m, 20.0), float(rng.uniform(0.0, 180.0)))
        shape = Polygon([(x + place.x, y + place.y) for x, y in shape.exterior.coords])
        zone = polygon("Z", "no_fly", shape)
    else:
        shape = Point(place).buffer(size_m, quad_segs=64)
        zone = feature(
            "Z", "threat", "Point", degrees(place.x, place.y), model="missile", radius_m=size_m, hard=True
        )
    if shape.distance(Point(-2500.0, 0.0)) < 50.0:
        pytest.skip("the zone holds the start")
    plan = make_plan(read_scenario(document(settle_m, half_m, zone, routing=routing)))
    assert plan.violations == ()
    line = flown(plan)
    assert line.intersection(shape.buffer(-0.05)).is_empty
    for run in straight_runs(plan, settle_m):
        assert line.buffer(0.1).covers(run)


def some_pass(area: Polygon, half_m: float, settle_m: float) -> bool:
    """Whether a straight run and pass of some heading, with room to turn at both ends, fit in an area.

    Brute force over headings and offsets by the geometry of a strip beside the track.
    """
    inner = area.buffer(-5.0)
    turning = area.buffer(-RADIUS_M * 1.02 - 5.0)
    corners = np.array([(-half_m, -half_m), (half_m, -half_m), (half_m, half_m), (-half_m, half_m)])
    for heading in np.arange(0.0, 2.0 * math.pi, math.radians(1.0)):
        ahead, left = (
            np.array([math.cos(heading), math.sin(heading)]),
            np.array([-math.sin(heading), math.cos(heading)]),
        )
        x, y = corners @ ahead, corners @ left
        spare_m = FAR_M - NEAR_M - (y.max() - y.min())
        for share in (0.05, 0.5, 0.95) if spare_m > 0.0 else ():
            across_m = y.max() + NEAR_M + share * spare_m
            begin = (x.min() - HALF_APERTURE_M - settle_m) * ahead + across_m * left
            end = (x.max() + HALF_APERTURE_M) * ahead + across_m * left
            if not inner.covers(LineString([begin, end])):
                continue
            if all(
                any(turning.covers(Point(p + s * RADIUS_M * left)) for s in (1, -1)) for p in (begin, end)
            ):
                return True
    return False


@pytest.mark.parametrize("routing", ["joint", "li2018"])
@pytest.mark.parametrize("seed", range(8))
def test_settling_runs_stay_in_the_area_and_what_can_be_flown_is(routing: str, seed: int) -> None:
    """In areas of random shape and turn all that is flown stays inside, and nothing possible is refused."""
    rng = np.random.default_rng(100 + seed)
    settle_m, half_m = float(rng.uniform(200.0, 1200.0)), float(rng.uniform(20.0, 250.0))
    long_m, wide_m = float(rng.uniform(800.0, 2200.0)), float(rng.uniform(700.0, 1300.0))
    area = rotate(box(-long_m, -wide_m, long_m, wide_m), float(rng.uniform(0.0, 180.0)), origin=(0.0, 0.0))
    asked = document(settle_m, half_m, polygon("area", "area", area), routing=routing)
    for terminal, east_m in ((asked["features"][1], -50.0), (asked["features"][2], 50.0)):
        terminal["geometry"]["coordinates"] = degrees(east_m, 0.0)
    try:
        plan = make_plan(read_scenario(asked))
    except InfeasibleError:
        assert not some_pass(area, half_m, settle_m)
        return
    assert plan.violations == ()
    line = flown(plan)
    assert area.buffer(0.1).covers(line)
    for run in straight_runs(plan, settle_m):
        assert line.buffer(0.1).covers(run)


def test_the_judge_finds_runs_that_are_too_short_or_not_straight() -> None:
    """A plan made for less straight flight does not do for more; made for more it does for less."""
    scenario = read_scenario(document(300.0, 100.0))
    plan = make_plan(scenario)
    for settle_m, sound in ((0.0, True), (299.9, True), (1500.0, False)):
        aircraft = tuple(replace(one, settle_m=settle_m) for one in scenario.aircraft)
        violations = judge(replace(scenario, aircraft=aircraft), plan).violations
        assert [v.constraint for v in violations] == ([] if sound else ["settling"]), settle_m


@pytest.mark.parametrize("seed", range(6))
def test_directions_of_small_aircraft_are_met_and_not_blamed(seed: int) -> None:
    """Whatever the turn radius, a plan with directions at both ends has no violation, and they are flown."""
    rng = np.random.default_rng(seed)
    radius_m = float(np.exp(rng.uniform(math.log(2.0), math.log(60.0))))
    headings = rng.uniform(0.0, 360.0, 2).tolist()
    asked = json.loads(json.dumps(document(0.0, 80.0)))
    asked["vehicles"] = [{"name": "uav", "airspeed_m_s": 12, "min_turn_radius_m": radius_m}]
    for terminal, heading in zip(asked["features"][1:3], headings, strict=True):
        terminal["properties"]["heading_deg"] = heading
    plan = make_plan(read_scenario(asked))
    assert plan.violations == ()
    line = np.array(flown(plan).coords)
    for edge, heading in ((line[1] - line[0], headings[0]), (line[-1] - line[-2], headings[1])):
        off_rad = math.remainder(math.atan2(edge[0], edge[1]) - math.radians(heading), math.tau)
        # Half of what an arc turns over its first chord.
        turned_rad = math.hypot(*edge) / (2.0 * radius_m) if math.hypot(*edge) <= 10.0 else 0.0
        assert abs(off_rad) <= turned_rad + math.radians(0.5)


def test_the_judge_finds_directions_that_are_not_met() -> None:
    """A plan judged for another direction at the start, a few degrees off, is blamed."""
    asked = document(0.0, 80.0)
    asked["features"][1]["properties"]["heading_deg"] = 80.0
    scenario = read_scenario(asked)
    plan = make_plan(scenario)
    assert scenario.start.angle_rad is not None
    for off_deg, sound in ((0.0, True), (6.0, False), (-6.0, False)):
        start = replace(scenario.start, angle_rad=scenario.start.angle_rad + math.radians(off_deg))
        violations = judge(replace(scenario, start=start), plan).violations
        assert [v.constraint for v in violations] == ([] if sound else ["continuity"])
