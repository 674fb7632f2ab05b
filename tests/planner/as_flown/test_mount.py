"""A sensor in a gimbal: its own attitude decides, whatever the aircraft round it does."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry.base import BaseGeometry

from planner.as_flown.track import Record, TrackSample
from planner.tasks.flown import flown_coverage, sortie_coverage
from tests.planner.as_flown import test_beam, test_photos
from tests.planner.as_flown.test_beam import HEIGHT_M, INCIDENCE_DEG, SPEED_M_S


def strip(roll_deg: float, pitch_deg: float, off_deg: tuple[float, float] | None) -> BaseGeometry:
    """What is credited of a pass flown on its line, with a gimbal off by so much in tilt and yaw, or none."""
    scenario, plan = test_beam.planned()
    collect = plan.collects[0]
    first, last = scenario.frame.to_local([place[:2] for place in collect.line])
    count = int(math.dist(first, last) / (SPEED_M_S * 0.5)) + 2
    abeam_deg = 90.0 if collect.look == "right" else -90.0
    mount = None
    if off_deg is not None:
        mount = (0.0, INCIDENCE_DEG - 90.0 + off_deg[0], collect.heading_deg + abeam_deg + off_deg[1])
    track = [
        TrackSample(
            0.5 * k, float(lon), float(lat), HEIGHT_M, roll_deg, True, collect.heading_deg, pitch_deg, mount
        )
        for k, (lon, lat) in enumerate(scenario.frame.to_wgs84(np.linspace(first, last, count)))
    ]
    return flown_coverage(scenario, plan, track).seen["A"]


def same(one: BaseGeometry, other: BaseGeometry) -> bool:
    """All but equal."""
    return bool(one.symmetric_difference(other).area < 0.01 * other.area)


def test_what_the_airframe_does_is_no_matter_to_a_gimbal_that_holds_the_antenna() -> None:
    """Rolled by 20° and pitched by 15°, where bolted on nothing would count."""
    straight = strip(0.0, 0.0, None)
    assert straight.area > 0.0
    assert same(strip(20.0, 15.0, (0.0, 0.0)), straight)
    assert strip(20.0, 15.0, None).is_empty


@pytest.mark.parametrize("tilt_deg", [4.0, -4.0])
def test_a_gimbal_that_is_off_looks_elsewhere(tilt_deg: float) -> None:
    """As a roll by the same angle: up is towards the horizon."""
    scenario, plan = test_beam.planned()
    sign = 1.0 if plan.collects[0].look == "right" else -1.0
    assert same(strip(0.0, 0.0, (tilt_deg, 0.0)), strip(-sign * tilt_deg, 0.0, None))
    assert not same(strip(0.0, 0.0, (tilt_deg, 0.0)), strip(0.0, 0.0, None))
    assert scenario.regions


def test_a_gimbal_turned_away_sees_nothing_that_counts() -> None:
    """Held at the horizon, or far from its tilt."""
    assert strip(0.0, 0.0, (45.0, 0.0)).is_empty
    assert strip(0.0, 0.0, (-30.0, 0.0)).is_empty


def test_photos_and_videos_without_attitude_have_the_gimbal_s() -> None:
    """Of an airframe that rolls by 40°: with the gimbal straight down all is seen, without it nothing."""
    for trigger in ("distance", "video"):
        one = test_photos.record(trigger, roll_deg=40.0)
        bare = tuple(replace(p, roll_deg=None, pitch_deg=None, yaw_deg=None) for p in one.photos)
        hung = tuple(replace(s, mount_deg=(0.0, -90.0, s.heading_deg)) for s in one.samples)
        judged = [
            sortie_coverage(*test_photos.planned(trigger), (Record(samples, one.vehicle, None, bare),))
            for samples in (hung, one.samples)
        ]
        assert judged[0].fraction["A"] > 0.999
        assert judged[1].fraction["A"] == 0.0
