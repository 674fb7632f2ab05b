"""Regions cut by obstacles, lane by lane over cells of their open ground, in one tour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import shapely

from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.sharing import Apart
from planner.coverage.survey.among import cell_targets, left_targets
from planner.coverage.urban.regions import unseen_m2, unseen_of
from planner.coverage.visible import Seeing, Visible
from planner.coverage.ways import Target
from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.routing.joint.route import Search, joint_route
from planner.tasks.urban import LEFT_PART

Passes = tuple[CollectPass, ...]

#: So much of the ground may be left for passes of its own, in so many pieces.
MOST_LEFT, MOST_PIECES = 0.02, 12
#: Of a turn radius so much is left for turns before obstacles, where more leaves ground unseen.
TURN_PARTS = (1.0, 0.75, 0.5)


def by_cells(asked: Seeing, search: Search) -> Passes | None:
    """Passes that see all of every region, or as much as may be; None where there are none.

    Lanes end before obstacles with room for a turn and the straight flight behind it, for a turn alone where
    that leaves ground unseen, and for parts of one.
    """
    best: tuple[float, Passes] | None = None
    model = asked.model
    room_m = asked.airspace.clearance_m + TRANSIT_MARGIN_M
    turns_m = [model.turn_radius_m + model.settle_m, *(part * model.turn_radius_m for part in TURN_PARTS)]
    for turn_m in turns_m:
        try:
            targets = cell_targets(asked, search.around, room_m + turn_m, search.enough)
            if targets is None:
                continue
            passes = _toured(search, targets)
        except InfeasibleError:
            continue
        if passes is None:
            continue
        left = left_m2(asked, passes)
        if left == 0.0:
            return passes
        if best is None or left < best[0]:
            best = (left, passes)
        if more := _seen_besides(asked, search, targets, passes):
            return more
    return None if best is None else best[1]


def _toured(search: Search, targets: Sequence[Target]) -> Passes | None:
    seen = Visible(tuple(targets), (), (), ())
    found = joint_route(search, seen, partial(_same, seen), _apart)
    return found.route.passes if math.isfinite(found.cost_m) else None


def _seen_besides(asked: Seeing, search: Search, targets: Sequence[Target], passes: Passes) -> Passes | None:
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
        more = _toured(search, (*targets, *left_targets(asked, search.around, left)))
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
