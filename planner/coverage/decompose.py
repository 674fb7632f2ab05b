"""Ways to divide a region that is not convex: at its reflex corners, round its holes, at a corridor's bends.

Each way is a set of pieces that together are the region. Pieces reach a metre over their cuts, so that no
rounding leaves a gap between their footprints.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.merge import polygons_of

Floats = NDArray[np.float64]

#: How far a piece reaches over its cut.
OVERLAP_M = 1.0
#: Corners and holes tried, the most telling first.
MOST_CORNERS = 5
MOST_HOLES = 3
#: Outlines are thinned by this fraction of √area before their corners are looked at.
THINNING = 0.01
#: A piece smaller than this fraction of the whole is not worth a pass.
LEAST_PIECE = 0.002
#: A bend of a corridor's axis that turns less is none.
LEAST_BEND_RAD = math.radians(10.0)
#: Corners that stick in less than this are none.
LEAST_REFLEX_RAD = math.radians(10.0)

#: Area over that of the convex hull, above which there is nothing to gain.
NEARLY_CONVEX = 0.93


def is_plain(area: Polygon) -> bool:
    """Whether a shape is so nearly convex that dividing it gains nothing."""
    return not area.interiors and area.area >= NEARLY_CONVEX * area.convex_hull.area


def cuts(area: Polygon) -> Iterator[tuple[Polygon, ...]]:
    """Divisions of a shape: along either edge of a reflex corner and its bisector, and beside holes."""
    for chord in _corner_chords(area):
        pieces = divide(area, [chord])
        if pieces is not None:
            yield pieces
    holes = sorted((Polygon(ring) for ring in area.interiors), key=lambda hole: -hole.area)
    for hole in holes[:MOST_HOLES]:
        for lines in _beside(area, hole):
            pieces = divide(area, lines)
            if pieces is not None:
                yield pieces


def legs(area: Polygon, axis: LineString) -> tuple[Polygon, ...] | None:
    """A corridor cut across at each bend of its axis, in the axis's order; None where it has none."""
    thin = np.asarray(axis.simplify(THINNING * math.sqrt(area.area)).coords)[:, :2]
    ahead = np.diff(thin, axis=0)
    ahead /= np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
    chords = []
    for place, before, after in zip(thin[1:-1], ahead[:-1], ahead[1:], strict=True):
        turn_rad = math.atan2(before[0] * after[1] - before[1] * after[0], float(before @ after))
        if abs(turn_rad) < LEAST_BEND_RAD:
            continue
        across = np.array([-(before + after)[1], (before + after)[0]])
        if np.hypot(*across) < 1e-6:
            across = before
        chord = _chord(area, place, across)
        if chord is not None:
            chords.append(chord)
    pieces = divide(area, chords) if chords else None
    if pieces is None:
        return None
    return tuple(sorted(pieces, key=lambda piece: axis.project(piece.centroid)))


def divide(area: Polygon, chords: list[LineString]) -> tuple[Polygon, ...] | None:
    """The pieces between chords, each with its overlap; None where that gives no two or a sliver."""
    noded = shapely.union_all([area.boundary, *chords])
    faces = [
        face
        for face in shapely.get_parts(shapely.polygonize([noded]))
        if area.contains(face.representative_point())
    ]
    if len(faces) < 2 or min(face.area for face in faces) < LEAST_PIECE * area.area:
        return None
    if abs(sum(face.area for face in faces) - area.area) > 1e-6 * area.area:
        return None
    return tuple(_with_overlap(area, face) for face in faces)


def _with_overlap(area: Polygon, face: Polygon) -> Polygon:
    wide = shapely.make_valid(face.buffer(OVERLAP_M, join_style="mitre"))
    try:
        # On a grid: without one the nearly parallel edges of outline and buffer can defeat the overlay.
        grown: BaseGeometry = shapely.intersection(area, wide, grid_size=1e-6)
    except shapely.GEOSException:
        # A spike of the outline thinner than the grid defeats it all the same. Pieces without an overlap
        # still share their edge.
        return face
    for part in shapely.get_parts(grown):
        if isinstance(part, Polygon) and part.buffer(1e-5).covers(face):
            return part
    return face


def _corner_chords(area: Polygon) -> Iterator[LineString]:
    """Chords from the sharpest reflex corners: on along either edge, and halfway between."""
    thin = shapely.simplify(area, THINNING * math.sqrt(area.area))
    ring = np.asarray(shapely.geometry.polygon.orient(thin).exterior.coords)[:-1, :2]
    before = ring - np.roll(ring, 1, axis=0)
    after = np.roll(ring, -1, axis=0) - ring
    turn_rad = np.arctan2(
        before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1)
    )
    reach_m = np.minimum(np.hypot(*before.T), np.hypot(*after.T))
    telling = np.where(turn_rad < -LEAST_REFLEX_RAD, -turn_rad * reach_m, 0.0)
    for corner in np.argsort(-telling, kind="stable")[:MOST_CORNERS]:
        if telling[corner] <= 0.0:
            return
        along = before[corner] / np.hypot(*before[corner])
        against = -after[corner] / np.hypot(*after[corner])
        for direction in (along, against, along + against):
            if np.hypot(*direction) < 1e-6:
                continue
            chord = _chord(area, ring[corner], direction, both=False)
            if chord is not None:
                yield chord


def _chord(area: Polygon, place: Floats, direction: Floats, *, both: bool = True) -> LineString | None:
    """The part of a line through a place, or of a ray from it, that runs inside from there to the outline."""
    unit = direction / np.hypot(*direction)
    reach_m = 2.0 * area.length
    ray = LineString([place - (reach_m if both else 0.0) * unit, place + reach_m * unit])
    inside = [
        part
        for part in shapely.get_parts(shapely.intersection(area, ray, grid_size=1e-6))
        if part.length > OVERLAP_M
    ]
    touching = [part for part in inside if part.distance(shapely.Point(place)) < 1e-6]
    if not touching:
        return None
    longest = max(touching, key=lambda part: float(part.length))
    ends = np.asarray(longest.coords)[[0, -1], :2]
    ahead = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
    # A little beyond the outline, so that rounding cannot leave the cut short of it.
    first = ends[0] - 1e-3 * ahead if both else place
    return LineString([first, ends[1] + 1e-3 * ahead])


def _beside(area: Polygon, hole: Polygon) -> Iterator[list[LineString]]:
    """Pairs of parallel lines that touch a hole from either side, along and across the shape's main axis."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(area))[:3]
    points = np.asarray(hole.exterior.coords)[:, :2]
    centre = points.mean(axis=0)
    for edge in np.diff(corners, axis=0):
        unit = edge / np.hypot(*edge)
        normal = np.array([-unit[1], unit[0]])
        offsets_m = (points - centre) @ normal
        lines = []
        for offset_m in (float(offsets_m.min()), float(offsets_m.max())):
            at = centre + offset_m * normal
            reach_m = area.length
            lines.append(LineString([at - reach_m * unit, at + reach_m * unit]))
        yield lines


def merged(pieces: tuple[Polygon, ...]) -> Polygon | None:
    """Neighbouring pieces as one again; None where they do not touch."""
    together = polygons_of(shapely.union_all(list(pieces), grid_size=1e-6))
    return together[0] if len(together) == 1 else None
