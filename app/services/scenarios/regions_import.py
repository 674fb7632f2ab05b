"""Region files of other programs as features of a scenario, with the services' own errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from app.imports import (
    FORMATS,
    Account,
    Imported,
    ImportOptions,
    RegionFileError,
    import_regions,
    read_choices,
)
from app.services.errors import RefusedError

__all__ = [
    "FORMATS",
    "FORMAT_OF_MEDIA_TYPE",
    "Account",
    "ImportOptions",
    "Imported",
    "import_file",
    "words_of",
]

_MOST_NAMED = 8

#: Formats by media type; other types, and none, leave the choice to the content.
FORMAT_OF_MEDIA_TYPE = {
    "application/vnd.google-earth.kml+xml": "kml",
    "application/vnd.google-earth.kmz": "kmz",
    "application/gpx+xml": "gpx",
    "application/gml+xml": "gml",
    "application/geo+json": "geojson",
    "application/geo+json-seq": "geojsonl",
    "text/csv": "csv",
}


def import_file(
    data: bytes,
    options: ImportOptions,
    form: str | None = None,
    companions: Mapping[str, bytes] | None = None,
    roles: Sequence[str] = (),
) -> Imported:
    """The features of a region file; see :func:`app.imports.import_regions`.

    Parameters
    ----------
    roles
        Choices of roles for single shapes and folders, ``NFZ north=roi``.

    Raises
    ------
    RefusedError
        With a finding for everything that is wrong.
    """
    try:
        return import_regions(data, replace(options, roles=read_choices(roles)), form, companions)
    except RegionFileError as error:
        raise RefusedError(str(error), error.findings) from error


def words_of(imported: Imported) -> list[str]:
    """What every shape became and why, in lines: shapes alike share one."""
    alike: dict[tuple[str, str, bool], list[Account]] = {}
    for account in imported.shapes:
        alike.setdefault((account.role, account.why, account.in_doubt), []).append(account)
    lines: list[str] = []
    for (role, why, in_doubt), accounts in alike.items():
        names = [f"#{account.number} {account.name}".rstrip() for account in accounts[:_MOST_NAMED]]
        if len(accounts) > _MOST_NAMED:
            names.append(f"{len(accounts) - _MOST_NAMED} more")
        became = "left out" if role == "none" else role
        doubt = ", IN DOUBT: it cannot be planned before its role is chosen" if in_doubt else ""
        lines.append(f"{', '.join(names)}: {became} ({why}){doubt}")
    return lines
