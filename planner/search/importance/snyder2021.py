"""Coverage of nonuniform importance as published.

After G. Snyder, S. Shriwastav, D. Morrison-Fogel and Z. Song, "Path Planning for Optimal Coverage of Areas
with Nonuniform Importance", 2021: Algorithm 1. Where print and text differ, the sense is followed:

- line 6 prints the argmin of the reward map, the text goes to "the target cell of the highest reward": argmax
  (``target="printed"`` takes the argmin among cells not yet seen);
- line 10 prints B_i > B_target + B_min, yet figure 6 (a) ends with nothing left: at least;
- Dijkstra's edges are "the reward of the cell" and the path is to maximise it: the length of an edge is one
  move and how far the reward of the cell that it leads to falls short of the best;
- a target refused for the battery ends the exploration, as figure 7's text tells of one that could not be
  afforded (``refused="next"`` tries the next best instead, which the paper does not).

Moves are to the four cells that share an edge ("all of which are l units away"), each costs one.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import bellman_ford, dijkstra

from planner.search.importance.grid import Bools, Floats, ImportanceGrid, Ints
from planner.search.importance.walk import Walk

Target = Literal["text", "printed"]
Refused = Literal["return", "next"]

#: The paper's penalty for a cell seen before, in its own scores of 0, 1, 10 and 100.
REVISIT = 100.0

#: Beyond so many cells the way home is by Dijkstra's algorithm: the same paths, as no edge is negative.
BELLMAN_FORD_CELLS = 1_000


def snyder2021(
    grid: ImportanceGrid,
    base: int,
    battery: int,
    *,
    revisit: float = REVISIT,
    target: Target = "text",
    refused: Refused = "return",
) -> Walk:
    """Algorithm 1 of Snyder et al. (2021).

    Parameters
    ----------
    grid
        Cells and their worth, gamma.
    base
        Index of the base's cell, row by row.
    battery
        B_start, in moves.
    revisit
        Penalty of a cell seen before, in units of worth.
    target, refused
        See the module.
    """
    area = _Area(grid, revisit)
    seen = np.zeros(grid.worth.size, dtype=np.bool_)
    seen[base] = True
    flown = [base]
    here, left = base, battery
    homeward: list[int] = [base]
    while left > 0:
        step = _next(area, seen, here, base, left, target, refused)
        if step is None:
            break
        out, homeward = step
        flown += out[1:]
        seen[out] = True
        left -= len(out) - 1
        here = flown[-1]
    return Walk(np.array(flown + homeward[1:], dtype=np.int64), battery)


def _next(
    area: _Area, seen: Bools, here: int, base: int, left: int, target: Target, refused: Refused
) -> tuple[list[int], list[int]] | None:
    """The path to the next target and the one home from there; nothing where the battery does not reach."""
    reward = area.reward_map(seen, here)
    candidates = np.flatnonzero(~seen & area.open)
    order = candidates[np.argsort(reward[candidates] * (1.0 if target == "printed" else -1.0), kind="stable")]
    paths = area.outgoing(seen, here)
    for goal in order.tolist():
        out = _path(paths, here, goal)
        if out is None:
            continue
        if refused == "next" and area.moves(here, goal) + area.moves(goal, base) > left:
            continue
        after = seen.copy()
        after[out] = True
        home = _path(area.homeward(after, goal), goal, base)
        if home is not None and left >= len(out) - 1 + len(home) - 1:
            return out, home
        if refused == "return":
            return None
    return None


class _Area:
    """The grid as a graph."""

    def __init__(self, grid: ImportanceGrid, revisit: float) -> None:
        beside = grid.neighbours()
        self._from, column = np.nonzero(beside >= 0)
        self._to: Ints = beside[self._from, column]
        self._cells = grid.worth.size
        self._columns = grid.shape[1]
        self._worth = grid.worth.reshape(-1)
        self.open = ~grid.blocked.reshape(-1)
        self._revisit = revisit

    def moves(self, here: int, there: int) -> int:
        """At least so many moves."""
        (row, column), (to_row, to_column) = divmod(here, self._columns), divmod(there, self._columns)
        return abs(row - to_row) + abs(column - to_column)

    def reward_map(self, seen: Bools, here: int) -> Floats:
        """W_i, lines 5 and 7: worth less the distance in cells, less the penalty where seen before."""
        index = np.arange(self._cells)
        row, column = divmod(here, self._columns)
        away = np.hypot(index // self._columns - row, index % self._columns - column)
        reward: Floats = self._rewards(seen) - away
        return reward

    def outgoing(self, seen: Bools, here: int) -> Ints:
        """Predecessors on the paths of most reward, by Dijkstra's algorithm."""
        rewards = self._rewards(seen)
        lengths = 1.0 + rewards.max() - rewards[self._to]
        _, before = dijkstra(self._graph(lengths), indices=np.array(here), return_predecessors=True)
        return np.asarray(before, dtype=np.int64)

    def homeward(self, seen: Bools, here: int) -> Ints:
        """Predecessors on the shortest paths, of these of most reward, by the Bellman–Ford algorithm."""
        rewards = self._rewards(seen)
        short = rewards.max() - rewards[self._to]
        lengths = 1.0 + short / (1.0 + short.max() * self._cells)
        shortest = bellman_ford if self._cells <= BELLMAN_FORD_CELLS else dijkstra
        _, before = shortest(self._graph(lengths), indices=np.array(here), return_predecessors=True)
        return np.asarray(before, dtype=np.int64)

    def _rewards(self, seen: Bools) -> Floats:
        return np.where(seen, -self._revisit, self._worth)

    def _graph(self, lengths: Floats) -> csr_array:
        return csr_array((lengths, (self._from, self._to)), shape=(self._cells, self._cells))


def _path(before: Ints, here: int, there: int) -> list[int] | None:
    path = [there]
    while path[-1] != here:
        previous = int(before[path[-1]])
        if previous < 0:
            return None
        path.append(previous)
    return path[::-1]
