"""Compiled ruin and recreate: strings of near jobs are taken out and put back where they cost least.

J. Christiaens and G. Vanden Berghe, "Slack induction by string removals for vehicle routing problems",
Transportation Science 54 (2020): sections 5.1 (ruin), 5.2 (recreate with blinks), 5.3 (annealing).
"""

from __future__ import annotations

import math

import numpy as np

from planner.fleet.auto.insert_kernels import (
    SLOPE,
    best_place,
    copy_member,
    cost_of,
    draw,
    place_of,
    put,
    take,
)
from planner.fleet.auto.tables import Costs, Crew, Floats, Ints, Jobs, Routes, Weights
from planner.fleet.auto.times_kernels import renew
from planner.jit import njit

#: Jobs taken out at a time on average, and the longest string.
MEAN_OUT, LONGEST = 10.0, 10.0
#: How many of the jobs left out are tried again at a time.
TRIED_AGAIN = 12
#: Chance that a string is cut in two with jobs kept between, and that those grow.
SPLIT, GROW = 0.5, 0.01


@njit(cache=True, nogil=True)
def _ruin(jobs: Jobs, routes: Routes, state: Ints, out: Ints) -> int:
    """Take out strings near one job; returns how many jobs ``out`` then holds."""
    total = routes.at.shape[0]
    inside = used = 0
    for r in range(routes.filled.shape[0]):
        inside += routes.filled[r]
        used += routes.filled[r] > 0
    if used == 0:
        return 0
    longest = min(LONGEST, inside / used)
    most = 4.0 * MEAN_OUT / (1.0 + longest) - 1.0
    strings = int(draw(state) * most + 1.0)
    seen = np.zeros(routes.filled.shape[0], dtype=np.bool_)
    seed = int(draw(state) * total)
    n = 0
    for k in range(total):
        j = jobs.near[seed, k]
        r = routes.at[j]
        if r < 0 or seen[r]:
            continue
        seen[r] = True
        count = routes.filled[r]
        length = int(draw(state) * min(float(count), longest) + 1.0)
        length = min(length, count)
        kept = 0
        if length > 1 and length < count and draw(state) < SPLIT:
            kept = 1
            while length + kept < count and draw(state) < GROW:
                kept += 1
        i = place_of(jobs, routes, j)
        span = length + kept
        low = max(1, i - span + 1)
        high = min(i, count - span + 1)
        begin = low + int(draw(state) * (high - low + 1))
        hole = begin + int(draw(state) * (length + 1)) if kept > 0 else count + 2
        first = n
        for q in range(begin, begin + span):
            if q < hole or q >= hole + kept:
                out[n] = jobs.of[routes.seq[r, q]]
                n += 1
        for q in range(first, n):
            take(jobs, routes, out[q])
        strings -= 1
        if strings <= 0:
            break
    return n


@njit(cache=True, nogil=True)
def _with_visits(jobs: Jobs, routes: Routes, out: Ints, n: int) -> int:
    """Take out the other visits of every target that lost one."""
    total = routes.at.shape[0]
    for k in range(n):
        j = out[k]
        while jobs.after[j] >= 0:
            j = jobs.after[j]
        while True:
            if routes.at[j] >= 0:
                take(jobs, routes, j)
                out[n] = j
                n += 1
            j += 1
            if j >= total or jobs.after[j] != j - 1:
                break
    return n


@njit(cache=True, nogil=True)
def _in_order(jobs: Jobs, state: Ints, out: Ints, n: int) -> None:
    """Sort what is to be put back by one of the keys, drawn; visits of one target stay in order."""
    kind = int(draw(state) * (jobs.keys.shape[0] + 2))
    key = np.empty(n)
    for k in range(n):
        j = out[k]
        own = draw(state) if kind >= jobs.keys.shape[0] else jobs.keys[kind, j]
        at = k
        while at > 0 and key[at - 1] > own:
            key[at], out[at] = key[at - 1], out[at - 1]
            at -= 1
        key[at], out[at] = own, j


@njit(cache=True, nogil=True)
def _set_apart(jobs: Jobs, routes: Routes, opened: Floats, closes: Floats, j: int, state: Ints) -> None:
    """Fix until when a visit has to have ended, so that the next may count on it."""
    r = routes.at[j]
    i = place_of(jobs, routes, j)
    ended = routes.fore[r, i, 0] + routes.fore[r, i, 1]
    u = draw(state)
    slack = 0.0 if u < 0.3 else u * u * min(3600.0, jobs.apart[j + 1] + 60.0)
    for v in range(jobs.first[j], jobs.first[j + 1]):
        jobs.late[v] = min(closes[v], ended + slack)
    for v in range(jobs.first[j + 1], jobs.first[j + 2]):
        jobs.early[v] = max(opened[v], min(closes[jobs.first[j]], ended + slack) + jobs.apart[j + 1])
        jobs.late[v] = closes[v]


