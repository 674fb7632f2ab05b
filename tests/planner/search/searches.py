"""Scenarios that ask for a search, small enough to be planned in a second."""

from __future__ import annotations

import copy
import math
from typing import Any

LON_DEG, LAT_DEG = 10.0, 47.0

CAMERA = {
    "name": "cam", "type": "camera", "focal_length_m": 0.016, "pixel_pitch_m": 4e-6,
    "image_px": [4000, 3000], "forward_overlap": 0.5,
}  # fmt: skip
RADAR = {
    "name": "sar", "type": "sar", "incidence_deg": 45, "elevation_beamwidth_deg": 30,
    "azimuth_beamwidth_deg": 5, "look": "both",
}  # fmt: skip
WING = {
    "name": "uav", "type": "fixed_wing", "autopilot": "ardupilot", "airspeed_m_s": 16, "max_bank_deg": 35,
    "energy_wh": 24, "power": {"model": "constant", "power_w": 120},
}  # fmt: skip
COPTER = {
    "name": "uav", "type": "multirotor", "autopilot": "ardupilot", "airspeed_m_s": 10,
    "energy_wh": 60, "power": {"model": "constant", "power_w": 300},
}  # fmt: skip


def lonlat(east_m: float, north_m: float) -> list[float]:
    """Degrees of a place, about."""
    return [LON_DEG + east_m / (111_320.0 * math.cos(math.radians(LAT_DEG))), LAT_DEG + north_m / 111_195.0]


def feature(role: str, kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    """A GeoJSON feature of a role."""
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "geometry": geometry, "properties": {"role": role, **properties}}


def rectangle(
    role: str, west: float, south: float, east: float, north: float, **properties: Any
) -> dict[str, Any]:
    """A feature that is a rectangle in metres."""
    corners = [(west, south), (east, south), (east, north), (west, north), (west, south)]
    return feature(role, "Polygon", [[lonlat(*corner) for corner in corners]], **properties)


def document(
    *more: dict[str, Any], vehicle: dict[str, Any] = WING, sensor: dict[str, Any] = CAMERA, **members: Any
) -> dict[str, Any]:
    """A search of 1200 m by 900 m from a corner of it."""
    return copy.deepcopy(
        {
            "type": "FeatureCollection", "task": "search", "altitude_m": 100,
            "vehicles": [vehicle], "sensors": [sensor],
            "features": [
                rectangle("area", 0.0, 0.0, 1200.0, 900.0),
                feature("start", "Point", lonlat(150.0, 150.0)),
                *more,
            ],
            **members,
        }
    )  # fmt: skip
