"""Where a flight can come to from its start: hard zones may lie all round it, the ground, or the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import shapely
from shapely.geometry import MultiPolygon, Point, Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.prepared import prep

from planner.airspace.airspace import Airspace, Level
from planner.airspace.zones import MITRE_LIMIT, TRANSIT_MARGIN_M, KeepOut, keep_out

Place = tuple[float, float]

#: Discs as polygons lie within them: what leads between two that touch is tried, not refused.
DISC_QUADRANT = 32
#: Without an area this much room is round all that is there.
ROUND_M = 100.0
#: Zones this near to a part of what is free are its walls.
WALL_M = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Reached:
    """What of the free space hangs together with the start; all of it where nobody can tell.

    Parameters
    ----------
    cut_off
        What of the ground is free, and no way leads to.
    end_off
        Whether none leads to the end.
    walls
        Names of the zones that lie between.
    free
        None where all of it is.
    """

    cut_off: BaseGeometry
    end_off: bool = False
    walls: tuple[str, ...] = ()
    free: BaseGeometry | None = None


ALL_OF_IT = Reached(Polygon())


def reached(
    airspace: Airspace, level: Level, ends: tuple[Place, Place], ground: Polygon | MultiPolygon
) -> Reached:
    """What a flight at a level can come to from a start, in lines of any curvature.

    One among the zones of that level, as one below them is, says nothing of where it leads; no more does such
    an end.

    Parameters
    ----------
    ends
        Start and end.
    """
    kept = keep_out(airspace, level, TRANSIT_MARGIN_M, soft=False)
    shapes = _shapes(kept)
    if not shapes:
        return ALL_OF_IT
    start, end = (Point(place) for place in ends)
    solid = shapely.union_all([shape for _, shape in shapes])
    whole: BaseGeometry | None = kept.area
    if whole is None:
        every = shapely.union_all([solid.envelope, ground.envelope, start, end])
        whole = box(*every.buffer(ROUND_M).bounds)
    parts = [part for part in shapely.get_parts(whole.difference(solid)) if isinstance(part, Polygon)]
    own, others = _part_at(start, parts), [part for part in parts if part.intersects(ground)]
    if own is None:
        return ALL_OF_IT
    ends_in = _part_at(end, parts)
    off = () if ends_in is None or ends_in is own else (ends_in,)
    others = [part for part in others if part is not own]
    beyond = shapely.union_all(off or others)
    if beyond.is_empty:
        return ALL_OF_IT
    near, far = prep(own.buffer(WALL_M)), prep(beyond.buffer(WALL_M))
    walls = [name for name, shape in shapes if near.intersects(shape) and far.intersects(shape)]
    # Of a wall of several layers none lies at both sides.
    walls = walls or [name for name, shape in shapes if far.intersects(shape)]
    cut_off = ground.intersection(shapely.union_all(others))
    return Reached(cut_off, bool(off), tuple(dict.fromkeys(walls)), own)


def _part_at(place: Point, parts: Sequence[Polygon]) -> Polygon | None:
    """That which a place lies in, or in the margin of; None where it lies in none."""
    own = min(parts, key=lambda part: float(part.distance(place)), default=None)
    return None if own is None or own.distance(place) > MITRE_LIMIT * TRANSIT_MARGIN_M else own


def _shapes(kept: KeepOut) -> list[tuple[str, BaseGeometry]]:
    discs: list[tuple[str, BaseGeometry]] = [
        (disc.name, Point(disc.east_m, disc.north_m).buffer(disc.radius_m, quad_segs=DISC_QUADRANT))
        for disc in kept.discs
    ]
    return [*discs, *((zone.name, zone.polygon) for zone in kept.polygons)]
