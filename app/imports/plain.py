"""GeoJSON of other programs: features that play no part in a scenario yet."""

from __future__ import annotations

from typing import Any

from app.imports.errors import file_error
from app.imports.shapes import LonLat, Rings, Shape
from app.services.documents import read_object
from app.services.errors import RefusedError

_NAMES = ("name", "Name", "NAME", "title", "label")
_MAX_DEPTH = 10


def read_geojson(data: bytes, notes: list[str]) -> list[Shape]:
    """The shapes of a FeatureCollection, a Feature or a geometry (RFC 7946)."""
    try:
        document = read_object(data)
    except RefusedError as error:
        raise file_error("json-syntax", str(error), "send GeoJSON") from error
    if "crs" in document:
        notes.append("the member crs is left out: GeoJSON is WGS 84")
    if document.get("type") == "FeatureCollection":
        features = document.get("features")
        if not isinstance(features, list):
            raise file_error("geojson", "the collection has no list of features", "send GeoJSON")
    else:
        features = [document]
    shapes: list[Shape] = []
    for feature in features:
        if not isinstance(feature, dict):
            raise file_error("geojson", "a feature is no object", "send GeoJSON")
        holder = feature.get("properties")
        properties = holder if isinstance(holder, dict) else {}
        geometry = feature.get("geometry") if feature.get("type") == "Feature" else feature
        name = next((str(properties[key]) for key in _NAMES if properties.get(key)), "")
        if not name and isinstance(feature.get("id"), (str, int)):
            name = str(feature["id"])
        texts = {key: str(value) for key, value in properties.items() if isinstance(value, (str, int, float))}
        if geometry is None:
            notes.append(f"{name or 'a feature'} has no geometry and is left out")
            continue
        shapes += [Shape(s.kind, s.parts, name, (), texts) for s in _shapes(geometry, name, 0)]
    return shapes


def _shapes(geometry: Any, name: str, depth: int) -> list[Shape]:
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    value = geometry.get("coordinates") if isinstance(geometry, dict) else None
    match kind:
        case "Point":
            return [Shape("point", (((_place(value, name),),),))]
        case "MultiPoint":
            return [Shape("point", (((_place(one, name),),),)) for one in _list(value, name)]
        case "LineString":
            return [Shape("line", ((_places(value, name),),))]
        case "MultiLineString":
            return [Shape("line", ((_places(one, name),),)) for one in _list(value, name)]
        case "Polygon":
            return [Shape("polygon", (_polygon(value, name),))]
        case "MultiPolygon":
            return [Shape("polygon", tuple(_polygon(one, name) for one in _list(value, name)))]
        case "GeometryCollection" if depth < _MAX_DEPTH:
            inner = _list(geometry.get("geometries"), name)
            return [shape for one in inner for shape in _shapes(one, name, depth + 1)]
    raise file_error("geojson", f"{name or 'a feature'} has the geometry {str(kind)[:40]!r}", "send GeoJSON")


def _list(value: Any, name: str) -> list[Any]:
    if not isinstance(value, list) or not value:
        raise file_error("geojson", f"{name or 'a feature'} has no list of coordinates", "send GeoJSON")
    return value


def _place(value: Any, name: str) -> LonLat:
    if (
        not isinstance(value, list)
        or len(value) < 2
        or not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in value[:2])
    ):
        raise file_error(
            "geojson", f"{name or 'a feature'} has the position {str(value)[:40]}", "send GeoJSON"
        )
    try:
        return float(value[0]), float(value[1])
    except OverflowError:
        raise file_error("geojson", f"{name or 'a feature'} has a huge number", "send degrees") from None


def _places(value: Any, name: str) -> tuple[LonLat, ...]:
    return tuple(_place(one, name) for one in _list(value, name))


def _polygon(value: Any, name: str) -> Rings:
    return tuple(_places(ring, name) for ring in _list(value, name))
