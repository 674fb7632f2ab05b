"""The survey benchmark: baselines are what they say, ours is never longer, its judge sees what is missing."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon, box

from benchmarks import survey
from benchmarks.photos import photos, places, seen_by
from benchmarks.survey_baselines import fields2cover, flown_m, qgc_transects, snake, swaths, to_and_fro
from benchmarks.survey_bound import least_order_m
from benchmarks.survey_overlap import looked_at, random_survey
from planner.airspace.values import STILL_AIR
from planner.dubins.words import shortest
from planner.pipeline import make_plan
from planner.route import Pose


def test_swaths_of_a_rectangle_are_worked_by_hand() -> None:
    """Four swaths of 40 m over 160 m by 300 m; one after the other three bulbs, every other one just one."""
    found = fields2cover(box(0.0, 0.0, 300.0, 160.0), 40.0, 30.0)
    there = shortest(Pose(0.0, 0.0, 0.0), Pose(0.0, 40.0, math.pi), 30.0).length_m
    over = shortest(Pose(0.0, 0.0, 0.0), Pose(0.0, 80.0, math.pi), 30.0).length_m
    assert over == pytest.approx(30.0 * math.pi + 20.0)
    assert found["boustrophedon"] == pytest.approx((4, 1200.0, 3.0 * there))
    assert found["snake"] == pytest.approx((4, 1200.0, there + 2.0 * over))
    assert snake(7) == [0, 2, 4, 6, 5, 3, 1]


def test_swaths_are_cut_where_they_leave_a_concave_field() -> None:
    """Across a U each line is two swaths in the arms and one in the base."""
    area = Polygon([(0, 0), (300, 0), (300, 200), (200, 200), (200, 100), (100, 100), (100, 200), (0, 200)])
    pieces = swaths(area, 0.0, 50.0)
    assert [round(float(np.ptp(piece[:, 0]))) for piece in pieces] == [300, 300, 100, 100, 100, 100]


def test_transects_lie_on_the_lattice_of_the_bounding_box() -> None:
    """Of a square of 100 m: from 1050 m beside its middle on, those of 30 m that meet it, edge to edge."""
    found = qgc_transects(box(0.0, 0.0, 100.0, 100.0), 0.0, 30.0)
    assert [round(float(line[0, 0]), 6) for line in found] == [20.0, 50.0, 80.0]
    assert all(sorted(line[:, 1].tolist()) == [0.0, 100.0] for line in found)
    turned = qgc_transects(box(0.0, 0.0, 100.0, 100.0), 90.0, 30.0)
    assert sorted(round(float(line[0, 1]), 6) for line in turned) == [20.0, 50.0, 80.0]


def test_lengths_are_those_of_lines_and_of_the_plain_turns() -> None:
    """Measured by shapely and by the plain words."""
    lines = to_and_fro([np.array([[0.0, 40.0 * k], [200.0, 40.0 * k]]) for k in range(3)], [0, 2, 1])
    lanes_m, turns_m = flown_m(lines, 30.0)
    assert lanes_m == pytest.approx(sum(LineString(line).length for line in lines))
    plain_m = [
        shortest(_pose(one, 1), _pose(other, 0), 30.0).length_m for one, other in itertools.pairwise(lines)
    ]
    assert turns_m == pytest.approx(sum(plain_m))


def _pose(line: np.ndarray, end: int) -> Pose:
    (e0, n0), (e1, n1) = line
    return Pose(float(line[end][0]), float(line[end][1]), math.atan2(n1 - n0, e1 - e0))


def test_ours_is_never_longer_on_fields_of_that_kind() -> None:
    """On all three, and no swath of theirs is without one of ours."""
    rows = list(survey.run(parts=("fields",)))
    for name in survey.FIELDS:
        of = [row for row in rows if row["field"] == name]
        ours = next(row for row in of if row["planner"] == "ours")
        assert ours["total_m"] <= min(row["total_m"] for row in of)


def test_no_order_of_lanes_comes_below_the_bound() -> None:
    """Of a rectangle, whose lanes end side by side, it is the flight; of slanted ends no order is less."""
    camera, radius_m = survey.camera_for(40.0), 20.0
    straight = box(0.0, 0.0, 400.0, 154.0)
    lines = survey.lines_of(survey.surveyed(straight, camera, radius_m))
    bound_m = least_order_m(straight, camera, survey.HEIGHT_M, radius_m)
    assert math.fsum(flown_m(lines, radius_m)) == pytest.approx(bound_m, rel=1e-9)
    slanted = Polygon([(0.0, 0.0), (400.0, 0.0), (520.0, 154.0), (80.0, 154.0)])
    lines = survey.lines_of(survey.surveyed(slanted, camera, radius_m))
    bound_m = least_order_m(slanted, camera, survey.HEIGHT_M, radius_m)
    flown = math.fsum(flown_m(lines, radius_m))
    assert 0.97 * flown <= bound_m <= 1.001 * flown
    orders = [lines[list(order)] for order in itertools.permutations(range(len(lines)))]
    ways = itertools.product((1, -1), repeat=len(lines))
    every = (
        math.fsum(flown_m(np.array([line[::way] for line, way in zip(order, each, strict=True)]), radius_m))
        for each in ways
        for order in orders
    )
    assert min(every) >= bound_m * (1.0 - 1e-3)


def test_the_judge_of_photos_misses_nothing() -> None:
    """With every other lane left out places are in one lane's photos only; half a lane left out, in none."""
    camera, area = survey.camera_for(40.0), box(0.0, 0.0, 240.0, 200.0)
    passes = survey.surveyed(area, camera, 20.0, (0.0, math.pi))
    at = places(area, 4.0)
    whole = seen_by(photos(passes, camera, survey.HEIGHT_M, 15.0, STILL_AIR), at)
    assert whole.max(axis=0).min() >= 2
    assert (whole > 0).sum(axis=0).min() >= 2
    kept = sorted(passes, key=lambda one: one.start[1])[::2]
    assert (seen_by(photos(kept, camera, survey.HEIGHT_M, 15.0, STILL_AIR), at) > 0).sum(axis=0).min() < 2


