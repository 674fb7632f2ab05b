"""Compiled insertion of a job at the best place of all routes, and its removal."""

from __future__ import annotations

import math

import numpy as np

from planner.fleet.auto.tables import (
    CAPACITY,
    DURATION,
    IDLE,
    LANDING,
    LENGTH,
    LOAD,
    MOVING,
    PRICE,
    USED,
    Costs,
    Crew,
    Floats,
    Ints,
    Jobs,
    Routes,
    Weights,
)
from planner.fleet.auto.times_kernels import EPSILON, join, within
from planner.jit import njit

#: A place is passed over with this chance, so that recreation does not always end alike.
BLINK = 0.01
#: What every landing weighs beside the last, so that a search for an early last landing sees a slope.
SLOPE = 0.02
#: Of more routes than these only those with one of so many nearest jobs are looked at, and empty ones.
MANY, NEAREST = 16, 40


@njit(cache=True, nogil=True)
def draw(state: Ints) -> float:
    """The next random number in [0, 1): xorshift, Marsaglia (2003)."""
    x = state[0]
    x ^= (x << 13) & 0x7FFFFFFFFFFFFFFF
    x ^= x >> 7
    x ^= (x << 17) & 0x7FFFFFFFFFFFFFFF
    state[0] = x
    return float((x & 0xFFFFFFFFFFFF) / 281474976710656.0)


@njit(cache=True, nogil=True)
def best_place(
    jobs: Jobs, costs: Costs, crew: Crew, weights: Weights, routes: Routes, j: int, state: Ints, place: Ints
) -> float:
    """What the best place for a job costs; ``place`` takes route, place in it, node and base to land at."""
    counts_length = costs.length.shape[0] > 1 or costs.length.shape[1] > 1
    counts_energy = costs.energy.shape[0] > 1 or costs.energy.shape[1] > 1
    timed = weights.time > 0.0 or weights.landing > 0.0
    best = math.inf
    top = 0.0
    if weights.landing > 0.0:
        for r in range(routes.filled.shape[0]):
            if routes.filled[r] > 0:
                top = max(top, routes.sums[r, LANDING])
    last_twin = -1
    many = routes.filled.shape[0] > MANY
    close = np.zeros(routes.filled.shape[0] if many else 0, dtype=np.bool_)
    if many:
        for k in range(min(NEAREST + 1, jobs.near.shape[1])):
            r = routes.at[jobs.near[j, k]]
            if r >= 0:
                close[r] = True
    for m in range(crew.profile.shape[0]):
        p = crew.profile[m]
        limits = crew.limits[m]
        for r in range(crew.first[m], crew.first[m + 1]):
            count = routes.filled[r]
            if count == 0 and r == crew.first[m]:
                if crew.twin[m] == last_twin:
                    break
                last_twin = crew.twin[m]
            if many and count > 0 and not close[r]:
                continue
            if routes.sums[r, LOAD] + jobs.load[j] > limits[CAPACITY] + EPSILON:
                continue
            free = r == crew.first[m + 1] - 1 or count == 0 or routes.filled[r + 1] == 0
            seq, fore, back, sums = routes.seq[r], routes.fore[r], routes.back[r], routes.sums[r]
            ends = crew.ends_first[m + 1] - crew.ends_first[m] if free else 1
            for v in range(jobs.first[j], jobs.first[j + 1]):
                service = costs.service[p, v]
                if not service < math.inf:
                    continue
                early, late = jobs.early[v], jobs.late[v] - service
                seconds_to, seconds_from = costs.seconds_to[p, v], costs.seconds[p, v]
                price_to, price_from = costs.price_to[p, v], costs.price[p, v]
                for i in range(count + ends):
                    a = seq[min(i, count)]
                    if i < count or not free:
                        b = seq[i + 1]
                        tail = i + 1
                    else:
                        b = crew.ends[crew.ends_first[m] + i - count]
                        tail = count + 1
                    i = min(i, count)
                    price = price_to[a] + price_from[b]
                    if count > 0:
                        price -= fore[i + 1, 3]
                    if not timed and count > 0 and price >= best:
                        continue
                    there = seconds_to[a]
                    if fore[i, 0] + fore[i, 1] + there > late + EPSILON:
                        continue
                    d, e, last = join(fore[i, 0], fore[i, 1], fore[i, 2], there, service, early, late)
                    onward = seconds_from[b]
                    d, e, last = join(d, e, last, onward, back[tail, 0], back[tail, 1], back[tail, 2])
                    if not e <= last + EPSILON:
                        continue
                    score = price + weights.time * (d - sums[DURATION])
                    if count == 0 and r == crew.first[m]:
                        score -= limits[IDLE]
                    if weights.landing > 0.0:
                        landing = d + e
                        rise = max(0.0, landing - top) + SLOPE * (landing - sums[LANDING])
                        score += weights.landing * rise
                    if score >= best:
                        continue
                    moving = sums[MOVING] + there + onward + service
                    length, used = sums[LENGTH], sums[USED]
                    if counts_length:
                        length += costs.length[p, a, v] + costs.length[p, v, b]
                    if counts_energy:
                        used += costs.energy[p, a, v] + costs.energy[p, v, b]
                    if count > 0:
                        b = seq[i + 1]
                        moving -= costs.seconds[p, a, b]
                        if counts_length:
                            length -= costs.length[p, a, b]
                        if counts_energy:
                            used -= costs.energy[p, a, b]
                    if not within(limits, d, moving, length, used, 0.0):
                        continue
                    if draw(state) < BLINK:
                        continue
                    best = score
                    place[0], place[1], place[2] = r, i + 1, v
            if count == 0:
                break
    return best


