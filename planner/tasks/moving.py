"""Sweeps among obstacles that cannot be flown as laid: moved, or left out where nothing is left to see."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, field

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
from planner.tasks.urban import cut_by_obstacles

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
        """The passes with those moved that no transit leads to, or from; None where nothing is left.

        Passes without room for a turn, of which nothing else sees the ground, are left out, and those with
        room that no way leads to all the same.
        """
        for _ in range(ROUNDS):
            cramped, barred = self._apart(passes)
            if not cramped and not barred:
                return passes
            passes = self.without(passes, cramped, barred)
            if not passes:
                return None
        return None

    def without(
        self, passes: Passes, numbers: Collection[int], barred: Collection[int] = (), *, kept: bool = False
    ) -> Passes:
        """The passes with some moved; those that cannot be, or are barred, are left out, or ``kept``."""
        found = list(passes)
        for number in sorted({*numbers, *barred}, reverse=True):
            moves = None if number in barred else self.moves_over(found[number].regions[0])
            instead = None if moves is None else moves.moved(found, number)
            found[number : number + 1] = (found[number],) if instead is None and kept else instead or ()
        return tuple(found)

    def _apart(self, passes: Passes) -> tuple[set[int], set[int]]:
        """Passes that want room where no transit leads to or from them, and others that none leads to."""
        begins = [self.legs.arrives(each) for each in passes]
        cramped: set[int] = set()
        barred: set[int] = set()
        last = len(passes) - 1
        for number in range(len(passes) + 1):
            here = self.ends[0] if number == 0 else leaves(passes[number - 1])
            there = self.ends[1] if number > last else begins[number]
            if math.isfinite(self.legs.cost_m(here, there)):
                continue
            beside = [k for k in (number - 1, number) if 0 <= k <= last]
            wanting = {k for k in beside if not self._roomy(passes[k], behind=k < number)}
            cramped |= wanting
            if not wanting:
                barred |= {k for k in beside if self.barred(passes[k])} or set(beside[-1:])
        return cramped, barred - cramped

    def barred(self, collect: CollectPass) -> bool:
        """Whether no way leads from the start to a pass, or none from it to the end."""
        ways = ((self.ends[0], self.legs.arrives(collect)), (leaves(collect), self.ends[1]))
        return any(math.isinf(self.legs.cost_m(*way)) for way in ways)

    def _roomy(self, collect: CollectPass, *, behind: bool) -> bool:
        moves = self.moves_over(collect.regions[0])
        return moves is None or (moves.leaves(collect) if behind else moves.enters(collect))

    def moves_over(self, name: str) -> Moves | None:
        """What passes over a region are moved among; None of what no camera sees."""
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
                moves = moves.reached([each.position for each in self.ends])
            self._moves[name] = moves
        return self._moves[name]


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
