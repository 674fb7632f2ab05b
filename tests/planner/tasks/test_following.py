"""Flights that follow the ground, from scenario to verdict, with a scanner that looks straight down."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from planner.airspace.terrain import Terrain
from planner.check import judge
from planner.check.footprints import FOOTPRINTS
from planner.coverage.registry import FAMILIES
from planner.errors import ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.registry import register_sensor
from planner.sensors.registry import KINDS, Kind
from tests.planner.scenarios import feature, small, square
from tests.planner.terrains import raster
from tests.planner.toys import scanner

HEIGHT_M, KEPT_M = 150.0, 40.0


@pytest.fixture(autouse=True)
def toy() -> Iterator[None]:
    """A scanner whose passes may follow the ground."""
    kind = Kind(scanner.read, scanner.seen_on_terrain, follows=True)
    register_sensor("scanner", kind, scanner.Scanners(), scanner.footprint)
    yield
    for known in (KINDS, FAMILIES, FOOTPRINTS):
        del known["scanner"]


def waves(high_m: float) -> Terrain:
    """Hills a kilometre apart."""
    frame = LocalFrame(0.01, 0.005)
    return raster(
        lambda e, n: 300.0 + high_m * np.sin(e / 240.0) * np.cos(n / 175.0), frame, half_deg=0.12, posts=601
    )


def document(*more: dict[str, Any], **members: Any) -> dict[str, Any]:
    """Two regions over hills."""
    asked = {
        "terrain": "t", "terrain_following": True, "altitude_m": HEIGHT_M, "clearance_m": KEPT_M,
        "sensors": [{"name": "eye", "type": "scanner", "swath_m": 900.0}],
    }  # fmt: skip
    return small(*more, **(asked | members))


@pytest.mark.parametrize("kind", ["fixed_wing", "multirotor", "vtol"])
@pytest.mark.parametrize("high_m", [40.0, 200.0])
def test_the_whole_flight_keeps_over_the_ground(kind: str, high_m: float) -> None:
    """Nothing violated: passes as high as asked, all else clear; hills steeper than it climbs, too."""
    asked = document()
    asked["vehicles"][0] |= {"type": kind, "autopilot": "ardupilot"}
    scenario = read_scenario(asked, {"t": waves(high_m)})
    plan = make_plan(scenario)
    assert {each.constraint for each in plan.violations} <= {"collect-height"}
    assert plan.hard_violations == ()
    assert min(plan.metrics.coverage.values()) == 1.0
    line = np.array(plan.paths[0].line)
    ground = scenario.terrain
    assert ground is not None
    over_m = line[:, 2] - ground.at(scenario.frame.to_local(line[:, :2]))
    flown = [place for place, up_m in zip(line, over_m, strict=True) if up_m > KEPT_M - 1.0]
    assert np.ptp([place[2] for place in flown]) > 20.0
    for collect in plan.collects:
        ends = scenario.frame.to_local([place[:2] for place in collect.line])
        for place, up_m in zip(ends, (place[2] for place in collect.line), strict=True):
            assert up_m - ground.at(place) >= HEIGHT_M - 4.5
    again = read_plan(json.loads(json.dumps(write_plan(plan))))
    told, own = (
        [(v.constraint, v.feature) for v in each]
        for each in (judge(scenario, again).violations, plan.violations)
    )
    assert told == own


def test_the_judge_tells_a_pass_that_is_too_low() -> None:
    """The same line 10 m lower is refused as a pass at another height than asked."""
    scenario = read_scenario(document(), {"t": waves(40.0)})
    plan = make_plan(scenario)
    (path,) = plan.paths
    lower = tuple((lon, lat, up_m - 10.0) for lon, lat, up_m in path.line)
    told = judge(scenario, replace(plan, paths=(replace(path, line=lower),))).violations
    assert {"A", "B"} <= {each.feature for each in told if each.constraint == "collect-altitude"}


def test_regions_have_heights_of_their_own_over_the_ground() -> None:
    """One region from 150 m, one from 300 m: each over its own ground, the flight climbs between."""
    asked = document()
    asked["features"][1]["properties"]["altitude_m"] = 300.0
    scenario = read_scenario(asked, {"t": waves(40.0)})
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert scenario.terrain is not None
    for collect in plan.collects:
        ends = scenario.frame.to_local([place[:2] for place in collect.line])
        over_m = [p[2] - float(scenario.terrain.at(end)) for p, end in zip(collect.line, ends, strict=True)]
        assert min(over_m) >= {"A": 150.0, "B": 300.0}[collect.roi] - 4.5
        assert max(over_m) <= {"A": 150.0, "B": 300.0}[collect.roi] + 60.0


def test_a_radar_beside_keeps_its_level() -> None:
    """On one flight the scanner follows the ground and the radar's pass is level, over all its ground."""
    sar = small()["sensors"][0]
    eye = {"name": "eye", "type": "scanner", "swath_m": 900.0}
    asked = document(
        feature("S", "roi", "Polygon", square(0.02, 0.03, 0.004), sensor="sar", altitude_m=400.0),
        sensors=[eye, sar],
    )
    scenario = read_scenario(asked, {"t": waves(40.0)})
    plan = make_plan(scenario)
    assert [v for v in plan.violations if v.hard] == []
    level = [collect for collect in plan.collects if collect.sensor == "sar"]
    assert level
    assert all(c.line[0][2] == pytest.approx(c.line[1][2], abs=0.05) for c in level)


