"""Which regions to leave out, by the orienteering form: the most priority within a length, and home again.

Places are the targets of all regions, each passed in one of its options, at costs that the choice of the
order goes by, too. Required regions are worth more than all others together.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.ways import Options, Target
from planner.fleet.prizes.choice import Choices, best_choice
from planner.fleet.prizes.exact import MOST_PLACES, exact_route
from planner.fleet.prizes.pools import Effort
from planner.route import Terminal
from planner.routing.joint.chain import estimates, from_start, to_end

Floats = NDArray[np.float64]

#: Options of a target: at headings about so far apart, at these offsets; the cheapest of each of so many
#: directions.
STEP_RAD, ETAS, DIRECTIONS = math.radians(15.0), np.array([0.0, 1.0]), 8
#: What is searched where there are too many places to prove.
EFFORT = Effort(pool=6, first_steps=120, child_steps=40, children=24)


@dataclass(frozen=True, slots=True)
class Kept:
    """What a flight of a length may see.

    Parameters
    ----------
    left
        Optional regions that it may not.
    length_m
        Of its route, as estimated.
    proved
        Whether no other route of that length as estimated sees more priority.
    """

    left: frozenset[str]
    length_m: float
    proved: bool


@dataclass(frozen=True, slots=True)
class Offer:
    """Targets with what they are worth, and what flying between them costs.

    Parameters
    ----------
    names
        Of the regions of each target.
    choices
        Start, targets and end; the budget is that of a tour of all.
    optional
        Priority of each region that need not be seen.
    """

    names: tuple[tuple[str, ...], ...]
    choices: Choices
    optional: Mapping[str, float]
    seed: int

    @classmethod
    def of(
        cls,
        targets: Sequence[Target],
        around: Surroundings,
        ends: tuple[Terminal, Terminal],
        optional: Mapping[str, float],
        seed: int,
    ) -> Offer:
        """The offer of targets.

        Raises
        ------
        InfeasibleError
            Where a target has no option that keeps the hard constraints.
        """
        names = tuple(target.region.names for target in targets)
        options = [_few(target.coarse(STEP_RAD, ETAS)) for target in targets]
        whole = sum(optional.values())
        parts = [sum(name in each for each in names) for name in (n for each in names for n in each)]
        share = iter(parts)
        rewards = [sum(optional.get(name, whole + 1.0) / next(share) for name in each) for each in names]
        choices = Choices(_costs(options, around, ends), np.array([0.0, *rewards, 0.0]), math.inf)
        return cls(names, choices, optional, seed)

    def kept(self, length_m: float) -> Kept | None:
        """What a route of a length sees; None where it sees not all that is required."""
        choices = replace(self.choices, budget=length_m)
        proved = len(self.names) <= MOST_PLACES
        try:
            found = exact_route(choices) if proved else best_choice(choices, self.seed, effort=EFFORT)
        except ValueError:
            return None
        seen = {place - 1 for place in found.order[1:-1]}
        missed = {name for k, names in enumerate(self.names) if k not in seen for name in names}
        if not missed <= set(self.optional):
            return None
        return Kept(frozenset(missed), found.cost, proved)

    def whole_m(self) -> float:
        """Length of a route that sees all, as estimated."""
        # No tour is longer than from each to the next in any order.
        order = tuple(range(len(self.names) + 2))
        kept = self.kept(self.choices.cost(order))
        return math.inf if kept is None else kept.length_m


def _few(options: Options) -> Options:
    """The cheapest option of each of some directions."""
    angles = options.entries[:, 2] % (2.0 * math.pi)
    bins = np.floor(angles / (2.0 * math.pi) * DIRECTIONS + 0.5).astype(int) % DIRECTIONS
    rows = [
        int(np.flatnonzero(bins == each)[np.argmin(options.inner_m[bins == each])])
        for each in np.unique(bins)
    ]
    return options.rows(np.array(rows, dtype=np.int64))


def _costs(options: Sequence[Options], around: Surroundings, ends: tuple[Terminal, Terminal]) -> Floats:
    """Blocks of costs between start, targets and end; what one costs by itself is part of the way to it."""
    places, ways = len(options) + 2, max(len(each.inner_m) for each in options)
    counts = [len(each.inner_m) for each in options]
    rows = np.cumsum([0, *counts])
    entries, exits, inner_m = (
        np.concatenate([getattr(each, name) for each in options]) for name in ("entries", "exits", "inner_m")
    )
    between = estimates(exits, entries, around, around.discs) + inner_m[None, :]
    first = from_start(ends[0], around, entries, around.discs) + inner_m
    last = to_end(ends[1], around, exits, around.discs)
    costs = np.full((places, places, ways, ways), np.inf)
    for i, count in enumerate(counts):
        own = slice(rows[i], rows[i + 1])
        costs[0, i + 1, :, :count] = first[own]
        costs[i + 1, -1, :count, :] = last[own, None]
        for j, other in enumerate(counts):
            if i != j:
                costs[i + 1, j + 1, :count, :other] = between[own, rows[j] : rows[j + 1]]
    costs[0, -1] = math.dist(ends[0].position, ends[1].position)
    return costs
