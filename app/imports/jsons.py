"""JSON of any kind: GeoJSON, one document a line, Esri JSON, and plans of QGroundControl."""

from __future__ import annotations

from typing import Any

from app.imports import esri_json, plain
from app.imports.errors import file_error
from app.imports.missions import shapes_of_mission
from app.imports.notes import Notes
from app.imports.shapes import MAX_SHAPES, Shape
from app.imports.surveys import shapes_of_surveys
from app.imports.zones import is_zones, shapes_of_zones
from app.services.documents import read_json
from app.services.errors import RefusedError

_SEPARATOR = b"\x1e"
#: One of them at least has what holds shapes.
_MEMBERS = frozenset(("type", "features", "geometry", "geometries", "coordinates"))


def read_json_file(data: bytes, crs: str | None, notes: Notes) -> tuple[str, list[Shape]]:
    """The format, and the shapes."""
    data = _as_utf8(data)
    text = data.lstrip(b"\xef\xbb\xbf \t\r\n")
    try:
        document = None if text.startswith(_SEPARATOR) else read_json(data)
    except RefusedError as error:
        if not _has_lines(text):
            raise file_error("json-syntax", str(error), "send GeoJSON") from error
        document = None
    if document is None:
        return "geojsonl", _lines(text, crs, notes)
    if isinstance(document, list):
        if not all(isinstance(one, dict) and "type" in one for one in document):
            raise file_error("geojson", "the list is none of GeoJSON features", "send a FeatureCollection")
        document = {"type": "FeatureCollection", "features": document}
    if not isinstance(document, dict):
        raise file_error("geojson", "the document is no JSON object", "send a FeatureCollection")
    if document.get("fileType") in ("Plan", "GeoFence", "RallyPoints"):
        return "mission", shapes_of_mission(data, notes, shapes_of_surveys(document, notes))
    if is_zones(document):
        return "geojson", shapes_of_zones(document, notes)
    if esri_json.is_esri(document):
        return "esrijson", esri_json.shapes_of(document, crs, notes)
    if not _MEMBERS & document.keys():
        told = ", ".join(str(key)[:30] for key in list(document)[:5]) or "none"
        raise file_error(
            "geojson", f"the JSON holds no shapes; its members: {told}", "export them as GeoJSON"
        )
    return "geojson", plain.shapes_of(document, crs, notes)


def _as_utf8(data: bytes) -> bytes:
    """The text in UTF-8 where its mark says that it is in UTF-16, as PowerShell writes it; else as it is."""
    if data[:2] not in (b"\xff\xfe", b"\xfe\xff") or data[:4] == b"\xff\xfe\x00\x00":
        return data
    try:
        return data.decode("utf-16").encode()
    except UnicodeError as error:
        raise file_error("json-syntax", f"the text is no UTF-16: {error}", "send UTF-8") from error


def _has_lines(text: bytes) -> bool:
    """Whether the first line is a document of its own, with more behind it."""
    first, _, rest = text.partition(b"\n")
    return first.rstrip().endswith(b"}") and rest.strip() != b""


def _lines(text: bytes, crs: str | None, notes: Notes) -> list[Shape]:
    """Newline-delimited GeoJSON, and GeoJSON text sequences (RFC 8142)."""
    shapes: list[Shape] = []
    pieces = text.split(_SEPARATOR) if text.startswith(_SEPARATOR) else text.splitlines()
    for number, piece in enumerate(pieces, 1):
        if not piece.strip():
            continue
        try:
            document: Any = read_json(piece)
        except RefusedError as error:
            raise file_error("json-syntax", f"line {number}: {error}", "send one document a line") from error
        if not isinstance(document, dict):
            raise file_error("geojson", f"line {number} is no object", "send one feature a line")
        read = esri_json.shapes_of if esri_json.is_esri(document) else plain.shapes_of
        shapes += read(document, crs, notes)
        if len(shapes) > MAX_SHAPES:
            raise file_error("too-many-shapes", f"more than {MAX_SHAPES} shapes", "send fewer")
    return shapes
