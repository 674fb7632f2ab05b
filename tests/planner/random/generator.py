"""Random scenarios of every kind, the same for the same number."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from pyproj import Transformer
from shapely import affinity
from shapely.geometry import LineString, MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from planner.airspace.terrain import Terrain

#: Name of the flat raster that some scenarios are set on.
RASTER = "flat"

#: Airspeeds, turn radii and heights of aircraft from the smallest multirotor to the jet.
SIZES = (
    ("multirotor", (5.0, 12.0), (2.0, 8.0), (50.0, 120.0)),
    ("fixed_wing", (11.0, 18.0), (15.0, 40.0), (100.0, 300.0)),
    ("vtol", (18.0, 25.0), (70.0, 150.0), (250.0, 700.0)),
    ("fixed_wing", (20.0, 30.0), (90.0, 250.0), (400.0, 1200.0)),
    ("fixed_wing", (60.0, 100.0), (700.0, 1500.0), (1500.0, 4000.0)),
    ("fixed_wing", (120.0, 160.0), (1800.0, 4000.0), (5000.0, 8000.0)),
)


#: The most that is kept from what is hard where a scenario does not say.
KEPT_M = 30.0
#: Areas are drawn round what is no wider than this.
MOST_M = 330_000.0


@dataclass(slots=True)
class Case:
    """A scenario, the raster it names, and whether zones or area may stand in the way of every pass."""

    number: int
    document: dict[str, Any]
    terrain: Terrain | None
    free: bool


@lru_cache(maxsize=4)
def _frame(lon_deg: float, lat_deg: float) -> Transformer:
    """From degrees to metres round a place."""
    middle = f"+proj=aeqd +lat_0={lat_deg} +lon_0={lon_deg} +datum=WGS84"
    return Transformer.from_crs("EPSG:4326", middle, always_xy=True)


@dataclass(slots=True)
class _World:
    """What the parts of one scenario have in common: chance, places, sizes."""

    rng: np.random.Generator
    lon_deg: float
    lat_deg: float
    height_m: float
    radius_m: float
    settle_m: float
    sensors: list[dict[str, Any]]
    wide: bool = False
    features: list[dict[str, Any]] = field(default_factory=list)
    kept: list[BaseGeometry] = field(default_factory=list)

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def between(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def degrees(self, place: tuple[float, float]) -> list[float]:
        frame = _frame(self.lon_deg, self.lat_deg)
        return [round(float(v), 9) for v in frame.transform(*place, direction="INVERSE")]

    def rings(self, shape: Polygon) -> list[list[list[float]]]:
        return [[self.degrees((x, y)) for x, y in ring.coords] for ring in (shape.exterior, *shape.interiors)]

    def add(self, name: str, role: str, kind: str, coordinates: Any, **properties: Any) -> None:
        self.features.append(
            {
                "type": "Feature",
                "id": name,
                "properties": {"role": role, **properties},
                "geometry": {"type": kind, "coordinates": coordinates},
            }
        )

    @property
    def swath_m(self) -> float:
        near_m, far_m = edges_m(self.sensors[0], self.height_m)
        return far_m - near_m

    @property
    def reach_m(self) -> float:
        """So far from a region no zone can hinder its passes nor the turns to them."""
        sensor = self.sensors[0]
        far_m = max(edges_m(each, self.height_m)[1] for each in self.sensors)
        squint_m = self.height_m * abs(math.tan(math.radians(sensor.get("squint_deg", 0.0)))) * 2.0
        return 1.3 * (far_m + 4.0 * self.radius_m + self.settle_m + squint_m + 0.3 * self.height_m)

    def place(self, spread_m: float) -> tuple[float, float]:
        angle, far_m = self.between(0.0, math.tau), spread_m * math.sqrt(self.rng.random())
        return (far_m * math.cos(angle), far_m * math.sin(angle))

    def blob(self, middle: tuple[float, float], size_m: float, corners: int) -> Polygon:
        """A star-shaped polygon."""
        angles = np.linspace(0.0, math.tau, corners, endpoint=False) + self.rng.uniform(-0.3, 0.3, corners)
        radii_m = size_m * self.rng.uniform(0.5, 1.0, corners)
        return Polygon(
            [
                (middle[0] + r * math.cos(a), middle[1] + r * math.sin(a))
                for a, r in zip(angles, radii_m, strict=True)
            ]
        )


def edges_m(sensor: dict[str, Any], height_m: float) -> tuple[float, float]:
    """Where a sensor's strip begins and ends beside the track."""
    half_deg = sensor["elevation_beamwidth_deg"] * sensor.get("sub_swaths", 1) / 2.0
    middle_deg = sensor["incidence_deg"]
    near_m, far_m = (
        height_m * math.tan(math.radians(angle)) for angle in (middle_deg - half_deg, middle_deg + half_deg)
    )
    return near_m, far_m


