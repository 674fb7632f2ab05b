"""A scenario document asked otherwise: turned, mirrored, moved or scaled, permuted, with noise."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from pyproj import Geod, Transformer

GEOD = Geod(ellps="WGS84")
#: Edges are straight in degrees: along a parallel one so long is off its geodesic by some millimetres.
CUT_M = 400.0
#: Members that are headings clockwise from north, whatever holds them.
HEADINGS = ("heading_deg", "from_deg", "toward_deg", "approach_deg", "take_off_heading_deg")
#: Members that grow with the ground: lengths, and what a flight takes where speeds stay what they are.
LENGTHS = (
    "altitude_m", "clearance_m", "min_height_m", "max_height_m", "height_m", "ceiling_m", "floor_m",
    "radius_m", "width_m", "spread_m", "min_turn_radius_m", "settle_m", "max_range_m", "horizontal_m",
    "vertical_m", "intensity_m", "position_margin_m", "elapsed_s", "max_flight_time_s", "energy_wh",
    "charge_mah", "turnaround_s",
)  # fmt: skip
SIDES = {"left": "right", "right": "left"}


@dataclass(frozen=True, slots=True)
class Otherwise:
    """How a question is put.

    Parameters
    ----------
    turned_deg
        By how much it is turned about the middle of its places, counter-clockwise.
    mirrored
        East and west are exchanged before.
    scaled
        All lengths times this, and the limits of flights; speeds stay.
    moved_to
        Longitude and latitude of the middle.
    reordered
        Features, vehicles and parts of rings in another order.
    noise_deg
        Standard deviation of what each place is off.
    """

    turned_deg: float = 0.0
    mirrored: bool = False
    scaled: float = 1.0
    moved_to: tuple[float, float] | None = None
    reordered: bool = False
    noise_deg: float = 0.0

    def of(self, document: dict[str, Any]) -> dict[str, Any]:
        """The same question, put so; places keep distance and azimuth from the middle."""
        asked = copy.deepcopy(document)
        places = np.array([place[:2] for f in asked["features"] for place in _places(f)])
        middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
        to = self.moved_to or (float(middle[0]), float(middle[1]))
        rng = np.random.default_rng(7)
        there, back = _plane(float(middle[0]), float(middle[1])), _plane(*to)
        cos, sin = math.cos(math.radians(self.turned_deg)), math.sin(math.radians(self.turned_deg))

        def put(place: list[float]) -> list[float]:
            east, north = there.transform(place[0], place[1])
            east = -east if self.mirrored else east
            east, north = self.scaled * (cos * east - sin * north), self.scaled * (sin * east + cos * north)
            lon, lat = back.transform(east, north, direction="INVERSE")
            off = rng.normal(0.0, self.noise_deg, 2) if self.noise_deg else (0.0, 0.0)
            return [lon + off[0], lat + off[1], *(self.scaled * h for h in place[2:])]

        for each in asked["features"]:
            geometry = each["geometry"]
            geometry["coordinates"] = self._turned(geometry["coordinates"], put, geometry["type"])
        for name, value in asked.items():
            if name != "features":
                asked[name] = self._member(name, value, put)
        for each in asked["features"]:
            each["properties"] = self._member("properties", each["properties"], put)
        if self.reordered:
            asked["features"] = asked["features"][::-1]
            if "vehicles" in asked:
                asked["vehicles"] = asked["vehicles"][::-1]
        return asked

    def _turned(self, node: Any, put: Any, kind: str) -> Any:
        if isinstance(node[0], (int, float)):
            return put(node)
        ring = len(node) > 3 and node[0] == node[-1] and "Polygon" in kind
        if isinstance(node[0][0], (int, float)) and kind != "MultiPoint":
            node = _cut(node)
        inner = [self._turned(each, put, kind) for each in node]
        if ring:
            inner[-1] = inner[0]
            if self.reordered:
                inner = [*inner[1:], inner[1]]
        return inner

    def _member(self, name: str, value: Any, put: Any) -> Any:
        if isinstance(value, dict):
            found = {key: self._member(key, each, put) for key, each in value.items()}
            if {"lon_deg", "lat_deg"} <= set(found):
                found["lon_deg"], found["lat_deg"] = put([value["lon_deg"], value["lat_deg"]])
            return found
        if isinstance(value, list):
            return [self._member(name, each, put) for each in value]
        if isinstance(value, (int, float)) and name in HEADINGS:
            return ((-value if self.mirrored else value) - self.turned_deg) % 360.0
        if isinstance(value, (int, float)) and name in LENGTHS:
            return value * self.scaled
        if self.mirrored and name == "look":
            return SIDES.get(value, value)
        return value


def _cut(line: list[list[float]]) -> list[list[float]]:
    """A line's places with others between, so that edges straight in degrees are so where they are put."""
    found = line[:1]
    for before, after in pairwise(line):
        long_m = GEOD.inv(*before[:2], *after[:2])[2]
        count = max(1, math.ceil(long_m / CUT_M))
        steps = np.linspace(before, after, count + 1)[1:-1].tolist()
        found += [*steps, after]
    return found


def _places(feature: dict[str, Any]) -> list[list[float]]:
    found: list[list[float]] = []
    nodes = [feature["geometry"]["coordinates"]]
    while nodes:
        node = nodes.pop()
        if isinstance(node[0], (int, float)):
            found.append(node)
        else:
            nodes += node
    return found


def _plane(lon_deg: float, lat_deg: float) -> Transformer:
    """Azimuthal equidistant on the ellipsoid."""
    plane = f"+proj=aeqd +lat_0={lat_deg!r} +lon_0={lon_deg!r} +ellps=WGS84 +units=m +no_defs"
    return Transformer.from_crs("+proj=longlat +ellps=WGS84 +no_defs", plane, always_xy=True)
