"""Ground that passes among obstacles leave, seen by passes of its own, put in where the way is least."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.merge import polygons_of
from planner.coverage.urban.moved import Moves
from planner.coverage.urban.regions import unseen_of
from planner.progress import Stop, raise_if
from planner.route import CollectPass
from planner.routing.legs import leaves
from planner.tasks.moving import Moving
from planner.tasks.urban import LEFT_PART

Floats = NDArray[np.float64]
Passes = tuple[CollectPass, ...]

#: Pieces are seen with so much round them, a part of what overlaps ask for, rather than by the edge of a
#: frame, and by passes with room for full turns, where there are such.
WAYS = ((True, 1.0), (True, 0.4), (True, 0.15), (True, 0.0), (False, 0.0))
#: Pieces that no one pass sees whole are halved so often, once they are no larger than what a photo sees.
HALVED = 4
#: More pieces than this are left, and no piece is halved more often.
MOST_PIECES, MOST_HALVED = 60, 9
#: Pieces this near to each other are looked for together first.
TOGETHER_M = 2.0
#: Of passes that see a piece so many, the nearest ones, are put in by true costs, at so many places each; or
#: more, where no transits lead to those.
TRIED, MOST_TRIED, PLACES, MOST_PLACES = 3, 6, 3, 24
#: What is as small as this part of what a photo sees, along its longer side, is not halved.
SMALL = 0.1


def mended(moving: Moving, passes: Passes, stop: Stop) -> Passes:
    """The passes with others that see what these leave, or all of it; the same where nothing more is seen."""
    for region in moving.asked.regions:
        level = moving.asked.level.of(region)
        left = unseen_of(region, moving.asked.airspace, level, passes)
        moves = moving.moves_over(region.name)
        if moves is None or left.area <= LEFT_PART * region.area.area:
            continue
        mending = _Mending(moving, moves, stop)
        for piece in _pieces(left)[:MOST_PIECES]:
            photos = max(1.0, piece.area / moves.frame_m2)
            halved = min(HALVED + math.ceil(math.log2(photos)), MOST_HALVED)
            passes = mending.over(passes, piece, halved)
    return passes


def _pieces(left: BaseGeometry) -> list[BaseGeometry]:
    """What is left, piece by piece, the largest first; what lies side by side is one."""
    parts = list(_areal(left).geoms)
    groups = polygons_of(shapely.union_all([part.buffer(TOGETHER_M / 2.0) for part in parts]))
    found = [shapely.union_all([part for part in parts if group.intersects(part)]) for group in groups]
    return sorted(found, key=lambda each: -float(each.area))


@dataclass(frozen=True, slots=True)
class _Mending:
    """Passes put in over one region."""

    moving: Moving
    moves: Moves
    stop: Stop

    def over(self, passes: Passes, piece: BaseGeometry, halved: int) -> Passes:
        """With passes over a piece, halves of it where none sees all; without where none sees any."""
        raise_if(self.stop)
        near = [each.footprint for each in passes if each.footprint.intersects(piece)]
        unseen = _areal(shapely.difference(piece, shapely.union_all(near), grid_size=1e-6) if near else piece)
        if unseen.is_empty:
            return passes
        for roomy, part in WAYS:
            wanted = unseen if part == 0.0 else unseen.buffer(part * self.moves.overlap_m)
            found = self._put_in(passes, wanted, roomy=roomy)
            if found is not None:
                return found
        if halved == 0 or _longest_m(unseen) < SMALL * math.sqrt(self.moves.frame_m2):
            return passes
        for half in _halves(unseen):
            passes = self.over(passes, half, halved - 1)
        return passes

    def _put_in(self, passes: Passes, ground: BaseGeometry, *, roomy: bool) -> Passes | None:
        """With a pass that sees all of some ground; None where there is none, or no way to it."""
        here, there = self.moving.ends[0].position, self.moving.ends[1].position
        ends = np.array([here, *(each.end for each in passes)])
        starts = np.array([*(each.start for each in passes), there])
        best: tuple[float, Passes] | None = None
        for tried, (at, laid) in enumerate(self.moves.seeing(ground, ends, starts, roomy=roomy)):
            if tried >= (MOST_TRIED if best is None else TRIED):
                break
            # Where no way leads from the start to it and on to the end, none is looked for elsewhere.
            if self.moving.barred(laid):
                continue
            joined = 0
            for number in at[:MOST_PLACES]:
                cost_m = _cost_m(self.moving, passes, number, laid)
                if math.isinf(cost_m):
                    continue
                if best is None or cost_m < best[0]:
                    best = (cost_m, (*passes[:number], laid, *passes[number:]))
                joined += 1
                if joined == PLACES:
                    break
        return None if best is None else best[1]


def _areal(ground: BaseGeometry) -> MultiPolygon:
    """What has area of an overlay."""
    return MultiPolygon([part for part in shapely.get_parts(ground).tolist() if isinstance(part, Polygon)])


def _longest_m(ground: BaseGeometry) -> float:
    """From one end to the other, about."""
    west, south, east, north = ground.bounds
    return math.hypot(east - west, north - south)


def _cost_m(moving: Moving, passes: Passes, number: int, laid: CollectPass) -> float:
    """What a pass put in before one of those costs more; inf where no transits lead to it and from it."""
    legs = moving.legs
    before = moving.ends[0] if number == 0 else leaves(passes[number - 1])
    behind = moving.ends[1] if number == len(passes) else legs.arrives(passes[number])
    to_m = legs.cost_m(before, legs.arrives(laid))
    if math.isinf(to_m):
        return math.inf
    from_m, known_m = legs.cost_m(leaves(laid), behind), legs.cost_m(before, behind)
    # Where nothing joins those two, what joins them by it is as good as free.
    return to_m + legs.pass_m(laid) + from_m - (known_m if math.isfinite(known_m) else 0.0)


def _halves(ground: BaseGeometry) -> Sequence[BaseGeometry]:
    """Both halves across the longer side of its least rectangle."""
    box = shapely.minimum_rotated_rectangle(ground)
    if not isinstance(box, Polygon):
        return ()
    a, b, c, d = shapely.get_coordinates(box)[:4]
    if math.dist(a, b) < math.dist(b, c):
        a, b, c, d = b, c, d, a
    middle, other = 0.5 * (a + b), 0.5 * (c + d)
    cuts = (Polygon([a, middle, other, d]), Polygon([middle, b, c, other]))
    halves = [_areal(shapely.intersection(ground, cut, grid_size=1e-6)) for cut in cuts]
    return [half for half in halves if half.area > 0.0]
