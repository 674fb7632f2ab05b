"""What no walk within the battery collects: slots for cells, and prices of visits.

Two bounds, the lower of which holds:

- A cell d moves from the base can only be seen after d moves and with d left. Moves are slots; each takes one
  cell within its reach and of its parity. The dearest cells that fit the slots are found greedily, as sets
  that fit slots form a matroid.
- Lagrangean: at a price for each visit a walk may be paid for a cell again and again; what a cell is worth
  beyond its price is had for nothing. The dearest walk at given prices is found by dynamic programming over
  moves, cell and direction, with turning straight back unpaid (which never is a first look); prices are
  improved by subgradients.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from planner.search.importance.bound_kernels import dearest
from planner.search.importance.grid import Floats, ImportanceGrid, Ints
from planner.search.importance.walk_kernels import distances

#: States of the dynamic programme that all rounds together may look at.
STATES = 200_000_000
LEAST_ROUNDS, MOST_ROUNDS = 8, 300

#: Rounds without a better bound after which steps get shorter.
PATIENCE = 5


@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """At most so much.

    Parameters
    ----------
    total
        Of the worth collected less penalties, the base's own included.
    prices
        float64 (cells,): what a visit is worth in the end.
    """

    total: float
    prices: Floats


def priced(grid: ImportanceGrid, base: int, battery: int, revisit: float, most_rounds: int) -> Floats:
    """Prices of visits alone, (cells,), improved at most so often: what leads a search."""
    beside = grid.neighbours()
    reached = _Reached(grid, base, battery, beside, distances(beside, base))
    return reached.priced(revisit, 0.0, most_rounds).prices


def bounded(
    grid: ImportanceGrid, base: int, battery: int, revisit: float = 0.0, unspent: float = 0.0
) -> Bound:
    """Bound the worth collected, less ``revisit`` a look again and ``unspent`` a move left over."""
    beside = grid.neighbours()
    away = distances(beside, base)
    reached = _Reached(grid, base, battery, beside, away)
    found = reached.priced(revisit, unspent, MOST_ROUNDS)
    if revisit == 0.0 and unspent == 0.0:
        home = float(grid.worth.reshape(-1)[base])
        return replace(found, total=min(found.total, home + _slotted(reached.worth, away, battery)))
    # Penalties only take away.
    return replace(found, total=min(found.total, bounded(grid, base, battery).total))


class _Reached:
    """Cells that a walk can see."""

    def __init__(self, grid: ImportanceGrid, base: int, battery: int, beside: Ints, away: Ints) -> None:
        self._beside, self._away, self._base, self._battery = beside, away, base, battery
        self._within = (away >= 0) & (2 * away <= battery)
        cells = np.flatnonzero(self._within)
        self._cells = cells[np.argsort(away[cells], kind="stable")]
        self._home = float(grid.worth.reshape(-1)[base])
        self.worth: Floats = np.where(self._within, grid.worth.reshape(-1), 0.0)
        self.worth[base] = 0.0

    def priced(self, revisit: float, unspent: float, most_rounds: int) -> Bound:
        """By prices of visits, improved by subgradients."""
        # Moves less cells seen are looks again: a cell seen saves its penalty, a move pays it.
        worth = np.where(self._within, self.worth + revisit, 0.0)
        worth[self._base] = 0.0
        fixed = self._home + revisit - unspent * self._battery
        prices = worth.copy()
        least, best_prices = np.inf, prices
        states = 4 * len(self._cells) * self._battery
        scale, stale = 1.0, 0
        for _ in range(min(most_rounds, max(LEAST_ROUNDS, STATES // max(1, states)))):
            paid, visits = dearest(
                self._beside, self._cells, self._away, prices, unspent - revisit, self._base, self._battery
            )
            total = paid + float((worth - prices)[self._within].sum())
            stale += 1
            if total < least - 1e-9:
                least, best_prices, stale = total, prices.copy(), 0
            elif stale >= PATIENCE:
                scale, stale = 0.6 * scale, 0
            slope = np.where(self._within, visits - 1, 0)
            slope[self._base] = 0
            # At the upper limit a price cannot rise.
            slope[(slope < 0) & (prices >= worth)] = 0
            size = float((slope**2).sum())
            if size == 0.0:
                break
            prices = np.clip(prices - scale * 0.1 * total / size * slope, 0.0, worth)
        return Bound(least + fixed, best_prices)


def _slotted(worth: Floats, away: Ints, battery: int) -> float:
    """The most that cells of distinct slots are worth."""
    total = 0.0
    for parity in (0, 1):
        reach = battery // 2
        # slots[d]: moves of this parity from d on and with d left.
        times = np.arange(1, battery + 1)
        times = times[times % 2 == parity]
        room = np.array([int(((times >= d) & (times <= battery - d)).sum()) for d in range(reach + 1)])
        taken = np.zeros(reach + 1, dtype=np.int64)
        mine = np.flatnonzero((away > 0) & (away <= reach) & (away % 2 == parity) & (worth > 0.0))
        for cell in mine[np.argsort(-worth[mine], kind="stable")]:
            d = int(away[cell])
            # Cells at least as far as each distance up to this one must fit the slots of that distance.
            if (taken[: d + 1] < room[: d + 1]).all():
                taken[: d + 1] += 1
                total += float(worth[cell])
    return total