def draw(number: int) -> Case:
    """The scenario of a number."""
    rng = np.random.default_rng([77, number])
    kind, speeds, radii, heights = SIZES[number % len(SIZES)]
    speed_m_s, radius_m, height_m = (float(rng.uniform(*pair)) for pair in (speeds, radii, heights))
    vehicle: dict[str, Any] = {
        "name": "uav",
        "type": kind,
        "autopilot": str(rng.choice(["ardupilot", "px4"])),
        "airspeed_m_s": round(speed_m_s, 2),
        "min_turn_radius_m": round(radius_m, 2),
        # Not its autopilot's own: what a plain search finds is to be planned.
        "settle_m": 0.0,
    }
    if rng.random() < 0.5:
        vehicle["settle_m"] = round(float(rng.uniform(0.3, 3.0)) * radius_m, 1)
    world = _World(
        rng,
        round(float(rng.uniform(-170.0, 170.0)), 5),
        round(float(rng.uniform(-65.0, 65.0)), 5),
        height_m,
        radius_m * 2.0,
        vehicle.get("settle_m", 0.0) * 2.0,
        _sensors(rng),
    )
    document: dict[str, Any] = {"type": "FeatureCollection", "name": f"random {number}", "seed": number}
    _wind(world, vehicle, document)
    home_m = round(world.between(0.0, 800.0), 1)
    reference = str(rng.choice(["amsl", "home", "terrain"]))
    amsl_m = home_m + height_m
    document["altitude_reference"] = reference
    document["altitude_m"] = round(amsl_m if reference == "amsl" else height_m, 1)
    _regions(world)
    _terminals(world, home_m)
    free = _zones(world, amsl_m, document)
    terrain = None
    if kind != "fixed_wing" and world.chance(0.25):
        terrain = _flat(world, home_m)
        document["terrain"] = RASTER
    asked = {name for each in world.features for name in each["properties"]}
    plain = not world.wide and asked.isdisjoint({"revisits", "approach_deg"})
    if plain and world.chance(0.2):
        document["method"] = {"routing": str(rng.choice(["li2018", "li2018-threat-aware"]))}
    if world.chance(0.1):
        document["objective"] = {"missile": round(world.between(0.0, 2.0), 2), "turns": 0.5}
    _limits(world, vehicle)
    document |= {"features": world.features, "vehicles": [vehicle], "sensors": world.sensors}
    return Case(number, document, terrain, free)


def _sensors(rng: np.random.Generator) -> list[dict[str, Any]]:
    sensors = []
    for index in range(2 if rng.random() < 0.15 else 1):
        sensor: dict[str, Any] = {
            "name": f"sar{index}",
            "type": "sar",
            "incidence_deg": round(float(rng.uniform(38.0, 52.0)), 1),
            "elevation_beamwidth_deg": round(float(rng.uniform(14.0, 30.0)), 1),
            "azimuth_beamwidth_deg": round(float(rng.uniform(2.0, 10.0)), 1),
            "look": str(rng.choice(["left", "right", "both"])),
            "resolution_m": 1.0,
            "pointing_margin_deg": 0.0,
            "position_margin_m": 0.0,
        }
        if rng.random() < 0.15:
            sensor["squint_deg"] = round(float(rng.uniform(-20.0, 20.0)), 1)
        elif rng.random() < 0.1:
            sensor |= {
                "mode": "scansar",
                "sub_swaths": 3,
                "elevation_beamwidth_deg": 9.0,
                "resolution_m": 0.2,
            }
        sensors.append(sensor)
    return sensors


