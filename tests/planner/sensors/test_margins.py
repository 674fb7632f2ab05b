"""Margins of pointing and position: planned with less than the beam sees, judged with all of it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.as_flown.track import TrackSample
from planner.check import footprint
from planner.coverage.strips.neighbourhood import check_sensor
from planner.errors import InfeasibleError, ScenarioError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Collect, Plan
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.tasks.flown import flown_coverage
from tests.planner.scenarios import case, feature, small, square

PLAIN = SarSensor("sar", math.radians(45.0), math.radians(30.0), math.radians(10.0))
MARGINS = {"pointing_margin_deg": 1.5, "position_margin_m": 8.0}


def document(margins: dict[str, float], **members: Any) -> dict[str, Any]:
    """The small scenario and a region wider than the swath, with margins on its sensor."""
    wide = feature("wide", "roi", "Polygon", square(0.02, 0.03, 0.0084))
    scenario = small(wide, **members)
    scenario["sensors"][0].update(margins)
    return scenario


def planned(margins: dict[str, float], **members: Any) -> tuple[Scenario, Plan]:
    """The scenario and its plan."""
    scenario = read_scenario(document(margins, **members))
    return scenario, make_plan(scenario)


@given(st.floats(200.0, 3000.0), st.floats(0.0, 5.0), st.floats(0.0, 20.0), st.floats(-1.0, 1.0))
def test_a_beam_rolled_and_moved_within_its_margins_still_holds_the_planned_swath(
    height_m: float, pointing_deg: float, position_m: float, share: float
) -> None:
    """Whatever part of both margins is used up, the planned swath lies between the real beam's edges."""
    margin = math.radians(pointing_deg)
    sensor = replace(PLAIN, pointing_margin_rad=margin, position_margin_m=position_m)
    half = math.radians(15.0)
    near_m = height_m * math.tan(math.radians(45.0) - half + share * margin) + share * position_m
    far_m = height_m * math.tan(math.radians(45.0) + half + share * margin) + share * position_m
    assert near_m <= sensor.near_m(height_m) + 1e-9
    assert far_m >= sensor.far_m(height_m) - 1e-9
    turned_m = math.hypot(sensor.far_m(height_m), height_m) * math.tan(margin)
    assert sensor.run_in_m(height_m) == pytest.approx(PLAIN.run_in_m(height_m) + position_m + turned_m)
    assert sensor.run_out_m(height_m) == pytest.approx(PLAIN.run_out_m(height_m) + position_m + turned_m)
    assert sensor.collection_m(height_m, 900.0) == pytest.approx(
        900.0 + sensor.run_in_m(height_m) + sensor.run_out_m(height_m)
    )
    assert sensor.whole() == PLAIN


def flown_off(scenario: Scenario, plan: Plan, roll_deg: float, across_m: float, along_m: float) -> float:
    """The least seen of any region when every pass is rolled and beside its place by so much."""
    samples: list[TrackSample] = []
    for collect in plan.collects:
        samples += _samples(scenario, collect, roll_deg, across_m, along_m, 1000.0 * collect.seq)
    return min(flown_coverage(scenario, plan, samples).fraction.values())


def _samples(
    scenario: Scenario, collect: Collect, roll_deg: float, across_m: float, along_m: float, start_s: float
) -> list[TrackSample]:
    (east0, north0), (east1, north1) = scenario.frame.to_local([place[:2] for place in collect.line])
    length_m = math.hypot(east1 - east0, north1 - north0)
    ahead = ((east1 - east0) / length_m, (north1 - north0) / length_m)
    samples = []
    for k in range(51):
        along = length_m * k / 50.0 + along_m
        east_m = east0 + ahead[0] * along + ahead[1] * across_m
        north_m = north0 + ahead[1] * along - ahead[0] * across_m
        lon_deg, lat_deg = (float(value) for value in scenario.frame.to_wgs84((east_m, north_m)))
        samples.append(TrackSample(start_s + k, lon_deg, lat_deg, scenario.height_m, roll_deg, True))
    return [*samples, replace(samples[-1], time_s=start_s + 51.0, sensor_on=False)]


