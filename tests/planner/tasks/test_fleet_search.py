"""The task search for several aircraft, from GeoJSON to a judged plan."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon

from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.validate import findings
from tests.planner.search.searches import CAMERA, WING, document, feature, lonlat, rectangle

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


def in_the_air(**members):
    """Two near one rich place."""
    rich = rectangle("importance", 450.0, 100.0, 750.0, 800.0, score=2.0)
    rest = rectangle("importance", 0.0, 0.0, 1200.0, 900.0, score=0.1)
    vehicles = []
    for name, north_m in (("a", 250.0), ("b", 650.0)):
        lon_deg, lat_deg = lonlat(300.0, north_m)
        place = {"lon_deg": lon_deg, "lat_deg": lat_deg, "height_m": 100.0, "heading_deg": 90.0}
        vehicles.append(SMALL | {"name": name, "energy_wh": 9, "in_flight": place})
    asked = document(rich, rest, method={"search": "parallel"}, **members) | {"vehicles": vehicles}
    scenario = read_scenario(asked)
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    prints = {
        name: shapely.union_all(
            [Polygon(scenario.frame.to_local(f.ring)) for f in plan.footprints if f.vehicle == name]
        ).intersection(scenario.area)
        for name in ("a", "b")
    }
    return plan, prints


def test_aircraft_in_the_air_both_search_and_mostly_what_the_other_does_not():
    """Kept apart by little, each sees some of it, and what the other saw is left to it.

    Where both would come home at once one flies less.
    """
    plan, prints = in_the_air(separation={"horizontal_m": 20.0, "vertical_m": 10.0})
    smaller_m2 = min(each.area for each in prints.values())
    assert smaller_m2 > 0.0
    assert prints["a"].intersection(prints["b"]).area < 0.5 * smaller_m2
    assert 0.0 < plan.metrics.importance_collected <= plan.metrics.importance_bound


def test_one_that_comes_too_near_wherever_it_searches_flies_home_and_says_so():
    """The other's search is not given up with it."""
    plan, prints = in_the_air(separation={"horizontal_m": 250.0, "vertical_m": 60.0})
    assert {path.vehicle for path in plan.paths} == {"a", "b"}
    assert plan.metrics.importance_collected > 0.0
    idle = [name for name, seen in prints.items() if seen.is_empty]
    assert idle
    assert all(any(name in warning and "too near" in warning for warning in plan.warnings) for name in idle)


def test_what_two_find_does_not_hang_on_how_the_ground_is_drawn():
    """Mirrored, a tenth of a millimetre off, the other aircraft first, two find as much."""
    rng = np.random.default_rng(1)

    def found(place, wind_from_deg=300.0, order=1):
        def ring(west, south, east, north):
            corners = [place(e, n) for e, n in ((west, south), (east, south), (east, north), (west, north))]
            return [[*corners, corners[0]]]

        fast = SMALL | {"name": "b", "airspeed_m_s": 20, "energy_wh": 18}
        asked = {
            "type": "FeatureCollection", "task": "search", "altitude_m": 100,
            "vehicles": [SMALL | {"name": "a"}, fast][::order], "sensors": [CAMERA],
            "wind": {"speed_m_s": 4.0, "from_deg": wind_from_deg},
            "features": [
                feature("area", "Polygon", ring(-100.0, -100.0, 1900.0, 1400.0)),
                feature("importance", "Polygon", ring(0.0, 0.0, 1800.0, 1300.0), score=0.2),
                feature("importance", "Polygon", ring(900.0, 350.0, 1700.0, 1100.0), score=2.0),
                feature("start", "Point", place(300.0, 100.0)),
            ],
        }  # fmt: skip
        plan = make_plan(read_scenario(asked))
        assert plan.violations == ()
        return plan.metrics.importance_collected

    otherwise = found(lambda e, n: [deg + 1e-9 * rng.normal() for deg in lonlat(-e, n)], 60.0, -1)
    assert otherwise == pytest.approx(found(lonlat), rel=0.005)
