"""Any region file: its format is found by its content."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import Any

from app.imports import esri, gml, gpx, kml
from app.imports.archive import is_zip
from app.imports.bundle import read_bundle
from app.imports.encodings import guessed
from app.imports.errors import RegionFileError, file_error
from app.imports.features import MAX_FINDINGS, Account, features
from app.imports.gml import is_gml
from app.imports.jsons import read_json_file
from app.imports.missions import shapes_of_mission
from app.imports.notes import Notes
from app.imports.options import ImportOptions, check_options
from app.imports.shapes import Shape
from app.imports.tables import is_table, read_table
from app.imports.wkt import is_wkt, read_wkt
from app.imports.xml import local_name, parse
from mavlink.formats.point_lists import is_point_list
from planner.errors import Finding


@dataclass(frozen=True, slots=True)
class Imported:
    """What a file became.

    Parameters
    ----------
    collection
        A FeatureCollection of scenario features.
    format
        The format it came in.
    shapes
        What each shape of the file became, and why.
    left_out
        What keeps shapes from taking a part, or from taking it as they are.
    notes
        What else is worth knowing.
    """

    collection: dict[str, Any]
    format: str
    shapes: tuple[Account, ...]
    left_out: tuple[Finding, ...]
    notes: tuple[str, ...]


#: A class of airspace, and a part of an outline, each on a line of its own.
_OPENAIR = (
    re.compile(r"^[ \t]*AC[ \t]", re.MULTILINE),
    re.compile(r"^[ \t]*(?:D[PCABY]|V)[ \t]", re.MULTILINE),
)

FORMATS = (
    "kml", "kmz", "gpx", "gml", "shp", "shapefile", "zip", "geojson", "geojsonl", "esrijson", "wkt",
    "csv", "mission",
)  # fmt: skip


def import_regions(
    data: bytes,
    options: ImportOptions | None = None,
    form: str | None = None,
    companions: Mapping[str, bytes] | None = None,
) -> Imported:
    """The features of a region file.

    Parameters
    ----------
    data
        The file.
    options
        What the file does not say.
    form
        One of ``FORMATS``, ``shapefile`` being an archive with a shapefile; None to look at the content.
    companions
        Beside a lone ``.shp``: the content of its ``.prj``, ``.dbf`` and ``.cpg`` files, by ending.

    Raises
    ------
    RegionFileError
        With a finding for everything that is wrong.
    """
    options = options or ImportOptions()
    check_options(options)
    notes = Notes()
    found, shapes = _read(data, form, options.crs, companions or {}, notes)
    if notes.faults and not shapes:
        raise RegionFileError(notes.faults[0].message, tuple(notes.faults[:MAX_FINDINGS]))
    made = features(shapes, options, notes)
    collection = {"type": "FeatureCollection", "features": made.features} | notes.members
    return Imported(
        collection, found, tuple(made.accounts), (*notes.faults, *made.findings), tuple(dict.fromkeys(notes))
    )


def _read(
    data: bytes, form: str | None, crs: str | None, companions: Mapping[str, bytes], notes: Notes
) -> tuple[str, list[Shape]]:
    found = form or _format(data)
    if found in ("zip", "kmz", "shapefile"):
        wanted = None if form in (None, "zip") else form
        return read_bundle(data, crs, notes, lambda inner, name: _member(inner, name, crs, notes), wanted)
    return _shapes(found, data, crs, companions, notes)


def _member(data: bytes, name: str, crs: str | None, notes: Notes) -> list[Shape]:
    """One file of an archive, its path its folders."""
    found = _format(data)
    if found == "zip":
        raise file_error("archive-nested", f"{name} is an archive within an archive", "unpack it")
    path = PurePosixPath(name)
    above = (*path.parent.parts, path.stem)
    _, shapes = _shapes(found, data, crs, {}, notes)
    return [replace(shape, folders=(*above, *shape.folders)) for shape in shapes]


def _format(data: bytes) -> str:
    if not data.strip():
        raise file_error("empty", "the file is empty", f"send one of {', '.join(FORMATS)}")
    if is_zip(data):
        return "zip"
    if data[:4] == esri.MAGIC:
        return "shp"
    start = _start(data)
    if start in ("{", "[", "\x1e"):
        return "geojson"
    if start == "<":
        root = parse(data)
        if local_name(root) == "gpx":
            return "gpx"
        return "gml" if local_name(root) != "kml" and is_gml(root) else "kml"
    text = _text(data, Notes())
    if text.lstrip("\ufeff \r\n").startswith("QGC WPL") or is_point_list(text):
        return "mission"
    if is_wkt(text):
        return "wkt"
    if is_table(text):
        return "csv"
    if all(form.search(text) for form in _OPENAIR):
        raise file_error(
            "openair",
            "the file is airspace in OpenAIR's format, which is not read",
            "turn it into KML or GeoJSON first, e.g. with AirspaceConverter, or take the same airspace as "
            "GeoJSON from openAIP",
        )
    raise file_error("unknown-format", "the file is of no known format", f"send one of {', '.join(FORMATS)}")


def _start(data: bytes) -> str:
    """The first character that is no blank."""
    head = data[:2000]
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = head[: len(head) // 2 * 2].decode("utf-16", "replace")
    else:
        # UTF-16 without its mark, too
        text = head.replace(b"\x00", b"").decode("utf-8-sig", "replace")
    return text.lstrip(" \t\r\n\ufeff")[:1]


def _text(data: bytes, notes: Notes) -> str:
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", "replace")
    if b"\x00" in data:
        raise file_error(
            "unknown-format", "the file is of no known format", f"send one of {', '.join(FORMATS)}"
        )
    codec = guessed(data)
    if codec != "utf-8":
        notes.append(f"the text names no code page, is no UTF-8, and is read as {codec}")
    return data.decode(codec, "replace").removeprefix("\ufeff")


def _shapes(
    form: str, data: bytes, crs: str | None, companions: Mapping[str, bytes], notes: Notes
) -> tuple[str, list[Shape]]:
    """The format that it is in the end, and the shapes."""
    match form:
        case "kml":
            return form, kml.read_kml(data, notes)
        case "gpx":
            return form, gpx.read_gpx(data, notes)
        case "gml":
            return form, gml.read_gml(data, crs, notes)
        case "shp":
            return form, esri.read_shapefile(data, companions, crs, notes)
        case "geojson" | "geojsonl" | "esrijson":
            return read_json_file(data, crs, notes)
        case "wkt":
            return form, read_wkt(_text(data, notes), crs, notes)
        case "csv":
            return form, read_table(_text(data, notes), crs, notes)
        case "mission":
            return form, shapes_of_mission(data, notes)
    raise file_error(
        "unknown-format", f"there is no format {form[:40]!r}", f"use one of {', '.join(FORMATS)}"
    )
