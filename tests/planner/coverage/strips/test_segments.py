"""Collection segments see what they must: shapely judges the footprints."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import substring

from planner.coverage.strips.classify import classify
from planner.coverage.strips.neighbourhood import neighbourhoods
from planner.coverage.strips.segments import pair, segment
from planner.errors import InfeasibleError
from planner.route import CollectPass, Look
from tests.planner.coverage.shapes import HEIGHT_M, as_merged, box, paper_sensor, polygons, unseen_m2

SENSOR = paper_sensor("left", "right")
SWATH_M, NEAR_M, APERTURE_M = (f(HEIGHT_M) for f in (SENSOR.swath_m, SENSOR.near_m, SENSOR.aperture_m))
LOOKS = st.sampled_from(["left", "right"])


def assert_sees(passes: tuple[CollectPass, ...], area: Polygon) -> None:
    """The union of the footprints covers the area."""
    assert unseen_m2(area, (collect.footprint for collect in passes)) < 1e-6 * area.area


def assert_true_geometry(collect: CollectPass) -> None:
    """The footprint is what a side-looking sensor sees from the middle part of the line, on its side."""
    line = LineString([collect.start, collect.end])
    inner = substring(line, APERTURE_M / 2.0, line.length - APERTURE_M / 2.0)
    sign = 1.0 if collect.look == "left" else -1.0
    near, far = (
        inner.parallel_offset(NEAR_M, collect.look),
        inner.parallel_offset(NEAR_M + SWATH_M, collect.look),
    )
    seen = Polygon([*near.coords, *reversed(far.coords)])
    assert collect.footprint.hausdorff_distance(seen) < 1e-6
    assert collect.footprint.area == pytest.approx(seen.area)
    middle = collect.footprint.centroid
    ahead = (math.cos(collect.angle_rad), math.sin(collect.angle_rad))
    left_m = ahead[0] * (middle.y - collect.start[1]) - ahead[1] * (middle.x - collect.start[0])
    assert sign * left_m == pytest.approx(NEAR_M + SWATH_M / 2.0)


@settings(max_examples=200, deadline=None)
@given(polygons((50.0, 280.0)), st.floats(0.0, 2.0 * math.pi), st.floats(0.0, 1.0), LOOKS)
def test_one_pass_sees_all(area: Polygon, angle_rad: float, eta: float, look: Look) -> None:
    """A point region is seen whole at any angle and any η, from either side."""
    collect = segment(as_merged(area), SENSOR, HEIGHT_M, angle_rad, look, eta)
    assert_sees((collect,), area)
    assert_true_geometry(collect)
    assert math.remainder(collect.angle_rad - angle_rad, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-6)
    assert (collect.eta, collect.look, collect.regions) == (eta, look, ("R",))


@settings(max_examples=200, deadline=None)
@given(
    polygons((300.0, 570.0)), st.floats(0.0, 2.0 * math.pi), st.floats(0.0, 1.0), st.floats(0.0, 1.0), LOOKS
)
def test_two_passes_see_all(area: Polygon, angle_rad: float, first: float, part: float, look: Look) -> None:
    """Two opposite passes see a region up to two swaths wide for all η₁ and η₂ ≤ 1 − η₁."""
    passes = pair(as_merged(area), SENSOR, HEIGHT_M, angle_rad, look, first, part * (1.0 - first))
    assert_sees(passes, area)
    for collect in passes:
        assert_true_geometry(collect)
        # Both fly outside of what the pair sees, each looking in.
        assert not any(p.footprint.intersects(Point(collect.start)) for p in passes)
    turn_rad = math.remainder(passes[1].angle_rad - passes[0].angle_rad, 2.0 * math.pi)
    assert abs(turn_rad) == pytest.approx(math.pi)


@pytest.mark.parametrize("look", ["left", "right"])
def test_more_than_eta_max_leaves_a_gap(look: Look) -> None:
    """The bound 1 − η₁ is sharp: a little more and the strips come apart, by as much as it exceeds it."""
    area = box(900.0, 900.0)
    slack_m = 2.0 * SWATH_M - 900.0
    halves = (
        segment(as_merged(area), SENSOR, HEIGHT_M, 0.0, look, 0.6, 1),
        segment(as_merged(area), SENSOR, HEIGHT_M, math.pi, look, 0.5, 1),
    )
    gap_m2 = unseen_m2(area, (p.footprint for p in halves))
    assert gap_m2 == pytest.approx(900.0 * 0.1 * slack_m)
    with pytest.raises(ValueError, match="gap"):
        pair(as_merged(area), SENSOR, HEIGHT_M, 0.0, look, 0.6, 0.5)


@pytest.mark.parametrize(("look", "side"), [("right", 1.0), ("left", -1.0)])
def test_boundary_segments(look: Look, side: float) -> None:
    """Eq 19 flying east past a box: near edge on its near side at η = 0, far edge on its far side at 1."""
    area = box(1000.0, 300.0)
    inner = segment(as_merged(area), SENSOR, HEIGHT_M, 0.0, look, 0.0)
    outer = segment(as_merged(area), SENSOR, HEIGHT_M, 0.0, look, 1.0)
    assert inner.start == pytest.approx((500.0 - APERTURE_M / 2.0, -2000.0 + side * (150.0 + NEAR_M)))
    assert inner.end == pytest.approx((1500.0 + APERTURE_M / 2.0, -2000.0 + side * (150.0 + NEAR_M)))
    assert outer.start[1] == pytest.approx(-2000.0 + side * (SWATH_M - 150.0 + NEAR_M))
    assert inner.length_m == pytest.approx(SENSOR.collection_m(HEIGHT_M, 1000.0))


def test_aperture_is_needed_at_both_ends() -> None:
    """Without its run-in a pass sees the region's first metres for less than one aperture length."""
    area = box(400.0, 300.0)
    collect = segment(as_merged(area), SENSOR, HEIGHT_M, 0.7, "right", 0.3)
    ahead = np.array([math.cos(0.7), math.sin(0.7)])
    along = np.array(area.exterior.coords) @ ahead
    assert along.min() - np.array(collect.start) @ ahead == pytest.approx(APERTURE_M / 2.0)
    assert np.array(collect.end) @ ahead - along.max() == pytest.approx(APERTURE_M / 2.0)


