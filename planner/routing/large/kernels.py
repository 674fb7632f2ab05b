"""Compiled search over the order of many regions, each with many options. Numbers only.

Options of region c fill the first ``counts[c]`` rows of arrays (C, K, …). Costs between two regions are a
block (K, K), made when first asked for and kept in a pool. For an order of regions, ``pre[p, j]`` is the
least cost of a line from the start to option j of the region at place p, and ``suf[p, j]`` that from there to
the end: putting a region between two others then costs two products of a vector with a block, not a walk
through the whole order. Ruin and recreate after G. Schrimpf et al., "Record breaking optimization results
using the ruin and recreate principle", Journal of Computational Physics 159 (2000).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.dubins.estimate_kernels import transit_costs
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Halves = NDArray[np.float32]
Flags = NDArray[np.bool_]

#: An insertion is passed over with this chance, so that recreation does not always end alike.
BLINK = 0.02


class Web(NamedTuple):
    """Options of all regions and what there is to know of lines between them.

    Attributes
    ----------
    first, last
        Costs from the start to each option, its own included, and from it to the end, (C, K).
    pool
        Blocks of costs between two regions, (P, K, K).
    slots
        Where in the pool the block of two regions is, −1 where it is not, (C, C).
    used
        How many places of the pool are taken, (1,).
    exits, entries
        Poses of options, (C, K, 3).
    inner
        What options cost by themselves, (C, K).
    counts
        How many options each region has, (C,).
    radius
        Of turns.
    discs
        What to go round, (D, 3) or wider.
    wind
        See ``in_wind``.
    """

    first: Floats
    last: Floats
    pool: Halves
    slots: Ints
    used: Ints
    exits: Floats
    entries: Floats
    inner: Floats
    counts: Ints
    radius: float
    discs: Floats
    wind: Floats


@njit(cache=True)
def discs_between(places: Floats, others: Floats, discs: Floats, slack: float) -> Floats:
    """Those of the discs that a straight line from one of the places to one of the others may touch."""
    ce, cn = places[:, 0].mean(), places[:, 1].mean()
    de, dn = others[:, 0].mean(), others[:, 1].mean()
    reach = 0.0
    for k in range(places.shape[0]):
        reach = max(reach, math.hypot(places[k, 0] - ce, places[k, 1] - cn))
    for k in range(others.shape[0]):
        reach = max(reach, math.hypot(others[k, 0] - de, others[k, 1] - dn))
    length = math.hypot(de - ce, dn - cn)
    kept = np.zeros(discs.shape[0], dtype=np.bool_)
    for k in range(discs.shape[0]):
        along = 0.0
        if length > 0.0:
            along = ((discs[k, 0] - ce) * (de - ce) + (discs[k, 1] - cn) * (dn - cn)) / (length * length)
            along = min(max(along, 0.0), 1.0)
        away = math.hypot(discs[k, 0] - ce - along * (de - ce), discs[k, 1] - cn - along * (dn - cn))
        kept[k] = away <= discs[k, 2] + reach + slack
    return discs[kept]


@njit(cache=True)
def in_wind(length: float, offset_e: float, offset_n: float, wind: Floats) -> float:
    """Metres through the air of a line over an offset; the twin of ``vehicle.wind.still_air_costs``.

    ``wind`` is (4,): its east and north parts by the airspeed, its speed by the airspeed, and the mean cost
    of a metre over all courses.
    """
    direct = math.hypot(offset_e, offset_n)
    if direct == 0.0:
        return float(length * wind[3])
    along = (wind[0] * offset_e + wind[1] * offset_n) / direct
    across = (wind[0] * offset_n - wind[1] * offset_e) / direct
    speed = along + math.sqrt(max(1.0 - across * across, 0.0))
    return float(direct / speed + (length - direct) * wind[3])


@njit(cache=True)
def block(a: int, b: int, web: Web) -> Halves:
    """Costs from every option of region a to every option of region b, b's own cost included."""
    if web.slots[a, b] < 0:
        if web.used[0] == web.pool.shape[0]:
            web.slots[:, :] = -1
            web.used[0] = 0
        slot = web.used[0]
        web.used[0] += 1
        web.slots[a, b] = slot
        here, there = web.exits[a, : web.counts[a]], web.entries[b, : web.counts[b]]
        costs = transit_costs(here, there, web.radius, discs_between(here, there, web.discs, 0.0))
        for i in range(web.counts[a]):
            for j in range(web.counts[b]):
                cost = costs[i, j]
                if web.wind[2] > 0.0:
                    offset_e, offset_n = there[j, 0] - here[i, 0], there[j, 1] - here[i, 1]
                    cost = in_wind(cost, offset_e, offset_n, web.wind)
                web.pool[slot, i, j] = cost + web.inner[b, j]
    found: Halves = web.pool[web.slots[a, b]]
    return found


