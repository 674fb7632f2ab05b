"""GPX 1.0 and 1.1: tracks and routes are lines, waypoints are points."""

from __future__ import annotations

from dataclasses import replace
from xml.etree.ElementTree import Element

from shapely.geometry import LineString

from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.shapes import LonLat, Shape, line_of
from app.imports.xml import child_text, children, local_name, parse

#: A receiver's points nearer than this to the line through their neighbours say nothing (about a metre).
_DETAIL_DEG = 1e-5


def read_gpx(data: bytes, notes: Notes) -> list[Shape]:
    """The shapes of a GPX document; heights and times are left out.

    Raises
    ------
    RegionFileError
        Where it is no GPX, or a point has no place.
    """
    root = parse(data, notes)
    if local_name(root) != "gpx":
        raise file_error("not-gpx", f"the file is a <{local_name(root)[:40]}>, not GPX", "send GPX")
    above = _said(root, "name", "desc") + tuple(
        text
        for metadata in children(root, "metadata")
        for text in _said(metadata, "name", "desc", "keywords")
    )
    shapes: list[Shape] = []
    for track in children(root, "trk"):
        with notes.one_shape(child_text(track, "name")):
            segments = [_points(segment, "trkpt") for segment in children(track, "trkseg")]
            shapes += [_shape(_plain(segment), track, above) for segment in segments if segment]
    for route in children(root, "rte"):
        with notes.one_shape(child_text(route, "name")):
            points = _points(route, "rtept")
            shapes += [_shape(_plain(points), route, above)] if points else []
    for waypoint in children(root, "wpt"):
        with notes.one_shape(child_text(waypoint, "name")):
            shapes.append(_shape((_place(waypoint),), waypoint, above))
    return shapes


def _shape(places: tuple[LonLat, ...], element: Element, folders: tuple[str, ...]) -> Shape:
    values = {key: child_text(element, key) for key in ("desc", "cmt", "type", "sym", "src")}
    shape = line_of(places, child_text(element, "name"), folders)
    return replace(shape, properties={key: value for key, value in values.items() if value})


def _said(element: Element, *keys: str) -> tuple[str, ...]:
    return tuple(text for key in keys if (text := child_text(element, key)))


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
