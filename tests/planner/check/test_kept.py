"""What is kept from everything hard, by shapely's own distances over the whole published line."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pyproj import Transformer
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from planner.check.verdict import judge
from planner.errors import InfeasibleError, ScenarioError
from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan
from planner.validate import findings
from planner.vehicle.steadiness import steadiness_of
from tests.planner.scenarios import feature, small, square

FRAME = Transformer.from_crs("EPSG:4326", "+proj=aeqd +lat_0=0.01 +lon_0=0.01 +datum=WGS84", always_xy=True)
METRE_DEG = 1.0 / 111_320.0


def ring(middle: tuple[float, float], size_m: float, corners: int, rng: np.random.Generator) -> list[Any]:
    """Coordinates of a star-shaped polygon."""
    angles = np.linspace(0.0, math.tau, corners, endpoint=False)
    radii = size_m * METRE_DEG * rng.uniform(0.5, 1.0, corners)
    places = [
        [middle[0] + r * math.cos(a), middle[1] + r * math.sin(a)] for a, r in zip(angles, radii, strict=True)
    ]
    return [[*places, places[0]]]


def cluttered(number: int) -> dict[str, Any]:
    """Two regions, with hard things of every kind round them and something to be kept from each."""
    rng = np.random.default_rng([5, number])
    things = []
    for k in range(16):
        middle = (float(rng.uniform(-0.015, 0.035)), float(rng.uniform(-0.015, 0.015)))
        if math.dist(middle, (-0.02, -0.02)) < 0.01:
            continue
        size_m, name = float(rng.uniform(60.0, 250.0)), f"H{k}"
        if k % 4 == 0:
            missile = {"model": "missile", "radius_m": size_m, "hard": True}
            things.append(feature(name, "threat", "Point", list(middle), **missile))
        elif k % 4 == 1:
            things.append(feature(name, "no_fly", "Polygon", ring(middle, size_m, 5, rng)))
        elif k % 4 == 2:
            things.append(feature(name, "no_fly", "Point", list(middle), radius_m=size_m))
        else:
            tall = feature(name, "obstacle", "Polygon", ring(middle, size_m, 6, rng), height_m=600.0)
            things.append(tall)
    kept = {} if number % 3 == 0 else {"clearance_m": float(rng.choice([1.0, 12.0, 60.0, 150.0]))}
    document = small(*things, **kept)
    kinds = [("ardupilot", "fixed_wing"), ("px4", "fixed_wing"), ("px4", "multirotor")]
    autopilot, kind = kinds[number % 3 if kept else (number // 3) % 3]
    document["vehicles"][0] |= {"autopilot": autopilot, "type": kind, "settle_m": 50.0, "finish": "land"}
    return document


def shapes(document: dict[str, Any]) -> dict[str, BaseGeometry]:
    """The hard things in metres, discs with 4096 corners."""
    found: dict[str, BaseGeometry] = {}
    for each in document["features"]:
        properties, geometry = each["properties"], each["geometry"]
        if properties["role"] not in ("threat", "no_fly", "obstacle"):
            continue
        if geometry["type"] == "Point":
            place = Point(FRAME.transform(*geometry["coordinates"]))
            found[each["id"]] = place.buffer(properties["radius_m"], quad_segs=1024)
        else:
            lons, lats = zip(*geometry["coordinates"][0], strict=True)
            found[each["id"]] = Polygon(list(zip(*FRAME.transform(lons, lats), strict=True)))
    return found


def line_of(plan: dict[str, Any]) -> LineString:
    """The whole published line, heights left out: everything hard here is hard at all heights flown."""
    (path,) = [f for f in plan["features"] if f["properties"]["role"] == "path"]
    return LineString([FRAME.transform(*place[:2]) for place in path["geometry"]["coordinates"]])


@pytest.mark.parametrize("number", [0, 1, 3, 6, 7, 9, 10, 11])
def test_the_whole_line_keeps_away_from_everything_hard(number: int) -> None:
    """As far as is stated, or as the autopilot needs where nothing is; take-off, passes and landing too."""
    document = cluttered(number)
    vehicle = document["vehicles"][0]
    default_m = steadiness_of(vehicle["autopilot"], vehicle["type"]).kept_m
    kept_m = document.get("clearance_m", default_m)
    plan = write_plan(make_plan(read_scenario(document)))
    assert plan["violations"] == []
    line = line_of(plan)
    near_m = {name: line.distance(shape) for name, shape in shapes(document).items()}
    assert min(near_m.values()) >= kept_m - 0.05, near_m


def test_nothing_stated_is_not_nothing_kept() -> None:
    """What the autopilot needs, and of one that is not named ArduPilot's; a stated 0 stays 0."""
    assert read_scenario(small()).clearance_m == steadiness_of("ardupilot", "fixed_wing").kept_m > 3.3
    assert read_scenario(small(clearance_m=0.0)).clearance_m == 0.0
    multirotor = small()
    multirotor["vehicles"][0] |= {"type": "multirotor", "autopilot": "px4"}
    assert read_scenario(multirotor).clearance_m == steadiness_of("px4", "multirotor").kept_m > 0.0