@njit(cache=True)
def forward(before: Floats, costs: Halves, rows: int, columns: int, out: Floats) -> None:
    """``out[j]`` = least ``before[i] + costs[i, j]``."""
    out[:] = np.inf
    for i in range(rows):
        so_far = before[i]
        if so_far < np.inf:
            for j in range(columns):
                cost = so_far + costs[i, j]
                if cost < out[j]:
                    out[j] = cost


@njit(cache=True)
def backward(after: Floats, costs: Halves, rows: int, columns: int, out: Floats) -> None:
    """``out[i]`` = least ``costs[i, j] + after[j]``."""
    out[:] = np.inf
    for i in range(rows):
        least = np.inf
        for j in range(columns):
            cost = costs[i, j] + after[j]
            if cost < least:
                least = cost
        out[i] = least


@njit(cache=True)
def sweep_forward(order: Ints, size: int, begin: int, pre: Floats, web: Web) -> None:
    """Fill ``pre`` from place ``begin`` on."""
    for p in range(begin, size):
        c = order[p]
        if p == 0:
            pre[0] = web.first[c]
            continue
        b = order[p - 1]
        costs = block(b, c, web)
        forward(pre[p - 1], costs, web.counts[b], web.counts[c], pre[p])


@njit(cache=True)
def sweep_backward(order: Ints, size: int, begin: int, suf: Floats, web: Web) -> None:
    """Fill ``suf`` from place ``begin`` back to the first."""
    for p in range(begin, -1, -1):
        c = order[p]
        if p == size - 1:
            suf[p] = web.last[c]
            continue
        d = order[p + 1]
        costs = block(c, d, web)
        backward(suf[p + 1], costs, web.counts[c], web.counts[d], suf[p])


