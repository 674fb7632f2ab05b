"""Planned anew in flight, heights of an aircraft are over the ground of the base that it took off from."""

from __future__ import annotations

import pytest

from app.services.plans.along import Course, where_planned
from app.services.plans.replanned import Changes
from app.services.plans.replanning import Asked, left_of
from mavlink.rules.heights import heights_of
from planner.check.clearance import begun_violations
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.plains import ABOARD, GROUND_M, LEVEL_M, over_plains, two_plains
from tests.planner.scenarios import feature, of_two, square


@pytest.mark.parametrize("at_s", [10.0, 60.0, 150.0])
def test_a_plan_made_in_flight_begins_at_the_height_flown(at_s: float) -> None:
    """In the climb and behind it: where the old plan has it then, its home the ground of its own base."""
    document = over_plains(of_two())
    terrains = {"t": two_plains()}.get
    scenario = read_scenario(document, terrains)
    plan = make_plan(scenario)
    flying = where_planned(scenario, plan, at_s)
    assert set(flying) == set(ABOARD)
    by_s = 4.0
    meant = {
        path.vehicle: Course(scenario, plan, path.vehicle, 1).place(at_s - path.start_s + by_s)
        for path in plan.paths
    }
    new = read_scenario(left_of(document, scenario, plan, Asked(at_s, {}, None, Changes(), by_s)), terrains)
    again = make_plan(new)
    assert again.violations == ()
    for path in again.paths:
        home_m = GROUND_M[ABOARD[path.vehicle]]
        assert path.line[0][2] == pytest.approx(home_m + meant[path.vehicle].height_m, abs=0.1)
        assert path.line[0][2] <= LEVEL_M + 0.1
        assert path.line[-1][2] == pytest.approx(home_m, abs=0.01)
        assert again.home_altitude_m(path.vehicle) == pytest.approx(home_m, abs=0.01)
        assert heights_of(again.of(path.vehicle), path.vehicle).lowest_m == pytest.approx(
            LEVEL_M - home_m, abs=0.1
        )


def test_a_zone_entered_before_the_new_plan_begins_counts_from_the_sea() -> None:
    """At 520 m over the sea each passes over one up to 510 m, and through one up to 530 m."""
    document = over_plains(of_two())
    terrains = {"t": two_plains()}.get
    scenario = read_scenario(document, terrains)
    plan = make_plan(scenario)
    for name in ABOARD:
        at_s = next(each.start_s for each in plan.collects if each.vehicle == name)
        lon_deg, lat_deg, _ = next(each.line[0] for each in plan.collects if each.vehicle == name)
        corner = square(lon_deg - 0.0005, lat_deg - 0.0005, 0.001)
        for top_m, entered in ((510.0, False), (530.0, True)):
            zone = feature("Z", "no_fly", "Polygon", corner, ceiling_m=top_m)
            changes = Changes(features=(zone,))
            asked = Asked(at_s - 2.0, {}, [], changes, 9.0)
            new = read_scenario(left_of(document, scenario, plan, asked), terrains)
            assert [each.feature for each in begun_violations(new)] == (["Z"] if entered else [])
