"""The proven clearance of a line, against shapely."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, box

from planner.airspace.zones import Disc, KeepOut, PolygonZone
from planner.dubins.path import Path, Segment
from planner.dubins.words import shortest
from planner.errors import InfeasibleError
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.route import Anchor, Pose
from planner.transit.certificate import TOLERANCE_M, clearance
from planner.transit.tangent import connect
from tests.planner.scenarios import feature, small

numbers = st.floats(-1500.0, 1500.0)
poses = st.builds(Pose, numbers, numbers, st.floats(-3.0, 3.0))
rows = st.lists(st.tuples(numbers, numbers, st.floats(20.0, 500.0)), min_size=1, max_size=4)


@settings(deadline=None, max_examples=60)
@given(poses, poses, rows, st.booleans())
def test_proof_holds_and_is_sharp(
    start: Pose, goal: Pose, found: list[tuple[float, float, float]], square: bool
) -> None:
    """The proven distance is no more than shapely's on a fine sample, and no less by the tolerance."""
    if square:
        boxes = [box(e - r, n - r, e + r, n + r) for e, n, r in found]
        zones = KeepOut((), tuple(PolygonZone(f"z{k}", b, True) for k, b in enumerate(boxes)))
    else:
        zones = KeepOut(tuple(Disc(f"d{k}", e, n, r, True) for k, (e, n, r) in enumerate(found)))
    line = shortest(start, goal, 120.0)
    proof = clearance(line, zones)
    assert proof is not None
    assert 0.0 <= proof.seen_m - proof.proven_m <= TOLERANCE_M + 1e-9
    if line.length_m == 0.0:
        return
    sampled = LineString(line.sample(1.0)[:, :2])
    if square:
        least_m = min(sampled.distance(b) for b in boxes)
    else:
        least_m = min(sampled.distance(Point(e, n)) - r for e, n, r in found)
    # A chord of 1 m leaves an arc of 120 m by a millimetre.
    if least_m > 0.0:
        assert proof.proven_m <= least_m + 2e-3
        assert proof.proven_m >= least_m - 2e-3 - TOLERANCE_M


@settings(deadline=None, max_examples=60)
@given(poses, poses, rows)
def test_connected_lines_are_certified(
    start: Pose, goal: Pose, found: list[tuple[float, float, float]]
) -> None:
    """What the connector finds clears every zone by the margin it was given, proven."""
    margin_m = 15.0
    grown = KeepOut(tuple(Disc(f"d{k}", e, n, r + margin_m, True) for k, (e, n, r) in enumerate(found)))
    exact = KeepOut(tuple(Disc(f"d{k}", e, n, r, True) for k, (e, n, r) in enumerate(found)))
    try:
        line = connect(Anchor(*start.position, start.angle_rad), Anchor(*goal.position), grown, 100.0)
    except InfeasibleError:
        return
    proof = clearance(line, exact)
    assert proof is not None
    assert proof.proven_m >= margin_m - TOLERANCE_M - 2e-3


def test_inside_is_negative_and_the_area_counts() -> None:
    """A line through a zone or out of the area is nearer than nothing, by its depth."""
    line = Path((Segment("straight", Pose(-500.0, 0.0, 0.0), 1000.0),))
    through = clearance(line, KeepOut((Disc("d", 0.0, 30.0, 100.0, True),)))
    assert through is not None
    assert through.seen_m == pytest.approx(-70.0, abs=TOLERANCE_M)
    assert through.where == pytest.approx((0.0, 0.0), abs=2.0)
    out = clearance(line, KeepOut(area=box(-600.0, -200.0, 450.0, 200.0)))
    assert out is not None
    assert out.proven_m == pytest.approx(-50.0, abs=TOLERANCE_M)


def test_nothing_hard_nothing_to_prove() -> None:
    """Without hard zones and area there is no clearance; soft discs do not count."""
    line = Path((Segment("straight", Pose(0.0, 0.0, 0.0), 100.0),))
    assert clearance(line, KeepOut((Disc("soft", 0.0, 0.0, 10.0, False),))) is None


def test_the_plan_carries_it() -> None:
    """Transits of a plan say how far they stay from hard zones, as shapely finds; read back unchanged."""
    zone = feature("N", "no_fly", "Point", [0.017, 0.007], radius_m=500.0)
    scenario = read_scenario(small(zone))
    plan = make_plan(scenario)
    centre = scenario.frame.to_local([(0.017, 0.007)])[0]
    for transit in plan.transits:
        line = LineString(scenario.frame.to_local([place[:2] for place in transit.line]))
        assert transit.clearance_m == pytest.approx(line.distance(Point(centre)) - 500.0, abs=0.1)
        assert transit.clearance_m is not None
        assert transit.clearance_m > 0.0
    again = read_plan(write_plan(plan))
    assert [t.clearance_m for t in again.transits] == pytest.approx(
        [t.clearance_m for t in plan.transits], abs=1e-2
    )
    assert all(t.clearance_m is None for t in make_plan(read_scenario(small())).transits)
    assert math.isfinite(plan.metrics.length_m)
