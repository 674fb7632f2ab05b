"""The judge of photos, against photos projected one by one, and against plans that were spoiled."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import contains_xy, union_all
from shapely.geometry import Point, Polygon

from planner.check import judge
from planner.check.camera_print import photo_corners
from planner.check.photo_grid import Lane, Seen, look
from planner.check.photo_places import grid_over, subdivided
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import LonLatAlt, Plan
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.optics import Optics
from tests.planner.scenarios import feature, small, square

OPTICS = Optics(0.02, 23.5e-3 / 6000, 6000, 4000)
EYE = {"name": "eye", "type": "camera", "model": "Sony a6000 20 mm", "rer": 0.92, "snr": 50.0}


def lane(course_rad: float, left_m: float, spacing_m: float, off_rad: float, camera: CameraSensor) -> Lane:
    """Twelve photos about the origin from 100 m."""
    ahead = np.array([math.cos(course_rad), math.sin(course_rad)])
    along_m = spacing_m * (np.arange(12) - 5.5)
    places_m = along_m[:, None] * ahead + left_m * np.array([-ahead[1], ahead[0]])
    return Lane(places_m, np.full(12, 100.0), photo_corners(camera, off_rad))


def outlines(lane: Lane, drop_m: float) -> list[Polygon]:
    """Each photo's ground at one height, turned and put where it is taken."""
    cos, sin = math.cos(lane.course_rad), math.sin(lane.course_rad)
    shape = drop_m * lane.corners @ np.array([[cos, sin], [-sin, cos]])
    return [Polygon(place + shape) for place in lane.places_m]


@settings(max_examples=30, deadline=None)
@given(
    st.floats(0.0, 6.2),
    st.floats(-0.6, 0.6),
    st.floats(-0.4, 0.5),
    st.floats(10.0, 40.0),
    st.floats(-20.0, 20.0),
)
def test_places_are_seen_by_the_photos_whose_outlines_hold_them(
    course_rad: float, off_rad: float, tilt_rad: float, spacing_m: float, ground_m: float
) -> None:
    """Counted photo by photo by shapely, at random places over and under the datum."""
    camera = CameraSensor("eye", OPTICS, tilt_rad=tilt_rad)
    lanes = [
        lane(course_rad, 0.0, spacing_m, off_rad, camera),
        lane(course_rad + math.pi, 30.0, 25.0, 0.0, camera),
    ]
    places_m = np.random.default_rng(1).uniform(-200.0, 200.0, (300, 2))
    seen = look(places_m, np.full(300, ground_m), lanes, camera)
    counted = np.zeros(300, dtype=int)
    sure = np.ones(300, dtype=bool)
    for each in lanes:
        for outline in outlines(each, 100.0 - ground_m):
            counted += contains_xy(outline, places_m)
            edge = outline.exterior.buffer(1e-6)
            sure &= ~contains_xy(edge, places_m)
    assert (seen.photos == counted)[sure].all()
    assert (np.isnan(seen.gsd_m) == (seen.photos == 0)).all()


def two_lanes(apart_m: float, spacing_m: float, drop: Any = slice(None)) -> Seen:
    """What two lanes over level ground give between them, there and back."""
    camera = CameraSensor("eye", OPTICS)
    there, back = (
        lane(turn, side, spacing_m, 0.0, camera) for turn, side in ((0.3, 0.0), (0.3 + math.pi, -apart_m))
    )
    there = replace(there, places_m=there.places_m[drop], altitudes_m=there.altitudes_m[drop])
    ahead = np.array([math.cos(0.3), math.sin(0.3)])
    left = np.array([-ahead[1], ahead[0]])
    along_m, across_m = np.meshgrid(np.arange(-40.0, 40.0), np.linspace(0.5, apart_m - 0.5, 30))
    places_m = along_m.reshape(-1, 1) * ahead + across_m.reshape(-1, 1) * left
    return look(places_m, np.zeros(len(places_m)), [there, back], camera)


def test_between_lanes_overlaps_are_those_of_their_distances() -> None:
    """By hand: 117.5 m across and 78.33 m along; 40 m between lanes, 20 m between photos."""
    seen = two_lanes(40.0, 20.0)
    assert seen.side == pytest.approx(1.0 - 40.0 / 117.5)
    assert seen.forward == pytest.approx(1.0 - 20.0 * 3.0 / 235.0)
    assert seen.worst_gsd_m == pytest.approx(100.0 * 23.5e-3 / 6000 / 0.02)


