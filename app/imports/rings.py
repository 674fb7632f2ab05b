"""Rings of one drawn thing by polygon: which lies in which says what is a hole, whatever way they run."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import Polygon, STRtree

from app.imports.errors import file_error
from app.imports.shapes import LonLat, Rings

Ring = tuple[LonLat, ...]

#: Pairs of rings, one box in the other, that are looked at; rings side by side have none.
MAX_PAIRS = 200_000
#: Of one drawn thing.
MAX_RINGS = 20_000


def encloses(ring: Ring) -> bool:
    """Whether it can be the ring of a polygon: three corners, all of them numbers."""
    return len(set(ring)) > 2 and all(math.isfinite(x) and math.isfinite(y) for x, y in ring)


def grouped(rings: Sequence[Ring]) -> tuple[Rings, ...]:
    """Polygons, each an outer ring and its holes, from rings in any order and direction.

    A ring in an even number of others is an outer one, in an odd number a hole of the smallest about it.
    Rings that cross each other enclose side by side; of rings drawn twice one counts.

    Raises
    ------
    RegionFileError
        Rule ``too-many-rings``, and ``rings-nested`` where too many of them lie within each other.
    """
    if len(rings) > MAX_RINGS:
        raise file_error(
            "too-many-rings",
            f"a shape has {len(rings)} rings, {MAX_RINGS} at most are read",
            "export it as several shapes",
        )
    if len(rings) < 2:
        return tuple((ring,) for ring in rings)
    whole = [index for index, ring in enumerate(rings) if encloses(ring)]
    polygons = np.array([Polygon(rings[index]) for index in whole], dtype=object)
    parent, depth, twice = _nested(polygons)
    holes: dict[int, list[Ring]] = {i: [] for i in range(len(whole)) if depth[i] % 2 == 0 and not twice[i]}
    for i in range(len(whole)):
        if depth[i] % 2 == 1 and not twice[i]:
            holes[int(parent[i])].append(rings[whole[i]])
    found = [(rings[whole[i]], *inner) for i, inner in holes.items()]
    # what encloses nothing is no hole; as a ring of its own it is found and told of
    enclosing = set(whole)
    found += [(ring,) for index, ring in enumerate(rings) if index not in enclosing]
    return tuple(found)


def _nested(
    polygons: NDArray[np.object_],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    """The smallest ring about each (-1: none), how many are about it, and whether it stands there already."""
    count = len(polygons)
    parent = np.full(count, -1)
    depth = np.zeros(count, dtype=np.int64)
    twice = np.zeros(count, dtype=np.bool_)
    if count == 0:
        return parent, depth, twice
    sound = shapely.is_valid(polygons)
    area = shapely.area(polygons)
    inner, outer = _boxes_within(polygons, sound)
    shapely.prepare(polygons)
    lies = shapely.covers(polygons[outer], polygons[inner])
    inner, outer = inner[lies], outer[lies]
    same = (area[inner] == area[outer]) & shapely.equals(polygons[inner], polygons[outer])
    twice[inner[same & (outer < inner)]] = True
    # a ring drawn twice is about nothing
    proper = ~same & ~twice[outer]
    inner, outer = inner[proper], outer[proper]
    np.add.at(depth, inner, 1)
    order = np.argsort(-area[outer], kind="stable")
    # the smallest is written last
    parent[inner[order]] = outer[order]
    return parent, depth, twice


def _boxes_within(
    polygons: NDArray[np.object_], sound: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of sound rings of which the box of the first lies in the box of the second."""
    tree = STRtree(polygons)
    boxes = shapely.bounds(polygons)
    inner: list[NDArray[np.int64]] = []
    outer: list[NDArray[np.int64]] = []
    left = MAX_PAIRS
    start, count = 0, 1
    while start < len(polygons):
        # Few at first: each of many that lie in each other has as many pairs as there are rings.
        some = np.arange(start, min(start + count, len(polygons)))
        start, count = start + count, min(2 * count, 512)
        a, b = tree.query(shapely.box(*boxes[some].T))
        a = some[a]
        within = (a != b) & sound[a] & sound[b]
        within &= (boxes[a, :2] >= boxes[b, :2]).all(axis=1) & (boxes[a, 2:] <= boxes[b, 2:]).all(axis=1)
        a, b = a[within], b[within]
        left -= len(a)
        if left < 0:
            raise file_error(
                "rings-nested",
                "a shape has too many rings within each other",
                "export it as several shapes, or with fewer holes",
            )
        inner.append(a)
        outer.append(b)
    return np.concatenate(inner), np.concatenate(outer)
