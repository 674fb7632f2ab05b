"""Esri JSON: feature sets, feature collections of layers, features and geometries of ArcGIS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from app.imports.crs import ToWgs84, crs_of_prj, mover, written_crs
from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.plain import places_of, texts_of
from app.imports.rings import grouped
from app.imports.shapes import Shape, labelled, moved

_NAMES = ("name", "label", "title")
_NUMBERS = ("objectid", "fid", "id")
_CURVES = ("curveRings", "curvePaths")


def is_esri(document: Mapping[str, Any]) -> bool:
    """Whether a parsed document is Esri JSON rather than GeoJSON."""
    if "type" in document and "features" in document:
        return False
    if "layers" in document or "featureSet" in document or "geometryType" in document:
        return True
    features = document.get("features")
    first = features[0] if isinstance(features, list) and features else document
    if not isinstance(first, dict) or "type" in first:
        return False
    return "attributes" in first or _is_geometry(first.get("geometry", first))


def _is_geometry(value: Any) -> bool:
    kinds = ("rings", "paths", "points", "x", "xmin", *_CURVES)
    return isinstance(value, dict) and any(kind in value for kind in kinds)


def shapes_of(document: Mapping[str, Any], crs: str | None, notes: Notes) -> list[Shape]:
    """The shapes of a parsed document."""
    shapes: list[Shape] = []
    for folders, feature_set in _sets(document):
        whole = _mover(feature_set, crs, notes)
        display = str(feature_set.get("displayFieldName") or "").lower()
        features = feature_set.get("features", [feature_set])
        if not isinstance(features, list):
            raise file_error("esri-json", "the feature set has no list of features", "export it again")
        for feature in features:
            if not isinstance(feature, dict):
                raise file_error("esri-json", "a feature is no object", "export it again")
            shapes += _of_feature(feature, folders, display, whole, crs, notes)
    return shapes


def _sets(document: Mapping[str, Any]) -> list[tuple[tuple[str, ...], Mapping[str, Any]]]:
    """Feature sets, each with the names of its layers."""
    title = document.get("name", document.get("title"))
    above = (str(title)[:500],) if isinstance(title, str) and title else ()
    layers = document.get("layers")
    if isinstance(layers, list):
        found = []
        for layer in layers:
            if isinstance(layer, dict) and isinstance(layer.get("featureSet"), dict):
                definition = layer.get("layerDefinition")
                name = definition.get("name") if isinstance(definition, dict) else None
                named = (*above, str(name)[:500]) if name else above
                found.append((named, layer["featureSet"]))
        return found
    inner = document.get("featureSet")
    return [(above, inner if isinstance(inner, dict) else document)]


def _of_feature(
    feature: Mapping[str, Any],
    folders: tuple[str, ...],
    display: str,
    move: ToWgs84 | None,
    crs: str | None,
    notes: Notes,
) -> list[Shape]:
    attributes = feature.get("attributes")
    texts = texts_of(attributes) if isinstance(attributes, dict) else {}
    keys = (*((display,) if display and display not in _NUMBERS else ()), *_NAMES, *_NUMBERS)
    name = next((texts[key] for key in keys if texts.get(key)), "")
    geometry = feature.get("geometry") if "geometry" in feature or "attributes" in feature else feature
    if not geometry:
        notes.append(f"{name or 'a feature'} has no geometry and is left out")
        return []
    if not isinstance(geometry, dict):
        raise file_error("esri-json", f"{name or 'a feature'} has no geometry", "export it again")
    move = _mover(geometry, crs, notes) or move
    drawn: list[Shape] = []
    with notes.one_shape(name):
        drawn = [Shape(s.kind, s.parts, name, folders, texts) for s in _drawn(geometry, name)]
    return labelled([moved(shape, move) for shape in drawn])


def _drawn(geometry: Mapping[str, Any], name: str) -> list[Shape]:
    if any(geometry.get(kind) for kind in _CURVES):
        raise file_error(
            "esri-json", f"{name or 'a feature'} has curves", "export it with outputs densified to lines"
        )
    if "rings" in geometry:
        rings = [places_of(ring, name) for ring in _list(geometry["rings"], name)]
        return [Shape("polygon", grouped(rings))] if rings else []
    if "paths" in geometry:
        return [Shape("line", ((places_of(path, name),),)) for path in _list(geometry["paths"], name)]
    if "points" in geometry:
        points = _list(geometry["points"], name)
        return [Shape("point", ((place,),)) for place in ((places_of([one], name)) for one in points)]
    if "xmin" in geometry:
        west, south, east, north = (geometry.get(key) for key in ("xmin", "ymin", "xmax", "ymax"))
        corners = [[west, south], [east, south], [east, north], [west, north], [west, south]]
        return [Shape("polygon", ((places_of(corners, name),),))]
    if geometry.get("x") is None or geometry.get("x") == "NaN":
        return []
    return [Shape("point", ((places_of([[geometry.get("x"), geometry.get("y")]], name),),))]


def _list(value: Any, name: str) -> list[Any]:
    if not isinstance(value, list):
        raise file_error("esri-json", f"{name or 'a feature'} has no list of coordinates", "export it again")
    return value


def _mover(holder: Mapping[str, Any], crs: str | None, notes: Notes) -> ToWgs84 | None:
    if crs is not None:
        return mover(written_crs(crs), notes)
    reference = holder.get("spatialReference")
    if not isinstance(reference, dict) or not reference:
        return None
    number = reference.get("latestWkid") or reference.get("wkid")
    if isinstance(number, int):
        return mover(written_crs(str(number)), notes)
    if isinstance(reference.get("wkt"), str):
        return mover(crs_of_prj(reference["wkt"]), notes)
    raise file_error("crs", f"the spatial reference is {str(reference)[:60]}", "give crs, e.g. EPSG:32611")
