"""Ground really seen: a track flown as planned sees all, and each way of flying it badly loses ground."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from shapely.geometry import Polygon

from planner.as_flown.coverage import FlownCoverage
from planner.as_flown.track import TrackSample
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.flown import flown_coverage
from tests.planner.scenarios import case


@lru_cache(maxsize=1)
def planned() -> tuple[Scenario, Plan]:
    scenario = read_scenario(case(1))
    return scenario, make_plan(scenario)


def flown(change: Callable[[TrackSample], TrackSample] = lambda s: s, north_m: float = 0.0) -> FlownCoverage:
    """The plan's collects flown exactly, a sample every 5 m, but for ``change`` and a shift to the north."""
    scenario, plan = planned()
    samples: list[TrackSample] = []
    for collect in plan.collects:
        first, last = scenario.frame.to_local([p[:2] for p in collect.line])
        count = int(np.hypot(*(last - first)) // 5) + 2
        places = scenario.frame.to_wgs84(np.linspace(first, last, count) + np.array([0.0, north_m]))
        for lon, lat in places:
            samples.append(change(TrackSample(float(len(samples)), lon, lat, 500.0, 0.0, True)))
        samples.append(replace(samples[-1], sensor_on=False))
    return flown_coverage(scenario, plan, samples)


def test_flown_as_planned_all_is_seen() -> None:
    """A perfect flight sees every region whole, and its passes have no cross-track error."""
    found = flown()
    assert all(fraction > 0.99999 for fraction in found.fraction.values())
    assert [p.seq for p in found.passes] == [1, 2, 3, 4, 5, 6, 7, 8]
    assert all(p.cross_track_max_m < 0.05 for p in found.passes)


def test_seen_ground_is_the_published_footprint() -> None:
    """The strip of a perfect pass is the plan's footprint: both are the same rectangle."""
    scenario, plan = planned()
    ground = [Polygon(scenario.frame.to_local(f.ring)) for f in plan.footprints]
    found = flown()
    for region in scenario.regions:
        both = [
            f.intersection(region.area)
            for f, p in zip(ground, plan.footprints, strict=True)
            if p.roi == region.name
        ]
        planned_m2 = both[0].union(both[-1]).area
        assert found.seen[region.name].area == pytest.approx(planned_m2, rel=1e-4)


def test_sensor_off_sees_nothing() -> None:
    """Without the sensor nothing is seen and no pass is reported."""
    found = flown(lambda s: replace(s, sensor_on=False))
    assert set(found.fraction.values()) == {0.0}
    assert found.passes == ()


def test_flying_beside_the_line_loses_ground_and_is_measured() -> None:
    """Shifted by 120 m some region is no longer seen whole, and the error is up to that much."""
    found = flown(north_m=120.0)
    assert min(found.fraction.values()) < 0.99
    assert max(p.cross_track_max_m for p in found.passes) == pytest.approx(120.0, rel=0.15)


@pytest.mark.parametrize(("height_m", "roll_deg"), [(350.0, 0.0), (500.0, 20.0), (500.0, -20.0)])
def test_height_and_bank_move_the_beam(height_m: float, roll_deg: float) -> None:
    """Flying too low, or banked to either side, moves the swath off what it should see."""
    found = flown(lambda s: replace(s, height_m=height_m, roll_deg=roll_deg))
    assert min(found.fraction.values()) < 0.97


def test_unseen_and_seen_make_up_each_region() -> None:
    """What is seen and what is not are the region, without overlap."""
    scenario, _ = planned()
    found = flown(north_m=200.0)
    for region in scenario.regions:
        seen, unseen = found.seen[region.name], found.unseen[region.name]
        assert seen.area + unseen.area == pytest.approx(region.area.area, rel=1e-9)