@pytest.mark.parametrize("lefts_m", [(0.0, 30.0, 60.0), (0.0, 60.0)])
def test_lanes_over_ground_elsewhere_leave_the_least_as_it_is(lefts_m: tuple[float, ...]) -> None:
    """Lanes of another piece, far ahead, lie between those here, a degree off their course.

    Places up to 25 m beside the outer ones, which the second of three sees, too, are among those looked at.
    """
    camera = CameraSensor("eye", OPTICS)
    here = [lane(0.0, left_m, 19.0, 0.0, camera) for left_m in lefts_m]
    there = [lane(0.015, left_m, 19.0, 0.0, camera) for left_m in (-10.0, 15.0, 45.0, 70.0)]
    there = [replace(each, places_m=each.places_m + np.array([1000.0, 0.0])) for each in there]
    low_m = -25.0 if len(lefts_m) > 2 else 0.0
    places_m = np.random.default_rng(2).uniform((-90.0, low_m), (90.0, 60.0 - low_m), (2000, 2))
    alone = look(places_m, np.zeros(2000), here, camera)
    both = look(places_m, np.zeros(2000), here + there, camera)
    assert (both.side >= alone.side - 1e-9).all()
    assert both.side.min() == pytest.approx(alone.side.min(), abs=0.01)
    assert both.forward == pytest.approx(alone.forward)


def test_a_photo_left_out_halves_what_its_neighbours_share() -> None:
    """Where it is missing the next is two intervals on."""
    seen = two_lanes(40.0, 20.0, drop=[0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11])
    assert seen.forward.min() == pytest.approx(1.0 - 40.0 * 3.0 / 235.0)


def test_where_lanes_cross_those_count_that_keep_the_overlaps() -> None:
    """Asked for 30 and 70 %: lanes with 40 and 75 count, not those across with 60 and 50."""
    camera = CameraSensor("eye", OPTICS, 0.3, 0.7)
    wide_m, long_m = 117.5, 235.0 / 3.0
    kept = [lane(0.0, left_m, 0.6 * long_m, 0.0, camera) for left_m in (0.0, 0.25 * wide_m)]
    across = [
        lane(math.pi / 2.0, left_m, 0.4 * long_m, 0.0, camera) for left_m in (-0.25 * wide_m, 0.25 * wide_m)
    ]
    at = np.array([[0.0, 0.1 * wide_m]])
    seen = look(at, np.zeros(1), [*across, *kept], camera)
    assert (seen.forward[0], seen.side[0]) == pytest.approx((0.4, 0.75))


def test_where_photos_overlap_by_less_than_half_the_lane_counts_that_shares_most() -> None:
    """A place past the end of the nearer lane, in its last photo's edge, is well within the other lane's."""
    camera = CameraSensor("eye", OPTICS, 0.4, 0.6)
    spacing_m = 0.6 * 235.0 / 3.0
    ends, passes = (lane(0.0, left_m, spacing_m, 0.0, camera) for left_m in (0.0, 40.0))
    ends = replace(ends, places_m=ends.places_m[:6], altitudes_m=ends.altitudes_m[:6])
    at = np.array([[ends.places_m[-1, 0] + 35.0, 10.0]])
    assert look(at, np.zeros(1), [ends], camera).forward[0] == pytest.approx(1.0 - 70.0 / (235.0 / 3.0))
    assert look(at, np.zeros(1), [ends, passes], camera).forward[0] >= 0.4 - 1e-9


def test_the_grid_holds_the_outline_and_no_place_outside() -> None:
    """A metre apart over a small region."""
    area = Polygon([(0.0, 0.0), (30.0, 5.0), (22.0, 28.0), (3.0, 14.0)])
    places_m = grid_over(area)
    assert contains_xy(area.buffer(1e-9), places_m).all()
    assert len(places_m) == pytest.approx(area.area + area.length, rel=0.1)


def test_squares_of_places_are_looked_at_by_parts_inside_the_area() -> None:
    """As much ground as shapely has of the squares round places, each part once where squares share it."""
    area = Polygon([(0.0, 0.0), (30.0, 5.0), (22.0, 28.0), (3.0, 14.0)])
    places_m = np.array([[0.5, 0.4], [10.5, 9.5], [11.0, 9.5], [22.0, 27.9]])
    fine_m, each_m2 = subdivided(area, places_m)
    squares = union_all([Point(place).buffer(0.5, cap_style="square") for place in places_m])
    assert contains_xy(area, fine_m).all()
    assert len(np.unique(fine_m, axis=0)) == len(fine_m)
    assert len(fine_m) * each_m2 == pytest.approx(squares.intersection(area).area, rel=0.2)
    assert contains_xy(squares.buffer(0.11), fine_m).all()


