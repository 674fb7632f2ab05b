"""The task search, from GeoJSON to a judged plan."""

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon

from mavlink.encoding.encode import encode
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan, with_bound
from tests.planner.search.searches import CAMERA, COPTER, RADAR, WING, document, feature, lonlat, rectangle


def seen_m2(scenario, plan):
    """Ground of the footprints that the plan publishes, in the area."""
    prints = [Polygon(scenario.frame.to_local(f.ring)) for f in plan.footprints]
    return shapely.union_all(prints).intersection(scenario.area).area


@pytest.mark.parametrize(
    ("vehicle", "sensor", "altitude_m"),
    [(WING, None, 100), (COPTER, None, 100), (WING | {"energy_wh": 40}, RADAR, 150)],
    ids=["camera", "copter", "radar"],
)
def test_a_search_comes_home_with_its_reserve(vehicle, sensor, altitude_m):
    """The plan keeps every constraint, uses nearly all it may and no more, and says what its prints see."""
    asked = document(vehicle=vehicle, altitude_m=altitude_m, **({} if sensor is None else {"sensor": sensor}))
    scenario = read_scenario(asked)
    plan = make_plan(scenario)
    assert plan.violations == ()
    usable_wh = 0.8 * vehicle["energy_wh"]
    whole = math.isclose(plan.metrics.coverage["area"], 1.0)
    assert plan.metrics.energy_wh <= usable_wh
    assert whole or plan.metrics.energy_wh > 0.9 * usable_wh
    assert plan.metrics.area_seen_m2 == pytest.approx(seen_m2(scenario, plan), rel=1e-3)
    assert plan.metrics.coverage["area"] == pytest.approx(
        plan.metrics.area_seen_m2 / scenario.area.area, rel=1e-4
    )
    assert plan.metrics.importance_collected is None
    assert plan.metrics.importance_bound is None
    assert plan.metrics.area_seen_m2 <= plan.metrics.area_seen_bound_m2 <= scenario.area.area * 1.01
    assert with_bound(scenario, plan) == plan
    assert read_plan(write_plan(plan)).metrics == plan.metrics
    assert encode(plan).mission


def test_importance_draws_the_search():
    """Ground that is worth more is seen first, its worth is counted anew, and twice the same plan is made."""
    patch = rectangle("importance", 800.0, 500.0, 1100.0, 800.0, score=2.5)
    scenario = read_scenario(document(patch))
    plan = make_plan(scenario)
    assert write_plan(make_plan(scenario))["features"] == write_plan(plan)["features"]
    prints = [Polygon(scenario.frame.to_local(f.ring)) for f in plan.footprints]
    wanted = scenario.importance.patches[0].area
    seen = shapely.union_all(prints).intersection(wanted).area
    assert seen > 0.9 * wanted.area
    assert plan.metrics.importance_collected == pytest.approx(2.5 * seen, rel=1e-3)
    assert plan.metrics.importance_collected <= plan.metrics.importance_bound


@pytest.mark.parametrize("name", ["importance", "snyder2021"])
def test_walks_over_importance_are_flown_by_name(name):
    """The walk's strips, cut to the energy, keep every constraint; most of what is worth more is seen."""
    patch = rectangle("importance", 800.0, 500.0, 1100.0, 800.0, score=2.5)
    scenario = read_scenario(document(patch, method={"search": name}))
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert (
        write_plan(plan)["metrics"]["importance_collected"]
        > 0.6 * 2.5 * scenario.importance.patches[0].area.area
    )


def test_zones_are_flown_round():
    """No pass enters a zone in the ground, nor the flight, in the pattern asked for by name."""
    zone = rectangle("no_fly", 500.0, 300.0, 700.0, 600.0)
    scenario = read_scenario(document(zone, method={"search": "spiral"}))
    plan = make_plan(scenario)
    assert plan.methods["search"] == "spiral"
    line = shapely.LineString(scenario.frame.to_local([place[:2] for place in plan.paths[0].line]))
    assert plan.violations == ()
    assert not line.intersects(scenario.no_fly[0].area)


@pytest.mark.parametrize("side_m", [2.0, 30.0, 70.0])
@pytest.mark.parametrize("vehicle", [WING, COPTER], ids=["wing", "copter"])
def test_ground_smaller_than_a_frame_is_seen(vehicle, side_m):
    """Ground shorter than what one photo sees is not blocked: a short pass over it sees all."""
    patch = rectangle("roi", 600.0, 400.0, 600.0 + side_m, 400.0 + side_m)
    scenario = read_scenario(document(patch, vehicle=vehicle))
    plan = make_plan(scenario)
    assert plan.violations == ()
    prints = shapely.union_all([Polygon(scenario.frame.to_local(f.ring)) for f in plan.footprints])
    ground = scenario.regions[0].area
    assert prints.intersection(ground).area == pytest.approx(ground.area, rel=1e-3)


