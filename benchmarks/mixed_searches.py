"""Random searches of every kind: ground, one to four aircraft, zones, threats, wind, importance, drift.

Aircraft take constant power, so that what a flight takes is its time: :func:`flights_of` tells that by
geodesics and the wind triangle, with nothing of the planner's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from pyproj import Geod

from benchmarks.search_scenarios import CAMERA, RADAR, feature, lonlat, polygon, rectangle
from planner.airspace.terrain import Terrain

GEOD = Geod(ellps="WGS84")
#: The raster of a search that has one, by this name.
RASTER = "worth"
#: Of the air's density low down: it falls by e over so much height, about (ISO 2533).
SCALE_M = 10_400.0


def mixed_search(seed: int) -> tuple[dict[str, Any], dict[str, Terrain]]:
    """A search, and the rasters that it names."""
    rng = np.random.default_rng([seed, 12])
    draw = _Draw(rng, *(float(each) for each in rng.uniform(700.0, 1600.0, 2)))
    features = [*draw.ground(), *draw.hindrances()]
    importance, members, rasters = draw.importance()
    vehicles, bases = draw.vehicles()
    document = {
        "type": "FeatureCollection", "name": f"mixed search {seed}", "task": "search",
        "altitude_m": round(draw.between(70.0, 140.0)), "vehicles": vehicles,
        "sensors": [RADAR if draw.chance(0.25) else CAMERA],
        "wind": {"speed_m_s": round(draw.between(0.0, 8.0), 1), "from_deg": round(draw.between(0.0, 359.0))},
        "features": [*features, *importance, *bases], **members,
    }  # fmt: skip
    return document, rasters


class _Draw:
    """Parts of a search over ground so wide and deep."""

    def __init__(self, rng: np.random.Generator, width_m: float, depth_m: float) -> None:
        self._rng, self._width_m, self._depth_m = rng, width_m, depth_m

    def between(self, low: float, high: float) -> float:
        return float(self._rng.uniform(low, high))

    def chance(self, part: float) -> bool:
        return bool(self._rng.random() < part)

    def _place(self) -> tuple[float, float]:
        return self.between(0.0, self._width_m), self.between(0.0, self._depth_m)

    def ground(self) -> list[dict[str, Any]]:
        """Regions, and mostly an area round them."""
        width_m, depth_m = self._width_m, self._depth_m
        low_m, high_m = 0.4 * width_m, 0.6 * width_m
        rings = {
            "rectangle": [[(0, 0), (width_m, 0), (width_m, depth_m), (0, depth_m)]],
            "triangle": [[(0, 0), (width_m, 0.2 * depth_m), (0.3 * width_m, depth_m)]],
            "bend": [[
                (0, 0), (width_m, 0), (width_m, 0.5 * depth_m), (high_m, 0.5 * depth_m), (high_m, depth_m),
                (0, depth_m),
            ]],
            "two": [
                [(0, 0), (low_m, 0), (low_m, depth_m), (0, depth_m)],
                [(high_m, 0.3 * depth_m), (width_m, 0), (width_m, depth_m), (high_m, depth_m)],
            ],
        }  # fmt: skip
        shape = str(self._rng.choice(list(rings)))
        found = [polygon("roi", ring, name=f"ground {k}") for k, ring in enumerate(rings[shape], 1)]
        if self.chance(0.7):
            round_m = self.between(250.0, 600.0)
            found.append(rectangle("area", -round_m, -round_m, width_m + round_m, depth_m + round_m))
        return found

    def hindrances(self) -> list[dict[str, Any]]:
        """Zones and threats, none of them wider than a fifth of the ground."""
        found = []
        for number in range(int(self._rng.integers(0, 4))):
            east_m, north_m = self._place()
            size_m = self.between(0.05, 0.2) * self._width_m
            kind = str(self._rng.choice(["no_fly", "obstacle", "missile", "radar"]))
            name = f"{kind} {number}"
            if kind in ("no_fly", "obstacle"):
                said = {"height_m": 300} if kind == "obstacle" else {}
                corner = (east_m + size_m, north_m + size_m)
                found.append(rectangle(kind, east_m, north_m, *corner, name=name, **said))
                continue
            said = {"intensity_m": round(0.5 * size_m, 1)} if kind == "radar" else {"hard": self.chance(0.5)}
            at = lonlat(east_m, north_m)
            found.append(
                feature("threat", "Point", at, model=kind, radius_m=round(size_m), name=name, **said)
            )
        return found

    def importance(self) -> tuple[list[dict[str, Any]], dict[str, Any], dict[str, Terrain]]:
        """What the ground is worth: features, members of the collection, rasters."""
        kind = str(self._rng.choice(["none", "polygons", "points", "raster", "drift"]))
        found: list[dict[str, Any]] = []
        members: dict[str, Any] = {}
        rasters: dict[str, Terrain] = {}
        if kind == "polygons":
            for score in (1.0, 5.0):
                (east_m, north_m), size_m = self._place(), self.between(200.0, 600.0)
                found.append(
                    rectangle("importance", east_m - size_m, north_m - size_m, east_m, north_m, score=score)
                )
            found.append(rectangle("importance", 0.0, 0.0, self._width_m, self._depth_m, score=0.2))
        elif kind in ("points", "drift"):
            for _ in range(1 if kind == "drift" else 3):
                at = lonlat(0.5 * self._width_m + self.between(-200.0, 200.0), 0.5 * self._depth_m)
                spread_m = round(self.between(60.0, 250.0))
                found.append(feature("importance", "Point", at, score=1.0, spread_m=spread_m))
        elif kind == "raster":
            cells = self._rng.random((24, 24)).astype(np.float32)
            (west, south), (east, north) = lonlat(-50.0, -50.0), lonlat(self._width_m + 50.0, self._depth_m)
            affine = ((east - west) / 24, 0.0, west, 0.0, (north - south) / 24, south)
            rasters[RASTER] = Terrain(RASTER, cells, affine)
            members["importance_raster"] = RASTER
        if kind == "drift":
            drift = {"speed_m_s": 0.3, "toward_deg": round(self.between(0.0, 359.0)), "spread_m_s": 0.1,
                     "elapsed_s": 300}  # fmt: skip
            members["search"] = {"detection": 0.7, "drift": drift}
        elif found and self.chance(0.4):
            members["search"] = {"detection": round(self.between(0.5, 0.95), 2)}
        return found, members, rasters

    def vehicles(self) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        """One to four aircraft, and where they start."""
        count = int(self._rng.integers(1, 5))
        shared = self.chance(0.5)
        vehicles, bases = [], []
        for number in range(count):
            wing = self.chance(0.6)
            airspeed_m_s = round(self.between(14.0, 20.0) if wing else self.between(8.0, 12.0), 1)
            power_w = round(self.between(90.0, 160.0) if wing else self.between(250.0, 400.0))
            vehicle: dict[str, Any] = {
                "name": f"uav {number}", "type": "fixed_wing" if wing else "multirotor",
                "autopilot": str(self._rng.choice(["ardupilot", "px4"])), "airspeed_m_s": airspeed_m_s,
                "power": {"model": "constant", "power_w": power_w},
                "reserve": round(self.between(0.1, 0.3), 2),
                "energy_wh": round(power_w * self.between(420.0, 1100.0) / 3600.0, 1),
            }  # fmt: skip
            if wing:
                vehicle["min_turn_radius_m"] = round(self.between(35.0, 60.0))
            if self.chance(0.2):
                vehicle["max_range_m"] = round(airspeed_m_s * self.between(400.0, 800.0))
            if count < 3 and self.chance(0.25):
                vehicle |= {"batteries": 2, "turnaround_s": 60}
            if count > 1:
                vehicle["base"] = "base 0" if shared else f"base {number}"
            vehicles.append(vehicle)
        places = 1 if shared or count == 1 else count
        for number in range(places):
            at = lonlat(self.between(0.2, 0.8) * self._width_m, self.between(-150.0, 0.15 * self._depth_m))
            if count == 1:
                bases.append(feature("start", "Point", at))
            else:
                bases.append(feature("base", "Point", at, name=f"base {number}"))
        return vehicles, bases


def flights_of(
    document: dict[str, Any], plan: dict[str, Any]
) -> Iterator[tuple[str, float, float, float | None]]:
    """Of each flight of a plan, both as GeoJSON: whose, what may be used, what it says, what is reckoned.

    All but the first are watt hours. What is reckoned is of wings alone, None of others: along the line's
    edges at the airspeed in the wind, climbs and thinner air counted.
    """
    vehicles = {vehicle["name"]: vehicle for vehicle in document["vehicles"]}
    toward_rad = math.radians(document["wind"]["from_deg"] + 180.0)
    wind = document["wind"]["speed_m_s"] * np.array([math.sin(toward_rad), math.cos(toward_rad)])
    for one in plan["features"]:
        said = one["properties"]
        if said["role"] != "path":
            continue
        vehicle = vehicles[said["vehicle"]]
        usable_wh = vehicle["energy_wh"] * (1.0 - vehicle["reserve"])
        reckoned_wh = None
        if vehicle["type"] == "fixed_wing":
            time_s = _time_s(np.array(one["geometry"]["coordinates"]), vehicle["airspeed_m_s"], wind)
            reckoned_wh = vehicle["power"]["power_w"] * time_s / 3600.0
        yield vehicle["name"], usable_wh, said["energy_wh"], reckoned_wh


def _time_s(line: np.ndarray, airspeed_m_s: float, wind: np.ndarray) -> float:
    lons, lats, amsl_m = line.T
    azimuths_deg, _, lengths_m = GEOD.inv(lons[:-1], lats[:-1], lons[1:], lats[1:])
    kept = lengths_m > 1e-6
    course_rad, length_m = np.radians(azimuths_deg[kept]), lengths_m[kept]
    middle_m, rise_m = 0.5 * (amsl_m[1:] + amsl_m[:-1])[kept], np.diff(amsl_m)[kept]
    # Equivalent airspeed through thinner air, and what of it is left over the ground on a slope.
    true_m_s = airspeed_m_s * np.exp(0.5 * middle_m / SCALE_M) / np.hypot(1.0, rise_m / length_m)
    ahead = np.stack([np.sin(course_rad), np.cos(course_rad)], axis=1)
    along, across = ahead @ wind, ahead[:, 0] * wind[1] - ahead[:, 1] * wind[0]
    return float((length_m / (along + np.sqrt(true_m_s**2 - across**2))).sum())