@pytest.mark.parametrize(
    ("members", "rule"),
    [
        ({"altitude_reference": "amsl", "altitude_m": 900.0}, "terrain-following"),
        ({"terrain": None}, "terrain-following"),
        ({"altitude_m": 42.0}, "altitude-below-clearance"),
    ],
)
def test_what_cannot_be_followed_is_refused(members: dict[str, Any], rule: str) -> None:
    """Heights over the sea, no terrain, and heights within what is kept over the ground: named."""
    asked = document(**members)
    asked = {name: value for name, value in asked.items() if value is not None}
    with pytest.raises(ScenarioError) as caught:
        read_scenario(asked, {"t": waves(40.0)})
    assert rule in {finding.rule for finding in caught.value.findings}


def test_photos_keep_their_height_over_the_ground() -> None:
    """Of a camera: each photo as high over its ground as asked, none worth much less than from there."""
    camera = {"name": "cam", "type": "camera", "model": "Sony RX1R II"}
    asked = document(sensors=[camera])
    asked["features"] = [f for f in asked["features"] if f["id"] != "B"]
    asked["vehicles"][0] |= {"autopilot": "px4", "max_climb_deg": 12.0, "min_turn_radius_m": 40.0}
    scenario = read_scenario(asked, {"t": waves(15.0)})
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert plan.metrics.coverage == {"A": 1.0}
    assert scenario.terrain is not None
    places = np.concatenate([np.array(photos.places) for photos in plan.photos])
    over_m = places[:, 2] - scenario.terrain.at(scenario.frame.to_local(places[:, :2]))
    assert over_m.min() >= HEIGHT_M - 4.1
    assert over_m.max() <= HEIGHT_M + 4.0
    level = make_plan(read_scenario(asked | {"terrain_following": False}, {"t": waves(15.0)}))
    gsd_m, level_gsd_m = (max(f.gsd_m or 0.0 for f in each.footprints) for each in (plan, level))
    assert gsd_m < 0.93 * level_gsd_m


def test_what_hovers_follows_steep_ground_by_flying_slower() -> None:
    """On a slope of a half: as high over it as asked, which wings at their speed cannot, and are told."""
    slope = raster(lambda e, n: 300.0 + 0.5 * e, LocalFrame(0.01, 0.005), half_deg=0.12, posts=601)
    camera = {"name": "cam", "type": "camera", "model": "Sony RX1R II", "min_interval_s": 0.0}
    asked = document(sensors=[camera], max_height_m=170.0)
    asked["features"] = [f for f in asked["features"] if f["id"] not in ("B", "area")]
    asked["vehicles"][0] |= {
        "type": "multirotor",
        "autopilot": "px4",
        "airspeed_m_s": 8.0,
        "max_climb_deg": 60.0,
    }
    scenario = read_scenario(asked, {"t": slope})
    plan = make_plan(scenario)
    assert plan.violations == ()
    places = np.concatenate([np.array(photos.places) for photos in plan.photos])
    assert scenario.terrain is not None
    over_m = places[:, 2] - scenario.terrain.at(scenario.frame.to_local(places[:, :2]))
    assert HEIGHT_M - 4.1 <= over_m.min() <= over_m.max() <= HEIGHT_M + 4.0
    asked["vehicles"][0] |= {"type": "fixed_wing", "airspeed_m_s": 16.0, "max_climb_deg": 8.0}
    told = make_plan(read_scenario(asked, {"t": slope})).violations
    assert {each.constraint for each in told} >= {"collect-height"}
    assert all(
        each.hard for each in told if each.constraint == "collect-height" and "the most" in each.message
    )


@pytest.mark.parametrize(
    ("kind", "up_deg", "slope", "home_m", "height_m"),
    [
        ("multirotor", 90.0, 0.2, (-300.0, -300.0), 90.0),
        ("fixed_wing", 180.0, 0.2, (-300.0, -300.0), 90.0),
        ("fixed_wing", 270.0, 0.2, (-300.0, -300.0), 90.0),
        ("fixed_wing", 120.0, 0.1, (-761.0, 180.0), 60.0),
    ],
)
def test_from_a_home_on_a_slope_nothing_is_too_steep_or_too_low(
    kind: str, up_deg: float, slope: float, home_m: tuple[float, float], height_m: float
) -> None:
    """Climbs on the spot over steep ground, passes below what is kept over home, the circle at the end."""
    frame = LocalFrame(9.0, 47.0)
    east, north = math.cos(math.radians(up_deg)), math.sin(math.radians(up_deg))
    ground = raster(lambda e, n: 800.0 + slope * (e * east + n * north), frame, half_deg=0.06, posts=601)
    corners = [(0.0, 0.0), (300.0, 0.0), (300.0, 300.0), (0.0, 300.0), (0.0, 0.0)]
    field = {"type": "Polygon", "coordinates": [[list(frame.to_wgs84(corner)) for corner in corners]]}
    start = {"type": "Point", "coordinates": list(frame.to_wgs84(home_m))}
    asked = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "id": "field", "geometry": field, "properties": {"role": "roi"}},
            {"type": "Feature", "id": "home", "geometry": start, "properties": {"role": "start"}},
        ],
        "vehicles": [
            {"name": "a", "type": kind, "airspeed_m_s": 15.0}
            | ({"min_turn_radius_m": 60.0} if kind == "fixed_wing" else {})
        ],
        "sensors": [
            {
                "name": "c", "type": "camera", "focal_length_m": 0.035, "pixel_pitch_m": 4e-6,
                "image_px": [6000, 4000], "side_overlap": 0.5, "stabilised": True,
            }
        ],
        "terrain": "t", "terrain_following": True, "altitude_reference": "terrain",
        "altitude_m": height_m, "clearance_m": 40.0,
    }  # fmt: skip
    plan = make_plan(read_scenario(asked, {"t": ground}))
    assert plan.hard_violations == ()
