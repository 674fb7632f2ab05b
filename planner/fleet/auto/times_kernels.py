"""Compiled times of routes: the parts of a route as least duration, earliest and latest start.

Two parts that follow one another are one part (T. Vidal et al., "A unified solution framework for
multi-attribute vehicle routing problems", European Journal of Operational Research 234 (2014)), so that
putting a job between two others costs two joins, not a walk along the route.
"""

from __future__ import annotations

import math

import numpy as np

from planner.fleet.auto.tables import (
    CAPACITY,
    DURATION,
    ENERGY,
    FLIGHT,
    LANDING,
    LENGTH,
    LOAD,
    MOVING,
    PRICE,
    RANGE,
    READY,
    SHIFT_END,
    TURNAROUND,
    USED,
    WAITING,
    Costs,
    Crew,
    Floats,
    Jobs,
    Routes,
    Weights,
)
from planner.jit import njit

#: Slack of comparisons, s, m and Wh.
EPSILON = 1e-7


@njit(cache=True, nogil=True)
def join(
    d1: float, e1: float, l1: float, leg: float, d2: float, e2: float, l2: float
) -> tuple[float, float, float]:
    """One part of two, ``leg`` seconds apart; its latest start is before its earliest where it cannot be."""
    if e1 > l1 + EPSILON or e2 > l2 + EPSILON:
        # A part that cannot be makes no whole: waiting before it would hide that.
        return d1 + d2 + leg, math.inf, -math.inf
    delta = d1 + leg
    wait = max(0.0, e2 - delta - l1)
    return d1 + d2 + leg + wait, max(e2 - delta, e1) - wait, min(l2 - delta, l1)


@njit(cache=True, nogil=True)
def within(limits: Floats, duration: float, moving: float, length: float, used: float, load: float) -> bool:
    """Whether a trip keeps what one trip may take."""
    if duration > limits[FLIGHT] + EPSILON or length > limits[RANGE] + EPSILON:
        return False
    if load > limits[CAPACITY] + EPSILON:
        return False
    waited = max(0.0, duration - moving)
    return bool(used + limits[WAITING] * waited / 3600.0 <= limits[ENERGY] + EPSILON)


@njit(cache=True, nogil=True)
def forward(jobs: Jobs, costs: Costs, crew: Crew, routes: Routes, r: int, ready: float) -> bool:
    """Fill ``fore`` and ``sums`` of a route that may take off at ``ready``; False where it breaks a limit."""
    m = routes.member[r]
    p = crew.profile[m]
    count = routes.filled[r]
    fore = routes.fore[r]
    seq = routes.seq[r]
    counts_length = costs.length.shape[0] > 1 or costs.length.shape[1] > 1
    counts_energy = costs.energy.shape[0] > 1 or costs.energy.shape[1] > 1
    fore[0, 0], fore[0, 1], fore[0, 2] = 0.0, ready, math.inf
    price = length = used = moving = load = 0.0
    for i in range(1, count + 2):
        a, b = seq[i - 1], seq[i]
        leg = costs.seconds[p, a, b]
        fore[i, 3] = costs.price[p, a, b]
        price += fore[i, 3]
        if counts_length:
            length += costs.length[p, a, b]
        if counts_energy:
            used += costs.energy[p, a, b]
        if i <= count:
            service = costs.service[p, b]
            early, late = jobs.early[b], jobs.late[b] - service
            load += jobs.load[jobs.of[b]]
        else:
            service, early, late = 0.0, 0.0, crew.limits[m, SHIFT_END]
        moving += leg + service
        d, e, last = join(fore[i - 1, 0], fore[i - 1, 1], fore[i - 1, 2], leg, service, early, late)
        if not e <= last + EPSILON or not moving < math.inf:
            return False
        fore[i, 0], fore[i, 1], fore[i, 2] = d, e, last
    sums = routes.sums[r]
    sums[DURATION] = fore[count + 1, 0]
    sums[LANDING] = fore[count + 1, 0] + fore[count + 1, 1]
    sums[PRICE], sums[LENGTH], sums[USED], sums[MOVING], sums[LOAD] = price, length, used, moving, load
    return within(crew.limits[m], sums[DURATION], moving, length, used, load)


