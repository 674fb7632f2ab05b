"""What forbids, read so that it forbids in any case: one badly drawn shape of hundreds refuses no scenario.

A ring that crosses itself forbids all that it encloses, an open one is closed, parts that overlap are one, a
hole that is misplaced is none; what encloses nothing forbids its line. Places that are none are left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import shapely
from shapely.geometry import LineString, MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry

from planner.frames import LocalFrame
from planner.geojson import geometry as shapes
from planner.geojson.fields import Findings, is_finite
from planner.geojson.outlines import few_cornered
from planner.geojson.sheet import LonLat, continued

#: Rules of drawing that say nothing against where a shape is.
OF_DRAWING = frozenset(
    {
        "ring-self-intersects", "ring-not-closed", "ring-too-short", "ring-no-area", "ring-empty",
        "hole-misplaced", "polygons-overlap", "not-finite",
    }
)  # fmt: skip
#: What has no width forbids this far beside it.
LEAST_M = 1.0


def forbidding_areas(
    owner: str, geometry: Mapping[str, Any], frame: LocalFrame, findings: Findings
) -> tuple[Polygon, ...]:
    """The polygons that a Polygon or MultiPolygon forbids; none after a finding, an error or a warning."""
    strict = Findings()
    area = shapes.area(owner, geometry, frame, strict)
    broken = {finding.rule for finding in strict.errors}
    if area is None and broken <= OF_DRAWING:
        area = _mended(owner, geometry, frame, findings, strict)
    else:
        findings.take(strict)
    if area is None:
        return ()
    few = few_cornered(owner, area, findings, forbids=True)
    return tuple(part for part in shapely.get_parts(few or Polygon()) if isinstance(part, Polygon))


def _mended(
    owner: str, geometry: Mapping[str, Any], frame: LocalFrame, findings: Findings, strict: Findings
) -> Polygon | MultiPolygon | None:
    """All that is enclosed by the rings as they are drawn, with a warning."""
    why = "; ".join(dict.fromkeys(finding.message for finding in strict.errors))
    lines = [_line(ring, frame) for ring in _rings(geometry)]
    drawn = [line for line in lines if line is not None]
    if not drawn:
        said = f"{why}: forbids nothing, nobody knows where"
        findings.warning(owner, "zone-without-place", said, "Draw it, or remove it.")
        return None
    enclosed = [shapely.polygonize([shapely.node(line)]) for line in drawn if isinstance(line, LineString)]
    faces = shapely.union_all([face for found in enclosed for face in shapely.get_parts(found)])
    # What lies within the outer edge is forbidden, what was left between crossing edges too.
    whole = [Polygon(part.exterior) for part in shapely.get_parts(faces) if isinstance(part, Polygon)]
    thin = [line.buffer(LEAST_M) for line in drawn if not _encloses(line, whole)]
    found = shapes.areal(shapely.union_all([*whole, *thin]))
    said = f"{why}: all that it encloses is forbidden"
    findings.warning(owner, "zone-mended", said, "Draw its edge anew, closed and uncrossed.")
    return found


def _encloses(line: BaseGeometry, whole: list[Polygon]) -> bool:
    return any(polygon.buffer(LEAST_M).covers(line) for polygon in whole)


def _rings(geometry: Mapping[str, Any]) -> list[Any]:
    """The rings of a Polygon or MultiPolygon; what is no list is none."""
    coordinates = geometry.get("coordinates")
    parts = [coordinates] if geometry["type"] == "Polygon" else coordinates
    listed = [part for part in parts if isinstance(part, list)] if isinstance(parts, list) else []
    return [ring for part in listed for ring in part if isinstance(ring, list)]


def _line(ring: list[Any], frame: LocalFrame) -> BaseGeometry | None:
    """A ring as a closed line in local metres, a place where it is only one; None without any."""
    places: list[LonLat] = [
        (float(value[0]), float(value[1]))
        for value in ring
        if isinstance(value, list) and len(value) >= 2 and all(is_finite(v) for v in value[:2])
    ]
    if not places:
        return None
    if len(set(places)) == 1:
        return Point(*frame.to_local(places[0]))
    return shapes.fine(LineString(continued([*places, places[0]], frame.lon_deg)), frame)