@pytest.mark.parametrize("coverage", ["auto", "li2018"])
def test_flown_at_the_margins_all_is_seen_and_without_them_not(coverage: str) -> None:
    """As flown with the whole beam: rolled either way, left or right, early or late, within the margins."""
    members: dict[str, Any] = {"method": {"coverage": coverage}}
    careful, plain = planned(MARGINS, **members), planned({}, **members)
    assert careful[1].violations == plain[1].violations == ()
    offsets = [(roll * 1.49, across * 7.9, roll * 7.9) for roll in (-1.0, 1.0) for across in (-1.0, 1.0)]
    assert min(flown_off(*careful, *off) for off in offsets) > 0.99999
    assert min(flown_off(*plain, *off) for off in offsets) < 0.999


def test_published_footprints_are_of_the_whole_beam() -> None:
    """The footprint of each pass is what the judge says is seen, wider than the swath planned with."""
    scenario, plan = planned(MARGINS)
    assert plan.collects
    for collect, published in zip(plan.collects, plan.footprints, strict=True):
        judged = footprint(scenario, collect)
        ring = scenario.frame.to_local(published.ring)
        assert type(judged)(ring).symmetric_difference(judged).area < 1e-3 * judged.area
        width_m = judged.area / (collect.end_m - collect.start_m - PLAIN.aperture_m(500.0))
        assert width_m == pytest.approx(PLAIN.swath_m(500.0), rel=1e-3)
        assert width_m > scenario.sensors[0].swath_m(500.0) + 2.0 * 8.0


def test_squinted_passes_keep_their_margins() -> None:
    """A squinted sensor's passes see all when beside their place, and not without margins."""
    careful, plain = planned(MARGINS | {"squint_deg": 15.0}), planned({"squint_deg": 15.0})
    assert careful[1].violations == ()
    offsets = [(0.0, sign * 7.9, sign * 7.9) for sign in (-1.0, 1.0)]
    assert min(flown_off(*careful, *off) for off in offsets) > 0.9999
    assert min(flown_off(*plain, *off) for off in offsets) < 0.999


def test_no_margin_changes_nothing() -> None:
    """Margins of nought give the line of the first shared case as without them."""
    plain = case(1)
    zeros = case(1)
    zeros["sensors"][0].update(pointing_margin_deg=0.0, position_margin_m=0.0)
    lines = [make_plan(read_scenario(one)).paths[0].line for one in (plain, zeros)]
    assert lines[0] == lines[1]


@pytest.mark.parametrize(
    ("margins", "rule"),
    [
        ({"pointing_margin_deg": 15.0}, "swath-not-positive"),
        ({"pointing_margin_deg": 15.1}, "out-of-range"),
        ({"pointing_margin_deg": -1.0}, "out-of-range"),
        ({"position_margin_m": -0.5}, "out-of-range"),
        ({"position_margin_m": "wide"}, "bad-value"),
        ({"position_margin_m": 289.0}, "swath-not-positive"),
        ({"pointing_margin_deg": 14.0, "position_margin_m": 20.0}, "swath-not-positive"),
    ],
)
def test_margins_that_cannot_be_are_refused(margins: dict[str, Any], rule: str) -> None:
    """Negative, no number, or nothing left of the swath: named, with the rule."""
    with pytest.raises(ScenarioError) as caught:
        read_scenario(document(margins))
    assert rule in [finding.rule for finding in caught.value.findings]


def test_a_height_too_low_for_the_margins_is_refused_by_the_planner() -> None:
    """Where the ground is only known later, the stage that plans says that the margins leave nothing."""
    scenario = read_scenario(document({"position_margin_m": 200.0}))
    check_sensor(scenario.regions[0], scenario.sensors[0], 500.0)
    with pytest.raises(InfeasibleError) as caught:
        check_sensor(scenario.regions[0], scenario.sensors[0], 300.0)
    assert caught.value.constraint == "swath"
    assert "margins" in str(caught.value)
