"""KML (OGC 12-007r2) and KMZ: placemarks in folders."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element

from app.imports.archive import unpack
from app.imports.errors import file_error
from app.imports.rings import grouped
from app.imports.shapes import LonLat, Rings, Shape, labelled, line_of
from app.imports.xml import child_text, children, local_name, parse

_CONTAINERS = ("kml", "Document", "Folder")
_GEOMETRIES = ("Point", "LineString", "LinearRing", "Polygon", "MultiGeometry", "Track", "MultiTrack")


def read_kml(data: bytes, notes: list[str]) -> list[Shape]:
    """The shapes of a KML document; heights are left out.

    Raises
    ------
    RegionFileError
        Where it is no KML, or a coordinate is none.
    """
    root = parse(data)
    if local_name(root) != "kml":
        raise file_error("not-kml", f"the file is a <{local_name(root)[:40]}>, not KML", "send KML")
    shapes: list[Shape] = []
    for placemark, folders in _placemarks(root, (), notes):
        found = _shapes(placemark, folders, notes)
        if not found:
            notes.append(f"{child_text(placemark, 'name') or 'a placemark'} has no geometry and is left out")
        shapes += found
    return shapes


def read_kmz(data: bytes, notes: list[str]) -> list[Shape]:
    """The shapes of the KML document in an archive: ``doc.kml``, or else its first."""
    documents = unpack(data, (".kml",))
    if not documents:
        raise file_error("no-kml", "the archive holds no .kml file", "pack a doc.kml")
    main = next((name for name in documents if name.lower() == "doc.kml"), next(iter(documents)))
    if len(documents) > 1:
        notes.append(f"of {len(documents)} documents in the archive, {main} is read")
    return read_kml(documents[main], notes)


def _placemarks(
    element: Element, folders: tuple[str, ...], notes: list[str]
) -> Iterator[tuple[Element, tuple[str, ...]]]:
    for child in element:
        kind = local_name(child)
        if kind == "Placemark":
            yield child, folders
        elif kind in _CONTAINERS:
            name = child_text(child, "name")
            inside = (*folders, name) if name else folders
            yield from _placemarks(child, inside, notes)
        elif kind == "NetworkLink":
            notes.append("a network link is not followed")


def _shapes(placemark: Element, folders: tuple[str, ...], notes: list[str]) -> list[Shape]:
    name = child_text(placemark, "name")
    properties = dict(_data(placemark))
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
    """Longitude, latitude and height by commas, places by white space."""
    text = child_text(geometry, "coordinates")
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
            "write longitude,latitude or longitude,latitude,height, without blanks after the commas",
        ) from None


def _data(placemark: Element) -> Iterator[tuple[str, str]]:
    for extended in children(placemark, "ExtendedData"):
        for data in children(extended, "Data"):
            yield data.get("name", ""), child_text(data, "value")
        for schema in children(extended, "SchemaData"):
            for simple in children(schema, "SimpleData"):
                yield simple.get("name", ""), (simple.text or "").strip()
