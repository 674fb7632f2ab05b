"""Aircraft that may land at any of several bases end at the one that suits, and are told to land there."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from pyproj import Geod

from mavlink.encoding.encode import encode
from mavlink.encoding.options import EncodeOptions
from mavlink.wire.items import Command
from planner.check import judge
from planner.errors import ScenarioError
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from tests.planner.scenarios import feature, of_two, small

WEST, EAST = (-0.03, -0.02), (0.05, 0.03)
GEOD = Geod(ellps="WGS84")


def with_bases(document: dict[str, Any], **vehicle: Any) -> dict[str, Any]:
    """A base at either end; all start in the west."""
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "start"]
    for name, place in (("west", WEST), ("east", EAST)):
        document["features"].append(feature(name, "base", "Point", list(place)))
    for own in document["vehicles"]:
        own |= {"base": "west", **vehicle}
    return document


def made(document: dict[str, Any]) -> tuple[Scenario, Plan]:
    """Read and planned, judged, and written as it is read."""
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    assert write_plan(read_plan(write_plan(plan))) == write_plan(plan)
    return scenario, plan


def lands(plan: Plan, vehicle: str) -> tuple[float, float]:
    """Where its mission's landing is, in degrees; that of its line and of the plan are there, too."""
    mission = encode(plan, vehicle, options=EncodeOptions())
    (land,) = [item for item in mission.mission if item.command == Command.NAV_LAND]
    place = (land.y / 1e7, land.x / 1e7)
    line = next(path for path in plan.paths if path.vehicle == vehicle).line
    assert GEOD.inv(*place, *line[-1][:2])[2] < 0.1
    own = next(each for each in plan.vehicles if each.name == vehicle)
    assert own.end == pytest.approx(place, abs=1e-6)
    return place


def test_one_ends_at_the_nearer_of_its_bases() -> None:
    """Its last region lies near the other base: a flight to that is shorter than one back."""
    _, back = made(with_bases(small(), end_bases=["west"]))
    _, free = made(with_bases(small(), end_bases=["west", "east"]))
    assert lands(back, "uav") == pytest.approx(WEST, abs=1e-6)
    assert lands(free, "uav") == pytest.approx(EAST, abs=1e-6)
    assert free.metrics.flight_length_m is not None
    assert back.metrics.flight_length_m is not None
    assert free.metrics.flight_length_m < back.metrics.flight_length_m


def test_each_of_two_ends_where_it_suits_it() -> None:
    """One sees what lies in the west and comes back, the other ends in the east; both may do either."""
    document = with_bases(of_two(), end_bases=["west", "east"])
    _, plan = made(document)
    names = [path.vehicle for path in plan.paths]
    ends = {name: lands(plan, name) for name in names}
    seen = {collect.vehicle: collect.roi for collect in plan.collects}
    assert {seen[name]: place for name, place in ends.items()} == {
        "A": pytest.approx(EAST, abs=1e-6),
        "B": pytest.approx(WEST, abs=1e-6),
    }


def test_a_window_is_kept_on_the_way_to_another_base() -> None:
    """Waiting in the air belongs to the flight to the base that was chosen."""
    document = with_bases(small(), end_bases=["west", "east"])
    document["features"][1]["properties"]["time_window_s"] = [1200.0, 1500.0]
    _, plan = made(document)
    assert lands(plan, "uav") == pytest.approx(EAST, abs=1e-6)
    (late,) = [c for c in plan.collects if c.roi == "B"]
    assert 1200.0 <= late.start_s < late.end_s <= 1500.0


def test_one_in_the_air_ends_where_its_flight_is_shortest_too() -> None:
    """Planned anew on its way: as long as the shorter of the flights to either base alone."""
    place = {"lon_deg": 0.02, "lat_deg": 0.005, "height_m": 500.0, "heading_deg": 45.0}
    found = {}
    for ends in (("west", "east"), ("west",), ("east",)):
        _, plan = made(with_bases(small(), end_bases=list(ends), in_flight=place))
        found[ends] = (plan.paths[0].length_m, lands(plan, "uav"))
    free = found.pop(("west", "east"))
    assert abs(found["west",][0] - found["east",][0]) > 100.0
    shortest_m, place_deg = min(found.values())
    assert free[0] == pytest.approx(shortest_m)
    assert free[1] == pytest.approx(place_deg)


