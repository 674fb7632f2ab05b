"""Compiled search for the route of most reward within a budget among places. Numbers only.

Ruin and recreate (G. Schrimpf et al., Journal of Computational Physics 159 (2000)) under annealing: strings
of the route near a place are taken out, as in slack induction by string removals (J. Christiaens and
G. Vanden Berghe, Transportation Science 54 (2020)), and what brings most reward for the way it takes is put
in until nothing fits. What each place outside would take, and where, is kept from one change to the next.
"""

# mypy: allow-untyped-decorators

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.draw_kernels import State, draw
from planner.fleet.prizes.shorten_kernels import SLACK, shorten
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: A place that takes no way at all is worth this much of it.
NO_WAY = 1e-6
#: An insertion is passed over with this chance, so that recreation does not always end alike.
BLINK = 0.02
#: So often places near one are liked, or disliked, by these factors.
WHIM = 0.4
LIKE, DISLIKE = 4.0, 0.2


@njit(cache=True, nogil=True)
def cheapest_place(costs: Floats, after: Ints, node: int, way: Floats, at: Ints) -> None:
    """Where on the route a place takes least: ``way`` and the place before it, ``at``."""
    least, place = np.inf, -1
    before = 0
    last = after.shape[0] - 1
    while before != last:
        behind = after[before]
        extra = costs[before, node] + costs[node, behind] - costs[before, behind]
        if extra < least:
            least, place = extra, before
        before = behind
    way[node] = least
    at[node] = place


@njit(cache=True, nogil=True)
def fill(
    costs: Floats,
    worth: Floats,
    budget: float,
    length: float,
    after: Ints,
    outside: Ints,
    count: int,
    way: Floats,
    at: Ints,
    state: State,
    blink: float,
) -> tuple[float, int]:
    """Put in what is worth most for its way until nothing fits; the length, and how many stay outside."""
    while True:
        best, pick = 0.0, -1
        left = budget - length + SLACK
        for k in range(count):
            node = outside[k]
            if way[node] > left or worth[node] <= 0.0:
                continue
            value = worth[node] / max(way[node], NO_WAY)
            if value > best and (blink == 0.0 or draw(state) >= blink):
                best, pick = value, k
        if pick < 0:
            return length, count
        node = outside[pick]
        before = at[node]
        behind = after[before]
        length += way[node]
        after[before] = node
        after[node] = behind
        count -= 1
        outside[pick] = outside[count]
        ahead, further = costs[before, node], costs[node, behind]
        for k in range(count):
            other = outside[k]
            if at[other] == before:
                cheapest_place(costs, after, other, way, at)
                continue
            to = costs[before, other] + costs[other, node] - ahead
            if to < way[other]:
                way[other], at[other] = to, before
            on = costs[node, other] + costs[other, behind] - further
            if on < way[other]:
                way[other], at[other] = on, node


@njit(cache=True, nogil=True)
def take_out(
    near: Ints, after: Ints, before: Ints, seed: int, strings: int, most: int, state: State, out: Ints
) -> int:
    """Strings of the route near a place, taken out: how many places, listed in ``out``.

    ``before`` is -1 for places outside.
    """
    total = 0
    last = after.shape[0] - 1
    for k in range(-1, near.shape[1]):
        if strings == 0:
            break
        here = seed if k < 0 else near[seed, k]
        if here == 0 or here == last or before[here] < 0:
            continue
        long = 1 + int(draw(state) * most)
        back = int(draw(state) * long)
        first = here
        while back > 0 and before[first] != 0:
            first = before[first]
            back -= 1
        left = before[first]
        while long > 0 and first != last:
            following = after[first]
            before[first] = -1
            out[total] = first
            total += 1
            long -= 1
            first = following
        after[left] = first
        before[first] = left
        strings -= 1
    return total


