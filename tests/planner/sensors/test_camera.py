"""Cameras: photos overlap as asked, in wind, tilted, over relief; against rays of the tests' own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import union_all
from shapely.affinity import translate
from shapely.geometry import Polygon, box

from planner.airspace.airspace import Airspace, Level
from planner.airspace.values import Wind
from planner.check.camera_print import apart_m, camera_footprint, photo_corners
from planner.sensors.camera import CameraSensor
from planner.sensors.camera_view import seen_on_flat, seen_on_terrain
from planner.sensors.optics import Optics
from planner.sensors.quality import Giqe4
from tests.planner.terrains import grid

A6000 = Optics(0.02, 23.5e-3 / 6000, 6000, 4000)
PLAIN = CameraSensor("eye", A6000)

drifts = st.floats(0.0, 0.6)
courses = st.floats(0.0, math.tau)
tilts = st.floats(math.radians(-25.0), math.radians(35.0))
overlaps = st.floats(0.0, 0.9)


def image_on_ground(optics: Optics, tilt_rad: float, turned_rad: float, height_m: float) -> Polygon:
    """A photo's ground, course along x: rays through the corners by three rotations in turn."""
    wide, high = math.tan(optics.half_width_rad), math.tan(optics.half_height_rad)
    ring = []
    for right, up in ((-wide, -high), (wide, -high), (wide, high), (-wide, high)):
        # From straight down: the image's top points ahead; pitched up by the tilt, then turned left.
        off = math.atan(up) + tilt_rad
        slant = math.hypot(1.0, up)
        ahead, down = slant * math.sin(off), slant * math.cos(off)
        x, y = ahead / down * height_m, -right / down * height_m
        ring.append(
            (
                x * math.cos(turned_rad) - y * math.sin(turned_rad),
                x * math.sin(turned_rad) + y * math.cos(turned_rad),
            )
        )
    return Polygon(ring)


def test_straight_down_in_still_air_it_is_the_image_and_its_parts() -> None:
    """Worked by hand: from 100 m a 20 mm lens before 23.5 × 15.67 mm sees 117.5 × 78.33 m."""
    assert PLAIN.swath_m(100.0) == pytest.approx(117.5, abs=1e-9)
    assert PLAIN.lane_spacing_m(100.0, 0.3) == pytest.approx(0.35 * 117.5, abs=1e-9)
    assert PLAIN.photo_spacing_m(100.0, 0.3) == pytest.approx(0.25 * 235.0 / 3.0, abs=1e-9)
    assert PLAIN.half_width_m(100.0, 0.3) == pytest.approx(58.75, abs=1e-9)
    # The first photo's middle lies as far inside as the second one sees the edge, an interval at most; where
    # no second one sees it half an interval.
    for overlap, inside in ((0.5, 0.0), (0.6, 0.1), (0.75, 0.25), (0.85, 0.15), (0.4, 0.3)):
        some = replace(PLAIN, forward_overlap=overlap)
        inside_m = -inside * 235.0 / 3.0
        assert (some.run_in_m(100.0, 0.3), some.run_out_m(100.0, 0.3)) == pytest.approx(
            (inside_m, inside_m), abs=1e-9
        )
    assert PLAIN.worst_gsd_m(100.0) == pytest.approx(100.0 * 23.5e-3 / 6000 / 0.02, rel=1e-12)


@given(drifts, courses, tilts, overlaps)
def test_a_photo_shares_the_asked_part_with_the_next(
    drift: float, course: float, tilt: float, overlap: float
) -> None:
    """Whatever wind, course and tilt: areas of quadrilaterals by shapely."""
    sensor = replace(PLAIN, tilt_rad=tilt, forward_overlap=overlap).in_wind(drift, 0.7)
    photo = image_on_ground(A6000, tilt, sensor.crab_rad(course), 100.0)
    spacing_m = sensor.photo_spacing_m(100.0, course)
    shared = photo.intersection(translate(photo, spacing_m)).area / photo.area
    # Photos that were to share nothing share a little: so that no strip beside them is without width.
    assert shared == pytest.approx(overlap, abs=1e-6) or (overlap < 0.05 and overlap < shared < 0.05)


