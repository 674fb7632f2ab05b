"""Over terrain each aircraft takes off, climbs, returns and lands over the ground of its own base."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any

import pytest

from mavlink.encoding.encode import encode
from mavlink.encoding.options import EncodeOptions
from mavlink.rules.heights import heights_of
from mavlink.wire.items import Command, Frame
from planner.as_flown.track import Record, TrackSample
from planner.check import judge
from planner.errors import ScenarioError
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.flown import sortie_coverage
from tests.planner.plains import ABOARD, GROUND_M, LEVEL_M, over_plains, two_plains
from tests.planner.scenarios import feature, of_two, square


def made(document: dict[str, Any]) -> tuple[Scenario, Plan]:
    """Read and planned, judged, and written as it is read."""
    scenario = read_scenario(document, {"t": two_plains()}.get)
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert write_plan(read_plan(write_plan(plan))) == write_plan(plan)
    return scenario, plan


@functools.cache
def planned(kind: str, autopilot: str) -> tuple[Scenario, Plan]:
    """Two aircraft of a kind, each with a region near its base."""
    return made(over_plains(of_two(), type=kind, autopilot=autopilot))


KINDS = [("fixed_wing", "ardupilot"), ("multirotor", "px4"), ("vtol", "ardupilot")]


@pytest.mark.parametrize(("kind", "autopilot"), KINDS)
def test_each_takes_off_and_lands_on_the_ground_of_its_base(kind: str, autopilot: str) -> None:
    """Its line begins and ends there, and climbs as far as is between that and the passes."""
    _, plan = planned(kind, autopilot)
    assert {path.vehicle for path in plan.paths} == set(ABOARD)
    for path in plan.paths:
        ground_m = GROUND_M[ABOARD[path.vehicle]]
        assert path.line[0][2] == pytest.approx(ground_m, abs=0.01)
        assert path.line[-1][2] == pytest.approx(ground_m, abs=0.01)
        assert max(place[2] for place in path.line) == pytest.approx(LEVEL_M, abs=0.01)


@pytest.mark.parametrize(("kind", "autopilot"), KINDS)
def test_items_over_home_are_over_the_base_that_a_mission_begins_at(kind: str, autopilot: str) -> None:
    """Flown from a home as high as the base's ground, all items are at the heights of the line."""
    _, plan = planned(kind, autopilot)
    for path in plan.paths:
        mission = encode(plan, path.vehicle, options=EncodeOptions(rally_at_home=True))
        home_m = GROUND_M[ABOARD[path.vehicle]]
        assert mission.home_altitude_m == pytest.approx(home_m, abs=0.01)
        over_sea = {Frame.GLOBAL: 0.0, Frame.GLOBAL_RELATIVE_ALT: home_m}
        flown_m = [
            (item.command, item.z + over_sea[Frame(item.frame)])
            for item in mission.mission
            if item.frame in over_sea and item.x and item.command != Command.DO_LAND_START
        ]
        assert all(home_m - 0.01 <= up_m <= LEVEL_M + 0.01 for _, up_m in flown_m)
        lands_m = [up_m for command, up_m in flown_m if command in (Command.NAV_LAND, Command.NAV_VTOL_LAND)]
        assert lands_m == [pytest.approx(home_m, abs=0.01)]
        takes_off = (Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF)
        (up_m,) = [up_m for command, up_m in flown_m if command in takes_off]
        assert up_m == pytest.approx(LEVEL_M if kind == "multirotor" else home_m + 50.0, abs=1.0)
        (rally,) = mission.rally
        assert rally.z + home_m == pytest.approx(LEVEL_M, abs=1.0)


def test_a_climb_of_less_takes_less() -> None:
    """What hovers climbs 120 m less from the higher base, and is up sooner by as much."""
    _, plan = planned("multirotor", "px4")
    up_s = {
        path.vehicle: next(phase.end_s for phase in path.phases if phase.kind == "climb")
        for path in plan.paths
    }
    less_m = GROUND_M["east"] - GROUND_M["west"]
    assert up_s["uav"] - up_s["second"] == pytest.approx(less_m / 3.0, abs=5.0)


def test_the_judge_finds_a_line_from_another_bases_height() -> None:
    """A take-off and a landing in the air over one base, or in its ground, are violations of that flight."""
    scenario, plan = planned("fixed_wing", "ardupilot")
    for name, lower_m in (("uav", -120.0), ("second", 120.0)):
        paths = tuple(
            path
            if path.vehicle != name
            else replace(path, line=tuple((*place[:2], place[2] - lower_m) for place in path.line))
            for path in plan.paths
        )
        found = judge(scenario, replace(plan, paths=paths)).violations
        off_m = [each.amount for each in found if each.constraint == "continuity" and each.feature == name]
        assert len([each for each in off_m if each == pytest.approx(120.0, abs=0.1)]) == 2


