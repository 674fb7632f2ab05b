"""The bound of a plan: every plan has one, and none is above any method's plan, however regions are taken."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from tests.planner.scenarios import feature, small, square
from tests.planner.stages import plan_bound_m

METHODS: list[dict[str, str]] = [
    {},
    {"routing": "li2018"},
    {"routing": "li2018-threat-aware", "transit": "ssas"},
    {"coverage": "li2018", "routing": "joint"},
]
ELL = [
    [[0.04, 0.03], [0.05, 0.03], [0.05, 0.034], [0.044, 0.034], [0.044, 0.042], [0.04, 0.042], [0.04, 0.03]]
]
#: An L with arms three to four swaths wide.
BENT = [
    (0.02, 0.02),
    (0.045, 0.02),
    (0.045, 0.032),
    (0.032, 0.032),
    (0.032, 0.05),
    (0.02, 0.05),
    (0.02, 0.02),
]


def twins() -> list[dict[str, Any]]:
    """Two regions that are merged, too far apart in one direction to be seen together for little."""
    return [
        feature("T1", "roi", "Polygon", square(-0.02, 0.02, 0.003)),
        feature("T2", "roi", "Polygon", square(-0.0155, 0.0207, 0.003)),
    ]


@pytest.mark.parametrize(
    ("more", "sensor", "members", "methods"),
    [
        (twins(), {}, {}, METHODS),
        (
            twins(),
            {"look": "both", "squint_deg": 12.0},
            {"wind": {"speed_m_s": 7.0, "from_deg": 30.0}},
            METHODS,
        ),
        ([feature("L", "roi", "Polygon", ELL)], {"squint_deg": -10.0}, {}, METHODS[:2]),
        (
            [feature("C", "roi", "LineString", [[0.04, 0.03], [0.05, 0.03], [0.05, 0.04]], width_m=200.0)],
            {},
            {"wind": {"speed_m_s": 7.0, "from_deg": 130.0}},
            METHODS,
        ),
    ],
)
def test_no_methods_plan_is_below_any_methods_bound(
    more: list[dict[str, Any]],
    sensor: dict[str, Any],
    members: dict[str, Any],
    methods: list[dict[str, str]],
) -> None:
    """Merged, divided, whole: what is proved of one plan holds for the others, and aiming higher, too."""
    lengths, bounds = [], []
    for method in methods:
        document = small(*more, method=method, **members)
        document["sensors"][0] |= sensor
        scenario = read_scenario(document)
        try:
            plan = with_bound(scenario, make_plan(scenario))
        except InfeasibleError:
            continue
        lengths.append(plan.metrics.route_length_m)
        assert plan.metrics.lower_bound_m is not None
        bounds.append(plan.metrics.lower_bound_m)
    bounds.append(plan_bound_m(scenario, 1.3 * min(lengths)))
    assert 0.6 * min(lengths) < max(bounds) <= min(lengths) + 1e-6


def test_where_more_are_divided_than_are_told_apart_a_place_of_each_counts() -> None:
    """Four merged pairs: the bound is there, below the plan, and more than the way from place to place."""
    document = small()
    for k in range(4):
        for name, east, north in (("a", 0.0, 0.0), ("b", 0.0045, 0.0007)):
            ring = square(-0.03 + 0.015 * k + east, 0.03 - 0.02 * (k % 2) + north, 0.003)
            document["features"].append(feature(f"T{k}{name}", "roi", "Polygon", ring))
    scenario = read_scenario(document)
    plan = with_bound(scenario, make_plan(scenario))
    assert plan.metrics.lower_bound_m is not None
    assert 0.3 * plan.metrics.length_m < plan.metrics.lower_bound_m <= plan.metrics.length_m


def test_regions_that_a_plan_leaves_out_do_not_count() -> None:
    """A wide region that is not required and two passes cannot see: left out of plan and bound."""
    wide = feature("W", "roi", "Polygon", square(0.045, -0.02, 0.015), required=False)
    without, scenario = (read_scenario(small(*more, method={"routing": "li2018"})) for more in ((), (wide,)))
    known, plan = (with_bound(asked, make_plan(asked)) for asked in (without, scenario))
    assert plan.metrics.length_m == pytest.approx(known.metrics.length_m)
    assert plan.metrics.lower_bound_m == pytest.approx(known.metrics.lower_bound_m)
    assert all("W" not in collect.regions for collect in plan.collects)


def test_with_nothing_known_of_its_regions_a_plan_is_as_long_as_straight_on() -> None:
    """From start to end and no regions that count: the straight line."""
    end = feature("end", "end", "Point", [0.03, 0.0])
    scenario = read_scenario(small(end))
    names = [region.name for region in scenario.regions]
    bound = plan_bound_m(scenario, 50_000.0, names)
    assert bound == pytest.approx(np.hypot(*np.subtract(scenario.start.position, scenario.end.position)))
    apart = replace(scenario, start=scenario.end)
    assert plan_bound_m(apart, 50_000.0, names) == 0.0


def test_bound_and_gap_are_of_the_mission_phase() -> None:
    """Of a short route much is flown before and after it: bound, length and gap leave that out alike."""
    near = feature("P", "roi", "Point", [0.004, 0.003])
    start = feature("start", "start", "Point", [0.0, 0.0])
    document = small(start, near)
    document["features"] = [start, near]
    scenario = read_scenario(document)
    metrics = with_bound(scenario, make_plan(scenario)).metrics
    assert metrics.lower_bound_m is not None
    assert metrics.gap is not None
    assert metrics.route_length_m is not None
    assert metrics.length_m < 0.95 * metrics.route_length_m
    assert 0.0 < metrics.lower_bound_m <= metrics.length_m
    assert metrics.gap == pytest.approx(1.0 - metrics.lower_bound_m / metrics.length_m, abs=1e-9)


def test_of_a_bent_region_near_another_the_division_counts() -> None:
    """Beside another region it may be divided as well as alone: no method's plan is below any bound."""
    ell = feature("L", "roi", "Polygon", [[[x, y] for x, y in BENT]])
    beside = feature("Q", "roi", "Polygon", square(0.052, 0.03, 0.012))
    lengths, bounds = [], []
    for method in METHODS:
        document = small(ell, beside, method=method)
        document["features"] = [f for f in document["features"] if f["id"] not in ("A", "B")]
        scenario = read_scenario(document)
        try:
            plan = with_bound(scenario, make_plan(scenario))
        except InfeasibleError:
            continue
        assert plan.metrics.lower_bound_m is not None
        lengths.append(plan.metrics.route_length_m)
        bounds.append(plan.metrics.lower_bound_m)
    bounds.append(plan_bound_m(scenario, 1.3 * min(lengths)))
    assert 0.4 * min(lengths) < max(bounds) <= min(lengths) + 1e-6
