"""Random scenarios of every kind are planned soundly: some in each run, all of them by command.

``SWATHPLAN_RANDOM`` chooses: a number of a block, 0 to 11, or ``all``.
"""

from __future__ import annotations

import json
import os

import pytest

from planner.errors import InfeasibleError
from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan
from tests.planner.random.generator import RASTER, SIZES, draw
from tests.planner.random.judge import faults
from tests.planner.random.refusals import possible

COUNT, BLOCK = 300, 25
CHOSEN = os.environ.get("SWATHPLAN_RANDOM", "0")
NUMBERS = range(COUNT) if CHOSEN == "all" else range(BLOCK * int(CHOSEN), BLOCK * (int(CHOSEN) + 1))


@pytest.mark.parametrize("number", NUMBERS)
def test_random_scenarios_are_planned_soundly(number: int) -> None:
    """A plan has nothing wrong by the tests' own geometry; none is refused that a simple search can fly."""
    case = draw(number)
    scenario = read_scenario(case.document, {} if case.terrain is None else {RASTER: case.terrain})
    try:
        plan = make_plan(scenario)
    except InfeasibleError as error:
        refusal = str(error)
    else:
        refusal = ""
    if refusal:
        assert not case.free, refusal
        assert not possible(case.document), refusal
    else:
        assert faults(case.document, json.loads(json.dumps(write_plan(plan)))) == []


def test_every_kind_is_among_all() -> None:
    """All shapes, zones, sizes, datums and wishes are drawn, each several times."""
    seen: dict[str, int] = {}
    for number in range(COUNT):
        document = draw(number).document
        words = {document["altitude_reference"], SIZES[number % len(SIZES)][0]}
        words |= {
            name for name in ("wind", "terrain", "clearance_m", "method", "objective") if name in document
        }
        words |= set(document["vehicles"][0]) | set(document["sensors"][0])
        for feature in document["features"]:
            properties = feature["properties"]
            words |= {f"{properties['role']} {feature['geometry']['type']}"}
            words |= {f"{properties['role']}.{name}" for name in properties}
            words |= {f"{properties['role']} holes"} if _holes(feature) else set()
        for word in words:
            seen[word] = seen.get(word, 0) + 1
    wanted = {
        "amsl", "home", "terrain", "multirotor", "vtol", "fixed_wing", "wind", "clearance_m", "method",
        "objective", "settle_m", "max_range_m", "max_flight_time_s", "energy_wh", "squint_deg", "sub_swaths",
        "roi Point", "roi LineString", "roi Polygon", "roi MultiPolygon", "roi holes", "roi.required",
        "roi.revisits", "roi.approach_deg", "roi.sensor", "roi.min_resolution_m", "threat Point",
        "threat.hard", "threat.height_m", "no_fly Point", "no_fly Polygon", "no_fly.floor_m",
        "no_fly.ceiling_m", "obstacle Polygon", "area Polygon", "start.heading_deg", "end.heading_deg",
    }  # fmt: skip
    assert {word for word in wanted if seen.get(word, 0) < 5} == set()


def _holes(feature: dict[str, object]) -> bool:
    geometry = feature["geometry"]
    assert isinstance(geometry, dict)
    return geometry["type"] == "Polygon" and len(geometry["coordinates"]) > 1


def test_the_judge_of_the_tests_finds_faults() -> None:
    """A sound plan moved aside, bent, cut short or judged for more than was asked is found wrong."""
    case = draw(1)
    plan = json.loads(json.dumps(write_plan(make_plan(read_scenario(case.document)))))
    assert faults(case.document, plan) == []
    path = next(f for f in plan["features"] if f["properties"]["role"] == "path")
    places = path["geometry"]["coordinates"]

    def wrong(change: str) -> str:
        return " ".join(faults(changed[change], plans.get(change, plan)))

    tighter = json.loads(json.dumps(case.document))
    tighter["vehicles"][0]["min_turn_radius_m"] *= 1.1
    farther = json.loads(json.dumps(case.document))
    farther["vehicles"][0]["settle_m"] = 3000.0
    wall = json.loads(json.dumps(case.document))
    lon, lat = places[len(places) // 2][:2]
    wall["features"].append(
        {
            "type": "Feature",
            "id": "W",
            "properties": {"role": "no_fly", "radius_m": 30.0},
            "geometry": {"type": "Point", "coordinates": [lon, lat]},
        }
    )
    blind = json.loads(json.dumps(plan))
    blind["features"] = [f for f in blind["features"] if f["properties"].get("seq") != 1 or f is path]
    short = json.loads(json.dumps(plan))
    for each in short["features"]:
        if each["properties"]["role"] == "path":
            each["geometry"]["coordinates"] = each["geometry"]["coordinates"][:-20]
    changed = {
        "turn": tighter,
        "settling": farther,
        "inside W": wall,
        "not seen": case.document,
        "end": case.document,
    }
    plans = {"not seen": blind, "end": short}
    for change in changed:
        said = {"end": "measured", "settling": "settling run"}.get(change, change)
        assert said in wrong(change), change
