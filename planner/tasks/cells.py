"""Regions cut by obstacles, lane by lane over cells of their open ground, in one tour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import shapely

from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.sharing import Apart
from planner.coverage.survey.among import cell_targets, left_targets
from planner.coverage.urban.regions import unseen_m2, unseen_of
from planner.coverage.visible import Seeing, Visible
from planner.coverage.ways import Target
from planner.errors import InfeasibleError
from planner.progress import Stop, Until, in_time
from planner.route import CollectPass
from planner.routing.joint.route import Search, joint_route
from planner.tasks.urban import LEFT_PART

Passes = tuple[CollectPass, ...]

#: So much of the ground may be left for passes of its own, in so many pieces.
MOST_LEFT, MOST_PIECES = 0.02, 12
#: Of a turn radius so much is left for turns before obstacles, where more leaves ground unseen.
TURN_PARTS = (1.0, 0.75, 0.5)


def by_cells(asked: Seeing, search: Search, enough: Until, *, needed: bool = True) -> Passes | None:
    """Passes that see all of every region, or as much as may be; None where there are none.

    Lanes end before obstacles with room for a turn and the straight flight behind it, for a turn alone where
    that leaves ground unseen, and for parts of one.

    Parameters
    ----------
    enough
        Ends the search for better ones. Where it will, the first cells that come are toured before the best
        are looked for.
    needed
        Whether there is no other answer: the first passes are then found however long that takes.
    """
    found = None
    if enough.comes:
        found = _least_left(asked, replace(search, enough=lambda: True), enough, needed=needed)
    better = _least_left(asked, search, enough, needed=needed and found is None)
    ways = [way for way in (found, better) if way is not None]
    if len(ways) < 2:
        return ways[0][1] if ways else None
    return min(ways, key=lambda way: (way[0], search.legs.tour_m(way[1])))[1]


def _least_left(asked: Seeing, search: Search, enough: Until, *, needed: bool) -> tuple[float, Passes] | None:
    """The passes that leave least of the ground for the most room to turn, and how much they leave."""
    best: tuple[float, Passes] | None = None
    model = asked.model
    room_m = asked.airspace.clearance_m + TRANSIT_MARGIN_M
    turns_m = [model.turn_radius_m + model.settle_m, *(part * model.turn_radius_m for part in TURN_PARTS)]
    # Without a straight flight before lanes the first two are one.
    for turn_m in dict.fromkeys(turns_m):
        tour = partial(_in_cells, asked, search, room_m + turn_m)
        first = needed and best is None
        found = tour(search.stop) if first else in_time(tour, search.stop, enough)
        if found is None:
            continue
        _, passes = found
        left = left_m2(asked, passes)
        if best is None or left < best[0]:
            best = (left, passes)
        if left == 0.0:
            break
        more = in_time(partial(_seen_besides, asked, search, *found), search.stop, enough)
        if more:
            return 0.0, more
    return best


def _in_cells(
    asked: Seeing, search: Search, margin_m: float, stop: Stop
) -> tuple[tuple[Target, ...], Passes] | None:
    """Cells so far from obstacles, and the tour over them; None where there is none."""
    try:
        targets = cell_targets(asked, search.around, margin_m, stop, search.enough)
        passes = None if targets is None else _toured(replace(search, stop=stop), targets)
    except InfeasibleError:
        return None
    return None if targets is None or passes is None else (targets, passes)


def _toured(search: Search, targets: Sequence[Target]) -> Passes | None:
    seen = Visible(tuple(targets), (), (), ())
    found = joint_route(search, seen, partial(_same, seen), _apart)
    return found.route.passes if math.isfinite(found.cost_m) else None


def _seen_besides(
    asked: Seeing, search: Search, targets: Sequence[Target], passes: Passes, stop: Stop
) -> Passes | None:
    """The tour with passes for what it leaves, where that is little, and nothing is left then."""
    left = [
        unseen_of(region, asked.airspace, asked.level.of(region), passes).buffer(0.0)
        for region in asked.regions
    ]
    pieces = sum(shapely.get_num_geometries(each) for each in left if not each.is_empty)
    little = sum(each.area for each in left) <= MOST_LEFT * sum(region.area.area for region in asked.regions)
    if not little or pieces > MOST_PIECES:
        return None
    try:
        more = _toured(replace(search, stop=stop), (*targets, *left_targets(asked, search.around, left)))
    except InfeasibleError:
        return None
    return more if more is not None and left_m2(asked, more) == 0.0 else None


def left_m2(asked: Seeing, passes: Passes) -> float:
    """Ground of all regions that no pass sees, where that is more than rounding."""
    left = [
        (unseen_m2(region, asked.airspace, asked.level.of(region), passes), region.area.area)
        for region in asked.regions
    ]
    return math.fsum(unseen for unseen, whole in left if unseen > LEFT_PART * whole)


def _same(seen: Visible, _: object) -> Visible:
    return seen


def _apart(_: Sequence[Target]) -> Apart:
    return Apart()
