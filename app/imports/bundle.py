"""Archives with files of regions: every one of them is read, each layer by its path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import PurePosixPath

from app.imports import esri, kml
from app.imports.archive import unpack
from app.imports.encodings import guessed
from app.imports.errors import RegionFileError, file_error
from app.imports.notes import Notes
from app.imports.shapes import Shape
from planner.errors import Finding

#: Files that are read by themselves.
SINGLE = (
    ".gpx", ".geojson", ".json", ".geojsonl", ".ndjson", ".jsonl", ".wkt", ".csv", ".tsv", ".gml",
    ".fen", ".fence", ".rally", ".ral", ".waypoints",
)  # fmt: skip
_DOCUMENTS = (".kml", ".wpml")
_SHAPEFILES = (".shp", ".prj", ".dbf", ".cpg")
_MAX_INNER = 50

ReadOne = Callable[[bytes, str], list[Shape]]


def read_bundle(
    data: bytes,
    crs: str | None,
    notes: Notes,
    read_one: ReadOne,
    form: str | None = None,
    *,
    nested: bool = False,
) -> tuple[str, list[Shape]]:
    """The shapes of every region file in an archive, and what kind of archive it is.

    Parameters
    ----------
    read_one
        Reads the content of a file of another format; the second argument is its name.
    form
        ``kmz`` or ``shapefile`` where such a one is expected; None for any.
    nested
        Whether it lies in another; archives in one that does are not opened.

    Raises
    ------
    RegionFileError
        Where a file in it cannot be read, or none is found.
    """
    members = _members(data)
    documents = {name: content for name, content in members.items() if _ending(name) in _DOCUMENTS}
    layers = _layers(members)
    inner = {name: content for name, content in members.items() if _ending(name) == ".kmz"}
    packed = {} if nested else {name: content for name, content in members.items() if _ending(name) == ".zip"}
    single = {name: content for name, content in members.items() if _ending(name) in SINGLE}
    if form == "kmz" and not documents and not inner:
        raise file_error("no-kml", "the archive holds no .kml file", "pack a doc.kml")
    if (form == "shapefile" and not layers) or not (documents or layers or inner or packed or single):
        raise file_error(
            "no-shapefile",
            "the archive holds no .shp file and no other of regions",
            "pack .shp, .prj and .dbf",
        )
    archives = len(inner) + len(packed)
    if archives > _MAX_INNER:
        raise file_error("archive-too-large", f"the archive holds {archives} archives", "unpack some")
    shapes = kml.read_documents(documents, notes) if documents else []
    for name, content in inner.items():
        shapes += _below(name, _named(name, partial(kml.read_kmz, content, notes)))
    for stem, files in layers.items():
        shapes += _named(
            stem,
            partial(esri.read_shapefile, files[".shp"], files, crs, notes, stem),
        )
    for name, content in single.items():
        shapes += _named(name, partial(read_one, content, name))
    for name, content in packed.items():
        shapes += _below(name, _named(name, partial(_of_archive, content, crs, notes, read_one)))
    if single or packed or (layers and (documents or inner)):
        return "zip", shapes
    return ("shapefile" if layers else "kmz"), shapes


def _below(name: str, shapes: list[Shape]) -> list[Shape]:
    """The shapes of an archive in an archive, its path their folders."""
    path = PurePosixPath(name)
    return [replace(shape, folders=(*path.parent.parts, path.stem, *shape.folders)) for shape in shapes]


def _of_archive(content: bytes, crs: str | None, notes: Notes, read_one: ReadOne) -> list[Shape]:
    """The shapes of an archive in an archive."""
    return read_bundle(content, crs, notes, read_one, nested=True)[1]


def _members(data: bytes) -> dict[str, bytes]:
    """The files that are somebody's, by path; the path's words in whatever code page."""
    found = unpack(data, (*_DOCUMENTS, ".kmz", ".zip", *_SHAPEFILES, *SINGLE))
    mine: dict[str, bytes] = {}
    for name, content in found.items():
        path = PurePosixPath(_readable(name).replace("\\", "/"))
        # what macOS keeps beside the files
        if "__MACOSX" not in path.parts and not path.name.startswith("._"):
            mine[str(path)] = content
    return mine


def _readable(name: str) -> str:
    """A path that an archive without UTF-8 names gives, which is read as code page 437."""
    if name.isascii():
        return name
    try:
        raw = name.encode("cp437")
    except UnicodeEncodeError:
        return name
    codec = guessed(raw)
    return name if codec == "cp1252" else raw.decode(codec, "replace")


def _ending(name: str) -> str:
    return PurePosixPath(name).suffix.lower()


def _layers(members: dict[str, bytes]) -> dict[str, dict[str, bytes]]:
    """Shapefiles by path without ending; names that differ in case belong together."""
    by_stem: dict[str, dict[str, bytes]] = {}
    named: dict[str, str] = {}
    for name, content in members.items():
        if _ending(name) in _SHAPEFILES:
            stem = str(PurePosixPath(name).with_suffix(""))
            files = by_stem.setdefault(stem.casefold(), {})
            if _ending(name) in files:
                raise file_error(
                    "archive-twice",
                    f"the archive holds two files {name[:80]!r}, and which is meant is not known",
                    "pack each file once",
                )
            files[_ending(name)] = content
            if _ending(name) == ".shp":
                named[stem.casefold()] = stem
    return {named[stem]: files for stem, files in by_stem.items() if ".shp" in files}


def _named(name: str, read: Callable[[], list[Shape]]) -> list[Shape]:
    """What a file in the archive holds; what is wrong with it names it."""
    try:
        return read()
    except RegionFileError as error:
        findings = tuple(
            Finding(name, finding.rule, finding.message, finding.fix)
            if finding.feature == "file"
            else finding
            for finding in error.findings
        )
        raise RegionFileError(f"{name}: {error}", findings) from error