def _wind(world: _World, vehicle: dict[str, Any], document: dict[str, Any]) -> None:
    if not world.chance(0.4):
        return
    document["wind"] = {
        "speed_m_s": round(world.between(0.05, 0.35) * vehicle["airspeed_m_s"], 2),
        "from_deg": round(world.between(0.0, 360.0), 1),
    }
    if world.chance(0.5):
        for sensor in world.sensors:
            sensor["stabilised"] = True


def _regions(world: _World) -> None:
    swath_m = world.swath_m
    count = int(world.rng.integers(1, 5))
    spread_m = max(3.0 * swath_m, 6.0 * world.radius_m) * math.sqrt(count)
    for index in range(count):
        size_m = swath_m * world.between(0.05, 0.5)
        wide = world.chance(0.12)
        world.wide |= wide
        if wide:
            size_m = swath_m * world.between(0.8, 1.6)
        middle = world.place(spread_m)
        properties: dict[str, Any] = {}
        if index > 0 and world.chance(0.25):
            properties |= {"required": False, "priority": round(world.between(0.1, 5.0), 2)}
        if world.chance(0.12):
            heading = round(world.between(0.0, 359.0), 1)
            properties["approach_deg"] = [heading, round((heading + 180.0) % 360.0, 1)][
                : 1 + world.chance(0.7)
            ]
        elif not wide and world.chance(0.07):
            properties["revisits"] = 2
        if world.chance(0.15):
            properties["min_resolution_m"] = 1.5
        if len(world.sensors) > 1 and world.chance(0.5):
            properties["sensor"] = "sar1"
        name, form = f"R{index}", int(world.rng.integers(0, 6))
        if form == 0:
            radius_m = 0.0 if world.chance(0.4) else size_m
            world.add(name, "roi", "Point", world.degrees(middle), radius_m=round(radius_m, 1), **properties)
            world.kept.append(Point(middle).buffer(max(radius_m, 1.0)))
        elif form == 1:
            line = _corridor(world, middle, 3.0 * size_m)
            width_m = max(round(0.4 * size_m, 1), 1.0)
            places = [world.degrees((x, y)) for x, y in line.coords]
            world.add(name, "roi", "LineString", places, width_m=width_m, **properties)
            world.kept.append(line.buffer(width_m))
        elif form == 2:
            parts = [
                world.blob(middle, 0.5 * size_m, 6),
                world.blob((middle[0] + 1.5 * size_m, middle[1]), 0.5 * size_m, 5),
            ]
            world.add(name, "roi", "MultiPolygon", [world.rings(part) for part in parts], **properties)
            world.kept.append(MultiPolygon(parts))
        else:
            shape = world.blob(middle, size_m, int(world.rng.integers(3, 9)))
            if form == 3:
                hole = affinity.scale(shape, 0.3, 0.3, origin=shape.representative_point())
                shape = shape.difference(hole) if shape.contains(hole) else shape
            world.add(name, "roi", "Polygon", world.rings(shape), **properties)
            world.kept.append(shape)


def _corridor(world: _World, middle: tuple[float, float], length_m: float) -> LineString:
    """A line that bends a little at each of its corners."""
    heading, places = world.between(0.0, math.tau), [middle]
    for _ in range(int(world.rng.integers(1, 4))):
        places.append(
            (places[-1][0] + length_m * math.cos(heading), places[-1][1] + length_m * math.sin(heading))
        )
        heading += world.between(-0.9, 0.9)
    return LineString(places)


def _terminals(world: _World, home_m: float) -> None:
    reach_m = max(Point(0.0, 0.0).hausdorff_distance(shape) for shape in world.kept) + 3.0 * world.radius_m
    for name in ("start", "end"):
        if name == "end" and world.chance(0.3):
            continue
        angle = world.between(0.0, math.tau)
        place = (reach_m * math.cos(angle), reach_m * math.sin(angle))
        heading = {"heading_deg": round(world.between(0.0, 360.0), 1)} if world.chance(0.4) else {}
        world.add(name, name, "Point", [*world.degrees(place), home_m], **heading)
        world.kept.append(Point(place))


