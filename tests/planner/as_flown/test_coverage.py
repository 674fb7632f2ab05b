"""Ground really seen: a track flown as planned sees all, and each way of flying it badly loses ground."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from shapely.geometry import Point, Polygon, box

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
    assert set(found.unknown_fraction.values()) == {0.0}


@pytest.mark.parametrize("change", [{"sensor_on": None}, {"roll_deg": math.nan}, {"height_m": math.nan}])
def test_what_nobody_told_of_is_neither_seen_nor_missed(change: dict[str, Any]) -> None:
    """Whether the sensor was on, or where it looked: all of the ground is unknown, and so are the passes."""
    found = flown(lambda s: replace(s, **change))
    assert set(found.fraction.values()) == {0.0}
    assert all(fraction > 0.999 for fraction in found.unknown_fraction.values())
    assert {part.seq for part in found.unknown_parts} == {1, 2, 3, 4, 5, 6, 7, 8}


def test_a_sensor_told_of_again_leaves_unknown_what_was_flown_meanwhile() -> None:
    """Of pass 3 the middle: the rest of its region is seen, nothing of any is missed."""
    scenario, plan = planned()
    third = plan.collects[2]
    begin, end = (scenario.frame.to_local([p[:2]])[0] for p in third.line)
    middle = np.linspace(begin, end, 11)[[4, 6]]
    heard = box(*(middle.min(axis=0) - 1.0), *(middle.max(axis=0) + 1.0))

    def told(sample: TrackSample) -> TrackSample:
        at = Point(scenario.frame.to_local([(sample.lon_deg, sample.lat_deg)])[0])
        return replace(sample, sensor_on=None if heard.covers(at) else sample.sensor_on)

    found = flown(told)
    (part,) = [part for part in found.unknown_parts if part.seq == third.seq]
    length_m = float(np.hypot(*(end - begin)))
    assert (part.start_m, part.end_m) == pytest.approx((0.4 * length_m, 0.6 * length_m), abs=10.0)
    assert 0.0 < found.unknown_fraction[third.roi] < 1.0
    assert all(unseen.area < 1.0 for unseen in found.unseen.values())


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
