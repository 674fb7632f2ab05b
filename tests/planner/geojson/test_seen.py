"""Looks had before a search's start, as its scenario tells them."""

import numpy as np
import pytest
import shapely

from planner.check.searched import searched
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.search.seen import missed_before
from planner.tasks.worth import worth_of
from planner.validate import findings
from planner.wishes import Importance, Seen
from tests.planner.search.searches import document, rectangle

WEST = rectangle("roi", -10.0, -10.0, 400.0, 910.0)["geometry"]
ALL = rectangle("roi", -10.0, -10.0, 1210.0, 910.0)["geometry"]


def look(geometry=WEST, **told):
    """One look."""
    return {"type": "Feature", "geometry": geometry, "properties": told}


@pytest.mark.parametrize(
    ("seen", "feature", "rule"),
    [
        ({}, "search", "bad-value"),
        ([WEST] * 2_001, "search", "too-many"),
        ([{"type": "Point", "coordinates": [10.0, 47.0]}], "look 0 of search.seen", "bad-geometry"),
        ([WEST, look(ago_s=[1.0, 2.0])], "look 1 of search.seen", "bad-value"),
        ([look(ago_s=[float("nan"), 0.0])], "look 0 of search.seen", "bad-value"),
        ([look(ago_s=5.0)], "look 0 of search.seen", "bad-value"),
        ([look(heading_deg=-3.0)], "look 0 of search.seen", "out-of-range"),
        ([look(when=3.0)], "look 0 of search.seen", "unknown-property"),
        ([ALL], "search", "nothing-left"),
    ],
)
def test_looks_that_cannot_be_read_are_refused(seen, feature, rule):
    """By the entry's number and the rule; nothing left to be seen is one."""
    found = findings(document(search={"seen": seen}))
    assert (feature, rule) in {(f.feature, f.rule) for f in found if f.severity == "error"}


def test_where_a_look_finds_all_its_ground_is_none_any_more():
    """A third seen before is two thirds to be searched; what the plan says it sees is of those."""
    scenario = read_scenario(document(search={"seen": [WEST]}, method={"search": "parallel"}))
    (region,) = scenario.regions
    assert region.area.area == pytest.approx(800.0 * 900.0, rel=0.01)
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    assert plan.metrics.area_seen_m2 <= region.area.area
    assert plan.metrics.coverage["area"] == pytest.approx(
        plan.metrics.area_seen_m2 / region.area.area, rel=1e-4
    )


def test_looks_that_miss_leave_their_part():
    """Two looks of six tenths leave 16 % where both were had: planner's cells and judge's places agree."""
    patch = rectangle("importance", 0.0, 0.0, 1200.0, 900.0, score=2.0)
    south = look(rectangle("roi", -10.0, -10.0, 1210.0, 450.0)["geometry"])
    asked = document(patch, search={"seen": [WEST, south], "detection": 0.6}, method={"search": "parallel"})
    scenario = read_scenario(asked)
    (region,) = scenario.regions
    left = 1200 * 900 - 0.6 * (400 * 900 + 1200 * 450) + 0.36 * 400 * 450
    assert worth_of(scenario, region.area, 5.0).total == pytest.approx(2.0 * left, rel=0.01)
    assert searched(scenario, make_plan(scenario)).total == pytest.approx(2.0 * left, rel=0.01)


def test_a_look_meets_what_drifts_when_it_came_by():
    """Held against the flight in steps of a hundredth of a second: what the swath's front passes."""
    rng = np.random.default_rng(5)
    course_rad = 0.7
    turn = np.array([[np.cos(course_rad), -np.sin(course_rad)], [np.sin(course_rad), np.cos(course_rad)]])
    strip = shapely.transform(shapely.box(0.0, -60.0, 800.0, 60.0), lambda at: at @ turn.T + [50.0, -20.0])
    one = Seen(strip, -90.0, -50.0, course_rad)
    places = np.array([300.0, 200.0]) + 300.0 * rng.standard_normal((300, 2))
    drifts = rng.uniform(-2.0, 2.0, (300, 2))
    met = np.zeros(300, dtype=bool)
    near = np.zeros(300, dtype=bool)
    before = None
    for at_s in np.arange(-90.0, -50.0, 0.01):
        own = (places + at_s * drifts - [50.0, -20.0]) @ turn
        front_m = 800.0 * (at_s + 90.0) / 40.0
        passed = own[:, 0] <= front_m
        if before is not None:
            crossed = passed & ~before
            met |= crossed & (np.abs(own[:, 1]) <= 60.0)
            near |= crossed & (np.abs(np.abs(own[:, 1]) - 60.0) < 1.0)
        near |= (np.abs(own[:, 0]) < 5.0) | (np.abs(own[:, 0] - 800.0) < 5.0)
        before = passed
    left = missed_before(Importance(detection=0.7, seen=(one,)), places, drifts)
    expected = np.where(met, 0.3, 1.0)
    assert met.sum() > 20
    assert np.allclose(left[~near], expected[~near])
