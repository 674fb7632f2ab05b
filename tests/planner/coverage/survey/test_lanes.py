"""Lanes: few, within what they answer for, and their photos overlap everywhere; judged photo by photo."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate
from shapely.geometry import Polygon, box

from benchmarks.photos import photos, places, seen_by
from planner.airspace.surroundings import Surroundings
from planner.airspace.values import STILL_AIR, Wind
from planner.coverage.survey.family import Surveys
from planner.coverage.survey.lanes import Survey, lanes_at
from planner.progress import never
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.sensors.optics import Optics
from tests.planner.coverage.shapes import as_merged, polygons

HEIGHT_M, SPEED_M_S = 60.0, 15.0
#: From 60 m a photo sees 70.5 × 47 m.
EYE = CameraSensor("eye", Optics(0.02, 23.5e-3 / 6000, 6000, 4000))
NOTHING = np.empty((0, 3))


def around(radius_m: float, settle_m: float = 0.0) -> Surroundings:
    return Surroundings(None, None, NOTHING, NOTHING, (), radius_m, settle_m)


def surveyed(area: Polygon, camera: CameraSensor, radius_m: float = 30.0) -> list[CollectPass]:
    """Passes of the cheapest option of each target."""
    found = Surveys().targets(
        as_merged(area), camera, HEIGHT_M, around(radius_m), wide=True, division="auto", enough=never
    )
    passes: list[CollectPass] = []
    for target in found:
        options = target.coarse(math.radians(15.0), np.array([0.0, 1.0]))
        passes += target.passes(options, int(options.inner_m.argmin()))
    return passes


@given(polygons((40.0, 120.0)), st.floats(0.0, 0.6), st.floats(0.0, math.tau), st.sampled_from([0.5, 0.75]))
@settings(max_examples=6, suppress_health_check=[HealthCheck.too_slow])
def test_every_place_is_in_two_photos_of_a_lane(
    area: Polygon, drift: float, toward_rad: float, overlap: float
) -> None:
    """In winds up to 60 % of the speed each place lies in two photos that overlap, edges included."""
    wind = Wind(drift * SPEED_M_S, toward_rad)
    camera = CameraSensor("eye", EYE.optics, overlap, 0.6).in_wind(drift, toward_rad)
    passes = surveyed(area, camera)
    taken = photos(passes, camera, HEIGHT_M, SPEED_M_S, wind)
    at = places(area, 2.0)
    seen = seen_by(taken, at)
    assert seen.max(axis=0).min() >= 2
    if len({photo.lane for photo in taken}) > 1:
        assert (seen > 0).sum(axis=0).min() >= 2
    for one, other in itertools.pairwise(taken):
        if one.lane == other.lane:
            assert one.ground.intersection(other.ground).area >= (overlap - 1e-6) * one.ground.area


@given(polygons((60.0, 200.0)), st.floats(0.0, math.pi), st.floats(0.0, 1.0))
@settings(max_examples=12)
def test_lanes_answer_for_what_is_nearest_and_see_beyond(area: Polygon, angle_rad: float, eta: float) -> None:
    """Each place is in two photos of a lane; a second lane has it in one."""
    survey = Survey(area, area, EYE, HEIGHT_M)
    angles_rad = np.array([angle_rad])
    count = int(survey.counts(angles_rad)[0])
    width_m, length_m = 70.5, 47.0
    spacing_m = 0.35 * width_m
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    left = np.array([-ahead[1], ahead[0]])
    across_m = np.ptp(shapely.get_coordinates(area) @ left)
    fewest = math.ceil((across_m - 0.3 * width_m - 1e-3) / spacing_m) + 1
    assert count == (1 if across_m <= spacing_m + 1e-3 else max(fewest, 2))
    lines = lanes_at(survey, angles_rad, np.array([eta]), count).lines[0, 0, :, 0]
    at = places(area, 3.0)
    near, seeing = np.zeros(len(at), dtype=np.bool_), np.zeros(len(at), dtype=np.int64)
    for start, end in lines:
        along, across = (at - start) @ ahead, np.abs((at - start) @ left)
        beyond_m = np.maximum(np.maximum(-along, along - math.dist(start, end)), 0.0)
        # At the tip of a spike a last digit across is centimetres along.
        near |= (across <= width_m / 2.0 + 1e-3) & (beyond_m <= 0.25 * length_m + 0.05)
        seeing += (across <= width_m / 2.0 + 1e-3) & (beyond_m <= 0.5 * length_m + 0.05)
        met = area.intersection(shapely.LineString([start - 500.0 * ahead, end + 500.0 * ahead]))
        if not met.is_empty:
            x_m = shapely.get_coordinates(met) @ ahead
            assert start @ ahead <= x_m.min() + 0.25 * length_m + 0.05
            assert end @ ahead >= x_m.max() - 0.25 * length_m - 0.05
    assert near.all()
    assert seeing.min() >= min(count, 2)
    apart_m = np.diff(np.sort(lines[:, 0] @ left))
    assert apart_m.max(initial=0.0) <= spacing_m + 1e-6


def test_a_lane_more_only_where_the_edges_would_be_seen_from_one() -> None:
    """Three spacings and the six sevenths that the outer lanes see twice take four lanes, more take five."""
    for more_m, lanes in ((-0.5, 4), (0.5, 5)):
        area = box(0.0, 0.0, 300.0, (3.0 * 0.35 + 0.3) * 70.5 + more_m)
        assert Survey(area, area, EYE, HEIGHT_M).counts(np.zeros(1)).tolist() == [lanes]


def test_photos_are_not_taken_over_gaps() -> None:
    """A lane across the arms of a U is flown in one and photographed in two; a gap of few photos is not."""
    for gap_m, pieces in ((200.0, 2), (10.0, 1)):
        arms = box(0, 0, 60, 50).union(box(60 + gap_m, 0, 120 + gap_m, 50))
        area = arms.union(box(0, 50, 120 + gap_m, 60))
        assert isinstance(area, Polygon)
        allowed = as_merged(area, (0.0, math.pi))
        survey = Survey(area, area, EYE, HEIGHT_M)
        (target,) = Surveys().targets(
            allowed, EYE, HEIGHT_M, around(10.0), wide=True, division="whole", enough=never
        )
        options = target.options(np.zeros(1), np.array([1.0]))
        assert options is not None
        passes = target.passes(options, 0)
        lanes = int(survey.counts(np.zeros(1))[0])
        assert len(passes) == lanes + pieces - 1
        taken = photos(passes, EYE, HEIGHT_M, SPEED_M_S, STILL_AIR)
        assert seen_by(taken, places(area, 3.0)).max(axis=0).min() >= 2


def test_a_narrow_region_takes_one_lane_however_it_lies() -> None:
    """A strip no wider than the spacing, turned by any angle, is one lane along it."""
    for turn_deg in (0.0, 17.0, 90.0, 123.0):
        area = rotate(box(0, 0, 400, 24), turn_deg)
        (one,) = surveyed(area, EYE)
        off = math.degrees(math.atan2(one.end[1] - one.start[1], one.end[0] - one.start[0])) - turn_deg
        assert math.sin(math.radians(off)) == pytest.approx(0.0, abs=1e-6)
