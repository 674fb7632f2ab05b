"""A field with something in its middle: lanes over the open ground round it, in one tour."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import pytest
from shapely.geometry import LineString, Polygon

from planner.coverage.survey.among import cell_targets
from planner.errors import CancelledError, InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.progress import never
from planner.tasks.setting import Setting, seeing
from planner.validate import findings
from tests.planner.moved import box, put_at
from tests.planner.scenarios import feature, small, square

FIELD = [[[0.0, 0.0], [0.009, 0.001], [0.008, 0.006], [0.004, 0.0045], [0.001, 0.007], [0.0, 0.0]]]
CAMERA = {"name": "eye", "type": "camera", "model": "DJI Mavic 3 Enterprise wide"}


def field(*more: dict[str, Any], **vehicle: Any) -> dict[str, Any]:
    """A field that is not convex, seen by a multirotor."""
    document = small(
        *more, sensors=[CAMERA], altitude_m=110.0,
        vehicles=[{"name": "uav", "type": "multirotor", "autopilot": "px4", "airspeed_m_s": 10.0, **vehicle}],
    )  # fmt: skip
    document["features"] = [each for each in document["features"] if each["id"] not in ("A", "B", "area")]
    document["features"].append(feature("F", "roi", "Polygon", FIELD))
    return document


def mast(**properties: Any) -> dict[str, Any]:
    return feature("mast", "obstacle", "Polygon", square(0.0045, 0.0022, 0.0004), **properties)


def flown(asked: dict[str, Any]) -> Plan:
    """The plan of a field with a mast: all seen, nothing hard broken, its clearance kept."""
    assert not [each for each in findings(asked) if each.severity == "error"]
    scenario = read_scenario(asked)
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == {"F": 1.0}
    (obstacle,) = scenario.obstacles
    line = LineString(scenario.frame.to_local([place[:2] for place in plan.paths[0].line]))
    assert line.distance(Polygon(obstacle.area)) >= scenario.clearance_m - 0.05
    return plan


def test_a_mast_in_a_field_is_flown_round() -> None:
    """On wings: at little more way than without it."""
    wing = {"type": "fixed_wing", "airspeed_m_s": 16.0, "min_turn_radius_m": 40.0}
    plan = flown(field(mast(height_m=200.0), **wing))
    free = make_plan(read_scenario(field(**wing)))
    assert plan.metrics.length_m < 1.4 * free.metrics.length_m


def test_overlaps_that_an_obstacle_takes_are_told_and_no_refusal() -> None:
    """On rotors: beside the mast overlaps fall short, which is told and forbids nothing."""
    told = [each for each in flown(field(mast(height_m=200.0))).violations if each.constraint == "overlap"]
    assert told
    assert all("beside obstacles" in each.message and not each.hard for each in told)


def test_directions_without_cells_do_not_hold_its_end_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no direction gives cells the search for one ends when it is told to, not after all of them."""
    scenario = read_scenario(field(mast(height_m=200.0)))
    asked = seeing(scenario, Setting.of(scenario))
    tried: list[float] = []

    def none(_: object, angle_rad: float) -> Iterator[Polygon]:
        tried.append(angle_rad)
        return iter(())

    monkeypatch.setattr("planner.coverage.survey.among._cells", none)
    with pytest.raises(CancelledError):
        cell_targets(asked, asked.surroundings(), 20.0, lambda: len(tried) > 1, never)
    assert len(tried) == 2


#: Buildings close together: metres west, south, east, north of a corner, and their height.
BUILDINGS = (
    (135, 77, 155, 107, 141), (148, 32, 172, 60, 72), (43, 100, 72, 140, 21), (156, 173, 199, 196, 38),
    (166, 148, 185, 187, 71), (32, 120, 82, 169, 55), (87, 36, 119, 57, 90), (129, 101, 184, 127, 58),
    (84, 106, 142, 123, 120),
)  # fmt: skip


def test_sweeps_that_end_without_room_for_a_turn_end_sooner() -> None:
    """Without time for anything else, too, sweeps among buildings are flown, where they were refused."""
    put = put_at((8.55, 47.4))
    document = field()
    document["features"] = [
        feature("R", "roi", "Polygon", box(put, 0, 0, 260, 260)),
        feature("start", "start", "Point", put(-60, -60)),
        *(
            feature(f"B{k}", "obstacle", "Polygon", box(put, *sides), height_m=height)
            for k, (*sides, height) in enumerate(BUILDINGS)
        ),
    ]
    document |= {
        "time_budget_s": 1.0, "altitude_m": 60.0, "altitude_reference": "home", "clearance_m": 8.0,
        "sensors": [
            {
                "name": "eye", "type": "camera", "model": "Sony a6000 20 mm", "forward_overlap": 0.7,
                "side_overlap": 0.6,
            }
        ],
        "vehicles": [{"name": "uav", "type": "multirotor", "airspeed_m_s": 8.0}],
    }  # fmt: skip
    ticks = itertools.count()
    plan = make_plan(read_scenario(document), clock=lambda: 100.0 * next(ticks))
    assert plan.metrics.coverage == {"R": 1.0}
    assert plan.hard_violations == ()


def test_what_is_lower_than_the_flight_changes_nothing() -> None:
    """A shed is flown over: the same plan as without it."""
    plan, free = (make_plan(read_scenario(each)) for each in (field(mast(height_m=8.0)), field()))
    assert plan.metrics.length_m == pytest.approx(free.metrics.length_m)


def test_obstacles_are_flown_round_beside_a_radars_region_and_by_headings_allowed() -> None:
    """A SAR's region in the same scenario, and headings asked for, take nothing of it."""
    sar = small()["sensors"][0]
    beside = feature("S", "roi", "Polygon", square(0.02, 0.0, 0.002), sensor="sar")
    asked = field(mast(height_m=200.0), beside)
    asked["sensors"].append(sar)
    next(each for each in asked["features"] if each["id"] == "F")["properties"]["approach_deg"] = [0.0, 180.0]
    assert not [each for each in findings(asked) if each.severity == "error"]
    plan = make_plan(read_scenario(asked))
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == {"F": 1.0, "S": 1.0}


def test_a_field_that_a_mast_leaves_no_room_to_turn_in_is_no_traceback() -> None:
    """A wing over a field smaller than its turns, a mast in the middle: a plan, or a refusal in words."""
    asked = field(mast(height_m=200.0), type="fixed_wing", airspeed_m_s=16.0, min_turn_radius_m=90.0)
    next(each for each in asked["features"] if each["id"] == "F")["geometry"]["coordinates"] = square(
        0.0035, 0.0012, 0.0025
    )
    refused: list[InfeasibleError] = []
    try:
        make_plan(read_scenario(asked))
    except InfeasibleError as error:
        refused.append(error)
    assert all(error.relaxation for error in refused)
