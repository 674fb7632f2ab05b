"""UAS geographical zones as the states publish them: EUROCAE ED-269, whose geometry is none of GeoJSON's."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from app.imports.bands import band_of, finite, metres
from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.plain import drawn, name_of, texts_of
from app.imports.shapes import Shape


def is_zones(document: Mapping[str, Any]) -> bool:
    """Whether a parsed document is a set of such zones: each has a list of volumes for its geometry."""
    features = _list_of(document)
    first = features[0] if isinstance(features, list) and features else None
    return isinstance(first, dict) and isinstance(first.get("geometry"), list)


def shapes_of_zones(document: Mapping[str, Any], notes: Notes) -> list[Shape]:
    """The zones; their heights where they count from the sea, else from the ground up."""
    title = document.get("title", document.get("name"))
    folders = (title,) if isinstance(title, str) and title else ()
    shapes: list[Shape] = []
    for zone in _list_of(document):
        if not isinstance(zone, dict):
            raise file_error("geojson", "a zone is no object", "send the set as it is published")
        values = {key: value for key, value in zone.items() if key != "geometry"}
        texts = texts_of(values)
        name = name_of(texts) or texts.get("identifier", "")
        with notes.one_shape(name):
            volumes = zone.get("geometry")
            if not isinstance(volumes, list):
                raise file_error("geojson", f"{name or 'a zone'} has no geometry", "export it again")
            for volume in volumes:
                shapes += _of_volume(volume, name, folders, texts, notes)
    return shapes


def _list_of(document: Mapping[str, Any]) -> Any:
    """The zones of a set, which some states call by the standard's older name."""
    return document.get("features", document.get("UASZoneList"))


def _of_volume(
    volume: Any, name: str, folders: tuple[str, ...], texts: Mapping[str, str], notes: Notes
) -> list[Shape]:
    projection = volume.get("horizontalProjection") if isinstance(volume, dict) else None
    if not isinstance(projection, dict):
        raise file_error("geojson", f"{name or 'a zone'} has no horizontalProjection", "export it again")
    texts = {**texts, **band_of(volume, notes)}
    if projection.get("type") == "Circle":
        radius = {"radius_m": json.dumps(_radius_m(projection.get("radius"), volume))}
        point = {"type": "Point", "coordinates": projection.get("center")}
        return [Shape(s.kind, s.parts, name, folders, {**texts, **radius}) for s in drawn(point, name)]
    return [Shape(s.kind, s.parts, name, folders, texts) for s in drawn(projection, name)]


def _radius_m(radius: Any, volume: Mapping[str, Any]) -> Any:
    """In metres where that is known; else as it is written, which is no shorter."""
    number, unit_m = finite(radius), metres(volume)
    return radius if number is None or unit_m is None else number * unit_m
