"""Well-known text, with an SRID or without: one geometry after the other."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator

import numpy as np
import shapely
from shapely.errors import ShapelyError

from app.imports.crs import mover, written_crs
from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.plain import drawn
from app.imports.shapes import Shape, labelled, moved

#: Deeper than any geometry: collections within collections.
MAX_DEPTH = 50
_KIND = r"(?:MULTI)?(?:POINT|LINESTRING|POLYGON)|GEOMETRYCOLLECTION|LINEARRING"
_BEGINNING = re.compile(rf"\s*(?:SRID\s*=\s*(\d{{1,6}})\s*;\s*)?(?:{_KIND})\b[\s(ZME]", re.IGNORECASE)
_TOKEN = re.compile(r"[()]|[A-Za-z]+")


def is_wkt(text: str) -> bool:
    """Whether a text begins as well-known text does."""
    return _BEGINNING.match(text[:200]) is not None


def read_wkt(text: str, crs: str | None, notes: Notes) -> list[Shape]:
    """The shapes of all geometries of a text.

    Raises
    ------
    RegionFileError
        Rules ``wkt``, ``crs``.
    """
    shapes: list[Shape] = []
    for piece in _pieces(text):
        shapes += shapes_of_wkt(piece, "", crs, notes)
    return shapes


def shapes_of_wkt(text: str, name: str, crs: str | None, notes: Notes) -> list[Shape]:
    """The shapes of one geometry."""
    head = _BEGINNING.match(text)
    if head is None:
        raise file_error("wkt", f"{name or 'a geometry'} is {text.strip()[:40]!r}", "write well-known text")
    body = text[text.index(";") + 1 :] if head[1] else text
    if _depth(body) > MAX_DEPTH:
        message = f"{name or 'a geometry'} has brackets within brackets over {MAX_DEPTH} deep"
        raise file_error("wkt", message, "write its parts as geometries of their own")
    try:
        with np.errstate(all="ignore"):
            geometry = json.loads(shapely.to_geojson(shapely.force_2d(shapely.from_wkt(body.strip()))))
    except (ShapelyError, ValueError) as error:
        raise file_error("wkt", f"{name or 'a geometry'} cannot be read: {error}", "mend it") from error
    system = crs or (head[1] if head[1] not in (None, "0") else None)
    move = mover(written_crs(system), notes) if system else None
    return labelled([moved(Shape(s.kind, s.parts, name), move) for s in drawn(geometry, name)])


def _depth(text: str) -> int:
    """Of its brackets, as deep as they go."""
    return max(itertools.accumulate((1 if c == "(" else -1 for c in text if c in "()"), initial=0))


def _pieces(text: str) -> Iterator[str]:
    """Geometries by their brackets; what stands between them is no geometry of its own."""
    depth, start = 0, 0
    for token in _TOKEN.finditer(text):
        if token[0] == "(":
            depth += 1
        elif token[0] == ")":
            depth -= 1
        if depth == 0 and (token[0] == ")" or token[0].upper() == "EMPTY"):
            yield text[start : token.end()].lstrip(" \t\r\n,;")
            start = token.end()
    if rest := text[start:].strip(" \t\r\n,;"):
        yield rest
