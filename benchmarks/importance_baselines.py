"""Walks of no cleverness: the most worth a move away, and a spiral round the base."""

from __future__ import annotations

import numpy as np

from planner.search.importance.grid import ImportanceGrid
from planner.search.importance.walk import Walk


def greedy(grid: ImportanceGrid, base: int, battery: int) -> Walk:
    """Always to the cell of most worth a move that leaves enough to go home, along rows then columns."""
    columns = grid.shape[1]
    row, column = np.divmod(np.arange(grid.worth.size), columns)
    worth = grid.worth.reshape(-1).copy()
    walk = [base]
    while True:
        worth[walk] = 0.0
        here = walk[-1]
        away = np.abs(row - row[here]) + np.abs(column - column[here])
        home = np.abs(row - row[base]) + np.abs(column - column[base])
        fits = (worth > 0.0) & (len(walk) - 1 + away + home <= battery)
        if not fits.any():
            return Walk(np.array(walk + _straight(here, base, columns)), battery)
        walk += _straight(here, int(np.argmax(np.where(fits, worth / np.maximum(away, 1), -1.0))), columns)


def spiral(grid: ImportanceGrid, base: int, battery: int) -> Walk:
    """Round the base, wider and wider, skipping what lies outside, and home when it is time."""
    rows, columns = grid.shape
    row, column = divmod(base, columns)
    walk, leg = [base], 1
    moves = ((0, 1), (1, 0), (0, -1), (-1, 0))
    for turn in range(4 * max(rows, columns)):
        north, east = moves[turn % 4]
        for _ in range(leg):
            row, column = row + north, column + east
            if not (0 <= row < rows and 0 <= column < columns):
                continue
            there = row * columns + column
            ahead = _straight(walk[-1], there, columns)
            if len(walk) - 1 + len(ahead) + len(_straight(there, base, columns)) > battery:
                return Walk(np.array(walk + _straight(walk[-1], base, columns)), battery)
            walk += ahead
        leg += turn % 2
    return Walk(np.array(walk + _straight(walk[-1], base, columns)), battery)


def _straight(here: int, there: int, columns: int) -> list[int]:
    """Cells after the first on the way along the column, then along the row."""
    (row, column), (to_row, to_column) = divmod(here, columns), divmod(there, columns)
    step, side = (1 if to_row > row else -1), (1 if to_column > column else -1)
    along = [r * columns + column for r in range(row + step, to_row + step, step)] if row != to_row else []
    across = (
        [to_row * columns + c for c in range(column + side, to_column + side, side)]
        if column != to_column
        else []
    )
    return along + across