@njit(cache=True)
def ruin_and_recreate(
    order: Ints,
    iterations: int,
    seed: int,
    most: int,
    heat: float,
    near: Flags,
    nearest: Ints,
    web: Web,
) -> tuple[float, Ints]:
    """Take out some regions that lie together, put each back where it costs least; keep what is shorter.

    Parameters
    ----------
    most
        Largest number of regions taken out at once.
    heat
        A little longer is kept too, by up to ``heat`` times the logarithm of a random number, falling to
        nothing in the last iteration.
    near, nearest
        Whether two regions are neighbours (C, C), and all others of each from the nearest on (C, C − 1).

    Returns
    -------
    tuple
        Cost and order (C,) of the best found.
    """
    np.random.seed(seed)
    n = len(order)
    k = web.first.shape[1]
    pre = np.empty((n, k))
    suf = np.empty((n, k))
    vector = np.empty(k)
    now = order.copy()
    sweep_forward(now, n, 0, pre, web)
    now_cost = np.inf
    for j in range(web.counts[now[n - 1]]):
        now_cost = min(now_cost, pre[n - 1, j] + web.last[now[n - 1], j])
    best, best_cost = now.copy(), now_cost
    out = np.zeros(n, dtype=np.bool_)
    removed = np.empty(n, dtype=np.int64)
    for iteration in range(iterations):
        count = 1 + np.random.randint(0, most)
        middle = np.random.randint(0, n)
        out[:] = False
        if np.random.random() < 0.5:
            begin = max(0, min(n - count, middle - np.random.randint(0, count)))
            for p in range(begin, begin + count):
                out[now[p]] = True
                removed[p - begin] = now[p]
        else:
            removed[0] = middle
            out[middle] = True
            for p in range(count - 1):
                removed[p + 1] = nearest[middle, p]
                out[nearest[middle, p]] = True
        for p in range(count - 1, 0, -1):
            q = np.random.randint(0, p + 1)
            removed[p], removed[q] = removed[q], removed[p]
        trial = np.empty(n, dtype=np.int64)
        size = 0
        for p in range(n):
            if not out[now[p]]:
                trial[size] = now[p]
                size += 1
        sweep_forward(trial, size, 0, pre, web)
        sweep_backward(trial, size, size - 1, suf, web)
        cost = np.inf
        for r in range(count):
            c = removed[r]
            cost, where = np.inf, -1
            for only_near in (True, False):
                for gap in range(size + 1):
                    if only_near:
                        if 0 < gap < size and not (near[c, trial[gap - 1]] or near[c, trial[gap]]):
                            continue
                        if np.random.random() < BLINK:
                            continue
                    if gap == 0:
                        vector[:] = web.first[c]
                    else:
                        a = trial[gap - 1]
                        costs = block(a, c, web)
                        forward(pre[gap - 1], costs, web.counts[a], web.counts[c], vector)
                    if gap == size:
                        for j in range(web.counts[c]):
                            if vector[j] + web.last[c, j] < cost:
                                cost, where = vector[j] + web.last[c, j], gap
                        continue
                    d = trial[gap]
                    costs = block(c, d, web)
                    for i in range(web.counts[c]):
                        if vector[i] < cost:
                            for j in range(web.counts[d]):
                                through = vector[i] + costs[i, j] + suf[gap, j]
                                if through < cost:
                                    cost, where = through, gap
                if where >= 0:
                    break
            if where < 0:
                cost = np.inf
                break
            for p in range(size, where, -1):
                trial[p] = trial[p - 1]
                suf[p] = suf[p - 1]
            trial[where] = c
            size += 1
            if r + 1 < count:
                sweep_forward(trial, size, where, pre, web)
                sweep_backward(trial, size, where, suf, web)
        if not cost < np.inf:
            continue
        warmth = heat * (1.0 - (iteration + 1.0) / iterations)
        if cost < now_cost - warmth * math.log(max(np.random.random(), 1e-12)):
            now, now_cost = trial, cost
            if cost < best_cost - 1e-6:
                best, best_cost = trial.copy(), cost
    return best_cost, best


@njit(cache=True)
def reverse_runs(order: Ints, longest: int, near: Flags, web: Web) -> tuple[float, Ints]:
    """One round of 2-opt: fly runs of regions the other way round where that is shorter.

    Runs up to ``longest`` that bring two neighbours side by side are tried.
    """
    n = len(order)
    k = web.first.shape[1]
    pre = np.empty((n, k))
    suf = np.empty((n, k))
    here, there = np.empty(k), np.empty(k)
    now = order.copy()
    sweep_forward(now, n, 0, pre, web)
    sweep_backward(now, n, n - 1, suf, web)
    best = np.inf
    for j in range(web.counts[now[0]]):
        best = min(best, pre[0, j] + suf[0, j])
    for i in range(n):
        for j in range(i + 1, min(n, i + longest)):
            beside = (i > 0 and near[now[i - 1], now[j]]) or (j + 1 < n and near[now[i], now[j + 1]])
            if not beside and i > 0 and j + 1 < n:
                continue
            before = i - 1
            for p in range(j, i - 1, -1):
                c = now[p]
                if p == j and before < 0:
                    here[:] = web.first[c]
                    continue
                b = now[before] if p == j else now[p + 1]
                costs = block(b, c, web)
                if p == j:
                    forward(pre[before], costs, web.counts[b], web.counts[c], here)
                else:
                    forward(here, costs, web.counts[b], web.counts[c], there)
                    here[:] = there
            c = now[i]
            total = np.inf
            if j + 1 == n:
                for q in range(web.counts[c]):
                    total = min(total, here[q] + web.last[c, q])
            else:
                d = now[j + 1]
                costs = block(c, d, web)
                forward(here, costs, web.counts[c], web.counts[d], there)
                for q in range(web.counts[d]):
                    total = min(total, there[q] + suf[j + 1, q])
            if total < best - 1e-3:
                best = total
                now[i : j + 1] = now[i : j + 1][::-1].copy()
                sweep_forward(now, n, i, pre, web)
                sweep_backward(now, n, j, suf, web)
    return best, now
