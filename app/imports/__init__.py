"""Region files of other programs (KML, KMZ, GPX, shapefiles, plain GeoJSON) as features of a scenario."""

from __future__ import annotations

from app.imports.errors import RegionFileError
from app.imports.features import Imported, ImportOptions
from app.imports.read import FORMATS, import_regions

__all__ = ["FORMATS", "ImportOptions", "Imported", "RegionFileError", "import_regions"]
