"""What is told beside the shapes: notes, and single shapes that cannot be read."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from app.imports.errors import RegionFileError
from planner.errors import Finding

#: Faults of one shape, which leave the others as they are.
_OF_ONE = frozenset(
    (
        *("kml-coordinates", "kml-polygon", "gpx-point", "geojson", "esri-json", "gml-geometry", "wkt"),
        *("table-place", "circle", "rings-nested", "too-many-rings", "shapefile-kind", "survey"),
    )
)


class Notes(list[str]):
    """Notes in words; ``faults`` are findings of shapes left out, ``members`` what belongs to all shapes."""

    def __init__(self) -> None:
        super().__init__()
        self.faults: list[Finding] = []
        self.members: dict[str, Any] = {}

    @contextmanager
    def one_shape(self, name: str) -> Iterator[None]:
        """Keep a fault of one shape from refusing the file; it is found by that name."""
        try:
            yield
        except RegionFileError as error:
            if not all(finding.rule in _OF_ONE for finding in error.findings):
                raise
            for found in error.findings:
                feature = name or found.feature
                self.faults.append(Finding(feature, found.rule, found.message, found.fix))