def test_of_two_with_their_own_bases_the_one_that_flies_is_at_home_at_its_own() -> None:
    """The first cannot reach anything: the mission of the second begins and ends in the east."""
    document = with_bases(of_two())
    document["vehicles"][0]["max_range_m"] = 500.0
    document["vehicles"][1]["base"] = "east"
    _, plan = made(document)
    assert [path.vehicle for path in plan.paths] == ["second"]
    assert lands(plan, "second") == pytest.approx(EAST, abs=1e-6)
    assert encode(plan, "second").home == pytest.approx(EAST, abs=1e-6)


def test_the_judge_tells_of_a_landing_that_is_not_allowed() -> None:
    """A flight to the east, of one that may land in the west alone."""
    scenario, plan = made(with_bases(small(), end_bases=["west", "east"]))
    only = replace(scenario.aircraft[0], end_bases=("west",))
    found = judge(replace(scenario, aircraft=(only,)), plan).violations
    far_m = max(violation.amount for violation in found if violation.constraint == "continuity")
    assert far_m == pytest.approx(GEOD.inv(*WEST, *EAST)[2], rel=0.01)
    assert not math.isnan(far_m)


@pytest.mark.parametrize(
    ("vehicle", "told"),
    [
        ({"end_bases": ["north"]}, "may land at the base 'north', which is not here"),
        ({"end_bases": []}, "Give a list of names of bases"),
        ({"end_bases": ["east"], "finish": "loiter"}, "finish-not-apart"),
    ],
)
def test_what_cannot_be_is_refused(vehicle: dict[str, Any], told: str) -> None:
    """Unknown bases, none, circles that never end."""
    with pytest.raises(ScenarioError, match=told):
        read_scenario(with_bases(small(), **vehicle))


@pytest.mark.parametrize("ends", [["east"], ["west", "east"]])
def test_with_several_batteries_the_next_flight_starts_where_the_last_has_landed(ends: list[str]) -> None:
    """The battery is changed in the east, though a flight of the first region alone is shorter back west.

    Both regions are too much for one flight, and the second for one from the west and back.
    """
    battery = {"batteries": 2, "turnaround_s": 60.0, "max_flight_time_s": 600.0}
    scenario, plan = made(with_bases(small(), end_bases=ends, **battery))
    assert plan.violations == ()
    first, second = plan.paths
    assert second.start_s >= first.end_s + 60.0
    assert first.line[0][:2] == pytest.approx(WEST)
    for path in (first, second):
        assert path.line[-1][:2] == pytest.approx(EAST)
        assert plan.of(path.vehicle, path.sortie).end == pytest.approx(EAST)
    assert second.line[0][:2] == pytest.approx(EAST)
    assert plan.of(second.vehicle, 2).home == pytest.approx(EAST)
    # Had it started in the west again, the judge would have told of it.
    moved = replace(second, line=((*WEST, second.line[0][2]), *second.line[1:]))
    found = judge(scenario, replace(plan, paths=(first, moved))).violations
    assert {each.constraint for each in found} > {each.constraint for each in plan.violations}


@pytest.mark.parametrize("limit_s", [540.0, 560.0, 570.0, 580.0])
def test_batteries_are_changed_at_an_end_that_is_elsewhere(limit_s: float) -> None:
    """From a start to an end, each region on a battery of its own: the second flight begins at the end.

    At any limit that both fit in: what one flight over both took more is none of one over either.
    """
    document = small(feature("end", "end", "Point", list(EAST)))
    document["vehicles"][0] |= {"batteries": 2, "turnaround_s": 60.0, "max_flight_time_s": limit_s}
    _, plan = made(document)
    assert plan.violations == ()
    assert [path.line[-1][:2] for path in plan.paths] == [pytest.approx(EAST)] * 2
    assert plan.paths[1].line[0][:2] == pytest.approx(EAST)
