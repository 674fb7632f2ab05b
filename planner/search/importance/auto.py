"""The most that a battery collects on a grid, and home again.

A bound's prices (:mod:`planner.search.importance.bound`), and prices drawn about them, lead beam searches;
their walks and those of Snyder et al. (2021) are annealed from two heats: stretches are taken out and
searched through again, moves shift from where they pay least to where they pay more. Looks again cost extra
in every other of these, as walks that cross themselves are hard to leave. The best few are annealed by what
is asked, the best of all once more. Large grids, and what is but a part of a larger search, get one walk
that is led, annealed twice.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planner.search.importance.anneal_kernels import improve
from planner.search.importance.bound import MOST_ROUNDS, priced
from planner.search.importance.grid import Floats, ImportanceGrid, Ints
from planner.search.importance.snyder2021 import snyder2021
from planner.search.importance.walk import Walk
from planner.search.importance.walk_kernels import beam, distances, guide

#: Width of the beam led by prices, and of those led by prices drawn about them, by so large a part of each.
WIDTH, DRAWN_WIDTH, DRAWN = 200, 60, 0.5
#: So many beams are led by prices drawn.
BEAMS = 3


@dataclass(frozen=True, slots=True)
class _Work:
    """How much is tried: stretches of each start from each heat, of the best so many, and of the best.

    Heats are by what a good cell is worth; ``nodes`` are looked at in a stretch, prices improved ``prices``
    times.
    """

    heats: tuple[float, ...]
    first: int
    kept: int
    second: int
    last: int
    nodes: int
    prices: int


_THOROUGH = _Work((1.0, 2.0), 2_000, 3, 4_000, 6_000, 300, MOST_ROUNDS)
_QUICK = _Work((1.0,), 3_000, 0, 0, 6_000, 100, 60)
#: What annealings of the best begin with.
COOLER = 0.5

#: Larger grids are not searched thoroughly.
STARTS_CELLS = 2_500

#: Stretches tried are for walks of so many moves; longer ones get as many more, shorter ones down to half.
LONG = 60


@dataclass(frozen=True, slots=True)
class Pay:
    """What a walk is to be paid for besides the worth of the cells that it sees.

    Parameters
    ----------
    detection
        Probability that a look finds what there is: the k-th look at a cell is worth (1 - detection)^(k - 1)
        of the first.
    revisit
        Penalty of each look again, in units of worth.
    unspent
        Penalty of each move left over.
    """

    detection: float = 1.0
    revisit: float = 0.0
    unspent: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.detection <= 1.0:
            raise ValueError("detection: above 0 and at most 1")
        if not (0.0 <= self.revisit < np.inf and 0.0 <= self.unspent < np.inf):
            raise ValueError("revisit, unspent: finite and at least 0")


def auto(
    grid: ImportanceGrid,
    base: int,
    battery: int,
    pay: Pay = Pay(),
    *,
    seed: int = 0,
    enough: Callable[[], bool] = lambda: False,
    thorough: bool = True,
) -> Walk:
    """Plan a closed walk that collects as much as it can.

    Parameters
    ----------
    grid, base, battery
        As for :func:`snyder2021`.
    pay
        What is paid besides.
    seed
        Of the annealing; the same seed gives the same walk.
    enough
        Asked between annealings: ends them with the best found.
    thorough
        False for a walk that is but one part of what is tried.
    """
    thorough = thorough and grid.worth.size <= STARTS_CELLS
    work = _THOROUGH if thorough else _QUICK
    search = _Search(grid, base, battery, pay, work)
    number = 0
    found: list[Ints] = []

    def anneal(start: Ints, stretches: int, heat: float, revisit: float) -> None:
        nonlocal number
        if not found or not enough():
            found.append(search.annealed(start, stretches, heat, revisit, 101 * seed + number))
            number += 1

    for index, start in enumerate(search.starts(seed, thorough=thorough)):
        for turn, heat in enumerate(work.heats):
            anneal(start, work.first, heat, search.shy if (index + turn) % 2 == 0 else pay.revisit)
    for kept, stretches in ((work.kept, work.second), (1, work.last)):
        for start in sorted(found, key=search.value, reverse=True)[:kept]:
            anneal(start, stretches, COOLER, pay.revisit)
    return Walk(max(found, key=search.value), battery)


class _Search:
    """One search's fixed values."""

    def __init__(self, grid: ImportanceGrid, base: int, battery: int, pay: Pay, work: _Work) -> None:
        self._grid, self._base, self._battery, self._pay, self._work = grid, base, battery, pay, work
        self._beside = grid.neighbours()
        self._away = distances(self._beside, base)
        self._cell_worth: Floats = np.ascontiguousarray(grid.worth.reshape(-1))
        within = (self._away >= 0) & (2 * self._away <= battery)
        reach = np.sort(self._cell_worth[within])
        #: What a good cell is worth: a third as many as there are moves are worth more.
        self._good = float(reach[-min(len(reach), 1 + battery // 3)]) if len(reach) else 0.0
        self.shy = max(pay.revisit, 0.5 * self._good) if pay.detection == 1.0 else pay.revisit

    def starts(self, seed: int, *, thorough: bool) -> list[Ints]:
        grid, base, battery = self._grid, self._base, self._battery
        prices = priced(grid, base, battery, self.shy, self._work.prices)
        walks = [self._led(prices, self.shy, WIDTH)]
        if thorough:
            rng = np.random.default_rng(seed)
            for index in range(BEAMS):
                drawn = prices * rng.uniform(1.0 - DRAWN, 1.0 + DRAWN, len(prices))
                walks.append(self._led(drawn, (self._pay.revisit, self.shy)[index % 2], DRAWN_WIDTH))
            walks += [snyder2021(grid, base, battery, refused=how).cells for how in ("return", "next")]
        return walks

    def _led(self, prices: Floats, revisit: float, width: int) -> Ints:
        """The walk of a beam search led by prices."""
        base, battery = self._base, self._battery
        ahead = guide(self._beside, self._away, prices, base, battery)
        again = 1.0 - self._pay.detection
        led = beam(self._beside, self._cell_worth, again, revisit, ahead, base, battery, width)
        return led[led >= 0]

    def annealed(self, start: Ints, stretches: int, heat: float, revisit: float, seed: int) -> Ints:
        cells, _ = improve(
            self._beside,
            self._grid.shape[1],
            self._cell_worth,
            1.0 - self._pay.detection,
            revisit,
            self._pay.unspent,
            start,
            self._battery,
            stretches * max(LONG // 2, self._battery) // LONG,
            self._work.nodes,
            heat * self._good,
            seed,
        )
        return cells

    def value(self, cells: Ints) -> float:
        """What a walk is paid, but for constants."""
        distinct, looks = np.unique(cells[:-1] if len(cells) > 1 else cells, return_counts=True)
        again = 1.0 - self._pay.detection
        paid = self._cell_worth[distinct] * (1.0 - again**looks) / self._pay.detection
        return (
            float(paid.sum()) - self._pay.revisit * float((looks - 1).sum()) + self._pay.unspent * len(cells)
        )
