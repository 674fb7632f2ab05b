"""A tour whose passes are fitted to neighbours that are free themselves, whatever these were before.

Fitting the passes of one place to what lies next to it, and that to the passes again, ends where neither
alone can be better: with lanes flown in an order that is best for one heading over the point before them, and
that heading best for this order. Here the passes of a place are chosen for all that may lie before and behind
it, by the least costs of a way up to each option of the place before, and from each of the one behind.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from planner.coverage.ways import Between, Options
from planner.routing.joint.chain import estimates, from_start, to_end
from planner.routing.joint.tours import FITTED_STEP_ETA, FITTED_STEP_RAD, Choice, Pool, Tours

Floats = NDArray[np.float64]

#: Passes are fitted at offsets about those that were, and at others over all the width there is.
STEPS_ETA = (FITTED_STEP_ETA, 0.4)


def freed(tours: Tours, choice: Choice, wide: Mapping[int, Options]) -> Choice:
    """The same order, each place fitted to all that may lie round it; no dearer than it was.

    Parameters
    ----------
    wide
        What of each target may be chosen besides what was.
    """
    way = _Way(tours, choice, wide)
    for place in range(len(choice.order)):
        way.fit(place)
    cost_m, picked = way.best()
    return Choice(choice.order, picked, cost_m) if cost_m < choice.cost_m else choice


class _Way:
    """Pools of options place by place, and the least costs up to each option of those that were fitted."""

    def __init__(self, tours: Tours, choice: Choice, wide: Mapping[int, Options]) -> None:
        self._tours, self._choice = tours, choice
        self._pools = [Pool.of([one, wide[c]]) for c, one in zip(choice.order, choice.picked, strict=True)]
        #: From each option of a place to the end, without its own cost.
        self._behind = [to_end(tours.ends[1], tours.around, self._pools[-1].exits, tours.around.discs)]
        for here, there in zip(self._pools[-2::-1], self._pools[:0:-1], strict=True):
            costs_m = self._estimates(here.exits, there.entries) + (there.inner_m + self._behind[-1])
            self._behind.append(costs_m.min(axis=1))
        self._behind.reverse()
        #: Up to each option of a place, its own cost included, and from which of the place before.
        self._before: list[Floats] = []
        self._came_from: list[NDArray[np.intp]] = []

    def _estimates(self, exits: Floats, entries: Floats) -> Floats:
        return estimates(exits, entries, self._tours.around, self._tours.around.discs)

    def _up_to(self, place: int, entries: Floats) -> tuple[Floats, NDArray[np.intp]]:
        """The least costs to poses at a place, and from which option before it."""
        tours = self._tours
        if place == 0:
            costs_m = from_start(tours.ends[0], tours.around, entries, tours.around.discs)
            return costs_m, np.zeros(len(entries), dtype=np.intp)
        through_m = self._before[-1][:, None] + self._estimates(self._pools[place - 1].exits, entries)
        return through_m.min(axis=0), through_m.argmin(axis=0)

    def _on_from(self, place: int, exits: Floats) -> Floats:
        """The least costs from poses at a place to the end."""
        tours = self._tours
        if place == len(self._pools) - 1:
            return to_end(tours.ends[1], tours.around, exits, tours.around.discs)
        there = self._pools[place + 1]
        costs_m = self._estimates(exits, there.entries) + (there.inner_m + self._behind[place + 1])
        least_m: Floats = costs_m.min(axis=1)
        return least_m

    def fit(self, place: int) -> None:
        """Put in the passes that are best for all that may lie round a place; places come in order."""
        number, picked = self._choice.order[place], self._choice.picked[place]
        between = Between(
            lambda entries: self._up_to(place, entries)[0], lambda exits: self._on_from(place, exits)
        )
        target = self._tours.targets[number]
        near = [target.near(picked, FITTED_STEP_RAD, step_eta, between) for step_eta in STEPS_ETA]
        pool = self._pools[place] = Pool.of([*self._pools[place].sets, *near])
        costs_m, came_from = self._up_to(place, pool.entries)
        self._before.append(costs_m + pool.inner_m)
        self._came_from.append(came_from)

    def best(self) -> tuple[float, tuple[Options, ...]]:
        """What the cheapest way costs, and its options."""
        last = len(self._pools) - 1
        whole_m = self._before[last] + self._on_from(last, self._pools[last].exits)
        index = int(np.argmin(whole_m))
        cost_m, chosen = float(whole_m[index]), [index]
        for came_from in self._came_from[:0:-1]:
            chosen.append(int(came_from[chosen[-1]]))
        rows = zip(self._pools, reversed(chosen), strict=True)
        return cost_m, tuple(pool.row(index) for pool, index in rows)
