"""A search planned anew in flight: what has been looked at is worth less, whoever looked."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon

from app.schemas.replans import ReplanIn
from app.services.errors import ConflictError
from app.services.flights.seen import Flown, Sortie
from app.services.plans.along import allowance_s
from app.services.plans.looked import Looked, flown_looks
from app.services.plans.replanning import SEARCH_S, left_of
from app.services.records import FlightRecord, TrackSample
from planner.check.searched import searched
from planner.geojson import read_scenario
from planner.geojson.going_on import MOST_S
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from tests.planner.search.searches import RADAR, WING, document, feature, lonlat, rectangle

BEGAN = datetime(2026, 5, 1, 12, tzinfo=UTC)
RICH = rectangle("importance", 800.0, 500.0, 1100.0, 800.0, name="rich", score=2.5)
PLAIN = rectangle("importance", 0.0, 0.0, 1200.0, 900.0, name="plain", score=1.0)
LOST = feature("importance", "Point", lonlat(600, 450), score=1e-5, spread_m=120.0, name="lost")
DRIFT = {"speed_m_s": 0.6, "toward_deg": 70.0, "spread_m_s": 0.1, "elapsed_s": 300.0}
CLOSE = {"horizontal_m": 30.0, "vertical_m": 10.0}
STORED = {key: value for key, value in WING.items() if key != "energy_wh"} | {
    "charge_mah": 1800, "voltage_v": 14.8,
}  # fmt: skip


@lru_cache
def asked(kind: str) -> tuple[dict[str, Any], Scenario, Plan]:
    """A search's document, read, and its plan."""
    made = {
        "finds": lambda: document(RICH, PLAIN, vehicle=STORED, method={"search": "parallel"}),
        "misses": lambda: document(
            RICH, PLAIN, sensor=RADAR, method={"search": "parallel"}, search={"detection": 0.6}
        ),
        "together": lambda: (
            document(RICH, PLAIN, method={"search": "parallel"}, separation=CLOSE)
            | {"vehicles": [WING | {"name": "a", "energy_wh": 14}, WING | {"name": "b", "energy_wh": 18}]}
        ),
        "drifts": lambda: document(
            LOST, method={"search": "parallel"}, search={"detection": 0.8, "drift": DRIFT}
        ),
    }[kind]()
    scenario = read_scenario(made)
    return made, scenario, make_plan(scenario)


def left(kind: str, **told: Any) -> dict[str, Any]:
    """What is left of it."""
    made, scenario, plan = asked(kind)
    return left_of(made, scenario, plan, ReplanIn.model_validate({"begins_in_s": 0.0} | told).asked())


def prints(scenario: Scenario, plan: Plan, until_s: float) -> list[Polygon]:
    """Footprints of the collects that have ended by a time."""
    ended = {(c.vehicle, c.seq) for c in plan.collects if c.end_s <= until_s}
    return [Polygon(scenario.frame.to_local(f.ring)) for f in plan.footprints if (f.vehicle, f.seq) in ended]


