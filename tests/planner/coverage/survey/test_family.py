"""Regions seen by a camera, lane by lane, planned and judged beside others."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shapely.geometry import Polygon

from benchmarks.photos import photos, places, seen_by
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.validate import findings
from tests.planner.scenarios import feature, small, square
from tests.planner.terrains import raster

EYE = {"name": "eye", "type": "camera", "model": "Sony a6000 20 mm"}


@pytest.mark.parametrize("wind_m_s", [0.0, 12.0])
def test_regions_are_covered_lane_by_lane_and_radar_flies_beside(wind_m_s: float) -> None:
    """In a wind of 60 % of the speed too: each place is in two photos of one lane, and in view of another."""
    l_shape = [
        [
            [0.02, 0.03],
            [0.024, 0.03],
            [0.024, 0.032],
            [0.022, 0.032],
            [0.022, 0.035],
            [0.02, 0.035],
            [0.02, 0.03],
        ]
    ]
    more = {"wind": {"speed_m_s": wind_m_s, "from_deg": 200.0}} if wind_m_s else {}
    document = small(feature("L", "roi", "Polygon", l_shape, sensor="eye"), altitude_m=300.0, **more)
    document["sensors"].append(EYE)
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}
    lanes = [collect for collect in plan.collects if collect.sensor == "eye"]
    assert {collect.sensor for collect in plan.collects} == {"sar", "eye"}
    (camera,) = (sensor for sensor in scenario.suite.sensors if isinstance(sensor, CameraSensor))
    aircraft, region = scenario.aircraft[0], next(r for r in scenario.regions if r.name == "L")
    flown = camera.in_wind(wind_m_s / aircraft.airspeed_m_s, scenario.wind.toward_rad)
    passes = []
    for lane in lanes:
        (e0, n0), (e1, n1) = scenario.frame.to_local([place[:2] for place in lane.line]).tolist()
        passes.append(CollectPass(lane.regions, "eye", "down", (e0, n0), (e1, n1), 0.5, Polygon()))
    assert isinstance(region.area, Polygon)
    taken = photos(passes, flown, 300.0, aircraft.airspeed_m_s, scenario.wind)
    seen = seen_by(taken, places(region.area, 10.0))
    assert seen.max(axis=0).min() >= 2
    assert (seen > 0).sum(axis=0).min() >= 2


def test_terrain_is_covered_over_its_highest_ground() -> None:
    """On a slope of one in five lanes are closer, and still all is seen."""
    document = small(sensors=[EYE], altitude_m=120.0, altitude_reference="terrain", terrain="t")
    frame = read_scenario(small()).frame
    slope = {"t": raster(lambda e, n: 0.2 * e * (np.abs(e) < 6000.0), frame, posts=401)}
    flat = make_plan(read_scenario(small(sensors=[EYE], altitude_m=120.0)))
    plan = make_plan(read_scenario(document, slope))
    assert set(plan.metrics.coverage.values()) == {1.0}
    assert len(plan.collects) >= 2
    assert len(flat.collects) >= 2


def test_overlaps_that_margins_eat_are_refused_with_what_would_help() -> None:
    """From 20 m a margin of 30 m to either side leaves nothing."""
    eye = {**EYE, "position_margin_m": 30.0, "min_interval_s": 0.0}
    found = findings(small(sensors=[eye], altitude_m=20.0))
    assert {(f.feature, f.rule) for f in found if f.severity == "error"} == {
        ("A", "not-seen-overlap"), ("B", "not-seen-overlap"),
    }  # fmt: skip


def test_each_visit_sees_the_region() -> None:
    """Two visits see it twice."""
    document = small(sensors=[EYE], altitude_m=300.0)
    document["features"][0]["properties"]["revisits"] = 2
    plan = make_plan(read_scenario(document))
    assert plan.violations == ()
    assert {c.heading_deg for c in plan.collects if c.roi == "A"}
    seen = [Polygon(f.ring).area for f in plan.footprints if f.roi == "A"]
    assert math.fsum(seen) >= 2.0 * Polygon(square(0.0, 0.0, 0.003)[0]).area