@njit(cache=True, nogil=True)
def backward(jobs: Jobs, costs: Costs, crew: Crew, routes: Routes, r: int, cap: float) -> None:
    """Fill ``back`` of a route that has to land by ``cap``."""
    p = crew.profile[routes.member[r]]
    count = routes.filled[r]
    back = routes.back[r]
    seq = routes.seq[r]
    back[count + 1, 0], back[count + 1, 1], back[count + 1, 2] = 0.0, 0.0, cap
    for i in range(count, 0, -1):
        v = seq[i]
        service = costs.service[p, v]
        d, e, last = join(
            service,
            jobs.early[v],
            jobs.late[v] - service,
            costs.seconds[p, v, seq[i + 1]],
            back[i + 1, 0],
            back[i + 1, 1],
            back[i + 1, 2],
        )
        back[i, 0], back[i, 1], back[i, 2] = d, e, last


@njit(cache=True, nogil=True)
def _land(
    jobs: Jobs, costs: Costs, crew: Crew, weights: Weights, routes: Routes, r: int, ready: float
) -> bool:
    """Take the best of the bases to land at."""
    m = routes.member[r]
    first, last = crew.ends_first[m], crew.ends_first[m + 1]
    if last - first == 1:
        routes.seq[r, routes.filled[r] + 1] = crew.ends[first]
        return forward(jobs, costs, crew, routes, r, ready)
    best, chosen = math.inf, -1
    for k in range(first, last):
        routes.seq[r, routes.filled[r] + 1] = crew.ends[k]
        if forward(jobs, costs, crew, routes, r, ready):
            sums = routes.sums[r]
            cost = weights.time * sums[DURATION] + sums[PRICE] + (weights.landing + 1e-9) * sums[LANDING]
            if cost < best:
                best, chosen = cost, crew.ends[k]
    if chosen < 0:
        return False
    routes.seq[r, routes.filled[r] + 1] = chosen
    return forward(jobs, costs, crew, routes, r, ready)


@njit(cache=True, nogil=True)
def renew(jobs: Jobs, costs: Costs, crew: Crew, weights: Weights, routes: Routes, m: int) -> bool:
    """Fill everything of a member's routes anew, emptied ones closed up; False where a limit breaks."""
    first, last = crew.first[m], crew.first[m + 1]
    used = first
    for r in range(first, last):
        if routes.filled[r] == 0:
            continue
        if r != used:
            routes.filled[used] = routes.filled[r]
            routes.seq[used, : routes.filled[r] + 2] = routes.seq[r, : routes.filled[r] + 2]
            for i in range(1, routes.filled[r] + 1):
                routes.at[jobs.of[routes.seq[r, i]]] = used
            routes.filled[r] = 0
        used += 1
    base, ready = crew.start[m], crew.limits[m, READY]
    for r in range(first, used):
        routes.seq[r, 0] = base
        kept = (
            _land(jobs, costs, crew, weights, routes, r, ready)
            if r == used - 1
            else forward(jobs, costs, crew, routes, r, ready)
        )
        if not kept:
            return False
        base = routes.seq[r, routes.filled[r] + 1]
        ready = routes.sums[r, LANDING] + crew.limits[m, TURNAROUND]
    cap = crew.limits[m, SHIFT_END]
    for r in range(used - 1, first - 1, -1):
        backward(jobs, costs, crew, routes, r, cap)
        lead = costs.seconds[crew.profile[m], routes.seq[r, 0], routes.seq[r, 1]]
        _, _, latest = join(
            0.0, 0.0, math.inf, lead, routes.back[r, 1, 0], routes.back[r, 1, 1], routes.back[r, 1, 2]
        )
        cap = latest - crew.limits[m, TURNAROUND]
    for r in range(used, last):
        routes.seq[r, 0] = base
        routes.seq[r, 1] = crew.ends[crew.ends_first[m]]
        routes.fore[r, 0, 0], routes.fore[r, 0, 1], routes.fore[r, 0, 2] = 0.0, ready, np.inf
        backward(jobs, costs, crew, routes, r, crew.limits[m, SHIFT_END])
        routes.sums[r] = 0.0
    return True