@njit(cache=True, nogil=True)
def anneal(
    costs: Floats,
    near: Ints,
    rewards: Floats,
    budget: float,
    symmetric: bool,
    order: Ints,
    size: int,
    best: Ints,
    best_size: int,
    state: State,
    steps: int,
    hot: float,
    cold: float,
    per_way: float,
    longest: int,
) -> tuple[int, int]:
    """So many steps of ruin and recreate from a route, the first at heat ``hot``, the last at ``cold``.

    ``order`` is left as the route at the end, ``best`` as the best seen; the sizes of both are returned. Of
    routes of one reward the shorter is better, by ``per_way`` of reward for its way in annealing. Strings of
    up to ``longest`` places are taken out.
    """
    count = costs.shape[0]
    last = count - 1
    after, before = np.full(count, -1), np.full(count, -1)
    now_after, now_before = np.full(count, -1), np.full(count, -1)
    way, at = np.full(count, np.inf), np.full(count, -1)
    now_way, now_at = np.full(count, np.inf), np.full(count, -1)
    outside, now_outside = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    gone, place = np.empty(count, dtype=np.int64), np.full(count, -1)
    trial = np.empty(count, dtype=np.int64)
    worth = np.empty(count)
    fresh = np.zeros(count, dtype=np.bool_)
    best_reward, best_length = 0.0, 0.0
    for k in range(best_size):
        best_reward += rewards[best[k]]
        best_length += costs[best[k], best[k + 1]] if k + 1 < best_size else 0.0
    now_reward, now_length = 0.0, 0.0
    for k in range(size):
        now_reward += rewards[order[k]]
        if k + 1 < size:
            now_length += costs[order[k], order[k + 1]]
            now_after[order[k]] = order[k + 1]
            now_before[order[k + 1]] = order[k]
    left_out = 0
    for node in range(1, last):
        if now_before[node] < 0:
            now_outside[left_out] = node
            left_out += 1
            cheapest_place(costs, now_after, node, now_way, now_at)
    cooling = (cold / hot) ** (1.0 / max(steps, 1))
    heat = hot
    for _ in range(steps):
        heat *= cooling
        after[:], before[:], way[:], at[:] = now_after, now_before, now_way, now_at
        outside[:left_out] = now_outside[:left_out]
        length = now_length
        seed = 1 + int(draw(state) * (count - 2))
        strings = 1 + int(draw(state) * 3.0)
        removed = take_out(near, after, before, seed, strings, longest, state, gone)
        total = left_out
        length = 0.0
        here = 0
        while here != last:
            length += costs[here, after[here]]
            fresh[here] = after[here] != now_after[here]
            here = after[here]
        for k in range(removed):
            way[gone[k]], at[gone[k]] = np.inf, -1
            outside[total] = gone[k]
            total += 1
        for k in range(total):
            node = outside[k]
            spot = at[node]
            if spot < 0 or (spot != 0 and before[spot] < 0) or fresh[spot]:
                cheapest_place(costs, after, node, way, at)
        here = 0
        while here != last:
            if fresh[here]:
                behind = after[here]
                for k in range(total):
                    node = outside[k]
                    extra = costs[here, node] + costs[node, behind] - costs[here, behind]
                    if extra < way[node]:
                        way[node], at[node] = extra, here
            here = after[here]
        power = 0.5 + 1.5 * draw(state)
        for k in range(total):
            node = outside[k]
            worth[node] = rewards[node] ** power * (0.7 + 0.6 * draw(state)) if rewards[node] > 0.0 else 0.0
        whim = draw(state)
        if whim < WHIM:
            # Way won in one place is spent in another.
            centre = seed if whim < 0.5 * WHIM else 1 + int(draw(state) * (count - 2))
            factor = DISLIKE if whim < 0.5 * WHIM else LIKE
            worth[centre] *= factor
            for k in range(int(draw(state) * near.shape[1])):
                worth[near[centre, k]] *= factor
        length, total = fill(costs, worth, budget, length, after, outside, total, way, at, state, BLINK)
        reward = 0.0
        here = 0
        while here != last:
            before[after[here]] = here
            reward += rewards[here]
            here = after[here]
        reward += rewards[last]
        change = reward - now_reward - per_way * (length - now_length)
        if change < 0.0 and draw(state) >= math.exp(change / heat):
            continue
        trial_size = 0
        here = 0
        place[:] = -1
        while True:
            trial[trial_size] = here
            place[here] = trial_size
            trial_size += 1
            if here == last:
                break
            here = after[here]
        saved = shorten(costs, near, trial, trial_size, place, symmetric)
        if saved > SLACK:
            length -= saved
            for k in range(trial_size - 1):
                after[trial[k]] = trial[k + 1]
            for k in range(total):
                cheapest_place(costs, after, outside[k], way, at)
            length, total = fill(costs, worth, budget, length, after, outside, total, way, at, state, 0.0)
            reward = rewards[last]
            here = 0
            while here != last:
                before[after[here]] = here
                reward += rewards[here]
                here = after[here]
        now_after[:], now_before[:], now_way[:], now_at[:] = after, before, way, at
        now_outside[:total] = outside[:total]
        left_out = total
        now_length, now_reward = length, reward
        if reward > best_reward + SLACK or (reward > best_reward - SLACK and length < best_length - SLACK):
            best_reward, best_length = reward, length
            best_size = 0
            here = 0
            while True:
                best[best_size] = here
                best_size += 1
                if here == last:
                    break
                here = after[here]
    size = 0
    here = 0
    while True:
        order[size] = here
        size += 1
        if here == last:
            break
        here = now_after[here]
    return size, best_size