@given(drifts, courses, tilts, overlaps, st.floats(0.0, 15.0))
def test_within_the_strip_every_place_is_seen_as_often_as_the_overlap_says(
    drift: float, course: float, tilt: float, overlap: float, relief_m: float
) -> None:
    """Photos counted one by one, at places across the strip, on the highest and the lowest ground."""
    sensor = replace(PLAIN, tilt_rad=tilt, forward_overlap=overlap).in_wind(drift, 0.7).over_relief(relief_m)
    spacing_m, half_m = sensor.photo_spacing_m(120.0, course), sensor.half_width_m(120.0, course)
    run_in_m = sensor.run_in_m(120.0, course)
    assert half_m > 0.0
    for height_m in (120.0 - relief_m, 120.0 + relief_m):
        photo = image_on_ground(A6000, tilt, sensor.crab_rad(course), height_m)
        for left_m in np.linspace(-half_m, half_m, 7) * (1.0 - 1e-9):
            low_m, _, high_m, _ = photo.intersection(box(-1e4, left_m - 1e-7, 1e4, left_m + 1e-7)).bounds
            assert math.floor((high_m - low_m) / spacing_m + 1e-4) >= math.floor(1.0 / (1.0 - overlap) + 1e-9)
            # From the first photo on, run_in_m before the ground, no place is missed.
            assert low_m - run_in_m <= 1e-4
            assert high_m + sensor.run_out_m(120.0, course) >= -1e-4


@given(drifts, courses, tilts, st.floats(0.3, 0.9))
def test_what_passes_see_is_what_their_photos_see_and_the_judge_finds(
    drift: float, course: float, tilt: float, overlap: float
) -> None:
    """The planner's polygon lies in the union of photos, and equals the judge's."""
    sensor = replace(PLAIN, tilt_rad=tilt, forward_overlap=overlap)
    windy = sensor.in_wind(drift, 0.7)
    spacing_m = windy.photo_spacing_m(100.0, course)
    ahead = np.array([math.cos(course), math.sin(course)])
    start = np.array([30.0, -70.0])
    line_m = np.array([start, start + 6 * spacing_m * ahead])
    seen = seen_on_flat(windy, line_m, 100.0)
    photo = image_on_ground(A6000, tilt, windy.crab_rad(course), 100.0)
    cos, sin = ahead
    turned = Polygon(
        [(start[0] + cos * x - sin * y, start[1] + sin * x + cos * y) for x, y in photo.exterior.coords]
    )
    photos = union_all([translate(turned, *(k * spacing_m * ahead)) for k in range(7)])
    assert seen.difference(photos.buffer(1e-4)).area < 1e-3
    air = Airspace(wind=Wind(20.0 * drift, 0.7))
    judged = camera_footprint(sensor, line_m, "down", 100.0, 20.0, air, Level(100.0, 100.0))
    assert seen.symmetric_difference(judged).area < 1e-5 * judged.area


@given(drifts, courses, tilts, st.floats(0.1, 0.49))
def test_photos_that_overlap_by_less_than_half_begin_early_enough_beside_the_line_too(
    drift: float, course: float, tilt: float, overlap: float
) -> None:
    """Anywhere in the strip, chords cut by shapely: no more than half a spacing from the middle of its."""
    camera = replace(PLAIN, tilt_rad=tilt, forward_overlap=overlap).in_wind(drift, 0.7)
    laid = camera.pattern(course)
    photo = image_on_ground(A6000, tilt, camera.crab_rad(course), 100.0)
    in_m, out_m = camera.kept_in_m(100.0, course), camera.kept_out_m(100.0, course)
    for share in (0.001, 0.2, 0.5, 0.8, 0.999):
        left_m = 100.0 * (laid.right + share * (laid.left - laid.right))
        chord = photo.intersection(box(-1e4, left_m - 1e-6, 1e4, left_m + 1e-6)).bounds
        middle_m = (chord[0] + chord[2]) / 2.0
        # Of the first photo, so far before the ground, that lies at +in; of the last one at -out.
        assert in_m >= middle_m - 50.0 * laid.spacing - 1e-3
        assert -out_m <= middle_m + 50.0 * laid.spacing + 1e-3
        assert chord[0] - 1e-3 <= in_m
        assert -out_m <= chord[2] + 1e-3


@given(drifts, courses, tilts)
def test_the_judge_spaces_photos_alike(drift: float, course: float, tilt: float) -> None:
    """By areas of polygons, where the planner sums chords."""
    sensor = replace(PLAIN, tilt_rad=tilt).in_wind(drift, 0.7)
    own = apart_m(Polygon(photo_corners(sensor, sensor.crab_rad(course))), sensor)
    assert sensor.photo_spacing_m(1.0, course) == pytest.approx(own, rel=1e-6)


@given(st.floats(0.0, 3.0), st.floats(0.0, 6.0), st.floats(0.0, 10.0))
def test_margins_asked_for_keep_the_overlap_others_keep_the_ground(
    pointing_deg: float, position_m: float, relief_m: float
) -> None:
    """Two lanes off towards each side with all of their margins: nothing is missed, overlap is as asked."""
    margins = replace(
        PLAIN, pointing_margin_rad=math.radians(pointing_deg), position_margin_m=position_m
    ).over_relief(relief_m)
    off_m = position_m + (100.0 + relief_m) * math.tan(math.radians(pointing_deg))
    whole_m = 1.175 * (100.0 - relief_m)
    assert margins.lane_spacing_m(100.0, 0.0) + 2.0 * off_m <= whole_m + 1e-9
    assert margins.lane_spacing_m(100.0, 0.0) == pytest.approx(min(0.35 * whole_m, whole_m - 2.0 * off_m))
    asked = replace(margins, steady_overlap=True)
    assert 1.0 - (asked.lane_spacing_m(100.0, 0.0) + 2.0 * off_m) / whole_m >= 0.65 - 1e-9


