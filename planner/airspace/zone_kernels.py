"""Compiled tests of straights and arcs against discs and polygons.

A *piece* is one row: side (0 straight, +1 left, -1 right), east_m, north_m and angle_rad of its start,
length_m, radius_m, centre east_m and north_m. Polygons are bags of edges (east0, north0, east1, north1) of
all rings, holes included; inside is where a ray crosses them an odd number of times.
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

TWO_PI = 2.0 * math.pi

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@njit(cache=True)
def position_on(piece: Array, along_m: float) -> tuple[float, float]:
    """Place a distance along a piece."""
    side, angle = piece[0], piece[3]
    if side == 0.0:
        return piece[1] + along_m * math.cos(angle), piece[2] + along_m * math.sin(angle)
    turned = angle + side * along_m / piece[5]
    return piece[6] + side * piece[5] * math.sin(turned), piece[7] - side * piece[5] * math.cos(turned)


@njit(cache=True)
def _along_arc(piece: Array, polar_rad: float) -> float:
    """Distance along the arc, within one turn, at which the piece is seen from its centre at an angle."""
    side = piece[0]
    turn = side * (polar_rad + side * 0.5 * math.pi - piece[3])
    return float(piece[5] * (turn - TWO_PI * math.floor(turn / TWO_PI)))


@njit(cache=True)
def nearest_along(piece: Array, east_m: float, north_m: float) -> tuple[float, float]:
    """Distance from a place to the nearest point of a piece, and how far along the piece that point lies."""
    if piece[0] == 0.0:
        cosine, sine = math.cos(piece[3]), math.sin(piece[3])
        along = (east_m - piece[1]) * cosine + (north_m - piece[2]) * sine
        along = min(max(along, 0.0), piece[4])
        return math.hypot(piece[1] + along * cosine - east_m, piece[2] + along * sine - north_m), along
    offset_e, offset_n = east_m - piece[6], north_m - piece[7]
    along = _along_arc(piece, math.atan2(offset_n, offset_e))
    if along <= piece[4]:
        return abs(math.hypot(offset_e, offset_n) - piece[5]), along
    end_e, end_n = position_on(piece, piece[4])
    at_start = math.hypot(piece[1] - east_m, piece[2] - north_m)
    at_end = math.hypot(end_e - east_m, end_n - north_m)
    return (at_start, 0.0) if at_start <= at_end else (at_end, piece[4])


@njit(cache=True)
def distances_from(pieces: Array, places: Array) -> Array:
    """Least distance of a line from each of many places (N, 2 or more: east_m, north_m); float64 (N,)."""
    out = np.full(places.shape[0], np.inf)
    for s in range(pieces.shape[0]):
        for k in range(places.shape[0]):
            out[k] = min(out[k], nearest_along(pieces[s], places[k, 0], places[k, 1])[0])
    return out


@njit(cache=True)
def crossings(piece: Array, edge: Array, out: Array, count: int) -> int:
    """Append to ``out`` the distances along a piece at which it meets an edge; returns the new count."""
    ee, en = edge[2] - edge[0], edge[3] - edge[1]
    if piece[0] == 0.0:
        de, dn = math.cos(piece[3]), math.sin(piece[3])
        determinant = de * en - dn * ee
        if determinant == 0.0:
            return count
        oe, on = edge[0] - piece[1], edge[1] - piece[2]
        along = (oe * en - on * ee) / determinant
        across = (oe * dn - on * de) / determinant
        if 0.0 <= across <= 1.0 and 0.0 <= along <= piece[4]:
            out[count] = along
            count += 1
        return count
    square = ee * ee + en * en
    if square == 0.0:
        return count
    oe, on = edge[0] - piece[6], edge[1] - piece[7]
    half = (oe * ee + on * en) / square
    root = half * half - (oe * oe + on * on - piece[5] * piece[5]) / square
    if root < 0.0:
        return count
    root = math.sqrt(root)
    for across in (-half - root, -half + root):
        if 0.0 <= across <= 1.0:
            along = _along_arc(piece, math.atan2(on + across * en, oe + across * ee))
            if along <= piece[4]:
                out[count] = along
                count += 1
    return count


@njit(cache=True)
def inside(edges: Array, first: int, last: int, east_m: float, north_m: float) -> bool:
    """Whether a place lies inside the rings ``edges[first:last]``."""
    odd = False
    for i in range(first, last):
        n0, n1 = edges[i, 1], edges[i, 3]
        if (n0 > north_m) != (n1 > north_m):
            at = edges[i, 0] + (north_m - n0) / (n1 - n0) * (edges[i, 2] - edges[i, 0])
            if at > east_m:
                odd = not odd
    return odd


@njit(cache=True)
def edge_distance(edges: Array, first: int, last: int, east_m: float, north_m: float) -> float:
    """Distance from a place to the nearest of ``edges[first:last]``."""
    best = np.inf
    for i in range(first, last):
        ee, en = edges[i, 2] - edges[i, 0], edges[i, 3] - edges[i, 1]
        oe, on = east_m - edges[i, 0], north_m - edges[i, 1]
        square = ee * ee + en * en
        share = 0.0 if square == 0.0 else min(max((oe * ee + on * en) / square, 0.0), 1.0)
        best = min(best, (oe - share * ee) ** 2 + (on - share * en) ** 2)
    return math.sqrt(best)


@njit(cache=True)
def _box(piece: Array) -> tuple[float, float, float, float]:
    """West, south, east, north of a box round a piece (for an arc, round its circle)."""
    if piece[0] != 0.0:
        r = piece[5]
        return piece[6] - r, piece[7] - r, piece[6] + r, piece[7] + r
    e, n = position_on(piece, piece[4])
    return min(piece[1], e), min(piece[2], n), max(piece[1], e), max(piece[2], n)


@njit(cache=True)
def polygon_depth(piece: Array, edges: Array, first: int, last: int, bad_inside: bool) -> tuple[float, float]:
    """How deep a piece goes into the rings ``edges[first:last]`` (or out of them), and where along.

    The piece is cut where it meets an edge; the parts on the wrong side are sampled for the deepest point.
    Depth 0 where no part is on the wrong side.
    """
    west, south, east, north = _box(piece)
    cuts = np.empty(2 * (last - first) + 2)
    cuts[0] = 0.0
    count = 1
    for i in range(first, last):
        if (
            max(edges[i, 0], edges[i, 2]) < west
            or min(edges[i, 0], edges[i, 2]) > east
            or max(edges[i, 1], edges[i, 3]) < south
            or min(edges[i, 1], edges[i, 3]) > north
        ):
            continue
        count = crossings(piece, edges[i], cuts, count)
    cuts[count] = piece[4]
    count += 1
    if count > 2:
        cuts[:count].sort()
    worst, worst_along = 0.0, 0.0
    for k in range(count - 1):
        a, b = cuts[k], cuts[k + 1]
        e, n = position_on(piece, 0.5 * (a + b))
        if inside(edges, first, last, e, n) != bad_inside:
            continue
        step = (b - a) / 32
        best, at = -1.0, a
        for m in range(33):
            e, n = position_on(piece, a + m * step)
            depth = edge_distance(edges, first, last, e, n)
            if depth > best:
                best, at = depth, a + m * step
        # The deepest point lies within a step of the deepest sample: halve towards it.
        while step > 1e-6 * (b - a):
            step *= 0.5
            for along in (max(a, at - step), min(b, at + step)):
                e, n = position_on(piece, along)
                depth = edge_distance(edges, first, last, e, n)
                if depth > best:
                    best, at = depth, along
        if best > worst:
            worst, worst_along = best, at
    return worst, worst_along


@njit(cache=True)
def depths(
    pieces: Array, discs: Array, edges: Array, offsets: Index, area_edges: Array, has_area: bool
) -> Array:
    """The deepest intrusion of a line into every zone.

    Returns float64, shape (K + P + 1, 3): depth_m, east_m, north_m for each disc, each polygon and the area
    (depth outside it).
    """
    n_discs, n_polygons = discs.shape[0], offsets.shape[0] - 1
    out = np.zeros((n_discs + n_polygons + 1, 3))
    for s in range(pieces.shape[0]):
        piece = pieces[s]
        for z in range(n_discs + n_polygons + 1):
            if z < n_discs:
                distance, along = nearest_along(piece, discs[z, 0], discs[z, 1])
                depth = discs[z, 2] - distance
            elif z < n_discs + n_polygons:
                first, last = offsets[z - n_discs], offsets[z - n_discs + 1]
                depth, along = polygon_depth(piece, edges, first, last, True)
            elif has_area:
                depth, along = polygon_depth(piece, area_edges, 0, area_edges.shape[0], False)
            else:
                continue
            if depth > out[z, 0]:
                out[z, 0] = depth
                out[z, 1], out[z, 2] = position_on(piece, along)
    return out


@njit(cache=True)
def is_clear(
    pieces: Array,
    discs: Array,
    edges: Array,
    offsets: Index,
    area_edges: Array,
    has_area: bool,
    touch_m: float,
) -> bool:
    """Whether a line goes nowhere deeper than ``touch_m`` into a disc or polygon or out of the area."""
    for s in range(pieces.shape[0]):
        piece = pieces[s]
        for k in range(discs.shape[0]):
            if discs[k, 2] - nearest_along(piece, discs[k, 0], discs[k, 1])[0] > touch_m:
                return False
        for p in range(offsets.shape[0] - 1):
            if polygon_depth(piece, edges, offsets[p], offsets[p + 1], True)[0] > touch_m:
                return False
        if has_area and polygon_depth(piece, area_edges, 0, area_edges.shape[0], False)[0] > touch_m:
            return False
    return True
