"""Random searches: ground, obstacles, importance, aircraft, sensor and wind by a seed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

LON_DEG, LAT_DEG = 10.0, 47.0

CAMERA = {
    "name": "eye", "type": "camera", "focal_length_m": 0.016, "pixel_pitch_m": 4e-6,
    "image_px": [4000, 3000], "forward_overlap": 0.5,
}  # fmt: skip
RADAR = {
    "name": "eye", "type": "sar", "incidence_deg": 45, "elevation_beamwidth_deg": 30,
    "azimuth_beamwidth_deg": 5, "look": "both",
}  # fmt: skip
MODELS = ("Skywalker X8", "Zagi", "DJI Matrice 300 RTK", "DJI Phantom 4 Pro", "WingtraOne GEN II")


def random_search(seed: int) -> dict[str, Any]:
    """A scenario whose ground takes more than its aircraft has."""
    rng = np.random.default_rng(seed)
    width_m, depth_m = (float(each) for each in rng.uniform(900.0, 2200.0, 2))
    model = str(rng.choice(MODELS))
    vehicle: dict[str, Any] = {
        "name": "uav",
        "model": model,
        "autopilot": str(rng.choice(["ardupilot", "px4"])),
        "reserve": round(float(rng.uniform(0.1, 0.3)), 2),
    }
    if model in ("Skywalker X8", "Zagi"):
        vehicle |= {"charge_mah": round(float(rng.uniform(1500.0, 4000.0))), "voltage_v": 14.8}
    features = [
        rectangle("area", -200.0, -200.0, width_m + 200.0, depth_m + 200.0),
        rectangle("roi", 0.0, 0.0, width_m, depth_m, name="ground"),
        point("start", float(rng.uniform(100.0, width_m - 100.0)), float(rng.uniform(-100.0, 100.0))),
    ]
    if rng.random() < 0.4:
        features.append(point("end", float(rng.uniform(100.0, width_m - 100.0)), depth_m - 50.0))
    if rng.random() < 0.5:
        west, south = width_m * float(rng.uniform(0.3, 0.5)), depth_m * float(rng.uniform(0.4, 0.6))
        features.append(rectangle("no_fly", west, south, west + 150.0, south + 120.0, name="zone"))
    if rng.random() < 0.5:
        west, south = width_m * float(rng.uniform(0.0, 0.6)), depth_m * float(rng.uniform(0.0, 0.6))
        patch = rectangle("importance", west, south, west + 300.0, south + 300.0, name="patch", score=5.0)
        features += [patch, rectangle("importance", 0.0, 0.0, width_m, depth_m, name="rest", score=1.0)]
    return {
        "type": "FeatureCollection",
        "name": f"search {seed}",
        "task": "search",
        "altitude_m": round(float(rng.uniform(80.0, 150.0))),
        "vehicles": [vehicle],
        "sensors": [RADAR if rng.random() < 0.25 else CAMERA],
        "wind": {
            "speed_m_s": round(float(rng.uniform(0.0, 6.0)), 1),
            "from_deg": round(float(rng.uniform(0.0, 359.0))),
        },
        "features": features,
    }


def lonlat(east_m: float, north_m: float) -> list[float]:
    """Degrees of a place, about."""
    lon_deg = LON_DEG + east_m / (111_320.0 * math.cos(math.radians(LAT_DEG)))
    return [round(lon_deg, 7), round(LAT_DEG + north_m / 111_195.0, 7)]


def feature(role: str, kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    """A GeoJSON feature of a role."""
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "geometry": geometry, "properties": {"role": role, **properties}}


def point(role: str, east_m: float, north_m: float, **properties: Any) -> dict[str, Any]:
    """One that is a place in metres."""
    return feature(role, "Point", lonlat(east_m, north_m), **properties)


def polygon(role: str, ring: Sequence[tuple[float, float]], **properties: Any) -> dict[str, Any]:
    """One that is an open ring in metres."""
    return feature(role, "Polygon", [[lonlat(*corner) for corner in [*ring, ring[0]]]], **properties)


def rectangle(
    role: str, west: float, south: float, east: float, north: float, **properties: Any
) -> dict[str, Any]:
    """One that is a rectangle in metres."""
    return polygon(role, [(west, south), (east, south), (east, north), (west, north)], **properties)
