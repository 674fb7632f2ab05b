"""The SSAS connector: flyable lines between random poses, judged on the sampled line."""

from __future__ import annotations

import json
import math
import random
from dataclasses import replace
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

from planner.airspace.threats import metres_inside
from planner.airspace.values import Threat
from planner.airspace.zones import Disc, KeepOut, PolygonZone, keep_out
from planner.errors import CancelledError, InfeasibleError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.route import Anchor, Terminal
from planner.scenario import Scenario
from planner.transit.ssas_connector import connect
from planner.wishes import Objective

RADIUS_M = 100.1
EXAMPLES = FilePath(__file__).parents[3] / "examples"


@pytest.fixture(scope="module")
def case():
    return read_scenario(json.loads((EXAMPLES / "sar-case-1.geojson").read_text()))


def asked_of(scenario: Scenario) -> dict[str, Any]:
    """What is told of a scenario."""
    return {"threats": scenario.threats, "objective": scenario.objective, "height_m": scenario.height_m}


def empty(**changes):
    place = Terminal("start", (0.0, 0.0))
    scenario = Scenario("empty", LocalFrame(0.0, 0.0), (), (), (), place, place, altitude_m=500.0)
    return replace(scenario, **changes)


def random_pose(rng, scenario, near=None):
    """A pose 500 m inside the area and 200 m outside every threat: room to turn."""
    east0, north0, east1, north1 = scenario.area.bounds
    while True:
        if near is None:
            place = (rng.uniform(east0, east1), rng.uniform(north0, north1))
        else:
            place = (near[0] + rng.uniform(-800.0, 800.0), near[1] + rng.uniform(-800.0, 800.0))
        roomy = scenario.area.buffer(-500.0).contains(Point(place))
        if roomy and all(math.dist(place, t.centre) > t.radius_m + 200.0 for t in scenario.threats):
            return Anchor(*place, rng.uniform(-math.pi, math.pi))


def assert_flyable(start, goal, path, radius_m=RADIUS_M):
    """Ends met in place and direction, joints continuous, no turn too tight."""
    for anchor, pose in ((start, path.start), (goal, path.end)):
        assert pose.position == pytest.approx(anchor.position, abs=1e-6)
        if anchor.angle_rad is not None:
            assert abs(math.remainder(pose.angle_rad - anchor.angle_rad, 2.0 * math.pi)) < 1e-7
    for before, after in pairwise(path.segments):
        assert before.end.position == pytest.approx(after.start.position, abs=1e-6)
        assert abs(math.remainder(before.end.angle_rad - after.start.angle_rad, 2.0 * math.pi)) < 1e-7
    assert all(segment.radius_m >= radius_m - 1e-9 for segment in path.segments)


@pytest.mark.parametrize("near", [False, True], ids=["far", "near"])
def test_random_poses_among_threats(case, near):
    """Any two poses with room to turn are joined: flyable, inside the area, no metre inside a threat."""
    rng = random.Random(3)
    zones = keep_out(case.airspace, case.level)
    for _ in range(100):
        start = random_pose(rng, case)
        goal = random_pose(rng, case, start.position if near else None)
        path, found = connect(start, goal, **asked_of(case), keep_out=zones, radius_m=RADIUS_M)
        assert_flyable(start, goal, path)
        line = path.sample(5.0)[:, :2]
        assert metres_inside(line, case.threats) == 0.0
        assert case.area.contains(LineString(line))
        assert path.length_m <= found.length_m * 1.1


@pytest.mark.parametrize("free_end", ["start", "goal", "both"])
def test_ends_without_direction(case, free_end):
    """Where an end has no direction the search grows from the other; start and end stay what they are."""
    rng = random.Random(4)
    zones = keep_out(case.airspace, case.level)
    for _ in range(40):
        start, goal = random_pose(rng, case), random_pose(rng, case)
        start = Anchor(*start.position) if free_end != "goal" else start
        goal = Anchor(*goal.position) if free_end != "start" else goal
        path, _ = connect(start, goal, **asked_of(case), keep_out=zones, radius_m=RADIUS_M)
        assert_flyable(start, goal, path)
        assert metres_inside(path.sample(5.0)[:, :2], case.threats) == 0.0


@pytest.mark.parametrize("aside_m", [0.0, 50.0, 200.0, 600.0, 750.0, 900.0])
@pytest.mark.parametrize("ahead_m", [-300.0, 0.0, 40.0, 400.0])
@pytest.mark.parametrize("turned_rad", [0.0, math.pi, math.pi / 2.0])
def test_short_and_turning_back(aside_m, ahead_m, turned_rad):
    """Antiparallel passes, ends abreast of each other and poses nearer than a leg are joined."""
    start, goal = Anchor(0.0, 0.0, 0.0), Anchor(ahead_m, aside_m, turned_rad)
    path, _ = connect(start, goal, **asked_of(empty()), keep_out=KeepOut(), radius_m=RADIUS_M)
    assert_flyable(start, goal, path)
    # a turn at 24° per 100 m leg has a radius of 236 m: two full circles and the way are room enough
    assert path.length_m < 2.0 * 2.0 * math.pi * 236.0 + 2.0 * math.dist(start.position, goal.position)


def test_straight_ahead_stays_straight():
    """Poses on one line in their direction are joined by that line, however near."""
    for apart_m in (20.0, 70.0, 180.0):
        path, _ = connect(
            Anchor(0.0, 0.0, 0.0),
            Anchor(apart_m, 0.0, 0.0),
            **asked_of(empty()),
            keep_out=KeepOut(),
            radius_m=RADIUS_M,
        )
        assert path.length_m == pytest.approx(apart_m)


