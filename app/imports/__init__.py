"""Region files of other programs (KML, KMZ, GPX, shapefiles, plain GeoJSON) as features of a scenario."""

from __future__ import annotations

from app.imports.errors import RegionFileError
from app.imports.features import Account
from app.imports.options import ImportOptions, RoleChoice, read_choices
from app.imports.read import FORMATS, Imported, import_regions

__all__ = [
    "FORMATS",
    "Account",
    "ImportOptions",
    "Imported",
    "RegionFileError",
    "RoleChoice",
    "import_regions",
    "read_choices",
]
