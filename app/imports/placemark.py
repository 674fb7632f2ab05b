"""One placemark: its geometry, and everything that it says of itself."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from xml.etree.ElementTree import Element

from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.rings import grouped
from app.imports.shapes import LonLat, Rings, Shape, labelled, line_of
from app.imports.xml import child_text, children, local_name

_GEOMETRIES = ("Point", "LineString", "LinearRing", "Polygon", "MultiGeometry", "Track", "MultiTrack")
_SAID = ("description", "snippet", "styleUrl", "address", "phoneNumber")
_COMMA = re.compile(r"\s*,\s*")


def shapes_of(
    placemark: Element, folders: tuple[str, ...], fields: Collection[str], notes: Notes
) -> list[Shape]:
    """The shapes of a placemark.

    Parameters
    ----------
    fields
        Names of children that a schema adds.
    """
    name = child_text(placemark, "name")
    properties = dict(_data(placemark, fields))
    polygons: list[Rings] = []
    others: list[Shape] = []
    for geometry in _flat(placemark):
        kind = local_name(geometry)
        if kind == "Polygon":
            polygons += grouped(_polygon(geometry, name))
        elif kind == "LinearRing":
            polygons.append((_coordinates(geometry, name),))
        elif kind in ("Point", "LineString"):
            positions = _coordinates(geometry, name)
            others.append(line_of(positions[:1] if kind == "Point" else positions, name, folders))
        elif kind == "Track":
            others.append(line_of(_track(geometry, name), name, folders))
    shapes = [Shape("polygon", tuple(polygons), name, folders)] if polygons else []
    shapes += others
    return labelled([Shape(shape.kind, shape.parts, name, folders, properties) for shape in shapes])


def _flat(element: Element) -> Iterator[Element]:
    for geometry in children(element, *_GEOMETRIES):
        if local_name(geometry) in ("MultiGeometry", "MultiTrack"):
            yield from _flat(geometry)
        else:
            yield geometry


def _polygon(polygon: Element, name: str) -> Rings:
    outer = [_coordinates(ring, name) for ring in _boundary(polygon, "outerBoundaryIs")]
    if len(outer) != 1:
        raise file_error("kml-polygon", f"{name or 'a polygon'} has {len(outer)} outer rings", "give it one")
    return (*outer, *(_coordinates(ring, name) for ring in _boundary(polygon, "innerBoundaryIs")))


def _boundary(polygon: Element, kind: str) -> Iterator[Element]:
    for boundary in children(polygon, kind):
        yield from children(boundary, "LinearRing")


def _coordinates(geometry: Element, name: str) -> tuple[LonLat, ...]:
    """Longitude, latitude and height by commas, places by white space; blanks by commas do not count."""
    text = _COMMA.sub(",", child_text(geometry, "coordinates"))
    places = [_numbers(word.split(","), name) for word in text.split()]
    if not places:
        raise file_error("kml-coordinates", f"{name or 'a placemark'} has no coordinates", "give it some")
    return tuple(places)


def _track(track: Element, name: str) -> tuple[LonLat, ...]:
    places = [_numbers((coord.text or "").split(), name) for coord in children(track, "coord")]
    if not places:
        raise file_error("kml-coordinates", f"{name or 'a track'} has no coordinates", "give it some")
    return tuple(places)


def _numbers(words: list[str], name: str) -> LonLat:
    try:
        if not 2 <= len(words) <= 3:
            raise ValueError
        return float(words[0]), float(words[1])
    except ValueError:
        found = ",".join(words)[:60]
        raise file_error(
            "kml-coordinates",
            f"{name or 'a placemark'} has the coordinate {found!r}",
            "write longitude,latitude or longitude,latitude,height",
        ) from None


def _data(placemark: Element, fields: Collection[str]) -> Iterator[tuple[str, str]]:
    """Values by names in lower case: of the placemark, of its schema, of others' elements in it."""
    for child in placemark:
        kind = local_name(child)
        if kind in _SAID or kind in fields:
            yield kind.lower(), (child.text or "").strip()
    for extended in children(placemark, "ExtendedData"):
        for data in extended:
            if local_name(data) == "Data":
                yield data.get("name", "").lower(), child_text(data, "value")
            elif local_name(data) == "SchemaData":
                for simple in children(data, "SimpleData", "SimpleArrayData"):
                    values = [value.text or "" for value in simple] or [simple.text or ""]
                    yield simple.get("name", "").lower(), " ".join(values).strip()
            else:
                yield local_name(data).lower(), (data.text or "").strip()
