"""GeoJSON geometry to shapely in the local frame, with a finding for everything wrong."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapely import segmentize
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.validation import explain_validity

from planner.frames import LocalFrame
from planner.geojson.fields import Findings, is_finite

#: An edge of a GeoJSON ring is straight in longitude and latitude; cut to pieces this long it is, within a
#: centimetre at latitudes below 60°, straight in the local frame as well.
EDGE_PIECE_DEG = 0.005

LonLat = tuple[float, float]


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
    if abs(lon) > 180.0:
        return "longitude-out-of-range", f"has longitude {lon:g}", "Longitude lies in [-180, 180]."
    return None


def _ring(owner: str, value: Any, findings: Findings) -> list[LonLat] | None:
    if not isinstance(value, list) or len(value) == 0:
        findings.error(owner, "ring-empty", "has an empty ring", "Give at least four positions.")
        return None
    ring = positions(owner, value, findings)
    if ring is None:
        return None
    if ring[0] != ring[-1]:
        findings.error(
            owner, "ring-not-closed", "has a ring whose last position is not its first", "Repeat the first."
        )
        return None
    if len(set(ring)) < 3:
        findings.error(
            owner,
            "ring-too-short",
            f"has a ring of {len(set(ring))} distinct positions",
            "Give three or more.",
        )
        return None
    return ring


def polygon(owner: str, rings: Any, frame: LocalFrame, findings: Findings) -> Polygon | None:
    """A valid polygon in the local frame, or None after a finding."""
    if not isinstance(rings, list) or not rings:
        findings.error(owner, "ring-empty", "has no ring", "Give an outer ring of at least four positions.")
        return None
    read = [_ring(owner, ring, findings) for ring in rings]
    if any(ring is None for ring in read):
        return None
    shape = Polygon(read[0] or [], [ring for ring in read[1:] if ring])
    if not shape.is_valid:
        reason = explain_validity(shape)
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
    fine = segmentize(shape, EDGE_PIECE_DEG)
    return Polygon(
        frame.to_local(fine.exterior.coords), [frame.to_local(hole.coords) for hole in fine.interiors]
    )


def area(
    owner: str, geometry: dict[str, Any], frame: LocalFrame, findings: Findings
) -> Polygon | MultiPolygon | None:
    """A Polygon or MultiPolygon in the local frame."""
    if geometry["type"] == "Polygon":
        return polygon(owner, geometry.get("coordinates"), frame, findings)
    parts = geometry.get("coordinates")
    if not isinstance(parts, list) or not parts:
        findings.error(owner, "ring-empty", "has no polygon", "Give at least one polygon.")
        return None
    shapes = [polygon(owner, part, frame, findings) for part in parts]
    sound = [shape for shape in shapes if shape is not None]
    if len(sound) != len(shapes):
        return None
    whole = MultiPolygon(sound)
    if not whole.is_valid:
        findings.error(
            owner, "polygons-overlap", "has overlapping polygons", "Unite them, or make them regions apart."
        )
        return None
    return whole


def line(owner: str, geometry: dict[str, Any], frame: LocalFrame, findings: Findings) -> LineString | None:
    """A LineString in the local frame."""
    coordinates = geometry.get("coordinates")
    if not isinstance(coordinates, list) or len(coordinates) < 2:
        findings.error(owner, "line-too-short", "needs two positions", "Give two positions or more.")
        return None
    sound = positions(owner, coordinates, findings)
    if sound is None:
        return None
    if len(set(sound)) < 2:
        findings.error(owner, "line-too-short", "has no length", "Give two different positions.")
        return None
    return LineString(frame.to_local(segmentize(LineString(sound), EDGE_PIECE_DEG).coords))


def point(
    owner: str, geometry: dict[str, Any], frame: LocalFrame, findings: Findings
) -> tuple[float, float] | None:
    """A Point in the local frame."""
    place = position(owner, geometry.get("coordinates"), findings)
    if place is None:
        return None
    east_m, north_m = frame.to_local(place)
    return (float(east_m), float(north_m))


def ring_lonlat(frame: LocalFrame, coords: NDArray[np.float64] | Any) -> tuple[LonLat, ...]:
    """A closed ring of WGS 84 positions of a shapely ring in the local frame."""
    return tuple((float(lon), float(lat)) for lon, lat in frame.to_wgs84(np.asarray(coords)[:, :2]))