def test_a_search_goes_on_over_what_it_has_not_seen() -> None:
    """After some passes: their ground is no more asked for, their energy is used, and the rest is planned."""
    _, scenario, plan = asked("finds")
    at_s = plan.collects[len(plan.collects) // 2].end_s + 0.5
    scenario_left = left("finds", at_s=at_s)
    on = read_scenario(scenario_left)
    seen = shapely.union_all(prints(scenario, plan, at_s))
    (region,) = on.regions
    # Looks are drawn a fifth of a metre within what was seen.
    assert region.area.intersection(seen).area < 1.5 * 0.2 * seen.length
    assert region.area.area == pytest.approx(scenario.regions[0].area.difference(seen).area, rel=0.01)
    new = make_plan(on)
    assert new.hard_violations == ()
    before = replace(plan, collects=tuple(c for c in plan.collects if c.end_s <= at_s))
    found, whole = searched(scenario, before), searched(scenario, plan)
    assert new.metrics.importance_total == pytest.approx(whole.total - found.importance, rel=0.01)
    # What is found in all is what the first plan would have found, or more.
    assert found.importance + new.metrics.importance_collected > 0.97 * whole.importance
    store_wh = scenario.aircraft[0].energy_wh
    assert on.aircraft[0].energy_wh < store_wh
    assert on.aircraft[0].energy_wh * on.aircraft[0].reserve == pytest.approx(0.2 * store_wh)
    assert new.metrics.energy_wh <= on.aircraft[0].usable_wh
    assert new.paths[0].phases[0].kind == "mission"


def test_several_find_about_as_much_planned_anew_as_they_would_going_on() -> None:
    """By the judge: what was found until then and what the new plan finds, against the plan made whole."""
    _, scenario, plan = asked("together")
    at_s = 0.6 * max(path.start_s + path.duration_s for path in plan.paths)
    scenario_left = left("together", at_s=at_s)
    assert set(scenario_left["replan"]["unflown"]) == {"a", "b"}
    new = make_plan(read_scenario(scenario_left))
    assert new.hard_violations == ()
    whole = searched(scenario, plan)
    found = whole.total - new.metrics.importance_total
    assert found + new.metrics.importance_collected > 0.92 * whole.importance


def test_in_flight_a_search_is_planned_soon_and_begins_so_much_later() -> None:
    """Within a few seconds where its scenario says nothing, else as it says; aircraft fly on for as long."""
    made, scenario, plan = asked("finds")
    at_s = plan.collects[0].end_s

    def begins_in_s(budget_s: float | None) -> float:
        own = made if budget_s is None else made | {"time_budget_s": budget_s}
        read = replace(scenario, time_budget_s=budget_s)
        found = left_of(own, read, plan, ReplanIn.model_validate({"at_s": at_s}).asked())
        assert found["time_budget_s"] == (budget_s or SEARCH_S)
        return float(found["replan"]["begins_in_s"])

    assert begins_in_s(None) == pytest.approx(allowance_s(plan, ["uav"]) + SEARCH_S)
    assert begins_in_s(9.0) == pytest.approx(begins_in_s(None) - SEARCH_S + 9.0)
    assert begins_in_s(1e4) == MOST_S
    assert "time_budget_s" not in left("finds", at_s=0.0)


def test_a_pass_that_is_being_flown_is_seen_as_far_as_it_has_come() -> None:
    """Half of the longest pass's time: about half of its ground is left."""
    _, _, plan = asked("finds")
    longest = max(plan.collects, key=lambda each: each.end_s - each.start_s)
    middle_s = 0.5 * (longest.start_s + longest.end_s)
    areas = [
        read_scenario(left("finds", at_s=at_s)).regions[0].area
        for at_s in (longest.start_s, middle_s, longest.end_s)
    ]
    begun, half, ended = (area.area for area in areas)
    assert (begun - half) / (begun - ended) == pytest.approx(0.5, abs=0.1)


def test_all_seen_is_nothing_left() -> None:
    """Told that everything was seen there is no search to be planned; a part of it is left out."""
    _, scenario, plan = asked("finds")
    told = {"at_s": plan.collects[0].end_s}
    whole = rectangle("roi", -50.0, -50.0, 1250.0, 950.0)["geometry"]
    with pytest.raises(ConflictError, match="nothing is left"):
        left("finds", **told, seen=[whole])
    west = rectangle("roi", -50.0, -50.0, 600.0, 950.0)["geometry"]
    on = read_scenario(left("finds", **told, seen=[west]))
    assert on.regions[0].area.area == pytest.approx(0.5 * scenario.regions[0].area.area, rel=0.01)


def recorded(plan: Plan, scenario: Scenario, order: list[int], boot_s: float) -> Sortie:
    """A record of collects flown exactly, one after the other, on a clock of the aircraft's own."""
    samples: list[TrackSample] = []
    now_s = boot_s
    for number in order:
        collect = plan.collects[number]
        first, last = scenario.frame.to_local([p[:2] for p in collect.line])
        count = int(np.hypot(*(last - first)) // 5) + 2
        lasts_s = collect.end_s - collect.start_s
        for part in np.linspace(0.0, 1.0, count):
            lon_deg, lat_deg = scenario.frame.to_wgs84(first + part * (last - first)).tolist()
            at_s = now_s + part * lasts_s
            samples.append(TrackSample(at_s, lon_deg, lat_deg, None, 100.0, None, 0.0, 16.0, 1, True))
        samples.append(replace(samples[-1], sensor_on=False))
        now_s += lasts_s + 30.0
    record = FlightRecord(
        "f", "v", "uav", "p", "uav", "flying", BEGAN, None, len(samples)
    )  # fmt: skip
    return Sortie("p", "", "", (Flown(record, tuple(samples), (), ()),), None)


def test_looks_as_flown_are_counted_each_with_its_time() -> None:
    """A pass flown twice is two looks at its footprint, as long ago as the record has them."""
    made, scenario, plan = asked("misses")
    sortie = recorded(plan, scenario, [0, 1, 0], boot_s=1000.0)
    looks = flown_looks(sortie, scenario, plan)
    first, second = plan.collects[:2]
    assert len(looks) == 3
    (own,) = [f for f in plan.footprints if f.seq == first.seq]
    ground = Polygon(scenario.frame.to_local(own.ring)).intersection(scenario.regions[0].area)
    same = [look for look in looks if look.ground.symmetric_difference(ground).area < 0.05 * ground.area]
    lasts_s = [each.end_s - each.start_s for each in (first, second)]
    assert sorted(look.start_s for look in same) == pytest.approx([0.0, sum(lasts_s) + 60.0], abs=0.5)
    assert all(look.end_s - look.start_s == pytest.approx(lasts_s[0], abs=0.5) for look in same)
    on = left_of(made, scenario, plan, ReplanIn().asked(), sortie)
    assert len(on["search"]["seen"]) == len(looks)
    assert on["search"]["detection"] == 0.6
    # A look takes six tenths of what its ground is worth, the next six tenths of what is left.
    rich = scenario.importance.patches[0]
    worth = ground.area + 2.5 * ground.intersection(rich.area).area
    total = searched(scenario, plan).total
    for order, taken in (([0], 0.6), ([0, 0], 0.84)):
        sortie = recorded(plan, scenario, order, boot_s=5.0)
        again = read_scenario(left_of(made, scenario, plan, ReplanIn().asked(), sortie))
        assert total - searched(again, replace(plan, collects=())).total == pytest.approx(
            taken * worth, rel=0.04
        )


def test_what_drifts_is_looked_for_where_no_look_has_come_by() -> None:
    """What is left is what the judge says the looks until then have missed; time has gone on."""
    _, scenario, plan = asked("drifts")
    at_s = plan.collects[len(plan.collects) // 2].end_s + 0.5
    on = left("drifts", at_s=at_s)
    assert on["search"]["drift"]["elapsed_s"] == DRIFT["elapsed_s"] + at_s
    again = read_scenario(on)
    before = replace(plan, collects=tuple(c for c in plan.collects if c.end_s <= at_s))
    old = searched(scenario, before)
    new = make_plan(again)
    assert new.hard_violations == ()
    assert new.metrics.importance_total == pytest.approx(old.total - old.importance, rel=0.015)
    whole = searched(scenario, plan)
    assert old.importance + new.metrics.importance_collected > 0.95 * whole.importance
    # A second time on, looks of the first flight are longer ago.
    later = left_of(on, again, new, ReplanIn.model_validate({"at_s": 10.0, "begins_in_s": 0.0}).asked())
    assert later["search"]["seen"][0]["properties"]["ago_s"][0] == pytest.approx(
        on["search"]["seen"][0]["properties"]["ago_s"][0] + 10.0
    )


def test_looks_are_by_the_clock_of_all_flights() -> None:
    """Of two aircraft on clocks of their own one's looks are as late as the service saw it begin."""
    _, scenario, plan = asked("misses")
    first = recorded(plan, scenario, [0], boot_s=500.0).flights[0]
    second = recorded(plan, scenario, [1], boot_s=20.0).flights[0]
    second = replace(second, record=replace(second.record, started_at=BEGAN + timedelta(seconds=90.0)))
    looks: list[Looked] = flown_looks(Sortie("p", "", "", (first, second), None), scenario, plan)
    assert [round(look.start_s) for look in looks] == [0, 90]
