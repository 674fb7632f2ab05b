"""Missions with more items than an autopilot holds are flown in several flights, each of which it holds."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

import planner.pipeline as pipeline
from mavlink.dialects import dialect_for
from mavlink.encoding.encode import encode
from mavlink.encoding.options import EncodeOptions
from mavlink.wire.items import MissionType
from planner.check import judge
from planner.errors import ScenarioError
from planner.geojson import read_scenario
from planner.plan import Plan
from planner.profile.items import items_of
from planner.scenario import Scenario
from planner.tasks.task import Answer
from planner.vehicle.aircraft import MOST_ITEMS
from tests.planner.scenarios import EXAMPLES, feature, small, square

#: Of the missions that are split.
MOST = 110
CAMERA = {
    "name": "eye",
    "type": "camera",
    "focal_length_m": 0.035,
    "pixel_pitch_m": 4.5e-6,
    "image_px": [6000, 4000],
}


def survey(**vehicle: Any) -> dict[str, Any]:
    """Some lanes over one field, and a small one beside it."""
    document = small(sensors=[CAMERA], altitude_m=110.0)
    document["features"][0] = feature("A", "roi", "Polygon", square(-0.02, -0.015, 0.0025))
    document["features"][1] = feature("B", "roi", "Polygon", square(-0.012, -0.015, 0.001))
    document["vehicles"][0] |= vehicle
    return document


def made(document: dict[str, Any]) -> tuple[Scenario, Plan]:
    """Read and planned."""
    scenario = read_scenario(document)
    return scenario, pipeline.make_plan(scenario)


def items(plan: Plan) -> list[int]:
    """Of each flight's mission, as encoded."""
    return [
        len(encode(plan, path.vehicle, options=EncodeOptions(sortie=path.sortie)).mission)
        for path in plan.paths
    ]


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("kind", ["fixed_wing", "multirotor", "vtol"])
def test_what_is_held_is_what_uploads_are_held_against(autopilot: Any, kind: Any) -> None:
    """Planner and dialect name one limit."""
    held = dialect_for(autopilot, kind).limits[MissionType.MISSION]
    assert MOST_ITEMS[autopilot, kind == "multirotor"] == held


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("name", ["sar-case-1", "inspection", "three-aircraft"])
def test_no_mission_has_more_items_than_are_reckoned(
    name: str, autopilot: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor so few that flights would be split for nothing."""
    document = json.loads((EXAMPLES / f"{name}.geojson").read_text())
    for vehicle in document["vehicles"]:
        vehicle["autopilot"] = autopilot
    reckoned: list[int] = []
    draft = pipeline._draft

    def noted(scenario: Scenario, chart: Any, answer: Answer) -> Plan:
        aircraft = answer.setting.model.aircraft
        reckoned.append(items_of(answer.composed.flight, len(answer.passes), aircraft))
        return draft(scenario, chart, answer)

    monkeypatch.setattr(pipeline, "_draft", noted)
    _, plan = made(document)
    encoded = items(plan)
    assert len(reckoned) == len(encoded)
    for most, count in zip(reckoned, encoded, strict=True):
        assert count <= most <= 1.3 * count + 10


@pytest.mark.parametrize(
    "vehicle",
    [{}, {"autopilot": "px4"}, {"type": "multirotor"}],
    ids=["plane", "px4", "copter"],
)
def test_one_flight_becomes_several_that_are_held(vehicle: dict[str, Any]) -> None:
    """All is seen by flights one after the other, with no violation, each within what its autopilot holds."""
    whole = made(survey(**vehicle))[1]
    assert len(whole.paths) == 1
    assert items(whole)[0] > MOST
    scenario, plan = made(survey(**vehicle, max_items=MOST))
    assert plan.violations == ()
    assert min(plan.metrics.coverage.values()) == pytest.approx(1.0)
    assert 2 <= len(plan.paths) <= math.ceil(items(whole)[0] / MOST) + 2
    assert max(items(plan)) <= MOST
    assert [path.sortie for path in plan.paths] == list(range(1, len(plan.paths) + 1))
    assert all(b.start_s >= a.end_s for a, b in pairwise(plan.paths))
    assert len(plan.collects) == len(whole.collects)
    assert judge(scenario, plan).violations == ()


def test_batteries_are_shared_out_by_items_as_well() -> None:
    """With several batteries a flight ends with its battery or its items, whichever is first."""
    vehicle = {"batteries": 6, "max_flight_time_s": 900.0, "turnaround_s": 60.0}
    plenty = made(survey(**vehicle))[1]
    scenario, plan = made(survey(**vehicle, max_items=MOST))
    assert max(items(plenty)) > MOST >= max(items(plan))
    assert len(plan.paths) > len(plenty.paths)
    assert plan.violations == ()
    assert all(b.start_s >= a.end_s + 60.0 for a, b in pairwise(plan.paths))
    assert judge(scenario, plan).violations == ()


def test_one_battery_is_for_all_of_them_together() -> None:
    """Where flights together are more than it gives there is one, and what is the matter is said."""
    whole = made(survey())[1]
    limit_s = whole.paths[0].duration_s + 1.0
    _, plan = made(survey(max_items=MOST, max_flight_time_s=limit_s))
    assert len(plan.paths) == 1
    assert any("too-many-items" in warning and f"holds {MOST}" in warning for warning in plan.warnings)
    scenario, split = made(survey(max_items=MOST, max_flight_time_s=2.0 * limit_s))
    assert len(split.paths) > 1
    assert split.violations == ()
    short = replace(scenario.aircraft[0], max_flight_time_s=limit_s)
    found = judge(replace(scenario, aircraft=(short,)), split).violations
    assert "batteries" in {violation.constraint for violation in found}


def fleet(**vehicle: Any) -> dict[str, Any]:
    """Two aircraft with a battery each, and a field for each."""
    document = survey(**vehicle)
    document["features"][1] = feature("B", "roi", "Polygon", square(-0.012, -0.02, 0.002))
    (one,) = document["vehicles"]
    return document | {"vehicles": [one, one | {"name": "second"}]}


#: Of either field the mission of one flight has more items, and half the lanes fewer.
FLEET_MOST = 70


def test_aircraft_of_a_fleet_fly_what_is_held_as_well() -> None:
    """Each several times on its one battery, which lasts for all of its flights; all is seen."""
    limit = {"max_flight_time_s": 1200.0, "max_range_m": 24_000.0}
    whole = made(fleet(**limit))[1]
    assert min(items(whole)) > FLEET_MOST
    assert len(whole.paths) == 2
    scenario, plan = made(fleet(**limit, max_items=FLEET_MOST))
    assert plan.violations == ()
    assert min(plan.metrics.coverage.values()) == pytest.approx(1.0)
    assert max(items(plan)) <= FLEET_MOST
    assert len(plan.paths) > 2
    for name in ("uav", "second"):
        own = [path for path in plan.paths if path.vehicle == name]
        assert sum(path.duration_s for path in own) <= limit["max_flight_time_s"]
        assert sum(path.length_m for path in own) <= limit["max_range_m"]
        assert all(b.start_s >= a.end_s for a, b in pairwise(own))
    assert judge(scenario, plan).violations == ()


def test_a_fleets_battery_that_lasts_for_its_passes_alone_is_dealt_out_by_them() -> None:
    """Where no other assignment keeps within it, each flight is cut between its passes."""
    _, plan = made(fleet(max_items=75, max_flight_time_s=700.0))
    assert plan.violations == ()
    assert max(items(plan)) <= 75
    assert [path.sortie for path in plan.paths] == [1, 2, 1, 2]


def test_a_flight_of_a_fleet_that_cannot_be_several_names_its_limit() -> None:
    """The one whose battery does not last for two stays whole, and what its plan says of it has the limit."""
    _, plan = made(fleet(max_items=75, max_flight_time_s=500.0))
    told = [warning for warning in plan.warnings if "too-many-items" in warning]
    long = [path.vehicle for path, count in zip(plan.paths, items(plan), strict=True) if count > 75]
    assert long
    assert [warning.split(":")[0] for warning in told] == long
    assert all("max_flight_time_s 500" in warning and "holds 75" in warning for warning in told)


def test_of_a_fleet_what_has_a_window_keeps_it_where_another_is_cut() -> None:
    """Flights dealt out anew go on the clock with those that have their times."""
    document = fleet(max_items=75, max_flight_time_s=700.0)
    document["features"][1]["properties"]["time_window_s"] = [300.0, 700.0]
    _, plan = made(document)
    assert plan.violations == ()
    assert len(plan.paths) > 2
    assert all(300.0 <= c.start_s < c.end_s <= 700.0 for c in plan.collects if c.roi == "B")


@pytest.mark.parametrize("named", [False, True], ids=["end", "end_bases"])
def test_a_mission_that_ends_elsewhere_goes_on_from_there(named: bool) -> None:
    """The first flight ends where all is to end, the next one starts there, and so say their missions."""
    document = survey(max_items=MOST)
    end = (-0.01, -0.02)
    document["features"].append(feature("there", "base" if named else "end", "Point", list(end)))
    if named:
        document["vehicles"][0] |= {"end_bases": ["there"]}
    scenario, plan = made(document)
    start = scenario.frame.to_wgs84([scenario.start.position])[0]
    assert plan.violations == ()
    assert len(plan.paths) > 1
    assert max(items(plan)) <= MOST
    starts = [tuple(start), *[end] * (len(plan.paths) - 1)]
    for path, place in zip(plan.paths, starts, strict=True):
        flight = plan.of(path.vehicle, path.sortie)
        assert (flight.home, flight.end) == (pytest.approx(place), pytest.approx(end))
        assert path.line[0][:2] == pytest.approx(place)
        assert path.line[-1][:2] == pytest.approx(end)


def test_no_more_are_asked_for_than_uploads_take() -> None:
    """Named with what is usual."""
    with pytest.raises(ScenarioError, match="ardupilot is uploaded 655 at most"):
        read_scenario(survey(max_items=2000))
