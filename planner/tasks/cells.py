"""Regions cut by obstacles, lane by lane over cells of their open ground, in one tour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.sharing import Apart
from planner.coverage.survey.among import cell_targets
from planner.coverage.urban.regions import unseen_m2
from planner.coverage.visible import Seeing, Visible
from planner.coverage.ways import Target
from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.routing.joint.route import Search, joint_route
from planner.tasks.urban import LEFT_PART

Passes = tuple[CollectPass, ...]


def by_cells(asked: Seeing, search: Search) -> Passes | None:
    """Passes that see all of every region; None where there are none.

    Lanes end before obstacles with room for a turn and the straight flight behind it, for a turn alone where
    that leaves ground unseen, and for half of one.
    """
    model = asked.model
    room_m = asked.airspace.clearance_m + TRANSIT_MARGIN_M
    for turn_m in (model.turn_radius_m + model.settle_m, model.turn_radius_m, model.turn_radius_m / 2.0):
        try:
            targets = cell_targets(asked, search.around, room_m + turn_m, search.enough)
            if targets is None:
                continue
            seen = Visible(targets, (), (), ())
            found = joint_route(search, seen, partial(_same, seen), _apart)
        except InfeasibleError:
            continue
        if math.isfinite(found.cost_m) and left_m2(asked, found.route.passes) == 0.0:
            return found.route.passes
    return None


def left_m2(asked: Seeing, passes: Passes) -> float:
    """Ground of all regions that no pass sees, where that is more than rounding."""
    left = [(unseen_m2(region, passes), region.area.area) for region in asked.regions]
    return math.fsum(unseen for unseen, whole in left if unseen > LEFT_PART * whole)


def _same(seen: Visible, _: object) -> Visible:
    return seen


def _apart(_: Sequence[Target]) -> Apart:
    return Apart()
