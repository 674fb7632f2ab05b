"""Aircraft that cross over or under each other where the planner chooses heights, instead of waiting."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import FlownPath, Plan
from planner.scenario import Scenario
from tests.planner.scenarios import feature, square

SENSOR = {
    "type": "sar", "incidence_deg": 45.0, "elevation_beamwidth_deg": 30.0, "azimuth_beamwidth_deg": 10.0,
    "look": "both",
}  # fmt: skip
KEPT_M, KEPT_UP_M = 100.0, 30.0


def crossing(kind: str, **heights: Any) -> Scenario:
    """Two whose bases lie east and west of each other, each to see what lies beside the other's base."""
    features, vehicles = [], []
    for name, sign in (("west", -1.0), ("east", 1.0)):
        features.append(feature(f"{name} base", "base", "Point", [sign * 0.012, 0.0]))
        lon, lat = -sign * 0.008, sign * 0.0005
        features.append(
            feature(f"of {name}", "roi", "Polygon", square(lon, lat, 0.001), sensor=f"sar {name}")
        )
        own = {"name": name, "type": kind, "airspeed_m_s": 14.0, "base": f"{name} base"}
        if kind != "multirotor":
            own["min_turn_radius_m"] = 50.0
        vehicles.append(own | {"sensors": [f"sar {name}"]})
    document = {
        "type": "FeatureCollection",
        "features": features,
        "vehicles": vehicles,
        "sensors": [SENSOR | {"name": f"sar {name}"} for name in ("west", "east")],
        "separation": {"horizontal_m": KEPT_M, "vertical_m": KEPT_UP_M},
        **heights,
    }
    return read_scenario(document)


def least_m(scenario: Scenario, one: FlownPath, other: FlownPath) -> float:
    """The nearest at any tenth of a second along both published lines, but for those apart in height.

    Times along a line as its phases have them, even within each: of what is flown at one speed that is
    near enough, with a second more and less.
    """
    at = []
    for path in (one, other):
        line_m = scenario.frame.to_local([place[:2] for place in path.line])
        up_m = np.array([place[2] for place in path.line])
        reached_m = np.concatenate(
            [[0.0], np.cumsum(np.hypot(np.hypot(*np.diff(line_m, axis=0).T), np.diff(up_m)))]
        )
        marks = [(phase.start_s, phase.start_m) for phase in path.phases]
        marks.append((path.phases[-1].end_s, path.phases[-1].end_m))
        at.append((np.array(marks), reached_m, np.column_stack([line_m, up_m])))
    first_s = max(marks[0, 0] for marks, _, _ in at)
    last_s = min(marks[-1, 0] for marks, _, _ in at)
    found = np.inf
    for shift_s in (-1.0, 0.0, 1.0):
        moments = np.arange(first_s, last_s, 0.1)
        places = []
        for (marks, reached_m, line_m), moved_s in zip(at, (0.0, shift_s), strict=True):
            along_m = np.interp(moments + moved_s, marks[:, 0], marks[:, 1])
            places.append(np.column_stack([np.interp(along_m, reached_m, line_m[:, k]) for k in range(3)]))
        off = places[0] - places[1]
        near = np.abs(off[:, 2]) < KEPT_UP_M
        found = min(found, float(np.hypot(*off[near, :2].T).min(initial=np.inf)))
    return found


def last_s(plan: Plan) -> float:
    return max(path.end_s for path in plan.paths)


@pytest.fixture(scope="module", params=["multirotor", "fixed_wing"])
def both(request: pytest.FixtureRequest) -> tuple[Scenario, Plan, Plan]:
    """With heights left open, with and without using that."""
    scenario = crossing(request.param, min_height_m=60.0, max_height_m=120.0)
    return scenario, make_plan(scenario), make_plan(replace(scenario, band=None))


def test_crossing_at_heights_of_their_own_they_land_sooner(both: tuple[Scenario, Plan, Plan]) -> None:
    """Nobody waits for the other to be gone, and both see what they saw."""
    scenario, plan, level = both
    assert plan.violations == () == level.violations
    assert plan.metrics.coverage == pytest.approx(level.metrics.coverage)
    assert last_s(plan) < 0.95 * last_s(level)
    assert any("over or under" in warning for warning in plan.warnings)
    assert least_m(scenario, *plan.paths) >= KEPT_M


def test_passes_stay_at_their_height_and_legs_within_the_band(both: tuple[Scenario, Plan, Plan]) -> None:
    """Collects at the greatest height allowed; what is flown level between is no lower than is allowed."""
    _, plan, _ = both
    assert {round(place[2], 6) for collect in plan.collects for place in collect.line} == {120.0}
    for path in plan.paths:
        up_m = np.array([place[2] for place in path.line])
        level = np.abs(np.diff(up_m)) < 1e-6
        assert up_m[:-1][level].min() >= 60.0 - 1e-6
        assert up_m.max() <= 120.0 + 1e-6


def test_where_the_altitude_is_given_nobody_leaves_it() -> None:
    """``altitude_m`` decides all heights: one waits."""
    plan = make_plan(crossing("fixed_wing", altitude_m=120.0))
    assert plan.violations == ()
    assert not any("over or under" in warning for warning in plan.warnings)
