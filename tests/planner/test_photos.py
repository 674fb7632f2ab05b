"""What a plan says of its cameras: places of photos, and what their images are worth."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pyproj import Geod

from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.sensors.sar import SarSensor
from planner.sensors.worth import worth_of
from tests.planner.scenarios import feature, small, square

EYE = {
    "name": "eye", "type": "camera", "model": "Sony a6000 20 mm", "rer": 0.92, "snr": 50.0,
    "min_interval_s": 0.5,
}  # fmt: skip
GEOD = Geod(ellps="WGS84")


def plan_of(eye: dict[str, Any], **members: Any) -> Plan:
    """One region of 220 m, from 100 m."""
    document = small(sensors=[{**EYE, **eye}], altitude_m=100.0, **members)
    document["features"] = [each for each in document["features"] if each["id"] in ("area", "start")]
    document["features"].append(feature("C", "roi", "Polygon", square(0.0, 0.0, 0.002)))
    return make_plan(read_scenario(document))


def test_photos_lie_evenly_from_first_to_last_and_keep_the_overlap() -> None:
    """Distances by geodesics; 75 % of 78.33 m leave 19.58 m between photos."""
    plan = plan_of({})
    assert plan.metrics.photos == sum(len(photos.places) for photos in plan.photos)
    assert len(plan.photos) == len(plan.collects)
    for collect, photos in zip(plan.collects, plan.photos, strict=True):
        assert (photos.seq, photos.sensor, photos.vehicle) == (collect.seq, "eye", "uav")
        assert photos.places[0] == pytest.approx(collect.line[0], abs=1e-12)
        assert photos.places[-1] == pytest.approx(collect.line[1], abs=1e-12)
        lons, lats, _ = np.array(photos.places).T
        _, _, steps_m = GEOD.inv(lons[:-1], lats[:-1], lons[1:], lats[1:])
        assert steps_m == pytest.approx(photos.interval_m, rel=1e-4)
        assert photos.interval_m <= 0.25 * 235.0 / 3.0 + 1e-6
        assert photos.interval_m > 0.25 * 235.0 / 3.0 * (len(photos.places) - 2) / (len(photos.places) - 1)
        assert photos.interval_s is None
    again = read_plan(write_plan(plan))
    assert read_plan(write_plan(again)).photos == again.photos
    assert [len(each.places) for each in again.photos] == [len(each.places) for each in plan.photos]


@pytest.mark.parametrize(("given", "each_mb"), [({}, 9.6), ({"photo_mb": 25.0}, 25.0)])
def test_what_photos_take_to_be_stored_is_told(given: dict[str, float], each_mb: float) -> None:
    """0.4 bytes a pixel of 24 million where nothing is given."""
    metrics = plan_of(given).metrics
    assert metrics.photos
    assert metrics.photos_mb == pytest.approx(each_mb * metrics.photos)


def test_timed_photos_say_their_time_and_a_video_has_none() -> None:
    """At 20 m/s in still air, the distance by the speed."""
    for photos in plan_of({"trigger": "time"}).photos:
        assert photos.interval_s == pytest.approx(photos.interval_m / 20.0)
    video = plan_of({"trigger": "video"})
    assert (video.photos, video.metrics.photos) == ((), 0)
    assert video.cameras[0].trigger == "video"
    assert video.violations == ()


def test_footprints_say_worst_and_mean_quality() -> None:
    """Straight down both are alike: 1.958 cm from 100 m, NIIRS by equation 1."""
    plan = plan_of({})
    (camera,) = plan.cameras
    gsd_m = camera.pixel_pitch_m / camera.focal_length_m * 100.0
    niirs = 10.25 - 3.32 * math.log10(gsd_m / 0.0254) + 1.559 * math.log10(0.92) - 0.344 / 50.0
    for footprint in plan.footprints:
        assert footprint.gsd_m == pytest.approx(gsd_m, abs=1e-9)
        assert footprint.gsd_mean_m == pytest.approx(gsd_m, abs=1e-9)
        assert footprint.niirs == pytest.approx(niirs, abs=1e-9)
        assert footprint.niirs_mean == pytest.approx(niirs, abs=1e-9)


def test_tilted_the_mean_is_that_of_the_ground_seen() -> None:
    """Against a fine grid of the image, each pixel weighed by the ground it covers."""
    plan = plan_of({"tilt_deg": 30.0, "side_overlap": 0.2})
    camera = plan.cameras[0]
    tilt = math.radians(30.0)
    half = camera.rows * camera.pixel_pitch_m / camera.focal_length_m / 2.0
    up = (np.arange(200_000) + 0.5) / 200_000 * 2.0 * half - half
    off = np.arctan(up) + tilt
    # Along and across by equations 4 and 5: slant range over the sine of the depression there.
    pixel = camera.pixel_pitch_m / camera.focal_length_m
    across_m = pixel * np.cos(np.arctan(up)) * 100.0 / np.cos(off)
    along_m = across_m * np.cos(np.arctan(up)) / np.cos(off)
    gsd_m, weights = (along_m + across_m) / 2.0, along_m * across_m
    footprint = plan.footprints[0]
    assert footprint.gsd_m == pytest.approx(gsd_m.max(), rel=1e-5)
    assert footprint.gsd_mean_m == pytest.approx((gsd_m * weights).sum() / weights.sum(), rel=1e-6)


def test_radars_have_a_niirs_by_range_and_depression() -> None:
    """Equation 9 at either edge of the swath, worked by hand, and its mean over the ground."""
    sensor = SarSensor("sar", math.radians(45.0), math.radians(30.0), math.radians(10.0))
    worth = worth_of(sensor, 500.0, 0.0, 0.0)
    edges = [
        5.606 - 0.763 * 0.5 / math.sin(down) + 3.657 * down - 3.422 * down**2
        for down in (math.radians(30.0), math.radians(60.0))
    ]
    assert worth.niirs == pytest.approx(min(edges), abs=1e-9)
    out_m = 500.0 * np.linspace(math.tan(math.radians(30.0)), math.tan(math.radians(60.0)), 200_001)
    down = np.arctan2(500.0, out_m)
    all_of_it = 5.606 - 0.763 * np.hypot(out_m, 500.0) / 1000.0 + 3.657 * down - 3.422 * down**2
    assert worth.niirs_mean == pytest.approx(all_of_it.mean(), abs=1e-5)
