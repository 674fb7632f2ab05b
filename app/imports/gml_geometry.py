"""Geometry of GML: rings, lines and places, by the elements of versions 2 and 3."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from app.imports.circles import outer_circle
from app.imports.errors import RegionFileError, file_error
from app.imports.rings import grouped
from app.imports.shapes import LonLat, Rings, Shape
from app.imports.xml import child_text, children, local_name

_POLYGONS = ("Polygon", "PolygonPatch", "Rectangle", "Triangle")
_LINES = ("LineString", "LinearRing", "Curve", "Ring")
_MANY = (
    "Surface", "OrientableSurface", "PolyhedralSurface", "MultiPolygon", "MultiSurface", "CompositeSurface",
    "MultiLineString", "MultiCurve", "CompositeCurve", "MultiPoint", "MultiGeometry", "GeometricComplex",
)  # fmt: skip
GEOMETRIES = frozenset(
    (*_POLYGONS, *_LINES, *_MANY, "Point", "ElevatedPoint", "ElevatedSurface", "ElevatedCurve")
)
_METRES = {"m": 1.0, "km": 1000.0, "ft": 0.3048, "nm": 1852.0, "nmi": 1852.0, "[nmi_i]": 1852.0, "": 1.0}
_MAX_DEPTH = 30


@dataclass(frozen=True, slots=True)
class Positions:
    """How coordinates are written: numbers a place, the order, and whose they are."""

    dimension: int
    north_first: bool
    name: str

    def error(self, message: str) -> RegionFileError:
        """An error of this geometry."""
        return file_error("gml-geometry", f"{self.name or 'a geometry'} {message}", "export simple features")

    def of_numbers(self, words: list[str], dimension: int) -> tuple[LonLat, ...]:
        """Places, east first."""
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            raise self.error(f"has the coordinates {' '.join(words)[:40]!r}") from None
        if not numbers or len(numbers) % dimension:
            raise self.error(f"has {len(numbers)} numbers of {dimension} to a place")
        east, north = (1, 0) if self.north_first else (0, 1)
        return tuple((numbers[i + east], numbers[i + north]) for i in range(0, len(numbers), dimension))


def shapes_in(geometry: Element, positions: Positions, depth: int = 0) -> list[Shape]:
    """The shapes of a geometry element; polygons of one surface are one shape."""
    polygons: list[Rings] = []
    others: list[Shape] = []
    for element in _simple(geometry, positions, depth):
        kind = local_name(element)
        if kind in _POLYGONS:
            polygons += _polygon(element, positions)
        elif kind == "LinearRing":
            polygons += grouped([_line(element, positions)])
        elif kind in _LINES:
            others.append(_line_or_circle(element, positions))
        else:
            others.append(Shape("point", ((_places(element, positions)[:1],),)))
    return [*([Shape("polygon", tuple(polygons))] if polygons else []), *others]


def _simple(element: Element, positions: Positions, depth: int) -> Iterator[Element]:
    """Polygons, lines and points, out of whatever holds them."""
    if depth > _MAX_DEPTH:
        raise positions.error("is nested too deeply")
    kind = local_name(element)
    if kind in (*_POLYGONS, *_LINES, "Point", "ElevatedPoint"):
        yield element
        return
    for child in element:
        # surfaceMember, patches and whatever else they are called
        if local_name(child) not in ("boundedBy", "metaDataProperty"):
            yield from _simple(child, positions, depth + 1)


def _polygon(polygon: Element, positions: Positions) -> tuple[Rings, ...]:
    outer = [_ring(boundary, positions) for boundary in children(polygon, "exterior", "outerBoundaryIs")]
    if len(outer) != 1:
        raise positions.error(f"has a polygon of {len(outer)} outer rings")
    inner = [_ring(boundary, positions) for boundary in children(polygon, "interior", "innerBoundaryIs")]
    return grouped([*outer, *inner])


def _ring(boundary: Element, positions: Positions) -> tuple[LonLat, ...]:
    places: list[LonLat] = []
    for element in boundary:
        if local_name(element) in _LINES:
            places += _line(element, positions)
    if not places:
        raise positions.error("has a ring without places")
    return tuple(places)


def _line_or_circle(element: Element, positions: Positions) -> Shape:
    places = _line(element, positions)
    if any(local_name(one).startswith("Circle") for one in element.iter()):
        return Shape("polygon", ((places,),))
    return Shape("line" if len(places) > 1 else "point", ((places,),))


def _line(element: Element, positions: Positions) -> tuple[LonLat, ...]:
    """The places of a line, a ring, or a curve of segments."""
    segments = list(_segments(element))
    if not segments:
        return _places(element, positions)
    places: list[LonLat] = []
    for segment in segments:
        kind = local_name(segment)
        if kind == "CircleByCenterPoint":
            more = outer_circle(_places(segment, positions)[0], _radius_m(segment, positions))
        elif kind.startswith(("Arc", "Circle", "Bezier", "BSpline", "Clothoid", "Cubic")):
            raise positions.error(f"has a curve of the kind {kind}")
        else:
            more = _places(segment, positions)
        places += more[1:] if places and places[-1] == more[0] else more
    return tuple(places)


def _segments(element: Element) -> Iterator[Element]:
    for holder in children(element, "segments", "curveMember", "curveMembers", "baseCurve"):
        for child in holder:
            inner = list(_segments(child))
            if inner:
                yield from inner
            else:
                yield child


def _radius_m(segment: Element, positions: Positions) -> float:
    for radius in children(segment, "radius"):
        unit = radius.get("uom", "").rpartition(":")[2].rpartition("/")[2].lower()
        try:
            value = float(radius.text or "")
        except ValueError:
            value = math.nan
        if unit in _METRES and math.isfinite(value):
            return value * _METRES[unit]
    raise positions.error("has a circle without a radius in a known unit")


def _places(element: Element, positions: Positions) -> tuple[LonLat, ...]:
    """Coordinates of an element, in any of the ways to write them."""
    places: list[LonLat] = []
    for child in element:
        kind = local_name(child)
        if kind in ("posList", "pos"):
            words = (child.text or "").split()
            places += positions.of_numbers(words, _dimension(child, element, words, positions))
        elif kind == "coordinates":
            places += _coordinates(child, positions)
        elif kind == "coord":
            words = [child_text(child, "X"), child_text(child, "Y")]
            places += positions.of_numbers(words, 2)
        elif kind in ("pointProperty", "pointMember"):
            for point in child:
                places += _places(point, positions)
    if not places:
        raise positions.error("has no coordinates")
    return tuple(places)


def _dimension(child: Element, element: Element, words: list[str], positions: Positions) -> int:
    said = child.get("srsDimension") or child.get("dimension") or element.get("srsDimension")
    if said in ("2", "3"):
        return int(said)
    if local_name(child) == "pos":
        return 3 if len(words) == 3 else 2
    return positions.dimension


def _coordinates(child: Element, positions: Positions) -> tuple[LonLat, ...]:
    """``x,y x,y``; the separators can be others."""
    between, within = child.get("ts") or " ", child.get("cs") or ","
    point = child.get("decimal") or "."
    text = (child.text or "").strip()
    tuples = text.split() if between == " " else [one for one in text.split(between) if one.strip()]
    places: list[LonLat] = []
    for one in tuples:
        words = one.strip().replace(point, ".").split(within) if point != within else []
        if not 2 <= len(words) <= 3:
            raise positions.error(f"has the coordinates {one[:40]!r}")
        places += positions.of_numbers(words, len(words))
    return tuple(places)
