"""GeoJSON of other programs: features that play no part in a scenario yet."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

from app.imports.bands import band_of
from app.imports.crs import ToWgs84, mover, written_crs
from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.rings import grouped
from app.imports.shapes import LonLat, Rings, Shape, labelled, moved

_NAMES = ("name", "title", "label", "id")
_TITLES = ("name", "title", "description", "metadata", "properties")
_MAX_DEPTH = 10
_MAX_NESTED = 20_000


def shapes_of(document: Mapping[str, Any], crs: str | None, notes: Notes) -> list[Shape]:
    """The shapes of a parsed GeoJSON document."""
    folders: tuple[str, ...] = ()
    if document.get("type") == "FeatureCollection":
        features = document.get("features")
        if not isinstance(features, list):
            raise file_error("geojson", "the collection has no list of features", "send GeoJSON")
        titles = texts_of({key: document[key] for key in _TITLES if key in document})
        folders = tuple(text for text in titles.values() if text)
    else:
        features = [document]
    whole = _mover(document, crs, notes)
    shapes: list[Shape] = []
    for feature in features:
        if not isinstance(feature, dict):
            raise file_error("geojson", "a feature is no object", "send GeoJSON")
        move = whole if feature is document else _mover(feature, crs, notes) or whole
        shapes += _of_feature(feature, folders, move, crs, notes)
    return shapes


def _of_feature(
    feature: Mapping[str, Any],
    folders: tuple[str, ...],
    move: ToWgs84 | None,
    crs: str | None,
    notes: Notes,
) -> list[Shape]:
    holder = feature.get("properties")
    texts = texts_of(holder) if isinstance(holder, dict) else {}
    geometry = feature.get("geometry") if feature.get("type") == "Feature" else feature
    name = name_of(texts)
    if not name and isinstance(feature.get("id"), (str, int)):
        name = str(feature["id"])
    if geometry is None:
        notes.append(f"{name or 'a feature'} has no geometry and is left out")
        return []
    if geometry is not feature and isinstance(geometry, dict):
        move = _mover(geometry, crs, notes) or move
    extent = geometry.get("extent") if isinstance(geometry, dict) else None
    if isinstance(extent, dict) and "radius" in extent:
        # a circle of EUROCAE ED-318
        texts = {**texts, "radius_m": json.dumps(extent["radius"])}
    layer = geometry.get("layer") if isinstance(geometry, dict) else None
    if isinstance(layer, dict):
        texts = {**texts, **band_of(layer, notes)}
    found: list[Shape] = []
    with notes.one_shape(name):
        found = [Shape(s.kind, s.parts, name, folders, texts) for s in drawn(geometry, name)]
    return labelled([moved(shape, move) for shape in found])


def name_of(texts: Mapping[str, str]) -> str:
    """The name; of one in several languages the first."""
    name = next((texts[key] for key in _NAMES if texts.get(key)), "")
    if name.startswith("["):
        found = re.search(r'"text": "((?:[^"\\\\]|\\\\.)*)"', name)
        name = found[1] if found else name
    return name


def texts_of(properties: Mapping[str, Any]) -> dict[str, str]:
    """Values as texts, by names in lower case; what is nested as JSON."""
    texts: dict[str, str] = {}
    for key, value in properties.items():
        if isinstance(value, (dict, list)):
            value = json.dumps(value, ensure_ascii=False)[:_MAX_NESTED]
        if value is not None:
            texts.setdefault(str(key).lower(), str(value).strip())
    return texts


def _mover(holder: Mapping[str, Any], crs: str | None, notes: Notes) -> ToWgs84 | None:
    """What brings the places to WGS 84, by the member ``crs`` of GeoJSON before RFC 7946."""
    if crs is not None:
        return mover(written_crs(crs), notes)
    member = holder.get("crs")
    if member is None:
        return None
    inner = member.get("properties") if isinstance(member, dict) else None
    if isinstance(inner, dict) and (name := _named(inner)) is not None:
        return mover(written_crs(str(name)), notes)
    if isinstance(member, str):
        return mover(written_crs(member), notes)
    raise file_error(
        "crs", f"the member crs is {str(member)[:60]}", "give crs with the import, e.g. EPSG:32611"
    )


def _named(properties: Mapping[str, Any]) -> Any:
    """What the properties of a ``crs`` call it; of a link, the code that its address ends in."""
    linked = re.search(r"/ref/(epsg|esri)/(\d+)", str(properties.get("href", "")))
    if linked is not None:
        return f"{linked[1].upper()}:{linked[2]}"
    return properties.get("name", properties.get("code"))


def drawn(geometry: Any, name: str, depth: int = 0) -> list[Shape]:
    """The shapes of a geometry, named and moved by nobody yet."""
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    value = geometry.get("coordinates") if isinstance(geometry, dict) else None
    if value == [] or (kind == "GeometryCollection" and geometry.get("geometries") == []):
        return []
    match kind:
        case "Point":
            return [Shape("point", (((_place(value, name),),),))]
        case "MultiPoint":
            return [Shape("point", (((_place(one, name),),),)) for one in _list(value, name)]
        case "LineString":
            return [Shape("line", ((places_of(value, name),),))]
        case "MultiLineString":
            return [Shape("line", ((places_of(one, name),),)) for one in _list(value, name)]
        case "Polygon":
            return [Shape("polygon", grouped(_polygon(value, name)))]
        case "MultiPolygon":
            return [Shape("polygon", sum((grouped(_polygon(one, name)) for one in _list(value, name)), ()))]
        case "GeometryCollection" if depth < _MAX_DEPTH:
            inner = _list(geometry.get("geometries"), name)
            return [shape for one in inner for shape in drawn(one, name, depth + 1)]
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


def places_of(value: Any, name: str) -> tuple[LonLat, ...]:
    """A list of positions, heights left out."""
    return tuple(_place(one, name) for one in _list(value, name))


def _polygon(value: Any, name: str) -> Rings:
    return tuple(places_of(ring, name) for ring in _list(value, name))
