"""Any region file: its format is found by its content."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import Any

from app.imports import esri, gpx, kml, plain
from app.imports.archive import is_zip
from app.imports.bundle import read_bundle
from app.imports.errors import file_error
from app.imports.features import Account, features
from app.imports.options import ImportOptions, check_options
from app.imports.shapes import Shape
from app.imports.xml import local_name, parse
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


FORMATS = ("kml", "kmz", "gpx", "shp", "shapefile", "zip", "geojson")


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
    notes: list[str] = []
    found, shapes = _read(data, form, options.crs, companions or {}, notes)
    made = features(shapes, options, notes)
    collection = {"type": "FeatureCollection", "features": made.features}
    return Imported(
        collection, found, tuple(made.accounts), tuple(made.findings), tuple(dict.fromkeys(notes))
    )


def _read(
    data: bytes, form: str | None, crs: str | None, companions: Mapping[str, bytes], notes: list[str]
) -> tuple[str, list[Shape]]:
    found = form or _format(data)
    if found in ("zip", "kmz", "shapefile"):
        wanted = None if form in (None, "zip") else form
        return read_bundle(data, crs, notes, lambda inner, name: _member(inner, name, crs, notes), wanted)
    return found, _shapes(found, data, crs, companions, notes)


def _member(data: bytes, name: str, crs: str | None, notes: list[str]) -> list[Shape]:
    """One file of an archive, its path its folders."""
    found = _format(data)
    if found == "zip":
        raise file_error("archive-nested", f"{name} is an archive within an archive", "unpack it")
    path = PurePosixPath(name)
    above = (*path.parent.parts, path.stem)
    return [
        replace(shape, folders=(*above, *shape.folders)) for shape in _shapes(found, data, crs, {}, notes)
    ]


def _format(data: bytes) -> str:
    if not data.strip():
        raise file_error("empty", "the file is empty", f"send one of {', '.join(FORMATS)}")
    if is_zip(data):
        return "zip"
    if data[:4] == esri.MAGIC:
        return "shp"
    start = data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1]
    if start in (b"{", b"["):
        return "geojson"
    if start == b"<" or data[:2] in (b"\xff\xfe", b"\xfe\xff", b"\x00<"):
        return "gpx" if local_name(parse(data)) == "gpx" else "kml"
    raise file_error(
        "unknown-format",
        "the file is of no known format",
        "send KML, KMZ, GPX, GeoJSON or a zipped shapefile",
    )


def _shapes(
    form: str, data: bytes, crs: str | None, companions: Mapping[str, bytes], notes: list[str]
) -> list[Shape]:
    match form:
        case "kml":
            return kml.read_kml(data, notes)
        case "gpx":
            return gpx.read_gpx(data, notes)
        case "shp":
            return esri.read_shapefile(data, companions, crs, notes)
        case "geojson":
            return plain.read_geojson(data, crs, notes)
    raise file_error(
        "unknown-format", f"there is no format {form[:40]!r}", f"use one of {', '.join(FORMATS)}"
    )
