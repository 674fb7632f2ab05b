"""Patterns by name: each as its name says, every place seen, by photos of the tests' own geometry."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from shapely.geometry import LineString, Point, Polygon, box

from benchmarks.photos import photos, places, seen_by
from planner.airspace.surroundings import Surroundings
from planner.airspace.values import STILL_AIR
from planner.coverage.merge import merge_regions, split_region
from planner.coverage.survey.family import Surveys
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.progress import never
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.sensors.optics import Optics
from planner.wishes import Pattern, Region
from tests.planner.scenarios import feature, small, square

HEIGHT_M = 60.0
#: From 60 m a photo sees 70.5 × 47 m.
OPTICS = Optics(0.02, 23.5e-3 / 6000, 6000, 4000)
EYE = CameraSensor("eye", OPTICS)
AHEAD = CameraSensor("eye", OPTICS, tilt_rad=math.radians(45.0))
NOTHING = np.empty((0, 3))
FIELD = box(-60.0, -40.0, 60.0, 40.0)


def surveyed(
    pattern: Pattern, area: Polygon = FIELD, camera: CameraSensor = EYE, radius_m: float = 8.0, **more: Any
) -> list[list[CollectPass]]:
    """Passes of the cheapest option, target by target."""
    region = Region("R", area, pattern=pattern, **more)
    around = Surroundings(None, None, NOTHING, NOTHING, (), radius_m, 0.0)
    family = Surveys()
    family.check(region, camera, HEIGHT_M)
    (merged,) = split_region(region)
    found = []
    for target in family.targets(merged, camera, HEIGHT_M, around, wide=True, division="auto", enough=never):
        options = target.coarse(math.radians(10.0), np.array([0.0, 1.0]))
        best: Any = options.rows(np.array([int(options.inner_m.argmin())]))
        found.append(list(target.passes(best, 0)))
    return found


def seen(passes: list[CollectPass], area: Polygon, camera: CameraSensor = EYE) -> np.ndarray:
    return seen_by(photos(passes, camera, HEIGHT_M, 15.0, STILL_AIR), places(area, 4.0))


def test_a_cross_hatch_sees_everything_from_two_sets_of_lanes_across() -> None:
    """Two sets at right angles, each complete by itself; of two headings allowed those, of one none."""
    for approach_rad in (None, (0.3, 0.3 + math.pi / 2.0)):
        one, other = surveyed("crosshatch", approach_rad=approach_rad)
        assert math.cos(one[0].angle_rad - other[0].angle_rad) == pytest.approx(0.0, abs=1e-9)
        for passes in (one, other):
            counts = seen(passes, FIELD)
            assert counts.max(axis=0).min() >= 2
            assert (counts > 0).sum(axis=0).min() >= 2
            assert {round(math.sin(p.angle_rad - passes[0].angle_rad), 6) for p in passes} == {0.0}
    with pytest.raises(InfeasibleError) as caught:
        surveyed("crosshatch", approach_rad=(0.3,))
    assert caught.value.constraint == "approach"


@pytest.mark.parametrize(
    ("pattern", "radius_m"), [("orbit", 8.0), ("spiral", 8.0), ("orbit", 30.0), ("spiral", 25.0)]
)
def test_rings_and_spirals_see_all_and_the_middle_from_all_sides(pattern: Pattern, radius_m: float) -> None:
    """Chords round the middle of a disc: every place is seen twice, the middle from every side."""
    disc = Point(100.0, -50.0).buffer(90.0)
    (passes,) = surveyed(pattern, disc, radius_m=radius_m)
    counts = seen(passes, disc)
    assert counts.sum(axis=0).min() >= 2
    away_m = [LineString([one.start, one.end]).distance(Point(100.0, -50.0)) for one in passes]
    assert min(away_m) >= 70.5 / 4.0 - 0.5
    near = [one for one, apart_m in zip(passes, away_m, strict=True) if apart_m <= min(away_m) + 23.0]
    bearings = np.sort([math.atan2(p.start[1] + 50.0, p.start[0] - 100.0) for p in near])
    assert np.diff(bearings, append=bearings[0] + math.tau).max() <= math.radians(93.0)
    steps_m = np.abs(np.diff(away_m))
    # A spiral comes in by a little each chord, rings by a lane spacing at once.
    assert bool(steps_m.max() < 10.0) is (pattern == "spiral")


def test_an_orbit_by_a_tilted_camera_looks_at_the_place_from_all_round() -> None:
    """Eight short passes towards it, 45° apart, so far before it as the tilt asks for."""
    (passes,) = surveyed("orbit", Point(0.0, 0.0).buffer(5.0), AHEAD)
    assert len(passes) == 8
    headings_deg = sorted(math.degrees(one.angle_rad) % 360.0 for one in passes)
    assert np.allclose(np.diff(headings_deg), 45.0)
    for one in passes:
        _looks_at_the_middle(one)


def _looks_at_the_middle(one: CollectPass) -> None:
    """Rays of a camera pitched by 45°: the middle of the target lies within the frame of both ends."""
    ahead = np.array([math.cos(one.angle_rad), math.sin(one.angle_rad)])
    half_deg = math.degrees(math.atan(4000 * OPTICS.pixel_pitch_m / 0.02 / 2.0))
    for place in (one.start, one.end):
        away = -np.array(place)
        assert float(away @ (-ahead[1], ahead[0])) == pytest.approx(0.0, abs=1.0)
        down_deg = math.degrees(math.atan2(float(away @ ahead), HEIGHT_M))
        assert abs(down_deg - 45.0) < half_deg


def test_a_look_is_one_pass_from_where_the_tilt_sees_the_region() -> None:
    """From any direction, or from those allowed."""
    target = Point(0.0, 0.0).buffer(5.0)
    ((one,),) = surveyed("look", target, AHEAD)
    _looks_at_the_middle(one)
    ((one,),) = surveyed("look", target, AHEAD, approach_rad=(1.0,))
    assert one.angle_rad == pytest.approx(1.0)
    _looks_at_the_middle(one)


@pytest.mark.parametrize(
    ("pattern", "camera", "area", "more", "constraint"),
    [
        ("look", EYE, FIELD, {}, "pattern"),
        ("spiral", AHEAD, FIELD, {}, "pattern"),
        ("look", AHEAD, box(0.0, 0.0, 900.0, 900.0), {}, "look"),
        ("orbit", AHEAD, box(0.0, 0.0, 900.0, 900.0), {}, "look"),
        ("orbit", EYE, FIELD, {"approach_rad": (0.0,)}, "approach"),
    ],
)
def test_what_a_camera_cannot_fly_is_refused(
    pattern: Pattern, camera: CameraSensor, area: Polygon, more: dict[str, Any], constraint: str
) -> None:
    """By name, with what would work."""
    with pytest.raises(InfeasibleError) as caught:
        surveyed(pattern, area, camera, **more)
    assert (caught.value.constraint, caught.value.feature) == (constraint, "R")
    assert caught.value.relaxation


@pytest.mark.parametrize("width_m", [15.0, 66.0])
def test_corridors_are_seen_twice_at_their_bends_too(width_m: float) -> None:
    """One lane along each leg of a narrow one, several along a wide one; cut at its bends."""
    axis = LineString([(0.0, 0.0), (300.0, 0.0), (450.0, 200.0), (450.0, 500.0)])
    area = axis.buffer(width_m / 2.0, cap_style="flat")
    assert isinstance(area, Polygon)
    legs = surveyed("auto", area, axis=axis)
    assert len(legs) == 3
    for lanes, turn in zip(legs, (0.0, math.atan2(4.0, 3.0), math.pi / 2.0), strict=True):
        assert all(abs(math.sin(one.angle_rad - turn)) < 1e-6 for one in lanes)
        assert len(lanes) == (1 if width_m < 24.0 else 3)
    counts = seen([one for lanes in legs for one in lanes], area)
    assert counts.max(axis=0).min() >= 2


def test_regions_of_a_pattern_of_their_own_stay_apart() -> None:
    """Two squares 20 m apart are one survey as lanes and two orbits."""
    both = [box(0.0, 0.0, 50.0, 50.0), box(70.0, 0.0, 120.0, 50.0)]
    for pattern, count in (("lanes", 1), ("orbit", 2)):
        regions = tuple(Region(f"R{k}", area, pattern=pattern) for k, area in enumerate(both))  # type: ignore[arg-type]
        assert len(merge_regions(regions)) == count


@pytest.mark.parametrize("pattern", ["crosshatch", "orbit", "spiral"])
def test_the_judge_finds_nothing_wrong_with_a_pattern(pattern: str) -> None:
    """From scenario to verdict: all seen, and overlaps asked of lanes alone."""
    eye = {"name": "eye", "type": "camera", "focal_length_m": 0.02, "pixel_pitch_m": 3.9e-6}
    document = small(altitude_m=HEIGHT_M, sensors=[{**eye, "image_px": [6000, 4000]}])
    document["features"] = [each for each in document["features"] if each["id"] != "B"]
    document["features"][0] = feature("A", "roi", "Polygon", square(0.0, 0.0, 0.0004), pattern=pattern)
    plan = make_plan(read_scenario(document))
    assert plan.violations == ()
    assert plan.metrics.coverage == {"A": 1.0}


@pytest.mark.parametrize(("pattern", "radius_m"), [("orbit", 8.0), ("spiral", 8.0), ("orbit", 30.0)])
def test_rings_are_flown_on_where_an_arc_fits_between_their_chords(pattern: Pattern, radius_m: float) -> None:
    """A circle of the turn radius touches both chords at their ends; all other chords are turned to."""
    (passes,) = surveyed(pattern, Point(100.0, -50.0).buffer(150.0), radius_m=radius_m)
    assert sum(one.goes_on for one in passes) > len(passes) / 2
    for before, one in pairwise(passes):
        if not one.goes_on:
            continue
        turned_rad = abs(math.remainder(one.angle_rad - before.angle_rad, math.tau))
        across_m = math.dist(before.end, one.start)
        assert across_m == pytest.approx(2.0 * radius_m * math.sin(turned_rad / 2.0), rel=1e-6)


def test_wings_go_round_a_place_in_one_turn() -> None:
    """With 100 m of straight flight before each pass, but none before the chords of a ring."""
    ring = [[0.002 * math.cos(a), 0.002 * math.sin(a)] for a in np.linspace(0.0, math.tau, 25)[:-1]]
    scenario = small(sensors=[{"name": "eye", "type": "camera", "focal_length_m": 0.02, "pixel_pitch_m": 4e-6,
                               "image_px": [6000, 4000]}], altitude_m=100.0)  # fmt: skip
    scenario["features"] = [
        feature("A", "roi", "Polygon", [[*ring, ring[0]]], pattern="orbit"),
        feature("start", "start", "Point", [-0.004, -0.004]),
    ]
    scenario["vehicles"] = [{"name": "w", "airspeed_m_s": 16.0, "min_turn_radius_m": 37.0, "settle_m": 100.0}]
    plan = make_plan(read_scenario(scenario))
    assert plan.violations == ()
    on_lines_m = sum(collect.end_m - collect.start_m for collect in plan.collects)
    assert plan.metrics.length_m < 3.0 * on_lines_m
