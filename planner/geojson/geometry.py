"""GeoJSON geometry to shapely in the local frame, with a finding for everything wrong."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeGuard, TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import segmentize
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.validation import explain_validity

from planner.frames import LocalFrame
from planner.geojson.fields import Findings, is_finite
from planner.geojson.sheet import MOST_LONGITUDE_DEG, LonLat, continued, cut, goes_round, multi

#: An edge of a GeoJSON ring is straight in longitude and latitude; cut to pieces this long it is, within a
#: centimetre at latitudes below 60°, straight in the local frame as well.
EDGE_PIECE_DEG = 0.005
#: Nearer to the pole a degree of longitude is shorter and a parallel rounder: pieces are as long as
#: keeps them within this of a parallel.
STEEP_DEG = 60.0
CHORD_M = 0.01
EARTH_M = 6.4e6
#: The two sides of a cut through a pole come out this close to each other, not equal.
POLAR_GRID_M = 1e-5
#: Of the whole; less is the rounding of coordinates.
OVERLAP = 1e-9


def positions_of(geometry: Any) -> Iterator[Any]:
    """Every position in a geometry's nested coordinate lists, however deep."""
    coordinates = geometry.get("coordinates") if isinstance(geometry, dict) else None
    stack = [coordinates]
    while stack:
        item = stack.pop()
        if isinstance(item, list) and item and not isinstance(item[0], list):
            yield item
        elif isinstance(item, list):
            stack.extend(reversed(item))


def position(owner: str, value: Any, findings: Findings) -> LonLat | None:
    """A checked longitude and latitude."""
    found = positions(owner, [value], findings)
    return None if found is None else found[0]


def positions(owner: str, values: list[Any], findings: Findings) -> list[LonLat] | None:
    """Checked longitudes and latitudes; None after one finding for each rule that any of them breaks."""
    broken: dict[str, list[tuple[int, str, str]]] = {}
    for number, value in enumerate(values, 1):
        fault = _fault(value)
        if fault is not None:
            rule, message, fix = fault
            broken.setdefault(rule, []).append((number, message, fix))
    for rule, faults in broken.items():
        number, message, fix = faults[0]
        if len(faults) > 1:
            message += f", position {number}, the first of {len(faults)} of {len(values)} like it"
        findings.error(owner, rule, message, fix)
    return None if broken else [(float(value[0]), float(value[1])) for value in values]


def _fault(value: Any) -> tuple[str, str, str] | None:
    """What is wrong with a position: rule, message and fix."""
    if (
        not isinstance(value, list)
        or len(value) < 2
        or not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in value[:3])
    ):
        return "bad-position", f"has the position {value!r}", "A position is [longitude, latitude]."
    if not all(is_finite(v) for v in value[:2]):
        return "not-finite", f"has the position {value!r}"[:200], "Positions must be finite numbers."
    lon, lat = float(value[0]), float(value[1])
    if abs(lat) > 90.0:
        swapped = abs(lon) <= 90.0 and abs(lat) <= 180.0
        return (
            "latitude-out-of-range",
            f"has latitude {lat:g} in {value!r}",
            "Latitude lies in [-90, 90] and comes second"
            + (": this looks like latitude, longitude order, write" if swapped else ": write")
            + " [longitude, latitude].",
        )
    if abs(lon) > MOST_LONGITUDE_DEG:
        return (
            "longitude-out-of-range",
            f"has longitude {lon:g}",
            "Longitude lies in [-180, 180]; what crosses the antimeridian may go on to 360.",
        )
    return None


def _ring(owner: str, value: Any, findings: Findings) -> list[LonLat] | None:
    if not isinstance(value, list) or len(value) == 0:
        findings.error(owner, "ring-empty", "has an empty ring", "Give at least four positions.")
        return None
    ring = positions(owner, value, findings)
    if ring is None:
        return None
    if not _same(ring[0], ring[-1]):
        findings.error(
            owner, "ring-not-closed", "has a ring whose last position is not its first", "Repeat the first."
        )
        return None
    distinct = len({(lon % 360.0, lat) for lon, lat in ring})
    if distinct < 3:
        findings.error(
            owner,
            "ring-too-short",
            f"has a ring of {distinct} distinct positions",
            "Give three or more.",
        )
        return None
    return ring


def _same(one: LonLat, other: LonLat) -> bool:
    """Whether two positions are one place, its longitude perhaps counted once more round."""
    return one[1] == other[1] and (one[0] - other[0]) % 360.0 == 0.0


