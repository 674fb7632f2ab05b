"""Sweeps among obstacles that cannot be flown as laid: moved, or left out where nothing is left to see."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace

from planner.coverage.urban.moved import Moves
from planner.coverage.visible import Seeing
from planner.errors import InfeasibleError
from planner.photos import too_soon
from planner.profile.compose import Composed
from planner.profile.ends import with_run
from planner.route import Anchor, CollectPass
from planner.routing.legs import Legs, anchor, leaves
from planner.sensors.camera import CameraSensor
from planner.tasks.cells import left_m2
from planner.tasks.setting import Setting
from planner.tasks.task import Controls
from planner.tasks.urban import cut_by_obstacles, swept

Passes = tuple[CollectPass, ...]

#: Times that passes are moved because of others that were.
ROUNDS = 4


@dataclass(slots=True)
class Moving:
    """What passes of one flight are moved by.

    Parameters
    ----------
    legs
        Tells which transits there are.
    """

    asked: Seeing
    legs: Legs
    ends: tuple[Anchor, Anchor]
    _moves: dict[str, Moves | None] = field(default_factory=dict)

    @classmethod
    def of(cls, asked: Seeing, setting: Setting, controls: Controls) -> Moving:
        """For the passes of a flight in a setting."""
        ends = with_run(setting.ends, setting.level.height_m, setting.model)
        legs = Legs(setting.airspace, setting.level, setting.model, asked.objective, ends, controls.stop)
        return cls(asked, legs, (anchor(ends[0]), anchor(ends[1])))

    def joined(self, passes: Passes) -> Passes | None:
        """The passes with those moved that no transit leads to, or from; None where some cannot be.

        Passes without room for a turn, of which nothing else sees the ground, are left out.
        """
        for _ in range(ROUNDS):
            bad = self._apart(passes)
            if not bad:
                return passes
            if None in bad:
                return None
            passes = self.without(passes, {k for k in bad if k is not None})
            if not passes:
                return None
        return None

    def without(self, passes: Passes, numbers: Collection[int], *, kept: bool = False) -> Passes:
        """The passes with some of them moved; those that cannot be are left out, or ``kept``."""
        found = list(passes)
        for number in sorted(numbers, reverse=True):
            moves = self._of(found[number])
            instead = None if moves is None else moves.moved(found, number)
            found[number : number + 1] = (found[number],) if instead is None and kept else instead or ()
        return tuple(found)

    def _apart(self, passes: Passes) -> set[int | None]:
        """Passes that want room where no transit leads to or from them; None where none wants it."""
        begins = [self.legs.arrives(each) for each in passes]
        found: set[int | None] = set()
        last = len(passes) - 1
        for number in range(len(passes) + 1):
            here = self.ends[0] if number == 0 else leaves(passes[number - 1])
            there = self.ends[1] if number > last else begins[number]
            if math.isfinite(self.legs.cost_m(here, there)):
                continue
            cramped: set[int | None] = set()
            if number > 0 and not self._roomy(passes[number - 1], behind=True):
                cramped.add(number - 1)
            if number <= last and not self._roomy(passes[number], behind=False):
                cramped.add(number)
            found |= cramped or {None}
        return found

    def _roomy(self, collect: CollectPass, *, behind: bool) -> bool:
        moves = self._of(collect)
        return moves is None or (moves.leaves(collect) if behind else moves.enters(collect))

    def _of(self, collect: CollectPass) -> Moves | None:
        """What passes over its region are moved among; None of what is no sweep."""
        name = collect.regions[0]
        if name not in self._moves:
            (region,) = (each for each in self.asked.regions if each.name == name)
            level = self.asked.level.of(region)
            moves = None
            try:
                sensor, height_m = self.asked.suite.over(
                    region.sensor, region.area, self.asked.airspace, level
                )
            except InfeasibleError:
                sensor = None
            if isinstance(sensor, CameraSensor):
                moves = Moves.over(region, sensor, height_m, self.asked.airspace, level, self.asked.model)
            self._moves[name] = moves
        return self._moves[name]


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
            yield left_m2(asked, joined), moves.legs.tour_m(joined), joined


def in_time_for_photos(
    asked: Seeing, setting: Setting, passes: Passes, composed: Composed, controls: Controls
) -> Passes | None:
    """The passes with those moved on which photos would come too soon; None where that is of no use."""
    soon = {each.number for each in too_soon(setting.suite, composed, passes)}
    if not soon or not cut_by_obstacles(asked):
        return None
    moves = Moving.of(asked, setting, controls)
    moved = moves.without(passes, soon, kept=True)
    if moved == passes or left_m2(asked, moved) > left_m2(asked, passes):
        return None
    return moves.joined(moved)
