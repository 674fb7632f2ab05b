"""The task search for several aircraft, from GeoJSON to a judged plan."""

from itertools import pairwise

import pytest
import shapely
from shapely.geometry import Polygon

from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.validate import findings
from tests.planner.search.searches import WING, document

SMALL = WING | {"energy_wh": 14}


def shared(*vehicles):
    """The search of 1200 m by 900 m by these vehicles."""
    return document() | {"vehicles": list(vehicles)}


def test_two_aircraft_share_the_ground():
    """Both come home with their reserve, nothing is seen by both, and what both see is added up."""
    fast = SMALL | {"name": "b", "airspeed_m_s": 20, "energy_wh": 18}
    scenario = read_scenario(shared(SMALL | {"name": "a"}, fast))
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert set(plan.metrics.vehicles) == {"a", "b"}
    assert plan.metrics.vehicles["a"].energy_wh <= 0.8 * 14
    assert plan.metrics.vehicles["b"].energy_wh <= 0.8 * 18
    seen = {
        name: shapely.union_all(
            [Polygon(scenario.frame.to_local(f.ring)) for f in plan.footprints if f.vehicle == name]
        ).intersection(scenario.area)
        for name in ("a", "b")
    }
    both_m2 = seen["a"].union(seen["b"]).area
    assert seen["a"].intersection(seen["b"]).area < 0.1 * both_m2
    assert plan.metrics.area_seen_m2 == pytest.approx(both_m2, rel=1e-3)
    assert both_m2 > 1.3 * max(each.area for each in seen.values())
    assert read_plan(write_plan(plan)).metrics == plan.metrics


def test_batteries_search_one_after_the_other():
    """Each battery is a flight of its own, lifting off once the one before is down and changed."""
    plan = make_plan(read_scenario(shared(SMALL | {"batteries": 2, "turnaround_s": 60})))
    assert plan.violations == ()
    flights = sorted((path.start_s, path.start_s + path.duration_s) for path in plan.paths)
    assert len(flights) == 2
    assert all(after[0] >= before[1] + 60.0 - 1e-6 for before, after in pairwise(flights))


def test_an_aircraft_that_cannot_search_stays_at_home():
    """What keeps one of two at home is a warning, and the other searches; of all it is an error."""
    empty = SMALL | {"name": "b", "energy_wh": 1}
    asked = shared(SMALL | {"name": "a"}, empty)
    assert {("b", "warning")} == {(f.feature, f.severity) for f in findings(asked) if f.feature in ("a", "b")}
    plan = make_plan(read_scenario(asked))
    assert {path.vehicle for path in plan.paths} == {"a"}
    assert plan.violations == ()
    none = findings(shared(empty | {"name": "a"}, empty))
    assert {f.feature for f in none if f.severity == "error"} == {"a", "b"}
