"""GPX 1.0 and 1.1: tracks and routes are lines, waypoints are points."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from shapely.geometry import LineString

from app.imports.errors import file_error
from app.imports.shapes import LonLat, Shape, line_of
from app.imports.xml import child_text, children, local_name, parse

#: A receiver's points nearer than this to the line through their neighbours say nothing (about a metre).
_DETAIL_DEG = 1e-5


def read_gpx(data: bytes, notes: list[str]) -> list[Shape]:
    """The shapes of a GPX document; heights and times are left out.

    Raises
    ------
    RegionFileError
        Where it is no GPX, or a point has no place.
    """
    root = parse(data, notes)
    if local_name(root) != "gpx":
        raise file_error("not-gpx", f"the file is a <{local_name(root)[:40]}>, not GPX", "send GPX")
    shapes: list[Shape] = []
    for track in children(root, "trk"):
        name = child_text(track, "name")
        segments = [_points(segment, "trkpt") for segment in children(track, "trkseg")]
        shapes += [line_of(_plain(segment), name) for segment in segments if segment]
    for route in children(root, "rte"):
        points = _points(route, "rtept")
        if points:
            shapes.append(line_of(_plain(points), child_text(route, "name")))
    for waypoint in children(root, "wpt"):
        shapes.append(line_of((_place(waypoint),), child_text(waypoint, "name")))
    return shapes


def _points(element: Element, kind: str) -> tuple[LonLat, ...]:
    return tuple(_place(point) for point in children(element, kind))


def _place(point: Element) -> LonLat:
    try:
        return float(point.attrib["lon"]), float(point.attrib["lat"])
    except (KeyError, ValueError):
        lat, lon = point.get("lat"), point.get("lon")
        raise file_error(
            "gpx-point", f"a point has lat {lat!r} and lon {lon!r}", "give both as degrees"
        ) from None


def _plain(points: tuple[LonLat, ...]) -> tuple[LonLat, ...]:
    if len(points) < 3:
        return points
    line = LineString(points).simplify(_DETAIL_DEG, preserve_topology=False)
    return tuple((float(lon), float(lat)) for lon, lat in line.coords)
