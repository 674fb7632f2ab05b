"""Ground that something stands on is not asked for: of plans with a mast in a corridor, and by hand."""

from __future__ import annotations

from typing import Any

import pytest
from shapely.geometry import Point, Polygon, box

from planner.airspace.airspace import Airspace, Level
from planner.airspace.built import bare_ground
from planner.airspace.values import NoFlyZone, Obstacle
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan

FRAME = LocalFrame(9.7, 47.05)
ROAD = box(0.0, -30.0, 800.0, 30.0)
LEVEL = Level(100.0, 100.0)


def airspace(*obstacles: Obstacle, no_fly: tuple[NoFlyZone, ...] = ()) -> Airspace:
    return Airspace(obstacles=obstacles, no_fly=no_fly, clearance_m=10.0)


def test_what_stands_into_the_flight_takes_its_ground() -> None:
    """A house that is flown over does not, nor a wire that begins above the ground, nor a zone."""
    tall = Obstacle("tall", box(100.0, -20.0, 140.0, 20.0), 95.0)
    low = Obstacle("low", box(300.0, -20.0, 340.0, 20.0), 80.0)
    wire = Obstacle("wire", box(500.0, -20.0, 540.0, 20.0), 60.0, base_m=40.0)
    zone = NoFlyZone("zone", area=box(600.0, -20.0, 640.0, 20.0))
    found = bare_ground(ROAD, airspace(tall, low, wire, no_fly=(zone,)), LEVEL)
    assert found.area == pytest.approx(800.0 * 60.0 - 40.0 * 40.0)
    assert not found.contains(Point(120.0, 0.0))
    for east_m in (320.0, 520.0, 620.0):
        assert found.contains(Point(east_m, 0.0))


def test_ground_that_is_built_over_whole_stays_asked_for() -> None:
    """Nothing is seen by leaving all of it out."""
    block = Obstacle("block", box(-10.0, -40.0, 900.0, 40.0), 300.0)
    assert bare_ground(ROAD, airspace(block), LEVEL) is ROAD
    half = Obstacle("half", box(-10.0, -40.0, 400.0, 40.0), 300.0)
    assert bare_ground(ROAD, airspace(half), LEVEL).equals(box(400.0, -30.0, 800.0, 30.0))


@pytest.mark.parametrize(
    ("size_m", "kind", "deep_m"), [(40.0, "multirotor", 60.0), (60.0, "fixed_wing", 200.0)]
)
def test_ground_round_a_tower_is_seen_and_none_under_it_is_missed(
    size_m: float, kind: str, deep_m: float
) -> None:
    """A corridor hardly wider than what stands in it, and a field whose lanes end before a tower."""
    half_m = size_m / 2.0

    def ring(area: Polygon) -> dict[str, Any]:
        return {"type": "Polygon", "coordinates": [[list(FRAME.to_wgs84(p)) for p in area.exterior.coords]]}

    def feature(name: str, geometry: Any, **properties: Any) -> dict[str, Any]:
        return {"type": "Feature", "id": name, "geometry": geometry, "properties": properties}

    tower = box(400.0 - half_m, -half_m, 400.0 + half_m, half_m)
    line = {"type": "LineString", "coordinates": [list(FRAME.to_wgs84((x, 0.0))) for x in (0.0, 800.0)]}
    region = {"geometry": line, "width_m": deep_m}
    if kind == "fixed_wing":
        region = {"geometry": ring(box(0.0, -deep_m / 2.0, 800.0, deep_m / 2.0))}
    start = {"type": "Point", "coordinates": list(FRAME.to_wgs84((-100.0, -50.0)))}
    vehicle = {"name": "v", "type": kind, "airspeed_m_s": 10.0}
    vehicle |= {"min_turn_radius_m": 40.0} if kind == "fixed_wing" else {}
    eye = {
        "name": "c",
        "type": "camera",
        "focal_length_m": 0.02,
        "pixel_pitch_m": 4e-6,
        "image_px": [6000, 4000],
    }
    plan = make_plan(
        read_scenario(
            {
                "type": "FeatureCollection",
                "features": [
                    feature("road", role="roi", **region),
                    feature("tower", ring(tower), role="obstacle", height_m=200.0),
                    feature("home", start, role="start"),
                ],
                "vehicles": [vehicle],
                "sensors": [eye],
                "altitude_m": 100.0,
                "clearance_m": 10.0,
            }
        )
    )
    assert not plan.hard_violations
    assert plan.metrics.coverage == {"road": 1.0}
    assert not plan.uncovered
