"""Lines of the program: flyable, clear, ends met; told where there are none; plans that the judge accepts."""

from __future__ import annotations

import math

import pytest
import shapely
from shapely.geometry import LineString, Point

from planner.airspace.zones import Disc, KeepOut, PolygonZone
from planner.errors import CancelledError, InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.route import Anchor
from planner.transit.milp.connector import connect
from planner.transit.milp.values import Goal
from planner.transit.tangent import connect as by_tangents
from tests.planner.scenarios import feature, small
from tests.planner.transit.test_ssas_connector import assert_flyable

RADIUS_M, SPEED_M_S = 100.0, 20.0
START, GOAL = Anchor(-1500.0, 0.0, 0.3), Anchor(1500.0, 0.0, -0.2)
DISC = Disc("d", 0.0, 40.0, 400.0, True)
WALL = PolygonZone("w", shapely.box(600.0, -700.0, 700.0, 200.0), True)


@pytest.mark.parametrize("goal", ["control", "length"])
def test_round_a_disc_and_a_wall(goal: Goal) -> None:
    """Met ends, no turn too tight, outside by shapely, and longer than the line of tangents."""
    zones = KeepOut((DISC,), (WALL,), shapely.box(-2000.0, -1500.0, 2000.0, 1500.0))
    path, found = connect(START, GOAL, zones, RADIUS_M, SPEED_M_S, goal)
    assert_flyable(START, GOAL, path, RADIUS_M)
    line = LineString(path.sample(1.0)[:, :2])
    assert line.distance(Point(0.0, 40.0)) > 399.9
    assert not line.intersects(WALL.polygon.buffer(-0.01))
    assert zones.area.contains(line)
    assert found.status in ("optimal", "feasible")
    shortest = by_tangents(START, GOAL, zones, RADIUS_M)
    assert shortest.length_m - 1e-6 <= path.length_m < 1.3 * shortest.length_m


def test_smoothed_by_any_name() -> None:
    """The same trajectory by each turn is another line, each flyable and clear."""
    zones = KeepOut((DISC,))
    lengths_m = set()
    for smoothing in ("fillet", "three-arc", "short-turn"):
        asked = {"directions": 2, "smoothing": smoothing}
        path, _ = connect(START, GOAL, zones, RADIUS_M, SPEED_M_S, "length", **asked)
        assert_flyable(START, GOAL, path, RADIUS_M)
        assert zones.clear(path)
        lengths_m.add(round(path.length_m, 3))
    assert len(lengths_m) > 1


def test_no_way_is_said_with_its_proof() -> None:
    """A wall across the whole area: no line, and the program's proof of it."""
    across = PolygonZone("w", shapely.box(-100.0, -1500.0, 100.0, 1500.0), True)
    zones = KeepOut((), (across,), shapely.box(-2000.0, -1000.0, 2000.0, 1000.0))
    with pytest.raises(InfeasibleError, match="proven"):
        connect(START, GOAL, zones, RADIUS_M, SPEED_M_S)
    with pytest.raises(InfeasibleError, match="one place"):
        connect(START, START, KeepOut(), RADIUS_M, SPEED_M_S)


def test_cancelled() -> None:
    """A stop ends it before the first program."""
    with pytest.raises(CancelledError):
        connect(START, GOAL, KeepOut((DISC,)), RADIUS_M, SPEED_M_S, stop=lambda: True)


def test_plans_by_the_program_are_accepted() -> None:
    """A plan with transits by the program breaks no hard constraint, names it, keeps out of the threat."""
    threat = feature("T", "threat", "Point", [0.016, 0.006], model="missile", radius_m=600.0)
    end = feature("E", "end", "Point", [0.05, 0.03])
    method = {"transit": "milp-length", "directions": 2, "smoothing": "three-arc"}
    document = small(threat, end, method=method)
    plan = make_plan(read_scenario(document))
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == {"A": 1.0, "B": 1.0}
    assert {transit.method for transit in plan.transits} == {"milp-length"}
    assert plan.methods["directions"] == "2"
    assert plan.metrics.risk_missile == 0.0


def test_no_room_to_turn_is_said() -> None:
    """Back the way it came, where the first step leads out of the area: refused, not an empty line."""
    start, goal = Anchor(-450.0, 0.0, math.pi), Anchor(-450.0, 130.0, 0.0)
    zones = KeepOut((), (), shapely.box(-500.0, -500.0, 500.0, 500.0))
    with pytest.raises(InfeasibleError) as refused:
        connect(start, goal, zones, RADIUS_M, SPEED_M_S)
    assert refused.value.constraint == "transit"
