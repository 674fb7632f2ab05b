"""A plan as KMZ: the KML document, packed."""

from __future__ import annotations

import io
import zipfile

from mavlink.formats.kml import write_kml
from planner.plan import Plan

#: The earliest date an archive can hold: the same plan gives the same bytes.
_NO_DATE = (1980, 1, 1, 0, 0, 0)


def write_kmz(plan: Plan, vehicle: str | None = None) -> bytes:
    """The document of :func:`mavlink.formats.kml.write_kml` as ``doc.kml`` in an archive.

    Raises
    ------
    ValueError
        Where the plan has no such vehicle.
    """
    buffer = io.BytesIO()
    entry = zipfile.ZipInfo("doc.kml", _NO_DATE)
    entry.compress_type = zipfile.ZIP_DEFLATED
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr(entry, write_kml(plan, vehicle))
    return buffer.getvalue()