def planned(eye: dict[str, Any] | None = None, **wishes: Any) -> tuple[Scenario, Plan]:
    """A region of 220 m from 100 m, and its plan."""
    document = small(sensors=[EYE | {"min_interval_s": 0.5} | (eye or {})], altitude_m=100.0)
    document["features"] = [each for each in document["features"] if each["id"] in ("area", "start")]
    document["features"].append(feature("C", "roi", "Polygon", square(0.0, 0.0, 0.002), **wishes))
    scenario = read_scenario(document)
    return scenario, make_plan(scenario)


def test_a_sound_plan_has_what_was_asked_for() -> None:
    """Overlaps as asked, quality by equations 1 and 2."""
    _, plan = planned(gsd_m=0.02)
    survey = plan.metrics.surveys["C"]
    assert plan.violations == ()
    assert survey.forward_overlap >= 0.75 - 1e-6
    assert survey.side_overlap >= 0.65 - 1e-6
    gsd_m = 100.0 * 23.5e-3 / 6000 / 0.02
    niirs = 10.25 - 3.32 * math.log10(gsd_m / 0.0254) + 1.559 * math.log10(0.92) - 0.344 / 50.0
    assert (survey.gsd_m, survey.gsd_mean_m) == pytest.approx((gsd_m, gsd_m), abs=1e-9)
    assert (survey.niirs, survey.niirs_mean) == pytest.approx((niirs, niirs), abs=1e-9)


def _up(places: tuple[LonLatAlt, ...]) -> tuple[LonLatAlt, ...]:
    return tuple((lon, lat, altitude_m + 40.0) for lon, lat, altitude_m in places)


def spoiled(plan: Plan, how: str) -> Plan:
    """The plan with its photos taken otherwise."""
    if how == "every other":
        return replace(plan, photos=tuple(replace(p, places=p.places[::2]) for p in plan.photos))
    if how == "a lane missing":
        return replace(plan, photos=plan.photos[1:], collects=plan.collects[1:])
    if how == "higher":
        return replace(plan, photos=tuple(replace(p, places=_up(p.places)) for p in plan.photos))
    return replace(plan, photos=tuple(replace(p, places=p.places * 3) for p in plan.photos))


@pytest.mark.parametrize(
    ("how", "constraint", "said"),
    [
        ("every other", "overlap", "forward overlap"),
        ("a lane missing", "overlap", "side overlap"),
        ("higher", "quality", "gsd_m"),
        ("sooner", "photo-interval", "every"),
    ],
)
def test_a_plan_whose_photos_are_not_as_asked_is_found_out(how: str, constraint: str, said: str) -> None:
    """In words, and by how much."""
    scenario, plan = planned(gsd_m=0.02)
    found = [v for v in judge(scenario, spoiled(plan, how)).violations if v.constraint == constraint]
    told = [v for v in found if said in v.message]
    assert told
    assert told[0].amount > 0.0


def test_ground_that_no_photo_sees_is_found_out() -> None:
    """Half of each lane's photos left out."""
    scenario, plan = planned()
    half = tuple(replace(p, places=p.places[: len(p.places) // 2]) for p in plan.photos)
    assert "photo-coverage" in {v.constraint for v in judge(scenario, replace(plan, photos=half)).violations}


def test_a_footprint_that_tells_other_than_its_images_give_is_found_out() -> None:
    """Of a camera that is tilted, and of a radar: the plan's own values are sound, others are not."""
    scenario, plan = planned({"tilt_deg": 25.0})
    radar = read_scenario(small())
    for asked, made in ((scenario, plan), (radar, make_plan(radar))):
        assert "footprint-quality" not in {v.constraint for v in made.violations}
        first, *rest = made.footprints
        assert first.niirs is not None
        better = replace(made, footprints=(replace(first, niirs=first.niirs + 0.01), *rest))
        found = [v for v in judge(asked, better).violations if v.constraint == "footprint-quality"]
        assert [v.feature for v in found] == [first.sensor]
