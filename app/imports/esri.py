"""Shapefiles (ESRI white paper, July 1998), alone or in an archive with ``.prj`` and ``.dbf``."""

from __future__ import annotations

import io
import struct
from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any

import shapefile

from app.imports.crs import ToWgs84, crs_of_prj, to_wgs84, written_crs
from app.imports.encodings import codec_of, codec_of_driver, guessed, reads
from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.rings import grouped
from app.imports.shapes import MAX_SHAPES, Shape, moved

MAGIC = b"\x00\x00\x27\x0a"
_HEADER_BYTES = 100
_POLYGONS = frozenset({5, 15, 25})
_LINES = frozenset({3, 13, 23})
_POINTS = frozenset({1, 11, 21})
_MULTIPOINTS = frozenset({8, 18, 28})
_NAMES = ("name", "label", "title", "id")


def read_shapefile(
    data: bytes, companions: Mapping[str, bytes], crs: str | None, notes: Notes, layer: str = ""
) -> list[Shape]:
    """The shapes of one shapefile.

    Parameters
    ----------
    companions
        Content of the files beside it, by ending: ``.prj``, ``.dbf``, ``.cpg``.
    crs
        Code of the reference system; goes before ``.prj``.
    layer
        The file's path without its ending; its parts stand for folders.

    Raises
    ------
    RegionFileError
        Where the file is damaged, or says no reference system.
    """
    _walk(data)
    move = to_wgs84(_crs(companions, crs, layer), notes)
    try:
        with shapefile.Reader(
            shp=io.BytesIO(data),
            dbf=io.BytesIO(companions[".dbf"]) if ".dbf" in companions else None,
            encoding=_encoding(companions, notes, layer),
            encodingErrors="replace",
        ) as reader:
            drawn = list(reader.iterShapes())
            records = [record.as_dict() for record in reader.records()] if ".dbf" in companions else []
    except Exception as error:
        # the reader has no error of its own for most of what a damaged file does to it
        raise file_error(
            "shapefile-damaged", f"the shapefile cannot be read: {type(error).__name__}", "export it again"
        ) from error
    if records and len(records) != len(drawn):
        raise file_error(
            "shapefile-damaged", f".shp has {len(drawn)} shapes, .dbf {len(records)} rows", "export it again"
        )
    shapes: list[Shape] = []
    for index, one in enumerate(drawn):
        row = {key: str(value).strip() for key, value in records[index].items()} if records else {}
        with notes.one_shape(""):
            shapes += _shapes(one, row, PurePosixPath(layer).parts, move, notes)
    return shapes


def _walk(data: bytes) -> None:
    """See that the records fit the file: a reader led astray by their lengths would not come back."""
    if data[:4] != MAGIC or len(data) < _HEADER_BYTES:
        raise file_error("not-shapefile", "the file is no shapefile", "send the .shp file")
    at, count = _HEADER_BYTES, 0
    while at < len(data):
        if at + 12 > len(data):
            break
        (words,) = struct.unpack_from(">i", data, at + 4)
        count += 1
        if words < 2 or at + 8 + 2 * words > len(data):
            raise file_error("shapefile-damaged", f"record {count} does not fit the file", "export it again")
        if count > MAX_SHAPES:
            raise file_error("too-many-shapes", f"more than {MAX_SHAPES} shapes", "export fewer")
        at += 8 + 2 * words
    if at != len(data):
        raise file_error("shapefile-damaged", "the file ends within a record", "export it again")


def _crs(companions: Mapping[str, bytes], crs: str | None, layer: str) -> Any:
    if crs is not None:
        return written_crs(crs)
    if ".prj" not in companions:
        raise file_error(
            "crs-missing",
            f"{layer or 'the shapefile'} has no .prj file: what its coordinates mean is not known",
            "send an archive with the .prj file, or give crs, e.g. EPSG:32611",
        )
    return crs_of_prj(companions[".prj"].decode("utf-8", "replace").strip("\ufeff\x00 \r\n\t"))


def _encoding(companions: Mapping[str, bytes], notes: Notes, layer: str) -> str:
    """The code page of the table: of .cpg, else as the table says, else as its text looks."""
    table = companions.get(".dbf", b"")
    named = codec_of(companions.get(".cpg", b"").decode("utf-8", "ignore"))
    if named == "utf-8" and not reads(_text_of(table), named):
        notes.append(f"{layer or 'the table'} is not of the code page that its .cpg names")
        named = None
    codec = named or codec_of_driver(table)
    if codec is None:
        codec = guessed(_text_of(table))
        if table[29:30] == b"\x00" and not _text_of(table).isascii():
            notes.append(f"{layer or 'the table'} names no code page and is read as {codec}")
    return codec


def _text_of(table: bytes) -> bytes:
    """The rows: the head holds numbers."""
    head = struct.unpack_from("<H", table, 8)[0] if len(table) >= 10 else len(table)
    return table[head:]


def _shapes(
    drawn: Any, row: dict[str, str], folders: tuple[str, ...], move: ToWgs84, notes: Notes
) -> list[Shape]:
    kind = drawn.shapeType
    lower = {key.lower(): value for key, value in row.items()}
    name = next((lower[key] for key in _NAMES if lower.get(key)), "")
    try:
        places = [(float(point[0]), float(point[1])) for point in getattr(drawn, "points", [])]
        starts = [int(start) for start in getattr(drawn, "parts", [])]
    except (TypeError, ValueError, IndexError) as error:
        raise file_error(
            "shapefile-damaged", f"{name or 'a shape'} has no places", "export it again"
        ) from error
    if kind == 0 or not places:
        notes.append(f"{name or 'a shape'} is empty and is left out")
        return []
    if kind in _POINTS | _MULTIPOINTS:
        return [Shape("point", ((tuple(move([place])),),), name, folders, lower) for place in places]
    pieces = [places[a:b] for a, b in zip(starts, [*starts[1:], len(places)], strict=True)]
    if not all(pieces):
        raise file_error("shapefile-damaged", f"{name or 'a shape'} has an empty part", "export it again")
    if kind in _LINES:
        return [Shape("line", ((tuple(move(piece)),),), name, folders, lower) for piece in pieces]
    if kind in _POLYGONS:
        rings = grouped([tuple(piece) for piece in pieces])
        return [moved(Shape("polygon", rings, name, folders, lower), move)]
    raise file_error(
        "shapefile-kind", f"{name or 'a shape'} is of type {kind}", "export polygons, lines or points"
    )
