"""The most that a battery collects on a grid, and home again.

A bound's prices (:mod:`planner.search.importance.bound`) lead a beam search; its walk and those of Snyder et
al. (2021) are annealed: stretches are taken out and searched through again, moves shift from where they pay
least to where they pay more. Looks again cost something extra at first, as walks that cross themselves are
hard to leave; the last annealing goes by what is asked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planner.search.importance.anneal_kernels import improve
from planner.search.importance.bound import bounded
from planner.search.importance.grid import Floats, ImportanceGrid, Ints
from planner.search.importance.snyder2021 import snyder2021
from planner.search.importance.walk import Walk
from planner.search.importance.walk_kernels import beam, distances, guide

#: Width of the beam.
WIDTH = 200

#: Stretches tried from each start, and nodes looked at for each.
ROUNDS = 3_000
NODES = 100

#: On larger grids the starts of the paper take longer than they are worth.
STARTS_CELLS = 2_500

#: Walks beyond so many moves are tried at as many more stretches as they are longer.
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
    """
    search = _Search(grid, base, battery, pay)
    rounds = ROUNDS * max(LONG, battery) // LONG
    found: list[tuple[float, Ints]] = []
    for index, start in enumerate(search.starts()):
        if found and enough():
            break
        found.append(search.annealed(start, rounds, 1.0, search.shy, 7 * seed + index))
    best = max(found, key=lambda one: search.value(one[1]))[1]
    if not enough():
        best = max(
            (best, search.annealed(best, 2 * rounds, 0.5, pay.revisit, 7 * seed + 5)[1]), key=search.value
        )
    return Walk(best, battery)


class _Search:
    """One search's fixed values."""

    def __init__(self, grid: ImportanceGrid, base: int, battery: int, pay: Pay) -> None:
        self._grid, self._base, self._battery, self._pay = grid, base, battery, pay
        self._beside = grid.neighbours()
        self._away = distances(self._beside, base)
        self._cell_worth: Floats = np.ascontiguousarray(grid.worth.reshape(-1))
        within = (self._away >= 0) & (2 * self._away <= battery)
        reach = np.sort(self._cell_worth[within])
        #: What a good cell is worth: a third as many as there are moves are worth more.
        self._good = float(reach[-min(len(reach), 1 + battery // 3)]) if len(reach) else 0.0
        self.shy = max(pay.revisit, 0.5 * self._good) if pay.detection == 1.0 else pay.revisit

    def starts(self) -> list[Ints]:
        grid, base, battery = self._grid, self._base, self._battery
        prices = bounded(grid, base, battery, self.shy).prices
        ahead = guide(self._beside, self._away, prices, base, battery)
        again = 1.0 - self._pay.detection
        led = beam(self._beside, self._cell_worth, again, self.shy, ahead, base, battery, WIDTH)
        walks = [led[led >= 0]]
        if grid.worth.size <= STARTS_CELLS:
            walks += [snyder2021(grid, base, battery, refused=how).cells for how in ("return", "next")]
        return walks

    def annealed(
        self, start: Ints, rounds: int, heat: float, revisit: float, seed: int
    ) -> tuple[float, Ints]:
        cells, value = improve(
            self._beside,
            self._grid.shape[1],
            self._cell_worth,
            1.0 - self._pay.detection,
            revisit,
            self._pay.unspent,
            start,
            self._battery,
            rounds,
            NODES,
            heat * self._good,
            seed,
        )
        return value, cells

    def value(self, cells: Ints) -> float:
        """What a walk is paid, but for constants."""
        distinct, looks = np.unique(cells[:-1] if len(cells) > 1 else cells, return_counts=True)
        again = 1.0 - self._pay.detection
        paid = self._cell_worth[distinct] * (1.0 - again**looks) / self._pay.detection
        return (
            float(paid.sum()) - self._pay.revisit * float((looks - 1).sum()) + self._pay.unspent * len(cells)
        )