def _zones(world: _World, amsl_m: float, document: dict[str, Any]) -> bool:
    """Threats, no-fly zones, obstacles and the area; whether none of them can be in the way."""
    kept = unary_union(world.kept)
    low_e, low_n, high_e, high_n = kept.buffer(world.reach_m).bounds
    size_m = world.swath_m
    free = not world.chance(0.3)
    apart_m = KEPT_M + (world.reach_m if free else 0.15 * size_m + 5.0)
    for index in range(int(world.rng.integers(0, 5))):
        middle = (world.between(low_e, high_e), world.between(low_n, high_n))
        radius_m = size_m * world.between(0.1, 0.8)
        form = int(world.rng.integers(0, 6))
        name = f"Z{index}"
        disc, blob = Point(middle).buffer(radius_m), world.blob(middle, radius_m, 6)
        if form == 0:
            model = {"model": "radar", "intensity_m": round(0.5 * radius_m, 1)}
            if world.chance(0.5):
                model = {"model": "missile"}
            if world.chance(0.3):
                model["height_m"] = round(world.between(0.3, 2.0) * world.height_m, 1)
            world.add(name, "threat", "Point", world.degrees(middle), radius_m=round(radius_m, 1), **model)
        elif form == 1 and disc.distance(kept) > apart_m:
            world.add(
                name,
                "threat",
                "Point",
                world.degrees(middle),
                radius_m=round(radius_m, 1),
                model="missile",
                hard=True,
            )
        elif form == 2 and blob.distance(kept) > apart_m:
            band = {"floor_m": round(amsl_m - world.between(50.0, 500.0), 1)} if world.chance(0.5) else {}
            world.add(name, "no_fly", "Polygon", world.rings(blob), **band)
        elif form == 3:
            band = {"floor_m": round(amsl_m + KEPT_M + 15.0, 1)}
            if world.chance(0.5):
                band = {"ceiling_m": round(amsl_m - KEPT_M - 15.0, 1)}
            world.add(name, "no_fly", "Point", world.degrees(middle), radius_m=round(radius_m, 1), **band)
        elif form == 4:
            document["clearance_m"] = 20.0
            tall = blob.distance(kept) > apart_m and world.chance(0.5)
            height_m = world.height_m + 50.0 if tall else max(world.height_m - 25.0, 5.0)
            world.add(name, "obstacle", "Polygon", world.rings(blob), height_m=round(height_m, 1))
        elif form == 5 and disc.distance(kept) > apart_m:
            world.add(name, "no_fly", "Point", world.degrees(middle), radius_m=round(radius_m, 1))
    # The jets' areas would be wider than a scenario may be.
    if max(high_e - low_e, high_n - low_n) < MOST_M and world.chance(0.4):
        share = 1.0 if world.chance(0.7) else 0.5
        free = free and share == 1.0
        world.add(
            "area",
            "area",
            "Polygon",
            world.rings(kept.convex_hull.buffer(share * world.reach_m, quad_segs=2)),
        )
    return free


def _limits(world: _World, vehicle: dict[str, Any]) -> None:
    """Limits that are enough for what is required, and may be too little for the rest."""
    if not world.chance(0.3):
        return
    optional = any(each["properties"].get("required") is False for each in world.features)
    corners = unary_union(world.kept).envelope.length
    range_m = world.between(1.0, 2.0) * (corners + 40.0 * world.radius_m) * (1.0 if optional else 4.0)
    form = int(world.rng.integers(0, 3))
    if form == 0:
        vehicle["max_range_m"] = round(range_m, 1)
    elif form == 1:
        vehicle["max_flight_time_s"] = round(range_m / vehicle["airspeed_m_s"], 1)
    else:
        vehicle |= {"cruise_power_w": 200.0, "reserve": 0.1}
        vehicle["energy_wh"] = round(200.0 * range_m / vehicle["airspeed_m_s"] / 3600.0, 2)


def _flat(world: _World, home_m: float) -> Terrain:
    """A raster of one height, as far as the flight can go and what is looked at beside it."""
    reach_m = unary_union(world.kept).buffer(world.reach_m).hausdorff_distance(Point(0.0, 0.0)) + 12_000.0
    half_lat_deg = reach_m / 111_000.0
    half_lon_deg = half_lat_deg / math.cos(math.radians(world.lat_deg))
    posts = 101
    affine = (
        2.0 * half_lon_deg / (posts - 1), 0.0, world.lon_deg - half_lon_deg,
        0.0, -2.0 * half_lat_deg / (posts - 1), world.lat_deg + half_lat_deg,
    )  # fmt: skip
    return Terrain(RASTER, np.full((posts, posts), home_m, dtype=np.float32), affine)