def test_what_is_flown_over_is_as_high_over_each_home_as_it_stands() -> None:
    """A zone up to 400 m over the sea is 300 m over the one home, and 180 m over the other."""
    document = over_plains(of_two())
    zone = feature("Z", "no_fly", "Polygon", square(-0.005, 0.04, 0.004), ceiling_m=400.0)
    document["features"].append(zone)
    _, plan = made(document)
    for name, base in ABOARD.items():
        top_m, zone_name = heights_of(plan.of(name), name).flown_over
        assert zone_name == "Z"
        assert top_m + GROUND_M[base] == pytest.approx(400.0, abs=0.01)


@pytest.mark.parametrize(("higher_m", "whole"), [(0.0, True), (-120.0, False)])
def test_a_track_over_its_own_home_sees_what_was_planned(higher_m: float, whole: bool) -> None:
    """Heights on record count from where an aircraft took off; flown so much lower it misses some."""
    scenario, plan = planned("fixed_wing", "ardupilot")
    records = []
    for path in plan.paths:
        samples = []
        for collect in plan.collects_of(path.vehicle):
            (lon, lat, up_m), (to_lon, to_lat, _) = collect.line
            count = int(collect.end_s - collect.start_s) + 2
            samples += [
                TrackSample(
                    collect.start_s + share * (collect.end_s - collect.start_s),
                    lon + share * (to_lon - lon),
                    lat + share * (to_lat - lat),
                    up_m - GROUND_M[ABOARD[path.vehicle]] + higher_m,
                    0.0,
                    sensor_on=True,
                    heading_deg=collect.heading_deg,
                )
                for share in (k / (count - 1) for k in range(count))
            ]
        records.append(Record(tuple(samples), path.vehicle, sortie=1))
    fractions = sortie_coverage(scenario, plan, records).fraction.values()
    assert [fraction > 0.99 for fraction in fractions] == [whole, whole]


def test_a_battery_is_changed_and_a_flight_ends_at_the_ground_of_another_base() -> None:
    """The flight behind a landing elsewhere begins there, its home is that ground, and so are its items'."""
    document = over_plains(of_two())
    (document["vehicles"][1], _) = reversed(document["vehicles"])
    document["vehicles"] = document["vehicles"][:1]
    document["vehicles"][0] |= {
        "name": "uav", "base": "west", "end_bases": ["east"], "batteries": 2, "max_range_m": 13_000.0
    }  # fmt: skip
    scenario, plan = made(document)
    assert [path.sortie for path in plan.paths] == [1, 2]
    first, second = plan.paths
    assert (first.line[0][2], first.line[-1][2]) == pytest.approx((100.0, 220.0), abs=0.01)
    assert (second.line[0][2], second.line[-1][2]) == pytest.approx((220.0, 220.0), abs=0.01)
    mission = encode(plan, "uav", options=EncodeOptions(sortie=2))
    assert mission.home_altitude_m == pytest.approx(220.0, abs=0.01)
    assert scenario.home_amsl_m == pytest.approx(100.0, abs=0.01)


def test_a_base_that_is_not_below_the_passes_is_refused_by_name() -> None:
    """Its aircraft would have to take off downwards."""
    document = over_plains(of_two()) | {"altitude_m": 210.0, "clearance_m": 5.0}
    document["features"][0]["geometry"]["coordinates"] = square(-0.045, -0.01, 0.003)
    with pytest.raises(ScenarioError) as refused:
        read_scenario(document, {"t": two_plains()}.get)
    found = {(finding.feature, finding.rule) for finding in refused.value.findings}
    assert ("east", "altitude-below-ground") in found


@pytest.mark.parametrize("role", ["base", "end"])
def test_ground_of_several_heights_without_terrain_is_refused(role: str) -> None:
    """Heights count from home there, and a vehicle's home is where it takes off."""
    document = over_plains(of_two())
    del document["terrain"]
    for own in document["features"]:
        if own["properties"]["role"] == "base":
            own["geometry"]["coordinates"].append(GROUND_M[own["id"]])
    if role == "end":
        document["vehicles"] = document["vehicles"][:1]
        document["features"][-2]["properties"]["role"] = "start"
        document["features"][-1]["properties"]["role"] = "end"
        del document["vehicles"][0]["base"]
    with pytest.raises(ScenarioError) as refused:
        read_scenario(document)
    (found,) = [finding for finding in refused.value.findings if finding.rule == "ground-not-flat"]
    assert found.feature == "east"
    document["features"][-1]["geometry"]["coordinates"][2] = GROUND_M["west"] + 4.0
    read_scenario(document)