def test_the_judge_sees_a_line_that_comes_too_near() -> None:
    """The plan that keeps 1 m is judged by the scenario that wants 60: by how much, as shapely has it."""
    document = cluttered(1)
    plan = make_plan(read_scenario(document))
    wanted = read_scenario(document | {"clearance_m": 60.0})
    near = [v for v in judge(wanted, plan).violations if v.constraint == "clearance"]
    line = line_of(write_plan(plan))
    near_m = {name: line.distance(shape) for name, shape in shapes(document).items()}
    assert {v.feature: v.amount for v in near} == pytest.approx(
        {name: 60.0 - away_m for name, away_m in near_m.items() if away_m < 60.0}, abs=0.1
    )
    assert near
    assert all(v.hard and v.where is not None for v in near)


def walls(gap_m: float, **members: Any) -> dict[str, Any]:
    """The small scenario's regions behind two long zones with a slot between them."""
    half_deg = gap_m / 2.0 * METRE_DEG
    west, east, away = -0.011, -0.008, 0.2
    south = [[[west, -away], [east, -away], [east, -half_deg], [west, -half_deg], [west, -away]]]
    north = [[[west, half_deg], [east, half_deg], [east, away], [west, away], [west, half_deg]]]
    zones = [feature("S", "no_fly", "Polygon", south), feature("N", "no_fly", "Polygon", north)]
    document = small(*zones, **members)
    document["features"] = [f for f in document["features"] if f["id"] != "area"]
    return document


def test_a_slot_that_is_closed_is_told_with_the_value_that_opens_it() -> None:
    """By both names; with that value, and no more, it is flown through."""
    document = walls(90.0, clearance_m=60.0)
    (told,) = [f for f in findings(document) if f.rule == "slot-too-narrow"]
    assert (told.severity, {told.feature} | {name for name in "NS" if f"to {name}," in told.message}) == (
        "warning",
        {"N", "S"},
    )
    assert "clearance_m to 42 at most" in told.fix
    open_, closed = (make_plan(read_scenario(walls(90.0, clearance_m=kept_m))) for kept_m in (42.0, 60.0))
    assert open_.metrics.length_m < 0.5 * closed.metrics.length_m
    assert not open_.violations
    assert not [f for f in findings(walls(90.0, clearance_m=42.0)) if f.rule == "slot-too-narrow"]


@pytest.mark.parametrize("gap_m", [0.0, 3.0, 200.0])
def test_what_is_no_slot_is_not_told(gap_m: float) -> None:
    """Zones that adjoin, or nearly, and those with room enough between them."""
    document = walls(max(gap_m, 0.0), clearance_m=60.0)
    assert not [f for f in findings(document) if f.rule == "slot-too-narrow"]


def test_a_start_nearer_than_is_kept_is_refused_with_the_value_that_works() -> None:
    """Outside the zone and within what is kept: said, and the value said is taken."""
    beside = feature("Z", "no_fly", "Polygon", square(-0.0198, -0.0205, 0.001))
    with pytest.raises(ScenarioError) as caught:
        read_scenario(small(beside))
    (refused,) = caught.value.findings
    assert (refused.feature, refused.rule) == ("start", "start-within-clearance")
    most_m = float(refused.fix.split("clearance_m to ")[1].split()[0])
    assert most_m == math.floor(0.0002 / METRE_DEG - 2.0)
    assert read_scenario(small(beside, clearance_m=most_m)).clearance_m == most_m


def test_keeping_less_is_among_what_helps() -> None:
    """A region that what is kept hides is refused with the most that may be kept, which lets it be seen."""
    zone = feature("Z", "no_fly", "Point", [0.0015, 0.0015], radius_m=250.0)
    document = small(zone, clearance_m=900.0)
    with pytest.raises(InfeasibleError) as caught:
        make_plan(read_scenario(document))
    most_m = float(caught.value.relaxation.split("set clearance_m to ")[1].split()[0])
    assert 0.0 < most_m < 900.0
    assert make_plan(read_scenario(document | {"clearance_m": most_m})).violations == ()