def test_an_end_elsewhere_is_kept():
    """The flight ends at its end."""
    scenario = read_scenario(
        document({"type": "Feature", "geometry": {"type": "Point", "coordinates": lonlat(1050.0, 750.0)},
                  "properties": {"role": "end"}})
    )  # fmt: skip
    plan = make_plan(scenario)
    last = scenario.frame.to_local(plan.paths[0].line[-1][:2])
    assert np.hypot(*(last - np.array(scenario.end.position))) < 1.0
    assert plan.violations == ()


@pytest.mark.parametrize(
    "name", ["energy-horizon", "energy-horizon-discrete", "energy-horizon-no-decision", "energy-horizon-time"]
)
@pytest.mark.parametrize("vehicle", [WING, COPTER], ids=["wing", "copter"])
def test_the_published_horizon_is_flown_by_name(name, vehicle):
    """Its straights are passes, the flight keeps every constraint, and deciding is told from not deciding."""
    scenario = read_scenario(document(vehicle=vehicle, method={"search": name}))
    plan = make_plan(scenario)
    assert plan.methods["search"] == name
    assert plan.violations == ()
    assert plan.metrics.area_seen_m2 > 0.1 * scenario.area.area


def test_moved_strips_find_more_than_patterns_and_as_much_mirrored():
    """Where energy sees part of the ground: by a twentieth at the least, and mirrored all but as much."""

    def found(sign, wind_from_deg, **members):
        def drawn(role, west, south, east, north, **properties):
            low, high = sorted((sign * west, sign * east))
            return rectangle(role, low, south, high, north, **properties)

        asked = document(vehicle=WING | {"energy_wh": 16}, **members)
        asked["wind"] = {"speed_m_s": 4.0, "from_deg": wind_from_deg}
        asked["features"] = [
            drawn("area", -100.0, -100.0, 1900.0, 1400.0),
            drawn("importance", 0.0, 0.0, 1800.0, 1300.0, score=0.2),
            drawn("importance", 900.0, 350.0, 1700.0, 1100.0, score=2.0),
            feature("start", "Point", lonlat(sign * 300.0, 100.0)),
        ]
        plan = make_plan(read_scenario(asked))
        assert plan.violations == ()
        return plan.metrics.importance_collected

    moved = found(1.0, 300.0)
    assert moved > 1.05 * found(1.0, 300.0, method={"search": "parallel"})
    assert found(-1.0, 60.0) == pytest.approx(moved, rel=0.02)


def test_refined_sees_no_less_than_patterns():
    """Strips moved each by itself, flown whole, find as much as the patterns that they began as."""
    patch = rectangle("importance", 700.0, 100.0, 1000.0, 800.0, score=2.5)
    asked = document(patch, feature("importance", "Point", lonlat(300, 600), score=3.0, spread_m=80.0))
    worth = {
        name: make_plan(read_scenario(asked | {"method": {"search": name}})).metrics.importance_collected
        for name in ("parallel", "creeping", "refined")
    }
    assert worth["refined"] >= max(worth.values()) * (1.0 - 1e-9)


@pytest.mark.parametrize("sensor", [CAMERA, RADAR], ids=["camera", "radar"])
@pytest.mark.parametrize("tiny", [(1100, 800, 1110, 808), (1150, 50, 1152, 52)])
def test_a_tiny_region_beside_a_large_one_is_seen_where_there_is_energy(sensor, tiny):
    """It is no part of any pattern over both; what a pattern leaves of the large one is seen, too."""
    asked = document(
        rectangle("roi", 100.0, 100.0, 700.0, 700.0, name="large"),
        rectangle("roi", *tiny, name="tiny"),
        vehicle=WING | {"energy_wh": 60}, sensor=sensor, altitude_m=120,
    )  # fmt: skip
    asked["features"][0] = rectangle("area", -800.0, -800.0, 2200.0, 2000.0)
    plan = make_plan(read_scenario(asked))
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == {"large": 1.0, "tiny": 1.0}
    assert plan.metrics.energy_wh <= 0.8 * 60


def test_what_cannot_be_reached_with_the_energy_left_stays_unseen():
    """With little energy a far small region is left out, and the flight is no longer for it."""
    asked = document(
        rectangle("roi", 100.0, 100.0, 500.0, 500.0, name="large"),
        rectangle("roi", 6100.0, 100.0, 6110.0, 110.0, name="far"),
        vehicle=WING | {"energy_wh": 16},
    )
    asked["features"][0] = rectangle("area", -800.0, -800.0, 7200.0, 2000.0)
    plan = make_plan(read_scenario(asked))
    assert plan.hard_violations == ()
    assert plan.metrics.coverage["far"] == pytest.approx(0.0, abs=1e-6)
    assert plan.metrics.coverage["large"] > 0.5
    assert plan.metrics.energy_wh <= 0.8 * 16
