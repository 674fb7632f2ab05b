"""The one place that converts between WGS 84 and the local frame.

The local frame is a transverse Mercator projection with scale 1 on the meridian through its origin: metres
east and north of the origin, or along axes turned from there. It is conformal, so right angles and turn arcs
stay what they are, and at 20 km from the central meridian its scale is off by 5 parts in a million.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pyproj import Geod, Transformer

from planner.angles import angle_from_heading, heading_from_angle, wrap_pi

WGS84 = Geod(ellps="WGS84")

#: Beyond this distance from the origin the frame's scale error exceeds 0.1 %.
MAX_EXTENT_M = 250_000.0


@lru_cache(maxsize=64)
def _transformers(lon_deg: float, lat_deg: float) -> tuple[Transformer, Transformer]:
    local = f"+proj=tmerc +lat_0={lat_deg!r} +lon_0={lon_deg!r} +k_0=1 +ellps=WGS84 +units=m +no_defs"
    geographic = "+proj=longlat +ellps=WGS84 +no_defs"
    return (
        Transformer.from_crs(geographic, local, always_xy=True),
        Transformer.from_crs(local, geographic, always_xy=True),
    )


@dataclass(frozen=True, slots=True)
class LocalFrame:
    """East-north metres round an origin, or metres along axes turned from there.

    Parameters
    ----------
    lon_deg, lat_deg
        The origin in WGS 84 degrees.
    turned_rad
        From east to the first axis, counter-clockwise. What is called east and north of a scenario are the
        axes of its frame: nothing of a plan hangs on where north is, if they lie as the scenario does.
    """

    lon_deg: float
    lat_deg: float
    turned_rad: float = 0.0

    def to_local(self, lonlat_deg: ArrayLike) -> NDArray[np.float64]:
        """Local metres of WGS 84 positions.

        Parameters
        ----------
        lonlat_deg
            Shape (..., 2): longitude, latitude in degrees.

        Returns
        -------
        ndarray
            float64, the same shape: east_m, north_m.
        """
        array = np.asarray(lonlat_deg, dtype=np.float64)
        forward, _ = _transformers(self.lon_deg, self.lat_deg)
        places = np.stack(forward.transform(array[..., 0], array[..., 1], errcheck=True), axis=-1)
        return places if self.turned_rad == 0.0 else np.asarray(places @ self._axes.T)

    def to_wgs84(self, enu_m: ArrayLike) -> NDArray[np.float64]:
        """WGS 84 positions, shape (..., 2): longitude, latitude in degrees, of local metres (..., 2)."""
        array = np.asarray(enu_m, dtype=np.float64)
        if self.turned_rad != 0.0:
            array = array @ self._axes
        _, inverse = _transformers(self.lon_deg, self.lat_deg)
        lon_deg, lat_deg = inverse.transform(array[..., 0], array[..., 1], errcheck=True)
        return np.stack([lon_deg, lat_deg], axis=-1)

    @property
    def _axes(self) -> NDArray[np.float64]:
        """Unit vectors along the axes, in rows."""
        cos, sin = math.cos(self.turned_rad), math.sin(self.turned_rad)
        return np.array([[cos, sin], [-sin, cos]])

    def north_up(self, places_m: ArrayLike) -> NDArray[np.float64]:
        """Metres east and north of the origin, of local places (..., 2)."""
        return np.asarray(np.asarray(places_m, dtype=np.float64) @ self._axes)

    def from_north_up(self, enu_m: ArrayLike) -> NDArray[np.float64]:
        """Local places of metres east and north of the origin (..., 2)."""
        return np.asarray(np.asarray(enu_m, dtype=np.float64) @ self._axes.T)

    def direction_rad(self, heading_deg: float) -> float:
        """Local angle of a heading at the origin, in (-π, π]: of what is the same everywhere, a wind say."""
        return wrap_pi(angle_from_heading(heading_deg) - self.turned_rad)

    def heading_deg(self, angle_rad: float) -> float:
        """Heading from north at the origin, in [0, 360), of a local angle."""
        return heading_from_angle(angle_rad + self.turned_rad)

    def true_heading_deg(self, east_m: float, north_m: float, angle_rad: float) -> float:
        """Heading clockwise from true north of a local direction at a place.

        The grid's north differs from true north by the meridian convergence, measured here on the geodesic
        to a point 100 m ahead.
        """
        ahead = [
            [east_m, north_m],
            [east_m + 100.0 * float(np.cos(angle_rad)), north_m + 100.0 * float(np.sin(angle_rad))],
        ]
        (lon0, lat0), (lon1, lat1) = self.to_wgs84(ahead)
        azimuth_deg, _, _ = WGS84.inv(lon0, lat0, lon1, lat1)
        return float(azimuth_deg) % 360.0

    def angle_rad(self, east_m: float, north_m: float, heading_deg: float) -> float:
        """Local angle, counter-clockwise from east, of a heading from true north at a place."""
        (lon_deg, lat_deg) = self.to_wgs84([east_m, north_m])
        ahead_lon, ahead_lat, _ = WGS84.fwd(lon_deg, lat_deg, heading_deg, 100.0)
        ahead_east_m, ahead_north_m = self.to_local([ahead_lon, ahead_lat])
        return math.atan2(float(ahead_north_m) - north_m, float(ahead_east_m) - east_m)
