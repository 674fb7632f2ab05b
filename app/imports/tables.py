"""Tables of places: comma-, semicolon- or tab-separated, with latitude and longitude or well-known text."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence

from app.imports.crs import ToWgs84, mover, written_crs
from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.shapes import MAX_SHAPES, Shape, moved
from app.imports.wkt import shapes_of_wkt
from app.imports.words import plain

_LATITUDE = frozenset(
    ("lat", "latitude", "latitude deg", "lat deg", "lat dd", "gps lat", "gps latitude", "breite",
     "breitengrad",
     "latitud", "latitudine", "breddegrad", "latitud n", "szerokosc", "широта", "纬度", "緯度", "위도")
)  # fmt: skip
_LONGITUDE = frozenset(
    ("lon", "long", "lng", "longitude", "longitude deg", "lon deg", "long deg", "lng deg", "lon dd",
     "gps lon",
     "gps long", "gps longitude", "lange", "langengrad", "laengengrad",
     "longitud", "longitudine", "lengdegrad",
     "dlugosc", "долгота", "经度", "經度", "経度", "경도")
)  # fmt: skip
_EAST = frozenset(("x", "east", "easting", "e", "rechtswert", "x coord", "point x", "ostwert"))
_NORTH = frozenset(("y", "north", "northing", "n", "hochwert", "y coord", "point y", "nordwert"))
_TEXT = frozenset(("wkt", "geometry", "geom", "the geom", "geometry wkt", "wkt geom", "shape wkt"))
_NAMES = ("name", "label", "title", "id", "nom", "nombre", "nome", "bezeichnung", "имя", "名称", "名前")
_DELIMITERS = (",", ";", "\t", "|")
_SEXAGESIMAL = re.compile(
    r"([NSEWnsew]?)\s*([-+]?)(\d{1,3})[°d:\s]\s*(\d{1,2}(?:\.\d+)?)(?:['′m:\s]\s*(?:(\d{1,2}(?:\.\d+)?)\s*[\"″s]?)?)?\s*"
    r"([NSEWnsew]?)"
)  # fmt: skip


def is_table(text: str) -> bool:
    """Whether the first line names columns of places."""
    return _columns(_head(text)[1]) is not None


def read_table(text: str, crs: str | None, notes: Notes) -> list[Shape]:
    """The shapes of the rows; every further column is a value of the shape.

    Raises
    ------
    RegionFileError
        With the number of the line.
    """
    delimiter, head = _head(text)
    columns = _columns(head)
    if columns is None:
        raise file_error(
            "table-columns",
            f"the columns are {', '.join(head)[:80]!r}",
            "name them lat and lon, or wkt, in the first line",
        )
    move = mover(written_crs(crs), notes) if crs is not None else None
    keys = [name.strip().strip("\ufeff").lower() for name in head]
    shapes: list[Shape] = []
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=True)
    try:
        next(reader)
        for row in reader:
            if any(cell.strip() for cell in row):
                with notes.one_shape(f"line {reader.line_num}"):
                    shapes += _of_row(row, keys, columns, reader.line_num, (move, crs), notes)
            if len(shapes) > MAX_SHAPES:
                raise file_error("too-many-shapes", f"more than {MAX_SHAPES} shapes", "send fewer")
    except csv.Error as error:
        raise file_error("table-syntax", f"line {reader.line_num}: {error}", "mend the line") from error
    return shapes


def _head(text: str) -> tuple[str, list[str]]:
    line = text.lstrip("\ufeff\r\n").partition("\n")[0].strip()[:10_000]
    delimiter = max(_DELIMITERS, key=line.count)
    try:
        return delimiter, next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:
        return delimiter, []


def _columns(head: Sequence[str]) -> tuple[int, ...] | None:
    """Where longitude and latitude stand, or the one column of well-known text."""
    names = [re.sub(r" (?:degrees|grad)$", " deg", plain(name)) for name in head]
    for xs, ys in ((_LONGITUDE, _LATITUDE), (_EAST, _NORTH)):
        x = next((i for i, name in enumerate(names) if name in xs), None)
        y = next((i for i, name in enumerate(names) if name in ys), None)
        if x is not None and y is not None:
            return x, y
    text = next((i for i, name in enumerate(names) if name in _TEXT), None)
    return None if text is None else (text,)


def _of_row(
    row: Sequence[str],
    keys: Sequence[str],
    columns: tuple[int, ...],
    line: int,
    system: tuple[ToWgs84 | None, str | None],
    notes: Notes,
) -> list[Shape]:
    values = {
        key: cell.strip() for i, (key, cell) in enumerate(zip(keys, row, strict=False)) if i not in columns
    }
    name = _name(values)
    cells = [row[column].strip() if column < len(row) else "" for column in columns]
    if not all(cells):
        notes.append(f"line {line} has no place and is left out")
        return []
    move, crs = system
    if len(columns) == 1:
        return [
            Shape(shape.kind, shape.parts, name, (), values, shape.label)
            for shape in shapes_of_wkt(cells[0], name, crs, notes)
        ]
    place = (_degrees(cells[0], line), _degrees(cells[1], line))
    return [moved(Shape("point", (((place,),),), name, (), values), move)]


def _name(values: Mapping[str, str]) -> str:
    return next((values[key] for key in _NAMES if values.get(key)), "")


def _degrees(text: str, line: int) -> float:
    """A number with point or comma, or degrees, minutes and seconds."""
    try:
        value = float(text.replace(",", ".") if text.count(",") == 1 and "." not in text else text)
    except ValueError:
        found = _SEXAGESIMAL.fullmatch(text.replace(",", "."))
        if found is None:
            raise file_error(
                "table-place", f"line {line}: {text[:40]!r} is no place", "write degrees"
            ) from None
        before, sign, degrees, minutes, seconds, after = found.groups()
        value = float(degrees) + float(minutes) / 60.0 + float(seconds or 0.0) / 3600.0
        if sign == "-" or (before or after).upper() in ("S", "W"):
            value = -value
    if not math.isfinite(value):
        raise file_error("table-place", f"line {line}: {text[:40]!r} is no place", "write degrees")
    return value