def test_random_regions_are_judged_photo_by_photo() -> None:
    """A few of the benchmark's 300, on a coarser grid: none unseen, none without its overlaps."""
    (row,) = survey.run(parts=("photos",), regions=3, grid_m=5.0, seed=7)
    assert (row["places_unseen"], row["places_in_one_photo"]) == (0, 0)
    assert row["least_lanes"] >= 2
    assert row["least_forward_kept"] >= 0.75 - 1e-3
    assert row["least_side_kept"] >= 0.65 - 1e-3


def test_random_surveys_overlap_as_asked() -> None:
    """Five of the benchmark's 300, wings that crab among them and a corridor round a bend, on 4 m."""
    *short, row = survey.run(parts=("overlap",), regions=5, grid_m=4.0)
    assert short == []
    assert (row["places_unseen"], row["places_once"], row["places_one_lane"]) == (0, 0, 0)
    assert min(row["least_forward_over_asked"], row["least_side_over_asked"]) >= -0.002


def test_photos_left_out_are_missed_over_terrain() -> None:
    """Of a survey over a slope: every other one, and less is shared; all but two, and ground is unseen."""
    asked = random_survey(1, 8)
    scenario = asked.scenario()
    plan = make_plan(scenario)
    whole = looked_at(asked, scenario, plan, 4.0)
    assert whole.forward_kept >= asked.forward - 0.01
    assert whole.unseen == whole.once == 0
    every_other = replace(plan, photos=tuple(replace(p, places=p.places[::2]) for p in plan.photos))
    assert looked_at(asked, scenario, every_other, 4.0).forward_kept < asked.forward - 0.05
    few = replace(plan, photos=tuple(replace(p, places=p.places[:2]) for p in plan.photos))
    assert looked_at(asked, scenario, few, 4.0).unseen > 0


def test_slants_are_how_far_ends_lie_apart_along_lanes() -> None:
    """Three lanes to and fro that each begin 15 m behind where the one before ended."""
    lines = np.array(
        [[[0.0, 0.0], [100.0, 0.0]], [[115.0, 40.0], [15.0, 40.0]], [[30.0, 80.0], [130.0, 80.0]]]
    )
    assert survey.slants_m(lines) == pytest.approx(30.0)


def test_ground_seen_from_lines_is_as_wide_as_photos_and_as_much_longer() -> None:
    """From 100 m a photo of 3 : 2 with lanes of 40 m at 60 % is 100 by 66.7 m."""
    camera = survey.camera_for(40.0, 0.6)
    seen = survey.seen_from([np.array([[0.0, 0.0], [0.0, 200.0]])], camera)
    assert seen.bounds == pytest.approx((-50.0, -100.0 / 3.0, 50.0, 200.0 + 100.0 / 3.0))