def polygon(owner: str, geometry: Mapping[str, Any], frame: LocalFrame, findings: Findings) -> Polygon | None:
    """A valid polygon in the local frame, or None after a finding.

    A MultiPolygon is one where its parts are: RFC 7946 cuts at the antimeridian what crosses it.
    """
    shape = area(owner, geometry, frame, findings)
    if isinstance(shape, MultiPolygon):
        findings.error(
            owner,
            "several-polygons",
            f"is {len(shape.geoms)} polygons apart from each other",
            "Give each a feature of its own.",
        )
        return None
    return shape


def area(
    owner: str, geometry: Mapping[str, Any], frame: LocalFrame, findings: Findings
) -> Polygon | MultiPolygon | None:
    """A Polygon or MultiPolygon in the local frame; parts that only touch become one."""
    coordinates = geometry.get("coordinates")
    if geometry["type"] == "Polygon":
        sheet = _sheet(owner, coordinates, frame, findings)
        return None if sheet is None else _to_local(sheet, frame)
    if not isinstance(coordinates, list) or not coordinates:
        findings.error(owner, "ring-empty", "has no polygon", "Give at least one polygon.")
        return None
    found = [_sheet(owner, part, frame, findings) for part in coordinates]
    sheets = [sheet for sheet in found if sheet is not None]
    if len(sheets) != len(found):
        return None
    polar = any(sheet.polar for sheet in sheets)
    parts = [_to_local(sheet, frame) for sheet in sheets] if polar else [sheet.shape for sheet in sheets]
    whole = MultiPolygon([piece for part in parts for piece in multi(part)])
    if whole.is_valid and not polar:
        return _to_local(_Sheet(whole), frame)
    one, other = shapely.STRtree(parts).query(parts, predicate="intersects")
    pairs = one < other
    each = np.array(parts, dtype=object)
    overlap = float(shapely.area(shapely.intersection(each[one[pairs]], each[other[pairs]])).sum())
    if overlap > OVERLAP * whole.area:
        findings.error(
            owner, "polygons-overlap", "has overlapping polygons", "Unite them, or make them regions apart."
        )
        return None
    united = areal(shapely.union_all(parts, grid_size=POLAR_GRID_M if polar else None))
    return united if polar else _to_local(_Sheet(united), frame)


@dataclass(frozen=True, slots=True)
class _Sheet:
    """A shape on a sheet of degrees, or in local metres where it reaches a pole, which no sheet shows."""

    shape: Polygon | MultiPolygon
    polar: bool = False


def _sheet(owner: str, rings: Any, frame: LocalFrame, findings: Findings) -> _Sheet | None:
    """A valid polygon, or None after a finding."""
    if not isinstance(rings, list) or not rings:
        findings.error(owner, "ring-empty", "has no ring", "Give an outer ring of at least four positions.")
        return None
    found = [_ring(owner, ring, findings) for ring in rings]
    read = [ring for ring in found if ring is not None]
    if len(read) != len(found):
        return None
    outer = continued(read[0], frame.lon_deg)
    lons = [lon for lon, _ in outer]
    sheets = [outer, *(continued(hole, (min(lons) + max(lons)) / 2.0) for hole in read[1:])]
    polar = any(goes_round(ring) or max(abs(lat) for _, lat in ring) == 90.0 for ring in sheets)
    if polar:
        shape = Polygon(_round(sheets[0], frame), [_round(ring, frame) for ring in sheets[1:]])
    else:
        shape = Polygon(sheets[0], sheets[1:])
    if not shape.is_valid:
        reason = _reason(shape, frame if polar else None)
        if reason.startswith(("Hole lies outside", "Holes are nested")):
            findings.error(
                owner,
                "hole-misplaced",
                f"is not a valid polygon: {reason}",
                "Put each hole inside the outer ring and outside the other holes.",
            )
            return None
        findings.error(
            owner,
            "ring-self-intersects",
            f"is not a valid polygon: {reason}",
            "Order the positions along the boundary so that no two edges cross.",
        )
        return None
    if shape.area == 0.0:
        findings.error(owner, "ring-no-area", "has no area", "Give positions that are not on one line.")
        return None
    return _Sheet(shape, polar)


