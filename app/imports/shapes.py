"""What every region file comes down to: named polygons, lines and points in WGS 84."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

LonLat = tuple[float, float]
Rings = tuple[tuple[LonLat, ...], ...]

#: More is no drawing of regions, and would only slow everything down.
MAX_POSITIONS = 200_000
MAX_SHAPES = 5_000


@dataclass(frozen=True, slots=True)
class Shape:
    """One drawn thing.

    Parameters
    ----------
    kind
        ``polygon``, ``line`` or ``point``.
    parts
        Of a polygon: one or more polygons, each an outer ring and its holes. Of a line or point: one part of
        one tuple of positions.
    name
        As in the file; empty where there is none.
    folders
        Names of the folders it lies in, outermost first.
    properties
        Further values of the file by name.
    """

    kind: Literal["polygon", "line", "point"]
    parts: tuple[Rings, ...]
    name: str = ""
    folders: tuple[str, ...] = ()
    properties: Mapping[str, str] = field(default_factory=dict)

    @property
    def positions(self) -> int:
        """How many positions it has."""
        return sum(len(ring) for part in self.parts for ring in part)


def line_of(positions: tuple[LonLat, ...], name: str, folders: tuple[str, ...] = ()) -> Shape:
    """A line; one position alone makes a point."""
    kind: Literal["line", "point"] = "line" if len(positions) > 1 else "point"
    return Shape(kind, ((positions,),), name, folders)
