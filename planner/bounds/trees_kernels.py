"""Compiled parts of the lower bound for many regions: lines between cells of neighbours, and the ascent."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.bounds.cells_kernels import ENTRY, EXIT, INNER, INNER_DEV, INNER_GAIN, INNER_JUMP
from planner.bounds.lines_kernels import between, from_terminal, together
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Prices(NamedTuple):
    """Prices of nodes, (C,), potentials of cells, (N,), and prices of turning back, by neighbour (see
    ``places``) and cell, (S, N), the last not negative.
    """

    price: Floats
    potential: Floats
    back: Floats

    def copied(self) -> Prices:
        """Of their own."""
        return Prices(self.price.copy(), self.potential.copy(), self.back.copy())


@njit(cache=True)
def blocks(
    cells: Floats, slopes: Floats, offsets: Ints, region: Ints, pairs: Ints, begins: Ints, radius: float
) -> Floats:
    """From all cells of one node to all of another, for pairs of nodes (P, 2), one block after the other.

    Block p begins at ``begins[p]`` and is row by row; ``begins`` ends with the length of the result.
    """
    out = np.empty(begins[-1])
    gains = np.empty(4)
    for p in range(len(pairs)):
        b, c = pairs[p, 0], pairs[p, 1]
        at = begins[p]
        for i in range(offsets[b], offsets[b + 1]):
            for j in range(offsets[c], offsets[c + 1]):
                out[at] = np.inf
                if region[b] != region[c] or together(cells[i], cells[j]):
                    out[at] = between(cells[i], cells[j], slopes[i], slopes[j], radius, gains)
                at += 1
    return out


@njit(cache=True)
def along_order(
    order: Ints,
    cells: Floats,
    slopes: Floats,
    offsets: Ints,
    region: Ints,
    start: Floats,
    end: Floats,
    radius: float,
) -> tuple[Floats, Floats, Ints, Ints]:
    """Least costs of the tour in a given order of nodes, up to each cell's exits and from them on.

    Returns
    -------
    ndarray, ndarray
        Float64 (N,).
    ndarray, ndarray
        Which cells are best before and after each, int64 (N,), −1 for the ends.
    """
    count = len(cells)
    ahead, behind = np.full(count, np.inf), np.full(count, np.inf)
    prior, after = np.full(count, -1), np.full(count, -1)
    two, four = np.empty(2), np.empty(4)
    nodes = len(order)
    for j in range(offsets[order[0]], offsets[order[0] + 1]):
        ahead[j] = from_terminal(start, cells[j], ENTRY, slopes[j], radius, two)
    for j in range(offsets[order[-1]], offsets[order[-1] + 1]):
        behind[j] = from_terminal(end, cells[j], EXIT, slopes[j], radius, two)
    widest = 0
    for c in range(nodes):
        widest = max(widest, offsets[c + 1] - offsets[c])
    legs = np.full((nodes, widest, widest), np.inf)
    for k in range(nodes - 1):
        b, c = order[k], order[k + 1]
        for i in range(offsets[b], offsets[b + 1]):
            for j in range(offsets[c], offsets[c + 1]):
                if region[b] == region[c] and not together(cells[i], cells[j]):
                    continue
                leg = between(cells[i], cells[j], slopes[i], slopes[j], radius, four)
                legs[k, i - offsets[b], j - offsets[c]] = leg
                if ahead[i] + leg < ahead[j]:
                    ahead[j], prior[j] = ahead[i] + leg, i
    for k in range(nodes - 2, -1, -1):
        b, c = order[k], order[k + 1]
        for i in range(offsets[b], offsets[b + 1]):
            for j in range(offsets[c], offsets[c + 1]):
                cost = legs[k, i - offsets[b], j - offsets[c]] + behind[j]
                if cost < behind[i]:
                    behind[i], after[i] = cost, j
    return ahead, behind, prior, after


@njit(cache=True)
def reach(cells: Floats, middle: Floats) -> tuple[float, float]:
    """How far entries and exits lie from a place at most, and the least inner cost, slopes left out."""
    far, inner = 0.0, np.inf
    for k in range(len(cells)):
        for end in (ENTRY, EXIT):
            away = math.hypot(cells[k, end] - middle[0], cells[k, end + 1] - middle[1])
            far = max(far, away + cells[k, end + 6])
        inner = min(
            inner, cells[k, INNER] - abs(cells[k, INNER_GAIN]) - cells[k, INNER_DEV] - cells[k, INNER_JUMP]
        )
    return far, inner


@njit(cache=True)
def places(pairs: Ints, nodes: int) -> tuple[Ints, int]:
    """Of each pair, which of its neighbours either node counts the other as, (P, 2); the most there are."""
    counts = np.zeros(nodes, dtype=np.int64)
    known = np.full((nodes, nodes), -1)
    for p in range(len(pairs)):
        b, c = pairs[p, 0], pairs[p, 1]
        known[b, c] = counts[b]
        counts[b] += 1
    out = np.empty((len(pairs), 2), dtype=np.int64)
    for p in range(len(pairs)):
        b, c = pairs[p, 0], pairs[p, 1]
        out[p, 0], out[p, 1] = known[b, c], known[c, b]
    return out, counts.max()


@njit(cache=True)
def _far_lines(
    base: Floats, offsets: Ints, leave: Floats, arrive: Floats, slack: Floats, lines: Floats, ends: Ints
) -> None:
    """Least lines between all nodes by how far apart they are: fills lines (C, C), their cells (C, C, 2)."""
    n = len(base)
    low, high = np.empty(n), np.empty(n)
    at = np.empty((n, 2), dtype=np.int64)
    for c in range(n):
        low[c], high[c] = np.inf, np.inf
        for i in range(offsets[c], offsets[c + 1]):
            if leave[i] - slack[i] < low[c]:
                low[c], at[c, 0] = leave[i] - slack[i], i
            if arrive[i] - slack[i] < high[c]:
                high[c], at[c, 1] = arrive[i] - slack[i], i
    for b in range(n):
        for c in range(n):
            lines[b, c] = base[b, c] + low[b] + high[c]
            ends[b, c, 0], ends[b, c, 1] = at[b, 0], at[c, 1]


@njit(cache=True)
def _near_lines(
    flat: Floats,
    begins: Ints,
    pairs: Ints,
    place: Ints,
    offsets: Ints,
    leave: Floats,
    arrive: Floats,
    back: Floats,
    lines: Floats,
    ends: Ints,
) -> None:
    """Least lines of pairs, over what ``_far_lines`` has filled in."""
    widest = 0
    for c in range(len(offsets) - 1):
        widest = max(widest, offsets[c + 1] - offsets[c])
    inward = np.empty(widest)
    for p in range(len(pairs)):
        b, c = pairs[p, 0], pairs[p, 1]
        begin, wide = offsets[c], offsets[c + 1] - offsets[c]
        for j in range(wide):
            inward[j] = arrive[begin + j] + back[place[p, 1], begin + j]
        at = begins[p]
        lines[b, c] = np.inf
        for i in range(offsets[b], offsets[b + 1]):
            least, least_at = np.inf, 0
            for j in range(wide):
                if flat[at + j] + inward[j] < least:
                    least, least_at = flat[at + j] + inward[j], j
            at += wide
            least += leave[i] + back[place[p, 0], i]
            if least < lines[b, c]:
                lines[b, c], ends[b, c, 0], ends[b, c, 1] = least, i, begin + least_at


@njit(cache=True)
def _least_tree(lines: Floats, price: Floats, chosen: Ints) -> float:
    """Cost of the least tree; the lines it is of, from and to, fill ``chosen`` (C − 1, 2)."""
    n = len(price)
    key, parent = np.full(n, np.inf), np.full(n, -1)
    done = np.zeros(n, dtype=np.bool_)
    key[0], total = 0.0, 0.0
    for k in range(n):
        u = -1
        for v in range(n):
            if not done[v] and (u < 0 or key[v] < key[u]):
                u = v
        done[u] = True
        total += key[u]
        if k > 0:
            v = parent[u]
            if lines[u, v] < lines[v, u]:
                chosen[k - 1, 0], chosen[k - 1, 1] = u, v
            else:
                chosen[k - 1, 0], chosen[k - 1, 1] = v, u
        for v in range(n):
            if not done[v]:
                cost = min(lines[u, v], lines[v, u]) + price[u] + price[v]
                if cost < key[v]:
                    key[v], parent[v] = cost, u
    return total


@njit(cache=True)
def _least_end(ends: Floats, level: Floats, offsets: Ints, price: Floats) -> tuple[float, int, int]:
    """The least line from the start or to the end: its cost, cell and node."""
    least, at, node = np.inf, 0, 0
    for c in range(len(price)):
        for i in range(offsets[c], offsets[c + 1]):
            if ends[i] + level[i] + price[c] < least:
                least, at, node = ends[i] + level[i] + price[c], i, c
    return least, at, node


@njit(cache=True)
def ascent(
    flat: Floats,
    begins: Ints,
    pairs: Ints,
    base: Floats,
    first: Floats,
    last: Floats,
    slack: Floats,
    offsets: Ints,
    at: Prices,
    best: Prices,
    used: Ints,
    came: Ints,
    went: Ints,
    state: Floats,
    target: float,
    steps: int,
) -> bool:
    """Subgradient ascent on prices of nodes, potentials of cells and prices of turning back.

    A tour is a tree over the nodes with a line from the start and one to the end, every node with two lines,
    one into and one out of the same cell, to other nodes than it comes from. Prices on lines at a node and
    potentials of cells, added to lines out and taken from lines in, change all tours alike. A price of
    turning back, of a cell and a neighbour, is paid by lines of the cell to and from that neighbour and given
    back by every visit of the cell: no tour pays it twice, a tree may. Any of them give a bound: the least
    tree of the least lines.

    Parameters
    ----------
    flat, begins, pairs
        See ``blocks``.
    base
        Least cost between nodes that are no pair, without slopes, (C, C).
    first, last
        From the start to each cell's exits, from these to the end, (N,).
    slack
        What slopes can make of a line at most, by cell, (N,).
    at, best
        Prices that the ascent has come to, and those of the best bound met; both are changed.
    used, came, went
        How often each cell was in a tree, and the last cells before and after it there, −1 for the ends and
        −2 where there was none; int64 (N,), changed.
    state
        The best bound met, the scale of steps, and how many have gained nothing, (3,); changed.
    target
        Length of a known tour: sets the step.

    Returns
    -------
    bool
        Whether further steps may gain anything.
    """
    price, potential, back = at
    n, count = len(price), len(potential)
    place, _ = places(pairs, n)
    number = np.full((n, n), -1)
    for p in range(len(pairs)):
        number[pairs[p, 0], pairs[p, 1]] = p
    lines = np.empty((n, n))
    ends = np.empty((n, n, 2), dtype=np.int64)
    tree = np.empty((n - 1, 2), dtype=np.int64)
    turn, visits = np.empty(count), np.empty(count)
    turned = np.zeros(back.shape)
    for _ in range(steps):
        given = 0.5 * back.sum(axis=0)
        leave, arrive = potential - given, -potential - given
        _far_lines(base, offsets, leave, arrive, slack, lines, ends)
        _near_lines(flat, begins, pairs, place, offsets, leave, arrive, back, lines, ends)
        bound = _least_tree(lines, price, tree) - 2.0 * price.sum()
        degree = np.full(n, -2.0)
        turn[:], visits[:], turned[:] = 0.0, 0.0, 0.0
        for k in range(n - 1):
            b, c = tree[k, 0], tree[k, 1]
            i, j = ends[b, c, 0], ends[b, c, 1]
            degree[b] += 1.0
            degree[c] += 1.0
            turn[i] += 1.0
            turn[j] -= 1.0
            visits[i] += 0.5
            visits[j] += 0.5
            used[i] += 1
            used[j] += 1
            went[i], came[j] = j, i
            if number[b, c] >= 0:
                turned[place[number[b, c], 0], i] += 1.0
                turned[place[number[b, c], 1], j] += 1.0
        cost, j, c = _least_end(first, arrive, offsets, price)
        bound, came[j] = bound + cost, -1
        degree[c] += 1.0
        turn[j] -= 1.0
        visits[j] += 0.5
        cost, i, b = _least_end(last, leave, offsets, price)
        bound, went[i] = bound + cost, -1
        degree[b] += 1.0
        turn[i] += 1.0
        visits[i] += 0.5
        if bound > state[0] + 1e-6 * target:
            state[0], state[2] = bound, 0.0
            best.price[:], best.potential[:], best.back[:] = price, potential, back
        else:
            state[2] += 1.0
            if state[2] >= 15.0:
                state[1], state[2] = state[1] * 0.7, 0.0
        norm = (degree**2).sum() + (turn**2).sum()
        for i in range(count):
            if visits[i] > 0.0:
                for k in range(len(back)):
                    turned[k, i] -= visits[i]
                    if back[k, i] > 0.0 or turned[k, i] > 0.0:
                        norm += turned[k, i] ** 2
        if norm == 0.0 or state[1] < 1e-4:
            return False
        step = state[1] * max(target - bound, 1e-3 * target) / norm
        price += step * degree
        potential += step * turn
        for i in range(count):
            if visits[i] > 0.0:
                for k in range(len(back)):
                    back[k, i] = max(back[k, i] + step * turned[k, i], 0.0)
    return True
