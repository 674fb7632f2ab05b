"""What every region file comes down to: named polygons, lines and points in WGS 84."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

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
    label
        Whether it is a point drawn with a polygon as one thing, to carry its name.
    wishes
        What the file asks of it as a region, by the contract's names.
    """

    kind: Literal["polygon", "line", "point"]
    parts: tuple[Rings, ...]
    name: str = ""
    folders: tuple[str, ...] = ()
    properties: Mapping[str, str] = field(default_factory=dict)
    label: bool = False
    wishes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def positions(self) -> int:
        """How many positions it has."""
        return sum(len(ring) for part in self.parts for ring in part)


def labelled(shapes: list[Shape]) -> list[Shape]:
    """The shapes of one drawn thing: beside polygons, its points are labels."""
    if not any(shape.kind == "polygon" for shape in shapes):
        return shapes
    return [replace(shape, label=shape.kind == "point") for shape in shapes]


def moved(shape: Shape, move: Callable[[list[LonLat]], list[LonLat]] | None) -> Shape:
    """The shape with every ring, line and place brought elsewhere."""
    if move is None:
        return shape
    parts = tuple(tuple(tuple(move(list(ring))) for ring in part) for part in shape.parts)
    return replace(shape, parts=parts)


def line_of(positions: tuple[LonLat, ...], name: str, folders: tuple[str, ...] = ()) -> Shape:
    """A line; one position alone makes a point."""
    kind: Literal["line", "point"] = "line" if len(positions) > 1 else "point"
    return Shape(kind, ((positions,),), name, folders)
