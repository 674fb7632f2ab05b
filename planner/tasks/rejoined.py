"""Other sweeps among obstacles, where no transits join those that were laid first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from planner.coverage.visible import Seeing
from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.tasks.cells import left_m2
from planner.tasks.mended import mended
from planner.tasks.moving import Moving
from planner.tasks.setting import Setting
from planner.tasks.task import Controls
from planner.tasks.urban import cut_by_obstacles, swept

Passes = tuple[CollectPass, ...]


def others(
    asked: Seeing, setting: Setting, passes: Passes, seed: int, controls: Controls
) -> Iterator[tuple[float, float, Passes]]:
    """Passes that may be flown instead of sweeps that no transits join: ground that they leave, way, passes.

    First these, with those moved that have no room for a turn; then sweeps that all end with room for one
    before obstacles. Sweeps are laid without a look at the turns between them: as near to obstacles as lines
    may be.
    """
    if not cut_by_obstacles(asked):
        return
    moves = Moving.of(asked, setting, controls)
    room_m = asked.airspace.clearance_m + setting.model.turn_radius_m
    wide = replace(asked, airspace=replace(asked.airspace, clearance_m=room_m))

    def roomier() -> Passes | None:
        try:
            return swept(wide, setting, "auto", seed, controls.progress, controls.stop)[0]
        except InfeasibleError:
            return None

    for laid in (lambda: passes, roomier):
        found = laid()
        joined = None if found is None else moves.joined(found)
        if joined is not None:
            joined = mended(moves, joined, controls.stop)
            yield left_m2(asked, joined), moves.legs.tour_m(joined), joined