@settings(max_examples=25, deadline=None)
@given(polygons((60.0, 560.0)), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=3))
def test_every_feasible_angle(area: Polygon, etas: list[float]) -> None:
    """At each angle of Θ, one degree apart, and each η the region is seen whole."""
    assume(classify(area, SWATH_M).feasible_rad.size)
    for side in neighbourhoods(as_merged(area), SENSOR, HEIGHT_M, math.radians(15.0)):
        for index in range(len(side.angles_rad)):
            for eta in etas:
                passes = (side.collect(index, eta),)
                if side.turns:
                    passes += (side.collect(index, 1.0 - eta, opposite=True),)
                assert_sees(passes, area)


def test_lines_and_collects_agree() -> None:
    """The arrays the search works on are the passes that are flown."""
    (side,) = neighbourhoods(as_merged(box(900.0, 900.0)), paper_sensor(), HEIGHT_M)
    etas = np.array([0.0, 0.25, 1.0])
    for opposite in (False, True):
        lines = side.lines(etas, opposite=opposite)
        assert lines.shape == (len(side.angles_rad), 3, 2, 2)
        for index, k in ((0, 0), (17, 1), (150, 2)):
            collect = side.collect(index, float(etas[k]), opposite=opposite)
            assert lines[index, k].tolist() == [list(collect.start), list(collect.end)]


def test_refused_angles_and_offsets() -> None:
    """An angle at which the swath is too narrow, and an η outside [0, 1], give no pass."""
    strip = as_merged(box(1000.0, 500.0))
    with pytest.raises(InfeasibleError) as caught:
        segment(strip, SENSOR, HEIGHT_M, math.pi / 2.0, "right", 0.5)
    assert caught.value.constraint == "swath"
    with pytest.raises(ValueError, match="η"):
        segment(strip, SENSOR, HEIGHT_M, 0.0, "right", 1.1)
