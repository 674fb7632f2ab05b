"""Region files of other programs as features of a scenario, with the services' own errors."""

from __future__ import annotations

from collections.abc import Mapping

from app.imports import FORMATS, Imported, ImportOptions, RegionFileError, import_regions
from app.services.errors import RefusedError

__all__ = ["FORMATS", "FORMAT_OF_MEDIA_TYPE", "ImportOptions", "Imported", "import_file"]

#: Formats by media type; other types, and none, leave the choice to the content.
FORMAT_OF_MEDIA_TYPE = {
    "application/vnd.google-earth.kml+xml": "kml",
    "application/vnd.google-earth.kmz": "kmz",
    "application/gpx+xml": "gpx",
    "application/geo+json": "geojson",
}


def import_file(
    data: bytes,
    options: ImportOptions,
    form: str | None = None,
    companions: Mapping[str, bytes] | None = None,
) -> Imported:
    """The features of a region file; see :func:`app.imports.import_regions`.

    Raises
    ------
    RefusedError
        With a finding for everything that is wrong.
    """
    try:
        return import_regions(data, options, form, companions)
    except RegionFileError as error:
        raise RefusedError(str(error), error.findings) from error