def test_quality_is_that_of_the_worst_pixel() -> None:
    """Tilted by 30°, half an image of 21.39° ahead: by equations 4 and 5 at its far edge, worked by hand."""
    tilted = replace(PLAIN, tilt_rad=math.radians(30.0), quality=Giqe4("visible", 0.9, 50.0)).over_relief(
        20.0
    )
    half = math.atan(23.5e-3 / 6000 * 4000 / 2 / 0.02)
    down = math.cos(math.radians(30.0) + half) / math.cos(half)
    gsd_m = 23.5e-3 / 6000 / 0.02 * 120.0 * (1.0 / down + 1.0 / down**2) / 2.0
    assert tilted.worst_gsd_m(100.0) == pytest.approx(gsd_m, rel=1e-9)
    assert tilted.height_for_m(gsd_m) == pytest.approx(100.0, rel=1e-9)
    niirs = 10.25 - 3.32 * math.log10(gsd_m / 0.0254) + 1.559 * math.log10(0.9) - 0.344 / 50.0
    assert tilted.worst_niirs(100.0) == pytest.approx(niirs, abs=1e-9)
    assert PLAIN.worst_niirs(100.0) is None


@pytest.mark.parametrize("drift", [0.0, 0.5])
def test_over_a_slope_the_strip_is_where_rays_meet_it(drift: float) -> None:
    """Across a slope of one in five each edge lies where its ray and the plane meet, in closed form."""
    slope = grid(lambda e, n: 0.2 * n)
    sensor = PLAIN.in_wind(drift, math.pi)
    line_m = np.array([(-200.0, 0.0), (200.0, 0.0)])
    seen = seen_on_terrain(sensor, line_m, "down", 150.0, slope).area
    ahead = seen_on_flat(sensor, line_m, 1.0)
    _, right, _, left = ahead.bounds
    # y = t·s, z = 0.2·y, 150 − s = 0.2·y for a ray that goes t aside for each metre down.
    for share, low, high in ((left, 0.0, 1e3), (right, -1e3, 0.0)):
        edge_m = share * 150.0 / (1.0 + 0.2 * share)
        found = seen.intersection(box(-20.0, low, 20.0, high)).bounds
        assert (found[3] if high else found[1]) == pytest.approx(edge_m, abs=0.01)


def test_ground_that_is_not_known_is_not_seen() -> None:
    """A pass off the raster sees nothing."""
    assert seen_on_terrain(
        PLAIN, [(2950.0, 0.0), (2990.0, 0.0)], "down", 150.0, grid(lambda e, n: 0.0 * e)
    ).area.is_empty


def test_what_is_seen_from_a_line_beside_a_slope_is_that_over_level_ground() -> None:
    """A line that rises with a plane sees a strip as wide as from that height; a level one sees a wedge."""
    camera = CameraSensor("cam", Optics(0.035, 4.5e-6, 7952, 5304))
    ground = grid(lambda east, north: 0.1 * east, half_m=1000.0, step_m=10.0)
    line = [(-300.0, 0.0), (300.0, 0.0)]
    rising = seen_on_terrain(camera, line, "down", 0.1 * np.linspace(-300.0, 300.0, 7) + 120.0, ground).area
    flat = seen_on_flat(camera, line, 120.0)
    for at_m in (-250.0, 0.0, 250.0):
        across = [box(at_m - 1.0, -500.0, at_m + 1.0, 500.0).intersection(each) for each in (rising, flat)]
        assert across[0].area == pytest.approx(across[1].area, rel=0.02)
    assert seen_on_terrain(camera, line, "down", np.full(5, 200.0), ground).area.equals_exact(
        seen_on_terrain(camera, line, "down", 200.0, ground).area, 1e-9
    )


@given(st.floats(0.0, 0.6), courses, st.floats(0.0, 0.05))
def test_photos_that_hardly_overlap_leave_a_strip(drift: float, course: float, overlap: float) -> None:
    """Overlaps of next to nothing, whatever the crab: what a pass sees has an area, for judge and planner."""
    camera = replace(PLAIN, forward_overlap=overlap, side_overlap=0.0).in_wind(drift, 0.0)
    line = np.array([[0.0, 0.0], [400.0 * math.cos(course), 400.0 * math.sin(course)]])
    airspace, level = Airspace(wind=Wind(10.0 * drift, 0.0)), Level(100.0, 100.0)
    assert seen_on_flat(camera, line, 100.0).area > 0.0
    assert camera_footprint(camera, line, "down", 100.0, 10.0, airspace, level).area > 0.0
