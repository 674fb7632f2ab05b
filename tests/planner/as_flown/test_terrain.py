"""Ground really seen over terrain: hidden ground does not count, however well the pass is flown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planner.as_flown.coverage import FlownCoverage
from planner.as_flown.track import TrackSample
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.flown import flown_coverage
from tests.planner.scenarios import small
from tests.planner.terrains import raster

MIDDLE = LocalFrame(0.01, 0.01)


def flown(scenario: Scenario, plan: Plan) -> FlownCoverage:
    """The plan's collects flown exactly."""
    samples: list[TrackSample] = []
    for collect in plan.collects:
        first, last = scenario.frame.to_local([p[:2] for p in collect.line])
        count = int(np.hypot(*(last - first)) // 5) + 2
        for lon, lat in scenario.frame.to_wgs84(np.linspace(first, last, count)):
            height_m = collect.line[0][2] - (scenario.home_amsl_m or 0.0)
            samples.append(TrackSample(float(len(samples)), lon, lat, height_m, 0.0, True))
        samples.append(replace(samples[-1], sensor_on=False))
    return flown_coverage(scenario, plan, samples)


@pytest.mark.parametrize("squint_deg", [0.0, 15.0])
def test_a_plan_on_hills_flown_as_planned_sees_its_regions(squint_deg: float) -> None:
    """Over hills, a kilometre above the sea, the exact flight sees what was planned, squinted or not."""
    hills = raster(lambda e, n: 1000.0 + 40.0 * np.sin(e / 700.0) * np.cos(n / 900.0), MIDDLE)
    sensor = small()["sensors"][0] | {"squint_deg": squint_deg}
    scenario = read_scenario(small(terrain="t", sensors=[sensor]), {"t": hills})
    found = flown(scenario, make_plan(scenario))
    assert all(fraction > 0.995 for fraction in found.fraction.values()), found.fraction


def test_shadow_is_not_seen_in_flight() -> None:
    """The same flight over a ridge that was not there when it was planned sees less."""
    document = small(terrain="t", clearance_m=10.0)
    flat = read_scenario(document, {"t": raster(lambda e, n: 0.0 * e, MIDDLE, posts=801)})
    plan = make_plan(flat)
    lines = [flat.frame.to_local([p[:2] for p in c.line]).mean(axis=0) for c in plan.collects]
    regions = {region.name: np.array(region.area.centroid.coords[0]) for region in flat.regions}
    line = next(place for c, place in zip(plan.collects, lines, strict=True) if "A" in c.regions)
    wall = flat.frame.north_up(line + 0.6 * (regions["A"] - line))

    def peak(e, n):
        return 380.0 * np.exp(-((e - wall[0]) ** 2 + (n - wall[1]) ** 2) / (2.0 * 80.0**2))

    ground = read_scenario(
        small(terrain="t", altitude_reference="amsl"), {"t": raster(peak, flat.frame, posts=801)}
    )
    rough = replace(flat, terrain=ground.terrain)
    assert flown(flat, plan).fraction["A"] > 0.995
    assert flown(rough, plan).fraction["A"] < 0.97
