"""Several small aircraft over little room: edges, zones and obstacles close to all that is to be seen."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.planner.scenarios import feature

Document = dict[str, Any]
Place = tuple[float, float]

LON_DEG, LAT_DEG = 7.0, 46.0
#: Metres of a degree of longitude and of latitude, about.
DEGREE_M = (111_320.0 * math.cos(math.radians(LAT_DEG)), 111_130.0)
SAR = {
    "name": "sar", "type": "sar", "incidence_deg": 45.0, "elevation_beamwidth_deg": 30.0,
    "azimuth_beamwidth_deg": 10.0, "look": "both",
}  # fmt: skip
CAMERA = {
    "name": "eye", "type": "camera", "focal_length_m": 0.035, "pixel_pitch_m": 4.5e-6,
    "image_px": [6000, 4000],
}  # fmt: skip


def yard(seed: int) -> Document:
    """Two or three aircraft from one base or two, two to six regions, up to three zones and obstacles."""
    rng = np.random.default_rng(10_000 + seed)
    wings = bool(rng.random() < 0.5)
    width_m = float(rng.uniform(900, 2600) if wings else rng.uniform(250, 1200))
    depth_m = float(rng.uniform(0.6, 1.2) * width_m)
    turned = float(rng.uniform(0, math.pi)) if rng.random() < 0.5 else 0.0

    def place(part: float) -> Place:
        east, north = (rng.uniform(-part / 2, part / 2, 2) * (width_m, depth_m)).tolist()
        return _turned((0.0, 0.0), east, north, turned)

    count = int(rng.integers(2, 4))
    names = [f"b{k}" for k in range(1 + int(rng.random() < 0.5))]
    features = [feature("area", "area", "Polygon", _ring((0.0, 0.0), width_m, depth_m, turned))]
    bases = [place(0.85) for _ in names]
    features += [feature(name, "base", "Point", _lonlat(at)) for name, at in zip(names, bases, strict=True)]
    sensor = SAR if rng.random() < 0.45 else CAMERA
    altitude_m = float(rng.choice([60.0, 90.0, 120.0]) if sensor is CAMERA else rng.choice([150.0, 250.0]))
    vehicles = [_vehicle(rng, f"u{k}", names, wings=wings) for k in range(count)]
    regions = int(rng.integers(2, 7))
    windows = rng.random() < 0.25
    features += [_region(rng, f"R{k}", place, width_m, windows=bool(windows)) for k in range(regions)]
    for k in range(int(rng.integers(0, 4))):
        at, side_m = place(0.9), float(rng.uniform(0.03, 0.12)) * width_m
        if min(math.dist(at, base) for base in bases) >= side_m + 45:
            features.append(_barrier(rng, str(k), at, side_m))
    document: Document = {
        "type": "FeatureCollection", "name": f"yard {seed}", "features": features, "vehicles": vehicles,
        "sensors": [sensor], "seed": seed, "clearance_m": float(rng.choice([5.0, 10.0, 20.0])),
        "separation": {
            "horizontal_m": float(rng.choice([20.0, 50.0, 100.0])),
            "vertical_m": float(rng.choice([10.0, 20.0])),
        },
    }  # fmt: skip
    if rng.random() < 0.3:
        document |= {"max_height_m": altitude_m, "min_height_m": altitude_m / 2}
    else:
        document["altitude_m"] = altitude_m
    if rng.random() < 0.4:
        speed_m_s, from_deg = float(rng.uniform(1, 5)), float(rng.uniform(0, 359))
        document["wind"] = {"speed_m_s": round(speed_m_s, 1), "from_deg": round(from_deg, 1)}
    return document


def _lonlat(at: Place) -> list[float]:
    return [round(LON_DEG + at[0] / DEGREE_M[0], 7), round(LAT_DEG + at[1] / DEGREE_M[1], 7)]


def _turned(middle: Place, east_m: float, north_m: float, angle_rad: float) -> Place:
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return middle[0] + east_m * cos - north_m * sin, middle[1] + east_m * sin + north_m * cos


def _ring(middle: Place, width_m: float, depth_m: float, angle_rad: float) -> list[list[list[float]]]:
    corners = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5))
    return [[_lonlat(_turned(middle, x * width_m, y * depth_m, angle_rad)) for x, y in corners]]


def _vehicle(rng: np.random.Generator, name: str, bases: list[str], *, wings: bool) -> Document:
    if wings and rng.random() < 0.8:
        kind = "vtol" if rng.random() < 0.3 else "fixed_wing"
        speed_m_s, radius_m = float(rng.uniform(13, 20)), float(rng.uniform(35, 70))
        own: Document = {
            "type": kind,
            "airspeed_m_s": round(speed_m_s, 1),
            "min_turn_radius_m": round(radius_m, 1),
        }
        if rng.random() < 0.5:
            own["settle_m"] = float(rng.choice([0, 20, 50]))
    else:
        own = {"type": "multirotor", "airspeed_m_s": round(float(rng.uniform(5, 12)), 1)}
    own |= {"name": name, "base": str(rng.choice(bases)), "autopilot": str(rng.choice(["ardupilot", "px4"]))}
    if rng.random() < 0.25:
        own |= {"batteries": 2, "turnaround_s": 60.0, "max_flight_time_s": float(rng.uniform(600, 1500))}
    elif rng.random() < 0.2:
        own |= {"max_range_m": float(rng.uniform(6000, 20000))}
    if len(bases) > 1 and rng.random() < 0.3:
        own["end_bases"] = bases
    return own


def _region(rng: np.random.Generator, name: str, place: Any, width_m: float, *, windows: bool) -> Document:
    at, side_m, kind = place(0.7), float(rng.uniform(0.04, 0.2)) * width_m, rng.random()
    wishes: Document = {}
    if windows and rng.random() < 0.3:
        opens_s = float(rng.uniform(100, 600))
        wishes["time_window_s"] = [round(opens_s, 1), round(opens_s + float(rng.uniform(300, 900)), 1)]
    if rng.random() < 0.3:
        wishes["required"] = False
    if kind < 0.6:
        ring = _ring(at, side_m, side_m * float(rng.uniform(0.4, 1)), float(rng.uniform(0, 3)))
        return feature(name, "roi", "Polygon", ring, **wishes)
    if kind < 0.8:
        radius_m = round(float(rng.uniform(0, 0.05)) * width_m, 1)
        return feature(name, "roi", "Point", _lonlat(at), radius_m=radius_m, **wishes)
    line = [_lonlat(at), _lonlat(place(0.7))]
    return feature(name, "roi", "LineString", line, width_m=round(float(rng.uniform(5, 30)), 1), **wishes)


def _barrier(rng: np.random.Generator, number: str, at: Place, side_m: float) -> Document:
    kind = rng.random()
    if kind < 0.45:
        return feature(f"Z{number}", "no_fly", "Polygon", _ring(at, side_m, side_m, float(rng.uniform(0, 3))))
    if kind < 0.8:
        ring, height_m = _ring(at, side_m, side_m, float(rng.uniform(0, 3))), float(rng.uniform(20, 150))
        return feature(f"O{number}", "obstacle", "Polygon", ring, height_m=height_m)
    return feature(
        f"T{number}", "threat", "Point", _lonlat(at), model="missile", radius_m=round(side_m, 1),
        hard=bool(rng.random() < 0.5),
    )  # fmt: skip