@njit(cache=True, nogil=True)
def _recreate(
    jobs: Jobs,
    costs: Costs,
    crew: Crew,
    weights: Weights,
    routes: Routes,
    opened: Floats,
    closes: Floats,
    state: Ints,
    out: Ints,
    n: int,
    touched: Ints,
) -> bool:
    """Put jobs back, each where it costs least, or leave it out where that costs less."""
    total = routes.at.shape[0]
    place = np.zeros(4, dtype=np.int64)
    again = True
    while again:
        again = False
        for k in range(n):
            j = out[k]
            if j < 0 or (jobs.after[j] >= 0 and routes.at[jobs.after[j]] < 0):
                continue
            out[k] = -1
            again = True
            score = best_place(jobs, costs, crew, weights, routes, j, state, place)
            if not score < jobs.prize[j]:
                continue
            put(jobs, routes, place[0], place[1], place[2])
            m = routes.member[place[0]]
            touched[m] = 1
            if not renew(jobs, costs, crew, weights, routes, m):
                return False
            if j + 1 < total and jobs.after[j + 1] == j:
                _set_apart(jobs, routes, opened, closes, j, state)
                if not renew(jobs, costs, crew, weights, routes, m):
                    return False
        if jobs.after.max() < 0:
            break
    return True


@njit(cache=True, nogil=True)
def improve(
    jobs: Jobs,
    costs: Costs,
    crew: Crew,
    weights: Weights,
    routes: Routes,
    work: Routes,
    best: Routes,
    windows: Floats,
    state: Ints,
    value: Floats,
    heats: Floats,
) -> None:
    """Anneal once for each of ``heats``.

    ``routes`` is the solution at hand, ``work`` equal to it at entry and exit, ``best`` the best yet;
    ``windows`` holds the windows as given and those of ``best``, rows early, late, early, late; ``value`` the
    annealed cost of ``routes`` and the true one of ``best``.
    """
    total = routes.at.shape[0]
    members = crew.profile.shape[0]
    revisited = total > 0 and jobs.after.max() >= 0
    out = np.zeros(2 * total + TRIED_AGAIN + 1, dtype=np.int64)
    touched = np.zeros(members, dtype=np.int64)
    early, late = jobs.early.copy(), jobs.late.copy()
    for heat in heats:
        touched[:] = 0
        n = _ruin(jobs, work, state, out)
        if revisited:
            n = _with_visits(jobs, work, out, n)
        for j in range(total):
            if work.at[j] != routes.at[j] and routes.at[j] >= 0:
                touched[routes.member[routes.at[j]]] = 1
        absent = 0
        for j in range(total):
            if work.at[j] < 0 and routes.at[j] < 0:
                absent += 1
        if absent > 0:
            chance = TRIED_AGAIN / absent
            for j in range(total):
                if n >= out.shape[0] - 1:
                    break
                if work.at[j] < 0 and routes.at[j] < 0 and draw(state) < chance:
                    out[n] = j
                    n += 1
        if revisited:
            for k in range(n):
                # What is tried again behind a visit that stays keeps the time that one leaves it.
                if jobs.after[out[k]] >= 0 and work.at[jobs.after[out[k]]] >= 0:
                    continue
                for v in range(jobs.first[out[k]], jobs.first[out[k] + 1]):
                    jobs.early[v], jobs.late[v] = windows[0, v], windows[1, v]
        kept = True
        for m in range(members):
            if touched[m] and not renew(jobs, costs, crew, weights, work, m):
                kept = False
        if kept:
            _in_order(jobs, state, out, n)
            kept = _recreate(jobs, costs, crew, weights, work, windows[0], windows[1], state, out, n, touched)
        cost = cost_of(jobs, crew, weights, work, SLOPE) if kept else math.inf
        if cost < value[0] - heat * math.log(1.0 - draw(state)):
            value[0] = cost
            for m in range(members):
                if touched[m]:
                    copy_member(work, routes, crew, m)
            routes.at[:] = work.at
            if revisited:
                early[:], late[:] = jobs.early, jobs.late
            true = cost_of(jobs, crew, weights, work, 0.0)
            if true < value[1] - 1e-9:
                value[1] = true
                for m in range(members):
                    copy_member(work, best, crew, m)
                best.at[:] = work.at
                windows[2], windows[3] = jobs.early, jobs.late
        else:
            for m in range(members):
                if touched[m]:
                    copy_member(routes, work, crew, m)
            work.at[:] = routes.at
            if revisited:
                jobs.early[:], jobs.late[:] = early, late