def _round(ring: list[LonLat], frame: LocalFrame) -> NDArray[np.float64]:
    """A ring that goes round a pole, or touches it, in local metres; the pole has one place, not a line."""
    if goes_round(ring):
        ring = [place for place in ring if abs(place[1]) < 90.0]
        ring = [*ring, ring[0]] if ring[0] != ring[-1] and not goes_round(ring) else ring
    local_m = shapely.get_coordinates(fine(LineString(ring), frame))
    steps_m = np.hypot(*np.diff(local_m, axis=0).T)
    kept = local_m[np.concatenate([[True], steps_m > POLAR_GRID_M])]
    return np.concatenate([kept[:-1], kept[:1]]) if np.hypot(*(kept[-1] - kept[0])) < POLAR_GRID_M else kept


def _reason(shape: Polygon, frame: LocalFrame | None) -> str:
    """Why a polygon is not valid, with the place in degrees."""
    reason = explain_validity(shape)
    text, bracket, place = reason.partition("[")
    if not bracket:
        return reason
    lon_deg, lat_deg = (float(value) for value in place.rstrip("]").split())
    if frame is not None:
        lon_deg, lat_deg = frame.to_wgs84([lon_deg, lat_deg])
    words = "its boundary crosses or touches itself" if text.endswith("elf-intersection") else text
    return f"{words} at {lon_deg:.7f}, {lat_deg:.7f}"


def _to_local(sheet: _Sheet, frame: LocalFrame) -> Polygon | MultiPolygon:
    return sheet.shape if sheet.polar else fine(sheet.shape, frame)


Shape = TypeVar("Shape", Polygon, MultiPolygon, Polygon | MultiPolygon, LineString)


def fine(shape: Shape, frame: LocalFrame) -> Shape:
    """A shape on a sheet of degrees in the local frame, its edges straight in degrees."""
    least_deg = min(abs(shape.bounds[1]), abs(shape.bounds[3]))
    piece_deg = EDGE_PIECE_DEG
    if least_deg > STEEP_DEG:
        double = math.sin(2.0 * math.radians(min(least_deg, 89.99)))
        piece_deg = math.degrees(math.sqrt(16.0 * CHORD_M / (EARTH_M * double)))
    local: Shape = shapely.transform(segmentize(shape, piece_deg), frame.to_local)
    return local


def line(owner: str, geometry: Mapping[str, Any], frame: LocalFrame, findings: Findings) -> LineString | None:
    """A LineString in the local frame, or a MultiLineString whose parts follow each other."""
    coordinates = geometry.get("coordinates")
    parts = coordinates if geometry["type"] == "MultiLineString" else [coordinates]
    if not isinstance(parts, list) or not parts or not all(_is_line(part) for part in parts):
        findings.error(owner, "line-too-short", "needs two positions", "Give two positions or more.")
        return None
    sound: list[LonLat] = []
    for part in parts:
        more = positions(owner, part, findings)
        if more is None:
            return None
        if sound and not _same(sound[-1], more[0]):
            findings.error(
                owner,
                "line-in-parts",
                "has a part that does not begin where the one before ends",
                "Give each part a feature of its own.",
            )
            return None
        sound += more
    if len(set(sound)) < 2:
        findings.error(owner, "line-too-short", "has no length", "Give two different positions.")
        return None
    return fine(LineString(continued(sound, frame.lon_deg)), frame)


def _is_line(value: Any) -> TypeGuard[list[Any]]:
    return isinstance(value, list) and len(value) >= 2


def written(shape: BaseGeometry, frame: LocalFrame) -> dict[str, Any]:
    """The polygons of a local shape as GeoJSON, cut where they cross the antimeridian."""
    polygons = [
        piece
        for part in multi(areal(shape))
        for piece in cut(
            [
                [(float(lon), float(lat)) for lon, lat in frame.to_wgs84(shapely.get_coordinates(ring))]
                for ring in (part.exterior, *part.interiors)
            ]
        )
    ]
    rings = [[[list(place) for place in ring] for ring in polygon] for polygon in polygons]
    if len(rings) == 1:
        return {"type": "Polygon", "coordinates": rings[0]}
    return {"type": "MultiPolygon", "coordinates": rings}


def areal(shape: BaseGeometry) -> Polygon | MultiPolygon:
    """The polygons of a shape."""
    parts = [part for part in shapely.get_parts(shape) if isinstance(part, Polygon)]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)


def point(
    owner: str, geometry: Mapping[str, Any], frame: LocalFrame, findings: Findings
) -> tuple[float, float] | None:
    """A Point in the local frame."""
    place = position(owner, geometry.get("coordinates"), findings)
    if place is None:
        return None
    east_m, north_m = frame.to_local(place)
    return (float(east_m), float(north_m))
