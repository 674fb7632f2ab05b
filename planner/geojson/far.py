"""Zones far from what is flown: left out of a scenario before anything is computed of them.

A country's zones are thousands of polygons, a handful of which matter. Where there is an operating area
everything flown stays inside it; where there is none the flight is taken to stay near what it is to see, and
the judge sees to it (``Scenario.looked_at``).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon, box, mapping
from shapely.geometry.base import BaseGeometry

from planner.frames import LocalFrame
from planner.geojson.features import name_of
from planner.geojson.fields import Findings, is_finite
from planner.geojson.geometry import positions_of
from planner.geojson.sheet import MOST_LONGITUDE_DEG

#: What is flown, and what may stand in its way.
FLOWN = frozenset({"roi", "start", "end", "base"})
FORBIDDING = frozenset({"no_fly", "obstacle", "threat"})
#: Farther than this from the operating area nothing matters; from what is flown without one, nothing farther
#: than the greater of ``OPEN_M`` and the extent of it.
AREA_M, OPEN_M = 5_000.0, 50_000.0
#: Zones wider than this are cut to what is near.
WIDE_M = 100_000.0
#: Beyond these latitudes, and across so many degrees, boxes of degrees say little: nothing is left out.
MOST_LATITUDE_DEG, MOST_WIDTH_DEG = 80.0, 90.0
DEGREE_M = 111_320.0

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Near:
    """The features that count, and where they were looked for.

    Parameters
    ----------
    features
        As in the document, wide zones cut; those that are left out stand there as they are.
    left_out
        Which are.
    looked_at_deg
        West, south, east, north; None where nothing is left out or cut.
    """

    features: list[Any]
    left_out: frozenset[int] = field(default_factory=frozenset)
    looked_at_deg: Box | None = None

    def looked_at(self, frame: LocalFrame) -> Polygon | None:
        """The box in the local frame."""
        if self.looked_at_deg is None:
            return None
        edge = shapely.segmentize(box(*self.looked_at_deg), 0.05)
        return Polygon(frame.to_local(shapely.get_coordinates(edge)))


def near_features(raw_features: list[Any], findings: Findings) -> Near:
    """The features without the zones that are far from what is flown, which one warning tells."""
    bounds = [_bounds(feature) for feature in raw_features]
    looked_at = _looked_at(raw_features, bounds)
    if looked_at is None:
        return Near(raw_features)
    features, left_out, cut = list(raw_features), [], []
    for index, (feature, found) in enumerate(zip(raw_features, bounds, strict=True)):
        if found is None or _role(feature) not in FORBIDDING or _in_doubt(feature):
            continue
        at = _shifted(found, looked_at)
        if _apart(at, looked_at):
            # With the axes exchanged it may well matter: that is found when it is read.
            if _apart(_shifted((at[1], at[0], at[3], at[2]), looked_at), looked_at):
                left_out.append(index)
        elif _width_m(at) > WIDE_M:
            less = _cut(feature, looked_at)
            if less is not None:
                features[index] = less
                cut.append(index)
    _tell(raw_features, left_out, "zones-left-out", "far from all that is flown: left out", findings)
    _tell(raw_features, cut, "zones-cut", "wider than what is flown by far: cut to what is near it", findings)
    return Near(features, frozenset(left_out), looked_at if left_out or cut else None)


def _looked_at(raw_features: list[Any], bounds: list[Box | None]) -> Box | None:
    """The box of what is flown with what is round it; None where it is no box, or too wide for one."""
    of_role: dict[Any, list[Box]] = {}
    for feature, found in zip(raw_features, bounds, strict=True):
        if found is not None:
            of_role.setdefault(_role(feature), []).append(found)
    areas = of_role.get("area", [])
    own = areas or [found for role in FLOWN for found in of_role.get(role, [])]
    if not own:
        return None
    first = own[0]
    west, south, east, north = np.array([_shifted(found, first) for found in own]).T
    whole = (float(west.min()), float(south.min()), float(east.max()), float(north.max()))
    if max(-whole[1], whole[3]) > MOST_LATITUDE_DEG or whole[2] - whole[0] > MOST_WIDTH_DEG:
        return None
    round_m = AREA_M if areas else max(OPEN_M, _width_m(whole))
    lat_deg = round_m / DEGREE_M
    lon_deg = lat_deg / math.cos(math.radians(min(max(-whole[1], whole[3]) + lat_deg, 89.0)))
    return (whole[0] - lon_deg, whole[1] - lat_deg, whole[2] + lon_deg, whole[3] + lat_deg)


def _role(feature: Any) -> Any:
    properties = feature.get("properties") if isinstance(feature, Mapping) else None
    role = properties.get("role") if isinstance(properties, Mapping) else None
    return role if isinstance(role, str) else None


def _in_doubt(feature: Mapping[str, Any]) -> bool:
    """Whether it may have another role, which has to be known first."""
    return feature["properties"].get("role_in_doubt") is not None


def _bounds(feature: Any) -> Box | None:
    """West, south, east, north of a feature, its radius included; None of one that has no place."""
    places = list(_places(feature))
    if not places:
        return None
    lons, lats = zip(*places, strict=True)
    west, east = min(lons), max(lons)
    if east - west > 180.0:
        # Written on both sides of the antimeridian.
        lons = tuple(lon + 360.0 if lon < 0.0 else lon for lon in lons)
        west, east = min(lons), max(lons)
    lat_deg = _radius_m(feature) / DEGREE_M
    south, north = min(lats) - lat_deg, max(lats) + lat_deg
    lon_deg = lat_deg / math.cos(math.radians(min(max(abs(south), abs(north)), 89.0)))
    return (west - lon_deg, south, east + lon_deg, north)


def _places(feature: Any) -> Iterator[tuple[float, float]]:
    for value in positions_of(feature.get("geometry") if isinstance(feature, Mapping) else None):
        if len(value) < 2 or not (is_finite(value[0]) and is_finite(value[1])):
            continue
        if abs(value[0]) <= MOST_LONGITUDE_DEG and abs(value[1]) <= 90.0:
            yield float(value[0]), float(value[1])


def _radius_m(feature: Mapping[str, Any]) -> float:
    properties = feature.get("properties")
    radius_m = properties.get("radius_m") if isinstance(properties, Mapping) else None
    return max(float(radius_m), 0.0) if isinstance(radius_m, int | float) and is_finite(radius_m) else 0.0


def _shifted(found: Box, near: Box) -> Box:
    """The box by whole turns of longitude nearest to another."""
    turns = 360.0 * round((near[0] + near[2] - found[0] - found[2]) / 720.0)
    return (found[0] + turns, found[1], found[2] + turns, found[3])


def _apart(one: Box, other: Box) -> bool:
    return one[0] > other[2] or one[2] < other[0] or one[1] > other[3] or one[3] < other[1]


def _width_m(found: Box) -> float:
    """From corner to corner."""
    lat_deg = min(abs(found[1]), abs(found[3])) if found[1] * found[3] > 0.0 else 0.0
    return DEGREE_M * math.hypot((found[2] - found[0]) * math.cos(math.radians(lat_deg)), found[3] - found[1])


def _cut(feature: Mapping[str, Any], looked_at: Box) -> dict[str, Any] | None:
    """The feature with what of its polygons is near; None where it has none that can be cut."""
    geometry = feature["geometry"]
    if (
        geometry.get("type") not in ("Polygon", "MultiPolygon")
        or looked_at[2] > 180.0
        or looked_at[0] < -180.0
    ):
        return None
    try:
        whole: BaseGeometry = shapely.geometry.shape(geometry)
        left = shapely.make_valid(whole, method="structure").intersection(box(*looked_at))
    except (ValueError, TypeError, IndexError, shapely.errors.ShapelyError):
        # Badly drawn: read as it is, where what it is to be is settled.
        return None
    parts = [part for part in shapely.get_parts(left) if isinstance(part, Polygon)]
    if not parts:
        return None
    return dict(feature) | {"geometry": _listed(mapping(shapely.MultiPolygon(parts)))}


def _listed(geometry: dict[str, Any]) -> dict[str, Any]:
    """Coordinates as JSON has them."""
    rings = [[[list(place) for place in ring] for ring in part] for part in geometry["coordinates"]]
    return {"type": "MultiPolygon", "coordinates": rings}


def _tell(raw_features: list[Any], found: list[int], rule: str, said: str, findings: Findings) -> None:
    if not found:
        return
    names = [name_of(index, raw_features[index]) for index in found[:5]]
    more = f" and {len(found) - len(names)} more" if len(found) > len(names) else ""
    verb = "lies" if len(found) == 1 else "lie"
    if rule == "zones-cut":
        verb = "is" if len(found) == 1 else "are"
    fix = "Draw an operating area to say how far counts."
    findings.warning("scenario", rule, f"{', '.join(names)}{more} {verb} {said}", fix)
