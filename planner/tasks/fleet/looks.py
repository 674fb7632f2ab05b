"""What crews of one kind see of jobs, and their tours of them in an order: found once, asked for often."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from planner.airspace.surroundings import Surroundings
from planner.coverage.ways import Options, Target
from planner.route import Terminal
from planner.routing.joint.chain import layers_of
from planner.routing.joint.tours import Choice, Tours
from planner.wishes import Region

#: Options of a region are looked at by headings so far apart, at the edges of what may be flown.
STEP_RAD = math.radians(15.0)
ETAS = np.array([0.0, 1.0])


class Looks:
    """Targets of regions with their options to choose an order by, and tours of some in an order.

    Targets are numbered as they are asked for.
    """

    def __init__(self) -> None:
        self._targets: list[Target] = []
        self._coarse: list[Options] = []
        self._of: dict[Region, tuple[int, ...]] = {}
        self._tours: dict[tuple[Terminal, Terminal], Tours] = {}
        self._refined: dict[tuple[tuple[Terminal, Terminal], tuple[int, ...]], Choice] = {}

    def numbers(self, region: Region, find: Callable[[], Sequence[Target]]) -> tuple[int, ...]:
        """Those of a region's targets; raises what finding them does."""
        if region not in self._of:
            found = find()
            coarse = [target.coarse(STEP_RAD, ETAS) for target in found]
            first = len(self._targets)
            self._targets.extend(found)
            self._coarse.extend(coarse)
            self._of[region] = tuple(range(first, first + len(found)))
        return self._of[region]

    def coarse(self, numbers: Sequence[int]) -> list[Options]:
        """The options to choose an order by."""
        return [self._coarse[number] for number in numbers]

    def tours(self, ends: tuple[Terminal, Terminal], around: Surroundings) -> Tours:
        """Tours of all targets between two ends."""
        if ends not in self._tours:
            self._tours[ends] = Tours(ends, around, self._targets)
        return self._tours[ends]

    def refined(
        self, ends: tuple[Terminal, Terminal], around: Surroundings, numbers: Sequence[int]
    ) -> Choice:
        """The tour of some targets in an order, with finer options; of infinite cost where there is none."""
        key = (ends, tuple(numbers))
        if key not in self._refined:
            coarse = self.coarse(numbers)
            cost_m, picked = layers_of(ends, around, coarse, around.discs).best()
            choice = Choice.of(numbers, coarse, picked, cost_m)
            self._refined[key] = self.tours(ends, around).refined(choice) if math.isfinite(cost_m) else choice
        return self._refined[key]
