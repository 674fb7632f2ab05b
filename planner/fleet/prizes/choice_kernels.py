"""Compiled search for the route of most reward where places are passed in one of several ways. Numbers only.

Costs are blocks (P, P, H, H): from each place left in each way to each place met in each. For a route,
``pre[k, h]`` is the least cost from the start to its place k passed in way h, and ``suf[k, h]`` that from
there to the end, so that what one more place takes between two is a product of a vector and a block twice.
Ruin and recreate under annealing as in ``route_kernels``; where a place may go is first judged by the least
costs between places, ``least``, and for the few best so judged found exactly.
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.draw_kernels import State, draw
from planner.fleet.prizes.route_kernels import BLINK, DISLIKE, LIKE, NO_WAY, WHIM
from planner.fleet.prizes.shorten_kernels import SLACK
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: So many gaps of the route are tried exactly for each place.
TRIED = 4


@njit(cache=True, nogil=True)
def forward(costs: Floats, order: Ints, size: int, first: int, pre: Floats) -> None:
    """``pre`` from place ``first`` on, which is at least 1."""
    ways = costs.shape[2]
    for k in range(first, size):
        block = costs[order[k - 1], order[k]]
        pre[k, :] = np.inf
        for g in range(ways):
            so_far = pre[k - 1, g]
            if so_far < np.inf:
                for h in range(ways):
                    pre[k, h] = min(pre[k, h], so_far + block[g, h])


@njit(cache=True, nogil=True)
def backward(costs: Floats, order: Ints, last: int, suf: Floats) -> None:
    """``suf`` from place ``last`` back to the start."""
    ways = costs.shape[2]
    for k in range(last, -1, -1):
        block = costs[order[k], order[k + 1]]
        for g in range(ways):
            least = np.inf
            for h in range(ways):
                least = min(least, block[g, h] + suf[k + 1, h])
            suf[k, g] = least


@njit(cache=True, nogil=True)
def through(costs: Floats, before: int, node: int, behind: int, ahead: Floats, after: Floats) -> float:
    """Least cost of a route through a place between two, given what leads to one and on from the other."""
    ways = costs.shape[2]
    to, on = costs[before, node], costs[node, behind]
    met = np.full(ways, np.inf)
    for g in range(ways):
        so_far = ahead[g]
        if so_far < np.inf:
            for h in range(ways):
                met[h] = min(met[h], so_far + to[g, h])
    best = np.inf
    for g in range(ways):
        if met[g] < best:
            for h in range(ways):
                best = min(best, met[g] + on[g, h] + after[h])
    return best


@njit(cache=True, nogil=True)
def gap_for(
    costs: Floats, least: Floats, order: Ints, size: int, pre: Floats, suf: Floats, node: int, most: float
) -> tuple[float, int]:
    """What a route costs with a place in its best gap, and the place before that; inf where over ``most``."""
    judged, gaps = np.full(TRIED, np.inf), np.full(TRIED, -1)
    for k in range(size - 1):
        before, behind = order[k], order[k + 1]
        extra = least[before, node] + least[node, behind] - least[before, behind]
        if extra < judged[TRIED - 1]:
            place = TRIED - 1
            while place > 0 and judged[place - 1] > extra:
                judged[place], gaps[place] = judged[place - 1], gaps[place - 1]
                place -= 1
            judged[place], gaps[place] = extra, k
    best, gap = np.inf, -1
    for j in range(TRIED):
        k = gaps[j]
        if k >= 0:
            cost = through(costs, order[k], node, order[k + 1], pre[k], suf[k + 1])
            if cost < best:
                best, gap = cost, k
    return (best, gap) if best <= most else (np.inf, -1)


@njit(cache=True, nogil=True)
def put(order: Ints, size: int, gap: int, node: int) -> None:
    """Put a place behind another."""
    for k in range(size, gap + 1, -1):
        order[k] = order[k - 1]
    order[gap + 1] = node


@njit(cache=True, nogil=True)
def take(order: Ints, size: int, first: int, many: int) -> int:
    """Take out places from ``first`` on; the size then."""
    for k in range(first, size - many):
        order[k] = order[k + many]
    return size - many


@njit(cache=True, nogil=True)
def settle(costs: Floats, order: Ints, size: int, pre: Floats, suf: Floats) -> float:
    """Both tables of a route; its cost."""
    pre[0, :] = 0.0
    suf[size - 1, :] = 0.0
    forward(costs, order, size, 1, pre)
    backward(costs, order, size - 2, suf)
    return float(suf[0].min())


@njit(cache=True, nogil=True)
def fill_ways(
    costs: Floats, least: Floats, worth: Floats, budget: float, order: Ints, size: int, cost: float,
    outside: Ints, count: int, pre: Floats, suf: Floats, state: State, blink: float,
) -> tuple[int, float, int]:  # fmt: skip
    """Put in what is worth most for its way until nothing fits: size, cost, how many stay outside."""
    known, gaps = np.full(costs.shape[0], -1.0), np.full(costs.shape[0], -1)
    while True:
        best, pick = 0.0, -1
        for k in range(count):
            node = outside[k]
            if worth[node] <= 0.0:
                continue
            if known[node] < 0.0:
                known[node], gaps[node] = gap_for(costs, least, order, size, pre, suf, node, budget + SLACK)
            if known[node] == np.inf or known[node] > budget + SLACK:
                continue
            value = worth[node] / max(known[node] - cost, NO_WAY)
            if value > best and (blink == 0.0 or draw(state) >= blink):
                best, pick = value, k
        if pick < 0:
            return size, cost, count
        node = outside[pick]
        gap = gaps[node]
        added = known[node] - cost
        put(order, size, gap, node)
        size += 1
        count -= 1
        outside[pick] = outside[count]
        for k in range(size - 1, gap + 1, -1):
            suf[k] = suf[k - 1]
        forward(costs, order, size, gap + 1, pre)
        backward(costs, order, gap + 1, suf)
        cost = float(suf[0].min())
        left = budget - cost
        for k in range(count):
            other = outside[k]
            if known[other] == np.inf:
                # What did not fit fits no better but beside what came in.
                near = least[node, other] + least[other, node]
                if near > 2.0 * left + added:
                    continue
            if known[other] >= 0.0:
                known[other] = -1.0


@njit(cache=True, nogil=True)
def _ruin(
    near: Ints, order: Ints, size: int, place: Ints, seed: int, strings: int, longest: int, state: State
) -> int:
    """Take strings near a place out of a route; the size then. ``place`` is -1 outside."""
    for k in range(-1, near.shape[1]):
        if strings == 0 or size <= 2:
            break
        here = seed if k < 0 else near[seed, k]
        at = -1
        for j in range(1, size - 1):
            if order[j] == here:
                at = j
                break
        if at < 0:
            continue
        many = 1 + int(draw(state) * min(longest, size - 2))
        first = max(at - int(draw(state) * many), 1)
        many = min(many, size - 1 - first)
        size = take(order, size, first, many)
        strings -= 1
    return size


@njit(cache=True, nogil=True)
def _turn_round(
    costs: Floats, least: Floats, order: Ints, size: int, pre: Floats, suf: Floats, cost: float, trial: Ints
) -> float:
    """Turn stretches of a route round where that is shorter; its cost then."""
    ways = costs.shape[2]
    met, on = np.empty(ways), np.empty(ways)
    better = True
    while better:
        better = False
        for i in range(1, size - 2):
            for j in range(i + 1, size - 1):
                a, b, c, d = order[i - 1], order[i], order[j], order[j + 1]
                if least[a, c] + least[b, d] >= least[a, b] + least[c, d]:
                    continue
                met[:] = pre[i - 1]
                for k in range(j, i - 2, -1):
                    # the stretch backwards, then what follows it
                    before = a if k == j else order[k + 1]
                    node = order[k] if k >= i else d
                    block = costs[before, node]
                    on[:] = np.inf
                    for g in range(ways):
                        if met[g] < np.inf:
                            for h in range(ways):
                                on[h] = min(on[h], met[g] + block[g, h])
                    met[:] = on
                total = np.inf
                for h in range(ways):
                    total = min(total, met[h] + suf[j + 1, h])
                if total < cost - SLACK:
                    for k in range(i, j + 1):
                        trial[k] = order[i + j - k]
                    order[i : j + 1] = trial[i : j + 1]
                    cost = settle(costs, order, size, pre, suf)
                    better = True
    return cost


@njit(cache=True, nogil=True)
def anneal_ways(
    costs: Floats,
    least: Floats,
    near: Ints,
    rewards: Floats,
    budget: float,
    order: Ints,
    size: int,
    best: Ints,
    state: State,
    steps: int,
    hot: float,
    cold: float,
    per_way: float,
    longest: int,
) -> tuple[int, float, float]:
    """So many steps of ruin and recreate from a route; the best is left in ``best``: size, reward, cost.

    A route over the budget first loses what brings least. Of routes of one reward the shorter is better.
    """
    count = costs.shape[0]
    last = count - 1
    ways = costs.shape[2]
    pre, suf = np.empty((count, ways)), np.empty((count, ways))
    now, trial = order.copy(), order.copy()
    spare = np.empty(count, dtype=np.int64)
    outside, worth = np.empty(count, dtype=np.int64), np.empty(count)
    place = np.full(count, -1)
    cost = settle(costs, now, size, pre, suf)
    while cost > budget + SLACK and size > 2:
        weakest = 1
        for k in range(2, size - 1):
            if rewards[now[k]] < rewards[now[weakest]]:
                weakest = k
        size = take(now, size, weakest, 1)
        cost = settle(costs, now, size, pre, suf)
    reward = 0.0
    for k in range(size):
        reward += rewards[now[k]]
    best[:] = now
    best_size, best_reward, best_cost = size, reward, cost
    heat, cooling = hot, (cold / hot) ** (1.0 / max(steps, 1))
    for _ in range(steps if count > 2 else 0):
        heat *= cooling
        trial[:] = now
        seed = 1 + int(draw(state) * (count - 2))
        long = _ruin(near, trial, size, place, seed, 1 + int(draw(state) * 2.0), longest, state)
        place[:] = -1
        for k in range(long):
            place[trial[k]] = k
        total = 0
        power = 0.5 + 1.5 * draw(state)
        for node in range(1, last):
            if place[node] < 0:
                outside[total] = node
                total += 1
                worth[node] = 0.0
                if rewards[node] > 0.0:
                    worth[node] = rewards[node] ** power * (0.7 + 0.6 * draw(state))
        whim = draw(state)
        if whim < WHIM:
            centre = seed if whim < 0.5 * WHIM else 1 + int(draw(state) * (count - 2))
            factor = DISLIKE if whim < 0.5 * WHIM else LIKE
            worth[centre] *= factor
            for k in range(int(draw(state) * near.shape[1] * 0.3)):
                worth[near[centre, k]] *= factor
        length = settle(costs, trial, long, pre, suf)
        if length > budget + SLACK:
            continue
        long, length, total = fill_ways(
            costs, least, worth, budget, trial, long, length, outside, total, pre, suf, state, BLINK
        )
        gained = 0.0
        for k in range(long):
            gained += rewards[trial[k]]
        change = gained - reward - per_way * (length - cost)
        if change < 0.0 and draw(state) >= math.exp(change / heat):
            continue
        shorter = _turn_round(costs, least, trial, long, pre, suf, length, spare)
        if shorter < length - SLACK:
            length = shorter
            long, length, total = fill_ways(
                costs, least, worth, budget, trial, long, length, outside, total, pre, suf, state, 0.0
            )
            gained = 0.0
            for k in range(long):
                gained += rewards[trial[k]]
        now[:] = trial
        size, reward, cost = long, gained, length
        if reward > best_reward + SLACK or (reward > best_reward - SLACK and cost < best_cost - SLACK):
            best[:] = now
            best_size, best_reward, best_cost = size, reward, cost
    return best_size, best_reward, best_cost


@njit(cache=True, nogil=True)
def cheapest_ways(costs: Floats, order: Ints) -> Ints:
    """In which way each place of a route is passed where the whole is cheapest."""
    size = len(order)
    count = costs.shape[2]
    pre, suf = np.empty((size, count)), np.empty((size, count))
    settle(costs, order, size, pre, suf)
    chosen = np.empty(size, dtype=np.int64)
    chosen[0] = np.argmin(suf[0])
    for k in range(1, size):
        chosen[k] = np.argmin(costs[order[k - 1], order[k], chosen[k - 1]] + suf[k])
    return chosen