@pytest.mark.parametrize("radius_m", [30.0, 100.0, 250.0, 600.0])
def test_legs_grow_with_the_turn_radius(radius_m):
    """Wide turns get longer legs, so that their arcs fit between the corners."""
    start, goal = Anchor(0.0, 0.0, 0.5), Anchor(9000.0, 4000.0, 2.5)
    path, found = connect(start, goal, **asked_of(empty()), keep_out=KeepOut(), radius_m=radius_m)
    assert_flyable(start, goal, path, radius_m)
    assert path.length_m == pytest.approx(found.length_m, rel=0.03)


def test_hard_zones_are_never_entered():
    """No-fly polygons and discs stay untouched on random pairs, judged by shapely."""
    wall = Polygon([(1900.0, -2500.0), (2100.0, -2500.0), (2100.0, 2000.0), (1900.0, 2000.0)])
    area = Polygon([(-1500.0, -3000.0), (6000.0, -3000.0), (6000.0, 4500.0), (-1500.0, 4500.0)])
    zones = KeepOut((Disc("N", 3500.0, 2500.0, 700.0, True),), (PolygonZone("W", wall, True),), area)
    forbidden = unary_union([wall, Point(3500.0, 2500.0).buffer(699.9, quad_segs=180)])
    rng = random.Random(6)
    for _ in range(40):
        start = Anchor(rng.uniform(-900.0, 1300.0), rng.uniform(-2300.0, 1500.0), rng.uniform(-3.0, 3.0))
        goal = Anchor(rng.uniform(2800.0, 5300.0), rng.uniform(-2300.0, 1000.0), rng.uniform(-3.0, 3.0))
        path, _ = connect(start, goal, **asked_of(empty(area=area)), keep_out=zones, radius_m=RADIUS_M)
        assert_flyable(start, goal, path)
        line = LineString(path.sample(2.0)[:, :2])
        assert not line.intersects(forbidden)
        assert area.contains(line)


def test_a_soft_threat_without_a_way_round_is_crossed():
    """A belt of soft threats across the whole area is crossed; the same belt hard is infeasible."""
    area = Polygon([(-1500.0, -1500.0), (5500.0, -1500.0), (5500.0, 1500.0), (-1500.0, 1500.0)])
    belt = tuple(Threat(f"M{n}", "missile", (2000.0, 500.0 * n), 600.0) for n in range(-3, 4))
    start, goal = Anchor(0.0, 0.0, 0.0), Anchor(4000.0, 0.0, 0.0)
    scenario = empty(area=area, threats=belt)
    path, _ = connect(
        start,
        goal,
        **asked_of(scenario),
        keep_out=keep_out(scenario.airspace, scenario.level),
        radius_m=RADIUS_M,
    )
    assert_flyable(start, goal, path)
    assert metres_inside(path.sample(5.0)[:, :2], belt) > 1000.0
    hard = empty(area=area, threats=tuple(replace(t, hard=True) for t in belt))
    with pytest.raises(InfeasibleError) as caught:
        connect(
            start, goal, **asked_of(hard), keep_out=keep_out(hard.airspace, hard.level), radius_m=RADIUS_M
        )
    assert caught.value.constraint in ("hard-zone", "area")


def test_threats_of_no_weight_do_not_bend_the_line():
    """A threat the objective does not count is flown through."""
    threat = Threat("M", "missile", (2000.0, 0.0), 700.0)
    scenario = empty(threats=(threat,), objective=Objective(missile=0.0))
    start, goal = Anchor(0.0, 0.0, 0.0), Anchor(4000.0, 0.0, 0.0)
    path, _ = connect(
        start,
        goal,
        **asked_of(scenario),
        keep_out=keep_out(scenario.airspace, scenario.level),
        radius_m=RADIUS_M,
    )
    assert path.length_m == pytest.approx(4000.0, rel=0.01)


def test_a_collect_ending_inside_a_threat_leaves_it():
    """With an anchor inside a soft threat the others are still kept out of."""
    inside = Threat("A", "missile", (0.0, 300.0), 800.0)
    other = Threat("B", "missile", (3000.0, 0.0), 800.0)
    scenario = empty(threats=(inside, other))
    start, goal = Anchor(0.0, 0.0, 0.0), Anchor(6000.0, 0.0, 0.0)
    path, _ = connect(
        start,
        goal,
        **asked_of(scenario),
        keep_out=keep_out(scenario.airspace, scenario.level),
        radius_m=RADIUS_M,
    )
    line = path.sample(5.0)[:, :2]
    assert metres_inside(line, (other,)) == 0.0
    assert 0.0 < metres_inside(line, (inside,)) < 1500.0


def test_the_same_request_gives_the_same_line(case):
    """Two runs agree to the last bit."""
    rng = random.Random(8)
    start, goal = random_pose(rng, case), random_pose(rng, case)
    lines = [
        connect(
            start, goal, **asked_of(case), keep_out=keep_out(case.airspace, case.level), radius_m=RADIUS_M
        )[0].sample(5.0)
        for _ in range(2)
    ]
    assert np.array_equal(lines[0], lines[1])


def test_stop_is_obeyed(case):
    """A caller that asks to stop gets no line."""
    with pytest.raises(CancelledError):
        connect(
            Anchor(0.0, 0.0, 0.0),
            Anchor(900.0, 900.0, 1.0),
            **asked_of(case),
            keep_out=keep_out(case.airspace, case.level),
            radius_m=RADIUS_M,
            stop=lambda: True,
        )