@njit(cache=True, nogil=True)
def put(jobs: Jobs, routes: Routes, r: int, i: int, v: int) -> None:
    """Put a node at place ``i`` of a route; its times are to be renewed."""
    seq = routes.seq[r]
    for k in range(routes.filled[r] + 1, i - 1, -1):
        seq[k + 1] = seq[k]
    seq[i] = v
    routes.filled[r] += 1
    routes.at[jobs.of[v]] = r


@njit(cache=True, nogil=True)
def place_of(jobs: Jobs, routes: Routes, j: int) -> int:
    """At which place of its route a job is."""
    r = routes.at[j]
    for i in range(1, routes.filled[r] + 1):
        if jobs.of[routes.seq[r, i]] == j:
            return i
    return -1


@njit(cache=True, nogil=True)
def take(jobs: Jobs, routes: Routes, j: int) -> None:
    """Take a job out of its route; its times are to be renewed."""
    r = routes.at[j]
    seq = routes.seq[r]
    for k in range(place_of(jobs, routes, j), routes.filled[r] + 1):
        seq[k] = seq[k + 1]
    routes.filled[r] -= 1
    routes.at[j] = -1


@njit(cache=True, nogil=True)
def cost_of(jobs: Jobs, crew: Crew, weights: Weights, routes: Routes, slope: float) -> float:
    """What a solution costs, what it leaves out included; ``slope`` weighs every landing beside the last."""
    cost = top = landings = 0.0
    for r in range(routes.filled.shape[0]):
        if routes.filled[r] > 0:
            sums: Floats = routes.sums[r]
            cost += weights.time * sums[DURATION] + sums[PRICE]
            top = max(top, sums[LANDING])
            landings += sums[LANDING]
    for j in range(routes.at.shape[0]):
        if routes.at[j] < 0:
            cost += jobs.prize[j]
    for m in range(crew.profile.shape[0]):
        if routes.filled[crew.first[m]] == 0:
            cost += crew.limits[m, IDLE]
    return cost + weights.landing * (top + slope * landings)


@njit(cache=True, nogil=True)
def copy_member(source: Routes, target: Routes, crew: Crew, m: int) -> None:
    """Make a member's routes in ``target`` those of ``source``; where its jobs are is not copied."""
    for r in range(crew.first[m], crew.first[m + 1]):
        target.filled[r] = source.filled[r]
        for i in range(source.filled[r] + 2):
            target.seq[r, i] = source.seq[r, i]
            for k in range(4):
                target.fore[r, i, k] = source.fore[r, i, k]
                target.back[r, i, k] = source.back[r, i, k]
        for k in range(7):
            target.sums[r, k] = source.sums[r, k]
