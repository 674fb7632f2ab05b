"""The ground inside an image: every pixel's ray by itself lands inside the loop, and no other ground does."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from pyproj import Geod

from planner.sensors.frame_view import (
    HorizonError,
    edge_rays,
    loop_on_ellipsoid,
    loop_on_plane,
    loop_on_terrain,
)

GEOD = Geod(ellps="WGS84")
WIDE_RAD, HIGH_RAD = math.radians(30.0), math.radians(20.0)


def cast(camera: NDArray[np.float64], target: NDArray[np.float64], u: float, v: float) -> NDArray[np.float64]:
    """The test's own ray through a place of the image, u and v from −1 to 1, down to height 0."""
    forward = (target - camera) / math.dist(target, camera)
    azimuth = math.atan2(forward[0], forward[1])
    right = np.array([math.cos(azimuth), -math.sin(azimuth), 0.0])
    up = np.cross(right, forward)
    ray = forward + u * math.tan(WIDE_RAD) * right + v * math.tan(HIGH_RAD) * up
    landed: NDArray[np.float64] = (camera + ray * (-camera[2] / ray[2]))[:2]
    return landed


@given(
    height_m=st.floats(20.0, 3000.0),
    ahead=st.floats(0.05, 1.4),
    bearing_rad=st.floats(-3.1, 3.1),
    u=st.floats(-1.0, 1.0),
    v=st.floats(-1.0, 1.0),
)
def test_pixels_land_inside_the_loop(
    height_m: float, ahead: float, bearing_rad: float, u: float, v: float
) -> None:
    """Over flat ground: corners to a centimetre a kilometre, and every pixel within them."""
    camera = np.array([500.0, -300.0, height_m])
    off_m = ahead * height_m
    east_m, north_m = off_m * math.sin(bearing_rad), off_m * math.cos(bearing_rad)
    target = camera + np.array([east_m, north_m, -height_m])
    loop = loop_on_plane(camera, edge_rays(camera, target, WIDE_RAD, HIGH_RAD))
    for (a, b), corner in zip([(-1, -1), (1, -1), (1, 1), (-1, 1)], loop, strict=True):
        assert math.dist(corner, cast(camera, target, a, b)) < 1e-5 * (height_m + 1000.0)
    seen = shapely.Polygon(loop)
    assert seen.is_valid
    assert seen.buffer(1e-6 * height_m).contains(shapely.Point(cast(camera, target, u, v)))


def test_straight_down_is_a_rectangle() -> None:
    """North up, as wide and high as the angles of view make it."""
    loop = loop_on_plane((0.0, 0.0, 100.0), edge_rays((0.0, 0.0, 100.0), (0.0, 0.0, 0.0), WIDE_RAD, HIGH_RAD))
    wide_m, high_m = 100.0 * math.tan(WIDE_RAD), 100.0 * math.tan(HIGH_RAD)
    box = shapely.box(-wide_m, -high_m, wide_m, high_m)
    assert shapely.Polygon(loop).symmetric_difference(box).area < 1e-9


def test_the_horizon_is_no_ground() -> None:
    """An image whose upper edge looks over the horizon is refused, on every kind of ground."""
    rays = edge_rays((0.0, 0.0, 100.0), (400.0, 0.0, 0.0), WIDE_RAD, HIGH_RAD)
    with pytest.raises(HorizonError):
        loop_on_plane((0.0, 0.0, 100.0), rays)
    with pytest.raises(HorizonError):
        loop_on_ellipsoid(8.0, 47.0, 100.0, rays)
    with pytest.raises(HorizonError):
        loop_on_terrain((0.0, 0.0, 100.0), rays, lambda places: np.zeros(len(places)), 10.0, 5000.0)


@given(lon_deg=st.floats(-179.0, 179.0), lat_deg=st.floats(-80.0, 80.0), bearing_rad=st.floats(-3.1, 3.1))
def test_on_the_ellipsoid_near_by_it_is_the_plane(lon_deg: float, lat_deg: float, bearing_rad: float) -> None:
    """From 200 m the two differ by what the Earth falls off: under a centimetre, by geodesics."""
    height_m = 200.0
    target = (120.0 * math.sin(bearing_rad), 120.0 * math.cos(bearing_rad), 0.0)
    rays = edge_rays((0.0, 0.0, height_m), target, WIDE_RAD / 2.0, HIGH_RAD / 2.0, 3)
    flat = loop_on_plane((0.0, 0.0, height_m), rays)
    curved = loop_on_ellipsoid(lon_deg, lat_deg, height_m, rays)
    for (east_m, north_m), (lon, lat) in zip(flat, curved, strict=True):
        azimuth_deg, _, away_m = GEOD.inv(lon_deg, lat_deg, lon, lat)
        there = away_m * math.sin(math.radians(azimuth_deg)), away_m * math.cos(math.radians(azimuth_deg))
        assert math.dist((east_m, north_m), there) < 0.02


@given(slope=st.floats(-0.3, 0.3), bearing_rad=st.floats(-3.1, 3.1))
def test_on_a_slope_it_is_where_line_and_plane_meet(slope: float, bearing_rad: float) -> None:
    """A tilted plane as terrain: the exact crossing of ray and plane."""
    camera = np.array([0.0, 0.0, 300.0])
    target = np.array([150.0 * math.sin(bearing_rad), 150.0 * math.cos(bearing_rad), 0.0])
    rays = edge_rays(camera, target, WIDE_RAD / 2.0, HIGH_RAD / 2.0, 4)
    loop = loop_on_terrain(camera, rays, lambda places: slope * places[:, 0], 5.0, 5000.0)
    along = camera[2] / (slope * rays[:, 0] - rays[:, 2])
    np.testing.assert_allclose(loop, (rays * along[:, None])[:, :2], atol=1e-6)


def test_a_ridge_hides_what_lies_behind() -> None:
    """The loop ends at the first ground that a ray meets."""
    camera, target = (0.0, 0.0, 100.0), (0.0, 300.0, 0.0)
    rays = edge_rays(camera, target, 0.05, 0.05, 1)

    def ridge(places: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(np.abs(places[:, 1] - 150.0) < 10.0, 90.0, 0.0)

    loop = loop_on_terrain(camera, rays, ridge, 2.0, 5000.0)
    assert (np.abs(loop[:, 1] - 140.0) <= 2.0).all()
