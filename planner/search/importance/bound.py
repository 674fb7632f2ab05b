"""What no walk within the battery collects: slots for cells, and prices of visits.

Two bounds, the lower of which holds:

- A cell d moves from the base can only be seen after d moves and with d left. Moves are slots; each takes one
  cell within its reach and of its parity. The dearest cells that fit the slots are found greedily, as sets
  that fit slots form a matroid.
- Lagrangean: at a price for each visit a walk may be paid for a cell again and again; what a cell is worth
  beyond its price is had for nothing. The dearest walk at given prices is found exactly by dynamic programming
  over moves, cell and direction, with turning straight back unpaid (which never is a first look); prices are
  improved by subgradients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.search.importance.bound_kernels import dearest
from planner.search.importance.grid import Floats, ImportanceGrid
from planner.search.importance.walk_kernels import distances

#: States of the dynamic programme that all rounds together may look at.
STATES = 400_000_000
MOST_ROUNDS = 300


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


def bounded(grid: ImportanceGrid, base: int, battery: int, revisit: float = 0.0, unspent: float = 0.0) -> Bound:
    """Bound the worth collected, less ``revisit`` for each look again and ``unspent`` for each move left over."""
    beside = grid.neighbours()
    away = distances(beside, base)
    within = (away >= 0) & (2 * away <= battery)
    cells = np.flatnonzero(within)
    cells = cells[np.argsort(away[cells], kind="stable")]
    # Moves less cells seen are looks again: a cell seen saves its penalty, a move pays it.
    worth = np.where(within, grid.worth.reshape(-1) + revisit, 0.0)
    worth[base] = 0.0
    move = unspent - revisit
    fixed = float(grid.worth.reshape(-1)[base]) + revisit - unspent * battery
    prices = worth.copy()
    best, best_prices = np.inf, prices
    if revisit == 0.0:
        best = _slotted(worth, away, battery) + max(0.0, unspent * battery)
    rounds = int(min(MOST_ROUNDS, max(8, STATES // max(1, 4 * len(cells) * battery))))
    # The slots' bound is no tighter for prices; the first step is of the size of a cell's worth.
    scale = 1.0
    stale = 0
    least = np.inf
    for _ in range(rounds):
        paid, visits = dearest(beside, cells, away, prices, move, base, battery, False)
        total = paid + float((worth - prices)[within].sum())
        if total < least - 1e-9:
            least, best_prices, stale = total, prices.copy(), 0
        else:
            stale += 1
            if stale >= 5:
                scale, stale = 0.6 * scale, 0
        slope = np.where(within, visits - 1, 0)
        slope[base] = 0
        # At the upper limit a price cannot rise.
        slope[(slope < 0) & (prices >= worth)] = 0
        size = float((slope**2).sum())
        if size == 0.0:
            break
        step = scale * 0.1 * total / size
        prices = np.clip(prices - step * slope, 0.0, worth)
    least += fixed
    best += fixed
    return Bound(min(least, best), best_prices)


def _slotted(worth: Floats, away: np.ndarray, battery: int) -> float:
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
