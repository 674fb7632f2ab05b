"""Compiled parts of the lower bound: lines between all cells, and the slopes that say most. Numbers only."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.bounds.cells_kernels import ENTRY, EXIT, HOLDS
from planner.bounds.lines_kernels import along, between, from_terminal, together
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@njit(cache=True)
def matrix(
    cells: Floats,
    offsets: Ints,
    region: Ints,
    looks: Floats,
    shared: Flags,
    open_pairs: Flags,
    slopes: Floats,
    radius: float,
) -> tuple[Floats, int]:
    """From each cell's exits to each other's exits, (N, N), and how many lines that were.

    Parameters
    ----------
    offsets
        Where the cells of each node begin, int64 (C + 1,).
    region
        Of each node. Strips of one region lie side by side: cells of two of its nodes have a line between
        them only if they hold passes at the same or at opposite headings.
    open_pairs
        From which cell to which a line is asked for, bool (N, N); inf between all others.
    """
    count = cells.shape[0]
    out = np.full((count, count), np.inf)
    gains = np.empty(4)
    evaluated = 0
    for b in range(len(region)):
        for c in range(len(region)):
            if b == c:
                continue
            for i in range(offsets[b], offsets[b + 1]):
                for j in range(offsets[c], offsets[c + 1]):
                    if open_pairs[i, j] and (region[b] != region[c] or together(cells[i], cells[j])):
                        out[i, j] = between(cells[i], cells[j], slopes[i], slopes[j], radius, gains)
                        evaluated += 1
                        if shared[region[b], region[c]] and looks[i] == looks[j]:
                            out[i, j] = min(out[i, j], along(cells[i], cells[j], slopes[i], slopes[j]))
    return out, evaluated


@njit(cache=True)
def terminals(terminal: Floats, cells: Floats, end: int, slopes: Floats, radius: float) -> Floats:
    """From a terminal to each cell's exits, or from these to it where ``end`` is the exit; (N,)."""
    out = np.full(cells.shape[0], np.inf)
    gains = np.empty(2)
    for k in range(cells.shape[0]):
        if cells[k, HOLDS] > 0.0:
            out[k] = from_terminal(terminal, cells[k], end, slopes[k], radius, gains)
    return out


@njit(cache=True)
def better_slopes(
    cells: Floats,
    slopes: Floats,
    prior: Ints,
    after: Ints,
    start: Floats,
    end: Floats,
    radius: float,
) -> Floats:
    """Slopes (N, 2) between the gradients of the lines into and out of each cell on the best tour through it.

    ``prior`` and ``after`` say where these lines come from and go to, −1 for start and end.
    """
    out = slopes.copy()
    four, two = np.empty(4), np.empty(2)
    for j in range(cells.shape[0]):
        if prior[j] >= 0:
            between(cells[prior[j]], cells[j], slopes[prior[j]], slopes[j], radius, four)
            into_x, into_y = four[2], four[3]
        else:
            from_terminal(start, cells[j], ENTRY, slopes[j], radius, two)
            into_x, into_y = two[0], two[1]
        if after[j] >= 0:
            between(cells[j], cells[after[j]], slopes[j], slopes[after[j]], radius, four)
            out_x, out_y = four[0], four[1]
        else:
            from_terminal(end, cells[j], EXIT, slopes[j], radius, two)
            out_x, out_y = two[0], two[1]
        out[j, 0], out[j, 1] = 0.5 * (into_x - out_x), 0.5 * (into_y - out_y)
    return out
